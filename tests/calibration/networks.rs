//! Networks of other sizes than three: two stations of real drives against all three, and the coverage of simulated networks.

#![allow(clippy::print_stdout, reason = "the coverage is the point")]

use resect_core::analysis::Settings;
use resect_core::calibration::{Calibration, Evidence, Method, TransformSigma, Verdict};
use resect_core::deployment::{Deployment, Measurement, Remedy, StatedPrismChange, kinds};
use resect_core::geometry::{LevelTransform, RigidTransform, wrap_to_pi};
use resect_core::network::{Number, PerStation, Prism, Station};
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
    let three = resect_io::open::open(&sample_folder("warthog")).expect("opens");
    for settings in [Settings::default(), by(Method::StaticGcp)] {
        let all = analyse(&three, &settings);
        let all = &answer(&all).calibration.station1_from_station;
        for chosen in [[1, 2], [1, 3], [2, 3]] {
            let [first, second] = chosen.map(|number| all[number - 1]);
            let expected = first.inverse().then_from(&second);
            let two = analyse(&with_stations(chosen), &settings);
            let two = &answer(&two).calibration;
            assert_eq!(two.verdict, Verdict::Good, "{chosen:?}: {:?}", two.findings);
            let sigma = &two.sigma.as_ref().expect("determined")[1];
            let sigmas = apart_sigmas(&two.station1_from_station[1], &expected, sigma);
            assert!(sigmas < 3.0, "{chosen:?}, {}: {sigmas} σ", two.method);
        }
    }
}

/// Returns the sample with some of its stations.
fn with_stations(numbers: [usize; 2]) -> Deployment {
    let folder = tempfile::tempdir().expect("a folder");
    for file in std::fs::read_dir(sample_folder("warthog")).expect("reads") {
        let file = file.expect("reads");
        let mut text = std::fs::read_to_string(file.path()).expect("reads");
        if file.file_name() == "deployment.toml" {
            text = format!("stations = {numbers:?}\n{text}");
        }
        std::fs::write(folder.path().join(file.file_name()), text).expect("writes");
    }
    let two = resect_io::open::open(folder.path()).expect("opens");
    assert_eq!(two.tracks.len(), 2);
    two
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

/// A simulated drive whose station 2 follows prism 3 during a part of it, without a statement; the poses of the stations; the changes.
fn with_changes_of_prism(
    seed: u64,
    [from, to]: [f64; 2],
) -> (Deployment, PerStation<LevelTransform>, [StatedPrismChange; 2]) {
    let mut scenario = Preset::Warthog.scenario();
    let simulated = simulate_scenario(&scenario, seed);
    let [mut deployment, other] = [false, true].map(|is_exchanged| {
        if is_exchanged {
            scenario.prisms_m.as_mut_slice().swap(1, 2);
        }
        resect_io::simulation_files::open(&simulate_scenario(&scenario, seed)).expect("valid")
    });
    let start_s = deployment.start_s().expect("readings");
    let length_s = deployment.end_s().expect("readings") - start_s;
    let [from_s, to_s] = [from, to].map(|share| start_s + share * length_s);
    let is_other = |reading: &Measurement| (from_s..to_s).contains(&reading.time_s);
    let track = &mut deployment.tracks[1].measurements;
    track.retain(|reading| !is_other(reading));
    track.extend(other.tracks[1].measurements.iter().filter(|reading| is_other(reading)));
    track.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let change = |time_s: f64, prism: u8| StatedPrismChange { station: 2, time_s, prism };
    (deployment, simulated.truth.station1_from_station, [change(from_s, 3), change(to_s, 2)])
}

/// Asserts a good answer within 4 σ of the truth.
#[track_caller]
fn assert_good_and_near(calibration: &Calibration, truth: &PerStation<LevelTransform>) {
    assert_eq!(calibration.verdict, Verdict::Good, "{:?}", calibration.findings);
    let sigma = calibration.sigma.as_ref().expect("determined");
    for (station, truth) in truth.each().skip(1) {
        let pose = &calibration.station1_from_station[station];
        let sigmas = apart_sigmas(pose, &RigidTransform::from(*truth), &sigma[station]);
        assert!(sigmas < 4.0, "{}, station {station}: {sigmas} σ", calibration.method);
    }
}

/// Returns the deployment with stated changes of prisms.
fn with_stated(deployment: &Deployment, changes: &[StatedPrismChange]) -> Deployment {
    let mut stated = deployment.clone();
    for (station, change) in changes.iter().filter_map(StatedPrismChange::change) {
        stated.tracks[station].prism_changes.push(change);
    }
    stated
}

#[test]
fn a_change_of_prism_is_found_with_its_station_and_times_and_offered() {
    for seed in 1..=3 {
        let (deployment, _, changes) = with_changes_of_prism(seed, [0.4, 0.6]);
        let analysis = analyse(&deployment, &Settings::default());
        let findings = &answer(&analysis).calibration.findings;
        let finding = findings.iter().find(|finding| finding.kind == kinds::PRISM_CHANGED);
        let finding = finding.unwrap_or_else(|| {
            panic!("{findings:?} {:#?}", answer(&analysis).calibration.joint_failure())
        });
        let Some(Remedy::ReadWith(overrides)) = finding.remedies.first() else {
            panic!("{finding:?}")
        };
        let offered = overrides.prism_changes.clone().expect("changes");
        assert_eq!(offered.len(), 2, "{offered:?}");
        for (change, truth) in offered.iter().zip(&changes) {
            assert_eq!((change.station, change.prism), (truth.station, truth.prism));
            assert!((change.time_s - truth.time_s).abs() < 3.0, "{change:?} {truth:?}");
        }
        let analysis = analyse(&with_stated(&deployment, &offered), &Settings::default());
        let calibration = &answer(&analysis).calibration;
        assert_eq!(calibration.verdict, Verdict::Good, "{:?}", calibration.findings);
        assert!(calibration.findings.iter().all(|finding| finding.kind != kinds::PRISM_CHANGED));
    }
}

#[test]
fn a_stated_change_of_prism_is_used_on_both_sides() {
    for seed in 1..=3 {
        let (unstated, truth, changes) = with_changes_of_prism(seed, [0.5, 2.0]);
        let stated = with_stated(&unstated, &changes[..1]);
        let (mut first_half, half_s) = (stated.clone(), changes[0].time_s);
        for track in &mut first_half.tracks {
            track.measurements.retain(|reading| reading.time_s < half_s);
        }
        let by_drive = Evidence { control_points: false, ..Evidence::default() };
        let mut settings = Settings::default();
        settings.calibration.evidence = by_drive;
        let sigma_m = |deployment: &Deployment| {
            let analysis = analyse(deployment, &settings);
            let calibration = &answer(&analysis).calibration;
            assert_good_and_near(calibration, &truth);
            calibration.sigma.as_ref().expect("determined")[2].translation_m.norm()
        };
        let [whole_m, half_m] = [&stated, &first_half].map(sigma_m);
        assert!(whole_m < 0.9 * half_m, "seed {seed}: {whole_m} of {half_m} m");
        // Without the statement, half of the drive contradicts the rig.
        let unstated = analyse(&unstated, &settings);
        let is_good =
            unstated.answer.is_ok_and(|answer| answer.calibration.verdict == Verdict::Good);
        assert!(!is_good, "seed {seed}");
    }
}

#[test]
fn joined_drives_keep_their_changes_of_prisms() {
    let (first, _, changes) = with_changes_of_prism(1, [0.5, 2.0]);
    let mut joined = with_stated(&first, &changes[..1]);
    let (second, _, changes) = with_changes_of_prism(2, [0.5, 2.0]);
    let second = with_stated(&second, &changes[..1]);
    joined.take_in(vec![second]).expect("the same set-up");
    let restart_s = joined.restarts_s[0];
    let length_s = joined.end_s().expect("readings") - restart_s;
    let schedule = joined.prism_schedule();
    let prism = |time_s: f64| schedule.at(time_s)[Station::at(1)].number();
    let times_s = [restart_s - 5.0, restart_s, restart_s + 0.4 * length_s, restart_s + length_s];
    assert_eq!(times_s.map(prism), [3, 2, 2, 3]);
}

#[test]
fn the_prisms_that_are_followed_most_are_those_of_the_published_answer() {
    let (deployment, truth, changes) = with_changes_of_prism(2, [0.0, 0.3]);
    let mut stated = with_stated(&deployment, &changes[1..]);
    for (track, prism) in stated.tracks.iter_mut().zip([0, 2, 2]) {
        track.prism = Some(Prism::at(prism));
    }
    for settings in [Settings::default(), by(Method::InterPrism)] {
        let analysis = analyse(&stated, &settings);
        let calibration = &answer(&analysis).calibration;
        assert_good_and_near(calibration, &truth);
        let usual: PerStation<Prism> = [0, 1, 2].map(Prism::at).into();
        assert_eq!(analysis.offer.followed, usual);
    }
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
