//! Local minima of method D, on simulated deployments and the published one.

use crate::common::{analyse, answer, of_field, published};
use resect_core::calibration::inter_prism::{SAME_TRANSLATION_M, SAME_YAW_RAD};
use resect_core::deployment::Deployment;
use resect_core::geometry::wrap_to_pi;
use resect_io::open::open;
use resect_tools::simulation::{Preset, simulate};

/// Returns roles and cost ratios, in order of cost.
fn minima(deployment: &Deployment) -> Vec<(&'static str, f64)> {
    let analysis = analyse(deployment, &published());
    let details = answer(&analysis).calibration.inter_prism().expect("method D");
    details.basins.iter().map(|b| (details.role(b), details.cost_ratio(b))).collect()
}

#[test]
fn the_lowest_is_the_truth_or_its_twin() {
    for preset in [Preset::Warthog, Preset::Hd2Tunnel, Preset::FigureEight, Preset::LShape] {
        for seed in 20..26 {
            let simulated = simulate(preset, seed);
            let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
            let analysis = analyse(&deployment, &published());
            let details = answer(&analysis).calibration.inter_prism().expect("method D");
            let (lowest, truth) = (&details.basins[0], &simulated.truth);
            let [p1, p2, p3] = *truth.prisms_m.as_array().expect("three");
            let heights_m = [p1.z - p2.z, p1.z - p3.z];
            let off_m = |sign: f64| {
                (0..2)
                    .map(|i| (lowest.height_differences_m[i + 1] - sign * heights_m[i]).abs())
                    .fold(0.0, f64::max)
            };
            assert!(off_m(1.0).min(off_m(-1.0)) < 0.03, "{preset:?} {seed}: {lowest:?}");
            for station in 1..3 {
                let found = &lowest.station1_from_station[station];
                let truth = &truth.station1_from_station[station];
                let off = (found.translation_m - truth.translation_m).xy().norm();
                assert!(off < SAME_TRANSLATION_M, "{preset:?} {seed}: {off} m");
                assert!(wrap_to_pi(found.yaw_rad - truth.yaw_rad).abs() < SAME_YAW_RAD);
            }
        }
    }
}

#[test]
fn every_list_names_one_answer_and_is_in_order() {
    for (preset, most) in [
        (Preset::Warthog, 2),
        (Preset::FigureEight, 2),
        (Preset::LShape, 6),
        // Unconstrained directions: valleys, not hundreds of minima.
        (Preset::Circle, 6),
        (Preset::StraightLine, 4),
    ] {
        let list = minima(&resect_io::simulation_files::open(&simulate(preset, 1)).expect("valid"));
        assert!((2..=most).contains(&list.len()), "{preset:?}: {list:?}");
        for role in ["answer", "mirror twin"] {
            let count = list.iter().filter(|(is, _)| *is == role).count();
            assert_eq!(count, 1, "{preset:?}: {list:?}");
        }
        assert!(list.is_sorted_by(|a, b| a.1 <= b.1), "{preset:?}: {list:?}");
        let of_answer = list.iter().find(|(is, _)| *is == "answer").expect("counted").1;
        assert_eq!(of_answer, 1.0);
    }
}

/// A rotated rig fits an L-shaped drive to centimetres.
#[test]
fn an_l_shape_lists_the_turned_rig() {
    let list =
        minima(&resect_io::simulation_files::open(&simulate(Preset::LShape, 1)).expect("valid"));
    assert!(list.iter().any(|(is, ratio)| *is == "other" && *ratio < 1000.0), "{list:?}");
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_published_run_has_the_answer_and_its_twin_and_no_more() {
    let path = of_field("2022-07-11-2");
    let list = minima(&open(&path).expect("opens"));
    assert_eq!(list.len(), 2, "{list:?}");
    assert_eq!(list[0], ("answer", 1.0));
    assert_eq!(list[1].0, "mirror twin");
    assert!((list[1].1 - 4.74).abs() < 0.1, "{list:?}");
}
