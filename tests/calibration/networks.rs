//! Networks of other sizes than three: two stations of real drives against all three, and the coverage of simulated networks.

#![allow(clippy::print_stdout, reason = "the coverage is the point")]

use resect_core::analysis::Settings;
use resect_core::calibration::{Calibration, Method, TransformSigma, Verdict};
use resect_core::deployment::Deployment;
use resect_core::geometry::{RigidTransform, wrap_to_pi};
use resect_core::network::{Number, Station};
use resect_tools::simulation::{Preset, simulate_scenario};

use crate::common::{analyse, answer, by, of_field, sample_folder};
use crate::real_drives::real_drives;

/// Returns a deployment with the readings of its first stations only.
fn first_stations(deployment: &Deployment, stations: usize) -> Deployment {
    let mut few = deployment.clone();
    few.tracks.resize_with(stations, Default::default);
    few.time_corrections.resize_with(stations, Vec::new);
    for point in few.control_points.iter_mut().flat_map(|set| &mut set.points) {
        point.readings.resize_with(stations, || None);
    }
    few
}

/// The largest difference of station 2's pose from another one, in σ of `sigma`.
fn apart_sigmas(pose: &RigidTransform, other: &RigidTransform, sigma: &TransformSigma) -> f64 {
    let off_m = pose.translation_m - other.translation_m;
    let turned_rad = wrap_to_pi(pose.yaw_rad() - other.yaw_rad());
    let axes = (0..3).map(|axis| off_m[axis] / sigma.translation_m[axis]);
    axes.chain([turned_rad / sigma.yaw_rad]).map(f64::abs).fold(0.0, f64::max)
}

/// Compares station 2 by two stations with station 2 by all, in σ of the answer by two, which has less data.
fn apart_from_all(all: &Calibration, two: &Calibration) -> f64 {
    let second = Station::at(1);
    let sigma = two.sigma.as_ref().expect("a determined answer");
    let poses = [all, two].map(|calibration| calibration.station1_from_station[second]);
    apart_sigmas(&poses[0], &poses[1], &sigma[second])
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn two_stations_of_real_drives_agree_with_three() {
    let mut lines = Vec::new();
    for drive in real_drives() {
        let two = first_stations(&drive.deployment, 2);
        let methods = [by(Method::StaticGcp), Settings::default()];
        for settings in methods {
            let [all, two] = [&drive.deployment, &two].map(|some| analyse(some, &settings));
            let (Ok(all), Ok(two)) = (&all.answer, &two.answer) else { continue };
            let (all, two) = (&all.calibration, &two.calibration);
            if all.sigma.is_none() || two.sigma.is_none() {
                continue;
            }
            let sigmas = apart_from_all(all, two);
            let verdicts = [all, two].map(|own| own.verdict.name());
            lines.push(format!("{}, {}: {sigmas:.2} σ, {verdicts:?}", drive.name, two.method));
            if two.method == Method::StaticGcp {
                let poses = [all, two].map(|own| own.station1_from_station[1].translation_m);
                assert!((poses[0] - poses[1]).norm() < 1e-9, "{lines:?}");
            } else if [all, two].iter().any(|own| own.verdict == Verdict::Good) {
                // The tunnel contradicts itself, and is weak for two stations and for three.
                assert!(sigmas < 3.0, "{}", lines.join("\n"));
            }
        }
    }
    assert!(lines.len() > 8, "{lines:?}");
}

#[test]
fn who_lists_two_stations_calibrates_these_with_the_rig_and_the_points_of_three() {
    let folder = tempfile::tempdir().expect("a folder");
    for file in std::fs::read_dir(sample_folder("warthog")).expect("reads") {
        let file = file.expect("reads");
        let mut text = std::fs::read_to_string(file.path()).expect("reads");
        if file.file_name() == "deployment.toml" {
            text = format!("stations = [1, 2]\n{text}");
        }
        std::fs::write(folder.path().join(file.file_name()), text).expect("writes");
    }
    let two = resect_io::open::open(folder.path()).expect("opens");
    assert_eq!(two.tracks.len(), 2);
    let three = resect_io::open::open(&sample_folder("warthog")).expect("opens");
    let [three, two] = [three, two].map(|own| analyse(&own, &Settings::default()));
    let two = &answer(&two).calibration;
    assert_eq!(two.verdict, Verdict::Good, "{:?}", two.findings);
    let sigmas = apart_from_all(&answer(&three).calibration, two);
    assert!(sigmas < 3.0, "{sigmas} σ");
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn two_stations_follow_one_prism_of_a_real_drive() {
    let three = resect_io::open::open(&of_field("real/20220711-1-part")).expect("opens");
    let two = analyse(&first_stations(&three, 2), &Settings::default());
    let two = &answer(&two).calibration;
    assert!(two.joint().is_some(), "{:?}", two.findings);
    let all = analyse(&three, &Settings::default());
    let sigmas = apart_from_all(&answer(&all).calibration, two);
    assert!(sigmas < 3.0, "{sigmas} σ");
}

/// Returns the number of components of poses at set-up within their 95 % interval, and the number of all, for this many seeds.
fn coverage((stations, prisms): (usize, usize), seeds: u64) -> [usize; 2] {
    let [mut covered, mut all] = [0; 2];
    for seed in 1..=seeds {
        let scenario = Preset::Warthog.scenario().with_network(stations, prisms);
        let simulated = simulate_scenario(&scenario.with_field_errors(seed), seed);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let analysis = analyse(&deployment, &Settings::default());
        let calibration = &answer(&analysis).calibration;
        let Some(sigma) = &calibration.sigma else { continue };
        for (station, truth) in simulated.truth.station1_from_station.each().skip(1) {
            let own = &calibration.station1_from_station[station];
            let sigma = &sigma[station];
            let off_m = own.translation_m - truth.translation_m;
            let turned_rad = wrap_to_pi(own.yaw_rad() - truth.yaw_rad);
            let axes = (0..3).map(|axis| off_m[axis] / sigma.translation_m[axis]);
            for sigmas in axes.chain([turned_rad / sigma.yaw_rad]) {
                covered += usize::from(sigmas.abs() < 1.96);
                all += 1;
            }
        }
    }
    [covered, all]
}

#[test]
#[ignore = "minutes in release; the coverage of four and six stations"]
fn four_and_six_stations_are_covered() {
    for network in [(4, 3), (4, 4), (6, 3)] {
        let [covered, all] = coverage(network, 40);
        let share = covered as f64 / all as f64;
        println!("{network:?}: {covered} of {all}, {:.1} %", 100.0 * share);
        assert!((0.92..=0.98).contains(&share), "{network:?}: {share}");
    }
}
