//! Stations with other numbers, and their prisms.

use nalgebra::DMatrix;
use resect_core::calibration::Method;
use resect_core::deployment::Deployment;
use resect_core::network::{Number, Pair, Prism};

use super::cases::complaints;
use super::told::{OF_PROBES, ROUNDING, Within, in_another_frame};

/// Renumbers the stations: station `i` is the former station `from[i]`.
fn renumber(deployment: &mut Deployment, from: [usize; 3]) {
    deployment.tracks = from.map(|station| deployment.tracks[station].clone()).into();
    deployment.time_corrections =
        from.map(|station| deployment.time_corrections[station].clone()).into();
    for point in deployment.control_points.iter_mut().flat_map(|set| &mut set.points) {
        point.readings = from.map(|station| point.readings[station]).into();
    }
    let Some(rig) = &mut deployment.rig else { return };
    let old = &rig.inter_prism_m;
    rig.inter_prism_m = old.map_each(|pair: Pair, _| {
        let [a, b] = pair.indices().map(|prism| Prism::at(from[prism]));
        old[Pair { first: a.min(b), second: a.max(b) }]
    });
    for prisms_m in [&mut rig.prisms_m, &mut rig.in_vehicle_m].into_iter().flatten() {
        *prisms_m = from.map(|prism| prisms_m[prism]).into();
    }
}

/// Returns the violations after renumbering the stations.
fn complaints_of_renumbering(from: [usize; 3], within: fn(Method) -> Within) -> Vec<String> {
    complaints(
        |deployment| renumber(deployment, from),
        |before, after, method| {
            let old_first = before.transforms[from[0]].inverse();
            let expected =
                from.map(|station| old_first.then_from(&before.transforms[station])).into();
            // With another station 1, σ refer to another frame.
            let swapped = before
                .covariance
                .as_ref()
                .map(|own| DMatrix::from_fn(8, 8, |i, j| own[((i + 4) % 8, (j + 4) % 8)]));
            let covariance = if from[0] == 0 { swapped } else { after.covariance.clone() };
            let within = within(method);
            let mut wrong = after.says_else(before, within);
            wrong.extend(after.stands_elsewhere(&expected, covariance.as_ref(), within));
            wrong
        },
    )
}

#[test]
fn stations_2_and_3_change_places_with_their_numbers() {
    let complaints = complaints_of_renumbering([0, 2, 1], in_another_frame);
    assert!(complaints.is_empty(), "{complaints:#?}");
}

/// Tolerances for calibrations relative to another station 1.
fn about_another_station(method: Method) -> Within {
    match method {
        // The reference clock and plumb line, relative to which the priors are defined, are another station's.
        Method::Joint => Within { sigmas: 0.5, millimetres: 1.0, ..OF_PROBES },
        // Each station is aligned to station 1 separately; the composition of
        // two alignments equals the third to the first order of the noise.
        Method::StaticGcp | Method::DynamicGcp => {
            Within { sigmas: 1e-3, millimetres: 1e-3, ..ROUNDING }
        }
        Method::TwoPoint | Method::InterPrism => ROUNDING,
    }
}

#[test]
fn another_station_1_leaves_the_stations_where_they_stood() {
    // Findings relative to station 1 refer to another one now, and of two indistinguishable solutions either may fit better.
    let about_station_1 = [
        "stamps are",
        "least certain",
        "largest part of σ",
        "measured distance",
        "another minimum fits better",
    ];
    for from in [[1, 0, 2], [1, 2, 0]] {
        let mut complaints = complaints_of_renumbering(from, about_another_station);
        complaints.retain(|what| !about_station_1.iter().any(|words| what.contains(words)));
        assert!(complaints.is_empty(), "from {from:?}: {complaints:#?}");
    }
}
