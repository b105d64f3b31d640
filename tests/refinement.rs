//! What method D estimates beyond the paper, on simulated deployments with known errors and on the field data.

mod common;

use common::{analyse, answer, field_data, normalised, rms_by_component};
use resect::analysis::{Analysis, Settings};
use resect::calibration::inter_prism::Refinement;
use resect::calibration::{CalibrationSettings, Estimated, Loss};
use resect::deployment::open;
use resect::simulation::{Preset, SystematicErrors, simulate_scenario};

fn settings(loss: Loss, estimate: Estimated) -> Settings {
    let mut settings = Settings::default();
    settings.calibration.loss = loss;
    settings.calibration.estimate = estimate;
    settings
}

const CLOCKS: Estimated = Estimated { clocks: true, distances: false, tilt: false };

fn refinement(analysis: &Analysis) -> &Refinement {
    let details = answer(analysis).calibration.inter_prism().expect("method D");
    details.refinement.as_ref().expect("it was asked for")
}

fn with_errors(errors: SystematicErrors, seed: u64) -> resect::simulation::Simulated {
    let mut scenario = Preset::Warthog.scenario();
    scenario.errors = errors;
    simulate_scenario(&scenario, seed)
}

#[test]
fn clock_offsets_of_10_ms_are_recovered_within_1_ms_and_bias_nothing() {
    for (seed, offsets_s) in
        [(1, [0.0, 0.010, -0.010]), (2, [0.0, -0.010, 0.0]), (3, [0.010, 0.0, 0.0])]
    {
        let errors = SystematicErrors { clock_offset_s: offsets_s, ..Default::default() };
        let simulated = with_errors(errors, seed);
        let deployment = simulated.deployment().expect("valid");
        let truth = &simulated.truth.station1_from_station;
        let mut robust = Settings::default();
        robust.calibration = CalibrationSettings::robust();
        let analysis = analyse(&deployment, &robust);
        let clocks = refinement(&analysis).clock_offsets_s.expect("estimated");
        for (slot, clock) in clocks.iter().enumerate() {
            let true_s = offsets_s[slot + 1] - offsets_s[0];
            let off_s = clock.value - true_s;
            assert!(off_s.abs() < 1e-3, "seed {seed}, station {}: {clock:?}", slot + 2);
            assert!(off_s.abs() < 4.0 * clock.sigma, "seed {seed}: {clock:?}, truly {true_s}");
        }
        let off = normalised(&analysis, truth);
        assert!(off.iter().all(|z| z.abs() < 3.0), "seed {seed}: {off:.1?}");
        // Without it the metric suffers.
        let plain = analyse(&deployment, &Settings::default());
        let median =
            |analysis: &Analysis| answer(analysis).evaluation.inter_prism_mm.expect("a rig").median;
        assert!(median(&analysis) < 0.7 * median(&plain));
    }
}

#[test]
fn a_wrong_distance_is_found_as_far_as_the_prior_lets_it() {
    let errors = SystematicErrors { inter_prism_m: [0.003, 0.0, 0.0], ..Default::default() };
    let simulated = with_errors(errors, 4);
    let deployment = simulated.deployment().expect("valid");
    let estimate = Estimated { clocks: false, distances: true, tilt: false };
    let mut all = settings(Loss::Squared, estimate);
    all.calibration.inter_prism_sigma_m = 0.003;
    let analysis = analyse(&deployment, &all);
    let found = refinement(&analysis).distances_m.expect("estimated");
    for pair in 0..3 {
        let off_m = found[pair].value - simulated.truth.inter_prism_m[pair];
        assert!(off_m.abs() < 3.0 * found[pair].sigma, "{pair}: {off_m} {:?}", found[pair]);
        assert!(found[pair].sigma <= 0.0031, "the data never makes it worse than the prior");
    }
}

#[test]
fn stated_sigmas_hold_for_the_robust_estimate() {
    const SEEDS: u64 = 24;
    let mut runs = Vec::new();
    for seed in 0..SEEDS {
        let simulated = with_errors(SystematicErrors::default(), seed);
        let deployment = simulated.deployment().expect("valid");
        let mut robust = Settings::default();
        robust.calibration = CalibrationSettings::robust();
        let analysis = analyse(&deployment, &robust);
        assert!(refinement(&analysis).converged, "seed {seed}");
        runs.push(normalised(&analysis, &simulated.truth.station1_from_station));
    }
    let rms = rms_by_component(&runs);
    assert!(rms.iter().all(|rms| (0.6..1.4).contains(rms)), "{rms:.2?}");
}

#[test]
fn the_field_data_has_a_late_station_3_and_the_robust_estimate_is_better() {
    let Some(path) = field_data("2022-07-11-2") else { return };
    let deployment = open(&path).expect("opens");
    let analysis = analyse(&deployment, &settings(Loss::Squared, CLOCKS));
    let [second, third] = refinement(&analysis).clock_offsets_s.expect("estimated");
    assert!((3.5e-3..5e-3).contains(&third.value), "{third:?}");
    assert!(second.value.abs() < 1e-3, "{second:?}");
    let words: Vec<&str> =
        answer(&analysis).calibration.findings.iter().map(|f| f.message.as_str()).collect();
    let late = |w: &&str| w.contains("station 3's stamps are 4.") && w.contains("late");
    assert!(words.iter().any(late), "{words:?}");

    let mut robust = Settings::default();
    robust.calibration = CalibrationSettings::robust();
    let analysis = analyse(&deployment, &robust);
    let metric = answer(&analysis).evaluation.inter_prism_mm.expect("a rig");
    assert!(metric.median <= 1.05 && metric.iqr <= 2.1, "{metric:?}");
    let [second, third] = refinement(&analysis).clock_offsets_s.expect("estimated");
    assert!((3.5e-3..5e-3).contains(&third.value) && second.value.abs() < 1e-3);
}

/// Fitted on some intervals, judged on the others.
#[test]
fn on_intervals_left_out_of_the_fit_the_robust_estimate_is_better_too() {
    use resect::calibration::{self, Offer};
    use resect::evaluation::evaluate_answer;
    let Some(path) = field_data("2022-07-11-2") else { return };
    let deployment = open(&path).expect("opens");
    let triplets = resect::pipeline::run(&deployment, &Settings::default().pipeline).triplets;
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
            let found = calibration::solve(&deployment, &train, settings, &offer).expect("solves");
            let (_, evaluation) = evaluate_answer(&deployment, &test, offer.targets, &found);
            all.extend(evaluation.distance_errors_mm.into_iter().flatten().map(f64::abs));
        }
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let plain = error_mm(&CalibrationSettings::default());
    let robust = error_mm(&CalibrationSettings::robust());
    assert!(robust < 0.95 * plain, "robust {robust:.2}, plain {plain:.2} mm");
}
