//! The joint estimate on simulated deployments with known errors and on the field data.

use resect_core::deployment::Finding;
use resect_core::deployment::kinds;
use std::sync::Arc;
use std::time::Instant;

use crate::common::{analyse, answer, by, normalised, of_field, published, rms_by_component};
use resect_core::analysis::{Analysis, Analyst, Settings};
use resect_core::calibration::joint::{JointEstimate, StepSize};
use resect_core::calibration::{CalibrationSettings, Method, Offer, Verdict, solve};
use resect_core::geometry::ARCSECOND_RAD;
use resect_core::pipeline;
use resect_core::progress::{Cancelled, Progress};
use resect_io::open::open;
use resect_tools::simulation::{
    ClockStep, ErrorKind, Preset, SystematicErrors, simulate, simulate_scenario,
};

fn joint(analysis: &Analysis) -> &JointEstimate {
    answer(analysis).calibration.joint().expect("a joint estimate")
}

fn with_errors(errors: SystematicErrors, seed: u64) -> resect_tools::simulation::Simulated {
    let mut scenario = Preset::Warthog.scenario();
    scenario.errors = errors;
    simulate_scenario(&scenario, seed)
}

#[test]
fn clock_offsets_of_10_ms_are_recovered_within_1_ms_and_bias_nothing() {
    for (seed, offsets_s) in
        [(1, [0.0, 0.010, -0.010]), (2, [0.0, -0.010, 0.0]), (3, [0.010, 0.0, 0.0])]
    {
        let errors = SystematicErrors { clock_offset_s: offsets_s.into(), ..Default::default() };
        let simulated = with_errors(errors, seed);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let truth = &simulated.truth.station1_from_station;
        let analysis = analyse(&deployment, &by(Method::Joint));
        let clocks = &joint(&analysis).clock_offsets_s;
        for (station, clock) in clocks.iter().enumerate().skip(1) {
            let true_s = offsets_s[station] - offsets_s[0];
            let off_s = clock.value - true_s;
            assert!(off_s.abs() < 1e-3, "seed {seed}, station {}: {clock:?}", station + 1);
            assert!(off_s.abs() < 4.0 * clock.sigma, "seed {seed}: {clock:?}, truly {true_s}");
        }
        let off = normalised(&analysis, truth);
        assert!(off.iter().all(|z| z.abs() < 3.0), "seed {seed}: {off:.1?}");
        // Without it the metric is worse.
        let plain = analyse(&deployment, &published());
        let median =
            |analysis: &Analysis| answer(analysis).evaluation.inter_prism_mm.expect("a rig").median;
        assert!(median(&analysis) < 0.7 * median(&plain));
    }
}

#[test]
fn a_wrong_distance_is_found_as_far_as_the_prior_lets_it() {
    let errors = SystematicErrors { inter_prism_m: [0.003, 0.0, 0.0].into(), ..Default::default() };
    let simulated = with_errors(errors, 4);
    let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
    let mut all = by(Method::Joint);
    all.calibration.inter_prism_sigma_m = 0.003;
    let analysis = analyse(&deployment, &all);
    let found = joint(&analysis).distances_m().expect("a rig");
    for pair in 0..3 {
        let off_m = found[pair].value - simulated.truth.inter_prism_m[pair];
        assert!(off_m.abs() < 3.0 * found[pair].sigma, "{pair}: {off_m} {:?}", found[pair]);
        // The data determines two thirds of the three millimetres, with a realistic σ.
        assert!(off_m.abs() < 0.001, "{pair}: {off_m} {:?}", found[pair]);
        assert!(
            found[pair].sigma < 0.0015,
            "{pair}: {:?} is hardly more than the prior",
            found[pair]
        );
    }
}

#[test]
fn stated_sigmas_hold_for_the_joint_estimate() {
    const SEEDS: u64 = 24;
    let mut runs = Vec::new();
    for seed in 0..SEEDS {
        // With the errors of instruments in the field, except clock steps.
        let mut scenario = Preset::Warthog.scenario().with_field_errors(seed);
        scenario.drawn_errors.retain(|kind| *kind != ErrorKind::ClockJumps);
        let simulated = simulate_scenario(&scenario, seed);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let analysis = analyse(&deployment, &by(Method::Joint));
        assert!(answer(&analysis).calibration.joint().is_some(), "seed {seed}");
        runs.push(normalised(&analysis, &simulated.truth.station1_from_station));
    }
    let rms = rms_by_component(&runs);
    // The smallest slow errors of the estimate are as large as those of real prisms, and larger than those drawn here.
    assert!(rms.iter().all(|rms| (0.5..1.4).contains(rms)), "{rms:.2?}");
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_field_data_has_a_late_station_3_and_the_joint_estimate_is_better() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let analysis = analyse(&deployment, &by(Method::Joint));
    let metric = answer(&analysis).evaluation.inter_prism_mm.expect("a rig");
    assert!(metric.median <= 1.05 && metric.iqr <= 2.1, "{metric:?}");
    let [_, second, third] = joint(&analysis).clock_offsets_s.as_array().expect("three stations");
    // The readings of the paper's intervals alone give 3.5 ± 0.8 ms.
    let is_late = third.value > 3.0 * third.sigma && third.sigma < 0.8e-3;
    assert!(is_late && (third.value - 3.5e-3).abs() < 2.0 * third.sigma, "{third:?}");
    assert!(second.value.abs() < 2.0 * second.sigma, "{second:?}");
    let late = |f: &Finding| f.kind == kinds::CLOCK_OFFSET && f.is_about_station(2);
    let findings = &answer(&analysis).calibration.findings;
    assert!(findings.iter().any(late), "{findings:?}");
}

#[test]
fn a_clock_that_jumps_is_said_with_when_and_by_how_much() {
    for (seed, by_s) in [(11, 0.020), (12, -0.012)] {
        let clock_steps = vec![ClockStep { station: 2, at_s: 210.0, by_s }];
        let errors = SystematicErrors { clock_steps, ..Default::default() };
        let simulated = with_errors(errors, seed);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let analysis = analyse(&deployment, &by(Method::Joint));
        let steps = &joint(&analysis).steps;
        let [step] = &steps[..] else { panic!("seed {seed}: {steps:?}") };
        let StepSize::Clock(found_s) = &step.size else { panic!("seed {seed}: {step:?}") };
        assert_eq!(step.station.number(), 3, "seed {seed}: the others are steady");
        assert!((found_s.value - by_s).abs() < 0.15 * by_s.abs(), "seed {seed}: {step:?}");
        assert!((step.after_s - 210.0).abs() <= 15.0, "seed {seed}: {step:?}");
        for settings in [published(), by(Method::Joint)] {
            let analysis = analyse(&deployment, &settings);
            let verdict = answer(&analysis).calibration.verdict;
            assert!(verdict >= Verdict::Weak, "seed {seed}: a jump is never good");
        }
    }
}

#[test]
fn a_station_that_follows_another_prism_for_a_while_does_not_lead_the_joint_estimate_astray() {
    for seed in [21, 22, 23] {
        let mut scenario = Preset::Warthog.scenario();
        scenario.noise.wrong_targets_per_minute = 0.3;
        let simulated = simulate_scenario(&scenario, seed);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let truth = &simulated.truth.station1_from_station;
        let analysis = analyse(&deployment, &by(Method::Joint));
        let calibration = &answer(&analysis).calibration;
        assert_eq!(calibration.verdict, Verdict::Good, "seed {seed}: {:?}", calibration.findings);
        let off = normalised(&analysis, truth);
        assert!(off.iter().all(|z| z.abs() < 4.0), "seed {seed}: {off:.1?}");
        // The published method is biased, and reports so.
        let plain = analyse(&deployment, &published());
        let calibration = &answer(&plain).calibration;
        assert!(calibration.verdict >= Verdict::Weak, "seed {seed}");
        let pulled = |f: &Finding| f.kind == kinds::OUTLIERS_SHIFT_ANSWER;
        assert!(calibration.findings.iter().any(pulled), "seed {seed}: {:?}", calibration.findings);
    }
}

/// The simulated noise is estimated, so that nobody has to state it.
#[test]
fn the_noise_of_ranges_and_angles_is_learned() {
    // Half an arcsecond is less than the error of cubic splines in a bend.
    for (range_sigma_m, angle_arcseconds) in [(0.001, 2.0), (0.003, 1.0)] {
        let mut scenario = Preset::FigureEight.scenario();
        scenario.noise.range_sigma_m = range_sigma_m;
        scenario.noise.angle_sigma_rad = angle_arcseconds * ARCSECOND_RAD;
        let simulated = simulate_scenario(&scenario, 31);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let analysis = analyse(&deployment, &by(Method::Joint));
        let noise = joint(&analysis).levels;
        // Ranges have 2 ppm in addition, and the weights of Cauchy's loss reduce the estimate by some per cent.
        assert!((0.8..1.2).contains(&(noise.range_m() / range_sigma_m)), "{noise:?}");
        for angle_rad in [noise.horizontal_rad, noise.vertical_rad] {
            let angle = angle_rad / scenario.noise.angle_sigma_rad;
            assert!((0.75..1.3).contains(&angle), "{angle} {noise:?}");
        }
    }
}

/// All three stations track one prism.
#[test]
fn method_c_estimates_clocks_and_is_no_surer_than_it_may_be() {
    let mut runs = Vec::new();
    for seed in 40..64 {
        let mut scenario = Preset::SinglePrism.scenario();
        scenario.errors.clock_offset_s = [0.0, 0.010, -0.005].into();
        let simulated = simulate_scenario(&scenario, seed);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let plain = analyse(&deployment, &by(Method::DynamicGcp));
        assert!(answer(&plain).calibration.verdict >= Verdict::Weak, "seed {seed}");
        let analysis = analyse(&deployment, &by(Method::Joint));
        assert_eq!(answer(&analysis).calibration.verdict, Verdict::Good, "seed {seed}");
        let clocks = answer(&analysis).calibration.clocks().expect("estimated");
        for (clock, true_s) in clocks.iter().zip([0.0, 0.010, -0.005]) {
            assert!((clock.offset_s - true_s).abs() < 1e-3, "seed {seed}: {clock:?}");
        }
        runs.push(normalised(&analysis, &simulated.truth.station1_from_station));
    }
    // No station leans here and the prism constant is correct; σ allows for both.
    let rms = rms_by_component(&runs);
    assert!(rms.iter().all(|rms| *rms < 1.3), "{rms:.2?}");
}

/// Fitted to some intervals, evaluated on the others.
#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn on_intervals_left_out_of_the_fit_the_joint_estimate_is_better_too() {
    use resect_core::evaluation::evaluate_answer;
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let triplets = pipeline::run(&deployment, &Settings::default().pipeline).triplets;
    let offer = Offer::of(&deployment, &triplets);
    let side = |odd: bool| {
        let indices: Vec<usize> =
            (0..triplets.len()).filter(|i| (triplets.interval[*i] % 2 == 1) == odd).collect();
        triplets.select(&indices)
    };
    let error_mm = |settings: &CalibrationSettings| {
        let mut all = Vec::new();
        for odd in [false, true] {
            let (train, test) = (side(odd), side(!odd));
            let found = solve(&deployment, &train, settings, &offer).expect("solves");
            let (_, evaluation) = evaluate_answer(&deployment, &test, &offer.followed, &found);
            all.extend(evaluation.distance_errors_mm.into_iter().flatten().map(f64::abs));
        }
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let plain = error_mm(&published().calibration);
    let joint = error_mm(&by(Method::Joint).calibration);
    assert!(joint < 0.95 * plain, "joint {joint:.2}, plain {plain:.2} mm");
}

#[test]
fn an_analysis_that_nobody_wants_any_more_stops() {
    let deployment =
        Arc::new(resect_io::simulation_files::open(&simulate(Preset::Warthog, 1)).expect("valid"));
    let settings = by(Method::Joint);
    let mut analyst = Analyst::new(Arc::clone(&deployment));
    // The pipeline's stages are cached, so that the cancellation below meets the joint estimate.
    let started = Instant::now();
    let whole = analyst.run(&settings);
    let whole_seconds = started.elapsed().as_secs_f64();
    assert!(whole.answer.expect("an answer").calibration.inter_prism().is_some());
    // `benches/path.rs` measures the delay of a cancellation: other tests on the same cores extend any time measured here. If a run ends
    // before it is cancelled, because the first one was slow by chance, the next attempt cancels earlier.
    let stopped = (1..=10).any(|attempt| {
        let progress = Progress::default();
        let result = std::thread::scope(|scope| {
            let running = scope.spawn(|| analyst.run_while(&settings, &progress));
            std::thread::sleep(std::time::Duration::from_secs_f64(
                whole_seconds / f64::from(1 << attempt),
            ));
            progress.cancel();
            running.join().expect("no panic")
        });
        result.err() == Some(Cancelled)
    });
    assert!(stopped, "no run was stopped");
}
