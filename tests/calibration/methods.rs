//! The four methods on simulated deployments with known ground truth.

use crate::common::{analyse, answer, by, normalised, rms_by_component};
use resect_core::analysis::Settings;
use resect_core::calibration::{Alignment, Method, Verdict};
use resect_core::deployment::kinds;
use resect_core::deployment::{Finding, Subject};
use resect_core::geometry::LevelTransform;
use resect_core::network::Prism;
use resect_tools::simulation::{Preset, simulate, simulate_scenario};

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
fn c_recovers_the_truth_within_its_stated_uncertainty() {
    for alignment in [Alignment::Level, Alignment::Rigid] {
        let mut all = Vec::new();
        for seed in 0..8 {
            let simulated = simulate(Preset::SinglePrism, seed);
            let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
            let mut settings = by(Method::DynamicGcp);
            settings.calibration.alignment = alignment;
            let analysis = analyse(&deployment, &settings);
            let verdict = answer(&analysis).calibration.verdict;
            assert_eq!(verdict, Verdict::Good, "{:?}", answer(&analysis).calibration.findings);
            all.extend(normalised(&analysis, &simulated.truth.station1_from_station));
        }
        // σ has errors of the instruments, which these drives have not (`campaign/methods.rs`).
        let rms = rms(&all);
        assert!((0.2..1.2).contains(&rms), "{alignment:?}: rms of error/σ is {rms:.2}");
        assert!(all.iter().all(|z| z.abs() < 4.0), "{alignment:?}: {all:.1?}");
    }
}

/// Calibrations by a method from simulated drives of the Warthog, compared with the truth.
struct Recovered {
    /// Errors of all eight parameters in σ, by drive.
    in_sigmas: Vec<[f64; 8]>,
    /// Largest error of a position over all drives (m), and its largest σ.
    error_m: f64,
    sigma_m: f64,
    /// Number of drives with a good verdict.
    good: usize,
}

impl Recovered {
    fn by(method: Method, seeds: std::ops::Range<u64>) -> Self {
        let mut all = Self { in_sigmas: Vec::new(), error_m: 0.0, sigma_m: 0.0, good: 0 };
        for seed in seeds {
            let simulated = simulate(Preset::Warthog, seed);
            let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
            let analysis = analyse(&deployment, &by(method));
            let truth = &simulated.truth.station1_from_station;
            let calibration = &answer(&analysis).calibration;
            let sigma = calibration.sigma.as_ref().expect("all directions are determined");
            for station in 1..3 {
                let placed = &calibration.station1_from_station[station];
                let off_m = (placed.translation_m - truth[station].translation_m).norm();
                all.error_m = all.error_m.max(off_m);
                all.sigma_m = all.sigma_m.max(sigma[station].translation_m.max());
            }
            all.good += usize::from(calibration.verdict == Verdict::Good);
            all.in_sigmas.push(normalised(&analysis, truth));
        }
        all
    }

    fn rms(&self) -> f64 {
        rms(self.in_sigmas.as_flattened())
    }

    /// Largest error in σ.
    fn largest(&self) -> f64 {
        self.in_sigmas.as_flattened().iter().fold(0.0, |most, z| z.abs().max(most))
    }
}

#[test]
fn b_recovers_the_truth_within_its_stated_uncertainty() {
    let all = Recovered::by(Method::StaticGcp, 0..12);
    // Twenty points within a hundred metres: errors of millimetres, whatever σ is.
    assert!(all.error_m < 0.005 && all.sigma_m < 0.003, "{} m ± {} m", all.error_m, all.sigma_m);
    assert_eq!(all.good, 12);
    assert!(all.largest() < 4.0, "{:.1?}", all.in_sigmas);
    // σ has errors of the instruments, which these drives have not (`campaign/methods.rs`).
    assert!((0.2..1.2).contains(&all.rms()), "rms of error/σ is {:.2}", all.rms());
}

#[test]
fn known_coordinates_give_the_same_relative_answer_and_the_global_one() {
    let simulated = simulate(Preset::Warthog, 3);
    let mut deployment = resect_io::simulation_files::open(&simulated).expect("valid");
    let relative = analyse(&deployment, &by(Method::StaticGcp));
    // A map frame, rotated and distant, in which the points' true positions are known.
    let map_from_station1 = LevelTransform::new([5000.0, -2000.0, 90.0].into(), 2.1);
    for point in deployment.control_points.iter_mut().flat_map(|set| &mut set.points) {
        let read: Vec<nalgebra::Vector3<f64>> = (0..3)
            .filter_map(|s| {
                let polar = point.readings[s]?;
                Some(simulated.truth.station1_from_station[s].apply(&polar.to_cartesian()))
            })
            .collect();
        let mean = read.iter().sum::<nalgebra::Vector3<f64>>() / read.len() as f64;
        point.known_m = Some(map_from_station1.apply(&mean));
    }
    let global = analyse(&deployment, &by(Method::StaticGcp));
    let (relative, global) = (&answer(&relative).calibration, &answer(&global).calibration);
    for station in 1..3 {
        crate::common::assert_close(
            &global.station1_from_station[station],
            &relative.station1_from_station[station],
            [0.004; 3],
            1e-4,
        );
    }
    let resect_core::calibration::Details::StaticGcp(details) = &global.details else {
        panic!("method B")
    };
    let world = details.world_from_station1.expect("coordinates are known");
    crate::common::assert_close(&world, &map_from_station1, [0.004; 3], 1e-4);
    // Method A can use known coordinates too: two of the points suffice.
    let two_point = analyse(&deployment, &by(Method::TwoPoint));
    for station in 1..3 {
        let found = &answer(&two_point).calibration.station1_from_station[station];
        let truth = &simulated.truth.station1_from_station[station];
        crate::common::assert_close(found, truth, [0.02; 3], 5e-4);
    }
}

#[test]
fn one_prism_is_recognised_and_three_are_not_mistaken_for_it() {
    for (preset, expected) in [
        (Preset::SinglePrism, 1),
        (Preset::Warthog, 3),
        (Preset::Hd2Tunnel, 3),
        (Preset::StraightLine, 3),
    ] {
        let deployment = resect_io::simulation_files::open(&simulate(preset, 5)).expect("valid");
        let analysis = analyse(&deployment, &Settings::default());
        assert_eq!(Prism::count(&analysis.offer.followed), expected, "{preset:?}");
        let by_paper = analysis.offer.published_method();
        assert_eq!(by_paper == Method::DynamicGcp, expected == 1);
    }
}

#[test]
fn a_straight_drive_without_a_rig_does_not_pass_for_one_prism() {
    // Level and straight: a translation makes the three prisms' tracks coincide.
    let mut deployment =
        resect_io::simulation_files::open(&simulate(Preset::StraightLine, 5)).expect("valid");
    deployment.rig = None;
    let analysis = analyse(&deployment, &by(Method::DynamicGcp));
    assert!(analysis.offer.is_undecided);
    assert_eq!(answer(&analysis).calibration.verdict, Verdict::Ambiguous);
}

#[test]
fn a_lacking_method_says_what_it_needs() {
    for (preset, method, word) in [
        (Preset::Hd2Tunnel, Method::TwoPoint, "known coordinates"),
        (Preset::Hd2Tunnel, Method::StaticGcp, "3 control points"),
        (Preset::Hd2Tunnel, Method::DynamicGcp, "one prism"),
        (Preset::SinglePrism, Method::InterPrism, "a prism for each station"),
    ] {
        let deployment = resect_io::simulation_files::open(&simulate(preset, 1)).expect("valid");
        let analysis = analyse(&deployment, &by(method));
        let error = analysis.answer.map(|_| ()).expect_err("not for this data").to_string();
        assert!(error.contains(word), "{error}");
        assert!(analysis.offer.lack(method).is_some_and(|lack| lack.contains(word)));
    }
}

#[test]
fn a_recovers_the_truth_within_its_stated_uncertainty() {
    let all = Recovered::by(Method::TwoPoint, 0..12);
    // Two pillars instead of twenty points: a centimetre.
    assert!(all.error_m < 0.010 && all.sigma_m < 0.015, "{} m ± {} m", all.error_m, all.sigma_m);
    assert_eq!(all.good, 12);
    assert!(all.largest() < 4.0, "{:.1?}", all.in_sigmas);
    // The other points select the pair, which improves it; the σ are those of any pair.
    assert!((0.2..1.3).contains(&all.rms()), "rms of error/σ is {:.2}", all.rms());
}

/// Tests each component separately, with all errors of real instruments.
#[test]
fn the_sigmas_of_b_hold_for_every_component() {
    const SEEDS: u64 = 40;
    let mut runs = Vec::new();
    for seed in 100..100 + SEEDS {
        let scenario = Preset::Warthog.scenario().with_field_errors(seed);
        let simulated = simulate_scenario(&scenario, seed);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let analysis = analyse(&deployment, &by(Method::StaticGcp));
        runs.push(normalised(&analysis, &simulated.truth.station1_from_station));
    }
    let rms = rms_by_component(&runs);
    assert!(rms.iter().all(|rms| (0.75..1.4).contains(rms)), "{rms:.2?}");
}

#[test]
fn a_blunder_is_named_and_lowers_the_verdict() {
    let mut deployment =
        resect_io::simulation_files::open(&simulate(Preset::Warthog, 7)).expect("valid");
    let point = &mut deployment.control_points[1].points[3];
    let marker = point.marker;
    point.readings[2].as_mut().expect("read").range_m += 0.05;
    let analysis = analyse(&deployment, &by(Method::StaticGcp));
    let calibration = &answer(&analysis).calibration;
    assert_eq!(calibration.verdict, Verdict::Weak);
    let point = Some(Subject::Point { file: "GCP_raw_2.txt".to_owned(), marker });
    let is_named = |f: &Finding| f.kind == kinds::CONTROL_POINT_OUTLIER && f.subject == point;
    assert!(calibration.findings.iter().any(is_named), "{:?}", calibration.findings);

    let mut deployment =
        resect_io::simulation_files::open(&simulate(Preset::Warthog, 7)).expect("valid");
    let pillars = deployment.control_points.iter_mut().find(|set| set.pillars).expect("pillars");
    pillars.points[2].known_m.as_mut().expect("surveyed").x += 0.1;
    let analysis = analyse(&deployment, &by(Method::TwoPoint));
    let calibration = &answer(&analysis).calibration;
    assert_eq!(calibration.verdict, Verdict::Weak, "{:?}", calibration.findings);
    let point = Some(Subject::Point { file: "Two_points.txt".to_owned(), marker: 3 });
    let is_named = |f: &Finding| f.kind == kinds::KNOWN_POINT_MISPLACED && f.subject == point;
    assert!(calibration.findings.iter().any(is_named), "{:?}", calibration.findings);
}

#[test]
fn stations_that_share_few_points_with_each_other_still_have_their_sigma() {
    let mut deployment =
        resect_io::simulation_files::open(&simulate(Preset::Warthog, 7)).expect("valid");
    deployment.control_points.truncate(1);
    // Station 2 observes the first five points, station 3 the others.
    for (index, point) in deployment.control_points[0].points.iter_mut().enumerate() {
        point.readings[if index < 5 { 2 } else { 1 }] = None;
    }
    let analysis = analyse(&deployment, &by(Method::StaticGcp));
    let calibration = &answer(&analysis).calibration;
    assert!(calibration.sigma.is_some());
    assert_eq!(calibration.verdict, Verdict::Good, "{:?}", calibration.findings);
}
