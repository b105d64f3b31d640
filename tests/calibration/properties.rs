//! Invariances that are independent of the data: moving the input moves the output in the same way.

mod cases;
mod moved;
mod renumbered;
mod told;
mod written;

use crate::common::{analyse, answer, published};
use resect_core::analysis::Settings;
use resect_core::calibration::{PriorMethod, ResolvedBy, Verdict};
use resect_core::deployment::Deployment;
use resect_core::deployment::kinds;
use resect_io::sample::Sample;
use resect_tools::simulation::{Preset, simulate, simulate_scenario};

fn sample() -> Deployment {
    Sample::Warthog.open().expect("built in")
}

#[test]
fn a_wrong_prism_order_is_called_ambiguous_not_good() {
    let mut wrong = sample();
    // The rig's heights are inverted, against the clear evidence of the cost.
    if let Some(prisms) = wrong.rig.as_mut().and_then(|rig| rig.prisms_m.as_mut()) {
        for prism in prisms {
            prism.z = -prism.z;
        }
    }
    wrong.control_points.clear();
    let analysis = analyse(&wrong, &published());
    assert_eq!(answer(&analysis).calibration.verdict, Verdict::Ambiguous);
}

#[test]
fn a_standing_vehicle_is_degenerate_and_gets_no_sigma() {
    let mut short = Sample::Hd2Tunnel.open().expect("built in");
    let start = short.start_s().expect("readings");
    for track in &mut short.tracks {
        track.measurements.retain(|m| m.time_s - start < 6.9);
    }
    let analysis = analyse(&short, &published());
    let calibration = &answer(&analysis).calibration;
    assert_eq!(calibration.verdict, Verdict::Degenerate, "{:?}", calibration.findings);
    assert!(calibration.sigma.is_none());
}

/// Drives with unconstrained directions are classified correctly, with each prior.
#[test]
fn the_shape_of_the_drive_shows_in_the_verdict() {
    let expected = [
        (Preset::StraightLine, Verdict::Degenerate, kinds::DRIVE_LEAVES_DIRECTION_FREE),
        (Preset::Circle, Verdict::Degenerate, kinds::DRIVE_LEAVES_DIRECTION_FREE),
        (Preset::FigureEight, Verdict::Good, kinds::WEAKEST_DIRECTION),
        (Preset::UnevenGround, Verdict::Good, kinds::WEAKEST_DIRECTION),
        (Preset::FlatFloor, Verdict::Good, kinds::MIRROR_RESOLVED_BY_RIG),
    ];
    for (preset, verdict, reason) in expected {
        let deployment = resect_io::simulation_files::open(&simulate(preset, 1)).expect("valid");
        for prior in [PriorMethod::ClosedForm, PriorMethod::Search] {
            let mut settings = published();
            settings.calibration.prior = prior;
            let analysis = analyse(&deployment, &settings);
            let calibration = &answer(&analysis).calibration;
            assert_eq!(calibration.verdict, verdict, "{preset:?}: {:?}", calibration.findings);
            assert!(calibration.findings.iter().any(|f| f.kind == reason), "{preset:?}");
        }
    }
}

#[test]
fn on_flat_ground_without_a_witness_the_mirror_stays_undecided() {
    let mut deployment =
        resect_io::simulation_files::open(&simulate(Preset::FlatFloor, 1)).expect("valid");
    deployment.control_points.clear();
    deployment.rig.as_mut().expect("a rig").prisms_m = None;
    let analysis = analyse(&deployment, &published());
    let calibration = &answer(&analysis).calibration;
    assert_eq!(calibration.verdict, Verdict::Ambiguous);
    assert_eq!(
        calibration.inter_prism().expect("method D").mirror.resolved_by,
        ResolvedBy::Nothing
    );
    let ratio = calibration.inter_prism().expect("method D").mirror.cost_ratio.expect("a twin");
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
}

/// A tunnel with gentle bumps, where D cannot decide, and a flat floor with prisms of a hand's breadth, where the wrong twin may be likelier.
#[test]
fn without_a_witness_all_readings_decide_the_mirror_where_the_vehicle_tilts() {
    for (preset, decided) in [(Preset::Hd2Tunnel, true), (Preset::ShortBaselines, false)] {
        for seed in [1, 4, 15] {
            let simulated = simulate_scenario(&preset.scenario().with_field_errors(seed), seed);
            let mut deployment = resect_io::simulation_files::open(&simulated).expect("valid");
            deployment.control_points.clear();
            deployment.rig.as_mut().expect("a rig").prisms_m = None;
            let analysis = analyse(&deployment, &Settings::default());
            let calibration = &answer(&analysis).calibration;
            let mirror = &calibration.inter_prism().expect("several prisms").mirror;
            let expected = if decided { ResolvedBy::Likelihood } else { ResolvedBy::Nothing };
            assert_eq!(mirror.resolved_by, expected, "{preset:?} {seed}");
            assert_eq!(calibration.verdict == Verdict::Ambiguous, !decided, "{preset:?} {seed}");
            let truth = &simulated.truth.station1_from_station;
            for (station, truth) in truth.each().skip(1).filter(|_| decided) {
                let pose = &calibration.station1_from_station[station];
                let off_m = (pose.translation_m - truth.translation_m).z;
                assert!(off_m.abs() < 0.05, "{preset:?} {seed}, station {station}: {off_m} m");
            }
        }
    }
}

#[test]
fn a_wrong_distance_or_swapped_stations_are_not_good() {
    let mut wrong_distance = sample();
    wrong_distance.rig.as_mut().expect("a rig").inter_prism_m[0] += 0.05;
    let mut swapped = sample();
    swapped.tracks.as_mut_slice().swap(1, 2);
    for (what, mut deployment) in [("d12 5 cm long", wrong_distance), ("2 and 3 swapped", swapped)]
    {
        deployment.control_points.clear();
        let analysis = analyse(&deployment, &published());
        let calibration = &answer(&analysis).calibration;
        assert!(calibration.verdict > Verdict::Good, "{what}: {:?}", calibration.findings);
    }
}
