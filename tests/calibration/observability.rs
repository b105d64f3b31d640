//! Observability of a drive: its shape by name, its unconstrained directions by number and in words.

use crate::common::{analyse, answer, of_field, published};
use resect_core::analysis::Settings;
use resect_core::calibration::inter_prism::observability::{Hold, Observability};
use resect_core::deployment::Deployment;
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_tools::simulation::{Preset, simulate};

fn words(observed: &Observability, hold: Hold) -> Vec<String> {
    observed.words(hold).split("; ").map(str::to_owned).collect()
}

const SEEDS: std::ops::Range<u64> = 1..13;

fn observed_with(deployment: &Deployment, settings: &Settings) -> Observability {
    let analysis = analyse(deployment, settings);
    answer(&analysis).calibration.inter_prism().expect("method D").observability.clone()
}

fn observed(deployment: &Deployment) -> Observability {
    observed_with(deployment, &published())
}

fn simulated(preset: Preset, seed: u64) -> Deployment {
    resect_io::simulation_files::open(&simulate(preset, seed)).expect("valid")
}

/// The bends of a figure-eight constrain everything; only its flat floor remains to be reported.
#[test]
fn every_preset_is_called_what_it_is_and_leaves_free_what_it_must() {
    let mut unfiltered = published();
    unfiltered.pipeline.outlier_filter = false;
    for (preset, name, free) in [
        (Preset::StraightLine, "straight-line", 3),
        (Preset::Circle, "circle", 1),
        (Preset::LShape, "l-shape", 0),
        (Preset::FlatFloor, "flat-floor", 0),
        (Preset::FigureEight, "flat-floor", 0),
        (Preset::Hd2Tunnel, "winding", 0),
        (Preset::Warthog, "winding", 0),
        (Preset::UnevenGround, "winding", 0),
    ] {
        let mut misnamed = 0;
        for seed in SEEDS {
            let deployment = simulated(preset, seed);
            let observed = observed(&deployment);
            let said = format!("{preset:?} {seed}: {:?}", observed.drive);
            assert_eq!(observed.drive.name(), name, "{said}");
            assert_eq!(observed.count(Hold::Free), free, "{said}");
            let some_weak = observed.count(Hold::Weak) > 0;
            assert_eq!(some_weak, preset == Preset::LShape, "{said}");
            let with_outliers = observed_with(&deployment, &unfiltered);
            misnamed += usize::from(with_outliers.drive.name() != name);
        }
        // With an outlier every 250 m, a drive may look more varied than it was.
        assert!(misnamed <= 1, "{preset:?}, outliers left in: {misnamed}");
    }
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_field_data_and_the_samples_wind() {
    for sample in Sample::ALL {
        assert_eq!(observed(&sample.open().expect("built in")).drive.name(), "winding");
    }
    let folder = of_field("2022-07-11-2");
    let observed = observed(&open(&folder).expect("field data"));
    assert_eq!(observed.drive.name(), "winding", "{:?}", observed.drive);
    assert_eq!(observed.count(Hold::Held), 8);
}

#[test]
fn what_is_free_is_said_in_words() {
    for seed in SEEDS {
        let line = observed(&simulated(Preset::StraightLine, seed)).words(Hold::Free);
        // The rig may rotate freely about the track, with the stations sliding or swinging along.
        let leans = "stations 2 and 3 can rotate about the track, like a roll of the rig";
        assert!(line.contains(leans), "{seed}: {line}");
        assert!(line.contains("can slide along the track"), "{seed}: {line}");
        assert_eq!(line.split("; ").count(), 3, "{seed}: {line}");
        let circle = observed(&simulated(Preset::Circle, seed)).words(Hold::Free);
        let expected = "stations 2 and 3 can turn about the middle of the track together";
        assert_eq!(circle, expected, "{seed}");
    }
}

/// The findings name the fault, the unconstrained directions, and the next drive for a surveyor.
#[test]
fn the_findings_name_the_drive_and_what_to_drive_next() {
    for (preset, parts) in [
        (
            Preset::StraightLine,
            [
                "one straight line",
                "3 of 8 directions are unobservable",
                "turn once around on the spot",
            ],
        ),
        (
            Preset::Circle,
            [
                "round one circle, one way (radius 10.0 m)",
                "1 of 8 directions is unobservable",
                "turn the other way too",
            ],
        ),
        (
            Preset::LShape,
            ["the drive is an L", "one corner of 90°", "depends on that corner alone"],
        ),
        (
            Preset::FlatFloor,
            [
                "the floor is flat (heights vary by",
                "mirror ambiguity",
                "only the rig or control points",
            ],
        ),
    ] {
        let analysis = analyse(&simulated(preset, 1), &published());
        let findings = &answer(&analysis).calibration.findings;
        for part in parts {
            assert!(findings.iter().any(|f| f.to_string().contains(part)), "{part}: {findings:?}");
        }
    }
}

#[test]
fn turning_a_station_changes_no_name() {
    for preset in [Preset::StraightLine, Preset::Circle, Preset::LShape, Preset::Warthog] {
        let before = observed(&simulated(preset, 1));
        for (station, by_rad) in [(0, 1.2), (1, -2.0), (2, 3.0)] {
            let mut turned = simulated(preset, 1);
            for m in &mut turned.tracks[station].measurements {
                m.azimuth_rad += by_rad;
            }
            for point in turned.control_points.iter_mut().flat_map(|set| &mut set.points) {
                if let Some(polar) = &mut point.readings[station] {
                    polar.azimuth_rad += by_rad;
                }
            }
            let after = observed(&turned);
            assert_eq!(before.drive.name(), after.drive.name());
            // With an unconstrained direction the solution itself may differ, and with it the constrained directions.
            let holds = [Hold::Free, Hold::Weak, Hold::Held];
            let count = if before.count(Hold::Free) > 0 { 1 } else { 3 };
            for hold in &holds[..count] {
                let [mut before, mut after] =
                    [&before, &after].map(|observed| words(observed, *hold));
                before.sort();
                after.sort();
                assert_eq!(before, after, "{preset:?}");
            }
        }
    }
}

/// The motion of a station agrees with the words: along a straight line, slides have no other component.
#[test]
fn motions_are_those_of_the_instruments() {
    let observed = observed(&simulated(Preset::StraightLine, 3));
    let of = |words: &str| observed.directions.iter().find(|d| d.words == words).expect("free");
    let slide = of("station 2 can slide along the track");
    // The simulated line runs along x.
    assert!(slide.motion[1].translation_m.x.abs() > 0.95, "{slide:?}");
    assert!(slide.motion[2].translation_m.norm() < 0.2, "{slide:?}");
    // The circle's stations are tens of metres from its middle: a rotation about it moves them far.
    let circle = self::observed(&simulated(Preset::Circle, 3));
    let turn = &circle.directions[0];
    for motion in turn.motion.iter().skip(1) {
        let lever_m = motion.translation_m.norm() / motion.yaw_rad.abs();
        assert!((40.0..80.0).contains(&lever_m), "{turn:?}");
    }
    assert!(turn.sigma_m.is_none());
}
