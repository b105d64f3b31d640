//! Stations rotated about their verticals, and clocks with other origins.

use nalgebra::{DMatrix, Vector3};
use resect_core::deployment::Deployment;
use resect_core::geometry::{LevelTransform, RigidTransform};
use resect_core::network::Number;
use resect_tools::simulation::EPOCH_S;

use super::cases::complaints;
use super::told::{OF_STAMPS, in_another_frame};

/// Rotates a station's zero direction: its azimuths increase, its points rotate clockwise.
fn turn_station(deployment: &mut Deployment, station: usize, by_rad: f64) {
    for m in &mut deployment.tracks[station].measurements {
        m.azimuth_rad += by_rad;
    }
    for point in deployment.control_points.iter_mut().flat_map(|set| &mut set.points) {
        if let Some(polar) = &mut point.readings[station] {
            polar.azimuth_rad += by_rad;
        }
    }
}

/// Returns the covariance of a calibration in a rotated frame.
fn turned(covariance: &DMatrix<f64>, new_from_old: &RigidTransform) -> DMatrix<f64> {
    let mut turn = DMatrix::identity(covariance.nrows(), covariance.ncols());
    for from in (0..covariance.nrows()).step_by(4) {
        turn.fixed_view_mut::<3, 3>(from, from).copy_from(new_from_old.rotation.matrix());
    }
    &turn * covariance * turn.transpose()
}

/// Returns the violations after rotations of the stations by these angles.
fn complaints_of_turning(by_rad: [f64; 3]) -> Vec<String> {
    complaints(
        |deployment| (0..3).for_each(|station| turn_station(deployment, station, by_rad[station])),
        |before, after, method| {
            let back = |station: usize| -> RigidTransform {
                LevelTransform::new(Vector3::zeros(), by_rad[station]).into()
            };
            let new_from_old = back(0).inverse();
            let expected = before.transforms.map_each(|station, transform| {
                new_from_old.then_from(transform).then_from(&back(station.index()))
            });
            let covariance = before.covariance.as_ref().map(|c| turned(c, &new_from_old));
            let within = in_another_frame(method);
            let mut wrong = after.says_else(before, within);
            wrong.extend(after.stands_elsewhere(&expected, covariance.as_ref(), within));
            wrong
        },
    )
}

#[test]
fn turning_stations_2_and_3_turns_their_transforms_back_and_nothing_else() {
    // Across the wrap of azimuths, and beyond half a turn.
    for by_rad in [[0.0, -2.0, 3.1], [0.0, 0.3, -4.0]] {
        let complaints = complaints_of_turning(by_rad);
        assert!(complaints.is_empty(), "{by_rad:?}: {complaints:#?}");
    }
}

#[test]
fn turning_station_1_turns_the_whole_answer() {
    // The dominant source of σ is reported along x and y, which have other directions now.
    let mut complaints = complaints_of_turning([1.2, 0.5, 0.0]);
    complaints.retain(|what| !what.contains("largest part of σ"));
    assert!(complaints.is_empty(), "{complaints:#?}");
}

fn shift_clocks(deployment: &mut Deployment, by_s: f64) {
    for track in &mut deployment.tracks {
        track.measurements.iter_mut().for_each(|m| m.time_s += by_s);
        track.own_clock_s.iter_mut().for_each(|time_s| *time_s += by_s);
    }
    for fix in deployment.gnss.iter_mut().flatten().flatten() {
        fix.time_s += by_s;
    }
}

#[test]
fn clocks_that_begin_elsewhere_change_nothing() {
    for by_s in [4096.0, 1.6e9 - 0.03125, -EPOCH_S] {
        let complaints = complaints(
            |deployment| shift_clocks(deployment, by_s),
            |before, after, _| {
                let mut wrong = after.says_else(before, OF_STAMPS);
                let covariance = before.covariance.as_ref();
                wrong.extend(after.stands_elsewhere(&before.transforms, covariance, OF_STAMPS));
                wrong
            },
        );
        assert!(complaints.is_empty(), "{by_s} s later: {complaints:#?}");
    }
}
