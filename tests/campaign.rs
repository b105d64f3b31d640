//! Random simulated deployments over presets and error sources: how often the stated region covers the truth, how good
//! the estimates are, and whether anything is ever silently wrong.
//!
//! The short version runs always; the whole one, which prints the table, on request:
//! `cargo test --release --no-default-features --test campaign -- --ignored --nocapture`

#![allow(clippy::print_stdout, reason = "the table is the point")]

mod common;

use std::collections::BTreeMap;

use common::analyse;
use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use resect::analysis::{Analysis, Settings};
use resect::calibration::{CalibrationSettings, Verdict};
use resect::geometry::{LevelTransform, wrap_to_pi};
use resect::simulation::{ARCSECOND_RAD, Preset, Scenario, simulate_scenario};

const PRESETS: [Preset; 8] = [
    Preset::Warthog,
    Preset::Hd2Tunnel,
    Preset::FlatFloor,
    Preset::UnevenGround,
    Preset::FigureEight,
    Preset::StraightLine,
    Preset::Circle,
    Preset::LShape,
];
/// Those whose drives hold all eight numbers well.
const WELL_POSED: [Preset; 5] = [
    Preset::Warthog,
    Preset::Hd2Tunnel,
    Preset::FlatFloor,
    Preset::UnevenGround,
    Preset::FigureEight,
];
/// 95 % of χ² with eight degrees of freedom.
const CHI2_95: f64 = 15.507;

/// A scenario with random errors of all kinds that happen in the field.
fn random_scenario(preset: Preset, seed: u64) -> Scenario {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5eed);
    let mut normal = |sigma: f64| -> f64 {
        let deviate: f64 = StandardNormal.sample(&mut rng);
        sigma * deviate
    };
    let mut scenario = preset.scenario();
    scenario.errors.clock_offset_s = [0.0, normal(0.004), normal(0.004)];
    scenario.errors.tilt_rad =
        std::array::from_fn(|_| [normal(ARCSECOND_RAD), normal(ARCSECOND_RAD)]);
    scenario.errors.inter_prism_m = std::array::from_fn(|_| normal(0.0005));
    scenario.noise.range_sigma_m = rng.random_range(0.001..0.003);
    scenario.noise.outlier_share = rng.random_range(0.0..0.008);
    scenario.noise.lost_locks_per_minute = rng.random_range(0.0..0.6);
    scenario
}

struct Outcome {
    verdict: Option<Verdict>,
    /// Within the stated 95 % region.
    covered: Option<bool>,
    /// Largest error over its σ, and largest error of a position (m).
    largest_sigmas: f64,
    largest_m: f64,
}

fn outcome(analysis: &Analysis, truth: &[LevelTransform; 3]) -> Outcome {
    let Ok(answer) = &analysis.answer else {
        return Outcome { verdict: None, covered: None, largest_sigmas: 0.0, largest_m: 0.0 };
    };
    let calibration = &answer.calibration;
    let error = SVector::<f64, 8>::from_fn(|k, _| {
        let (found, truth) = (&calibration.station1_from_station[k / 4 + 1], &truth[k / 4 + 1]);
        match k % 4 {
            3 => wrap_to_pi(found.yaw_rad() - truth.yaw_rad),
            axis => found.translation_m[axis] - truth.translation_m[axis],
        }
    });
    let covered = calibration.covariance.and_then(|covariance| {
        let inverse = covariance.cholesky()?.inverse();
        Some((error.transpose() * inverse * error)[0] <= CHI2_95)
    });
    let largest_sigmas = calibration.covariance.map_or(0.0, |covariance| {
        (0..8).map(|k| error[k].abs() / covariance[(k, k)].sqrt()).fold(0.0, f64::max)
    });
    let largest_m = (0..8).filter(|k| k % 4 != 3).map(|k| error[k].abs()).fold(0.0, f64::max);
    Outcome { verdict: Some(calibration.verdict), covered, largest_sigmas, largest_m }
}

/// Outcomes of the published method and of the robust one.
fn run(count: u64) -> Vec<(Preset, [Outcome; 2])> {
    (0..count)
        .into_par_iter()
        .map(|seed| {
            let preset = PRESETS[(seed % PRESETS.len() as u64) as usize];
            let simulated = simulate_scenario(&random_scenario(preset, seed), seed);
            let deployment = simulated.deployment().expect("valid");
            let truth = &simulated.truth.station1_from_station;
            let mut robust = Settings::default();
            robust.calibration = CalibrationSettings::robust();
            let outcomes = [Settings::default(), robust]
                .map(|settings| outcome(&analyse(&deployment, &settings), truth));
            (preset, outcomes)
        })
        .collect()
}

/// Good, yet off by more than 5 σ or 5 cm.
fn is_silent_failure(outcome: &Outcome) -> bool {
    outcome.verdict == Some(Verdict::Good)
        && (outcome.largest_sigmas > 5.0 || outcome.largest_m > 0.05)
}

/// Prints a line for each preset and gives silent failures and coverage on the well-posed ones, for both methods.
fn summarise(outcomes: &[(Preset, [Outcome; 2])]) -> [(usize, f64); 2] {
    let mut result = [(0, 0.0); 2];
    for (which, name) in ["published D", "robust"].into_iter().enumerate() {
        println!(
            "{name}\n  preset           n  good weak ambig degen none  covered  worst good: σ, mm  silent"
        );
        let mut by_preset: BTreeMap<&str, Vec<&Outcome>> = BTreeMap::new();
        for (preset, both) in outcomes {
            by_preset.entry(preset.name()).or_default().push(&both[which]);
        }
        let (mut covered, mut told) = (0, 0);
        for (preset, all) in &by_preset {
            let count =
                |verdict: Verdict| all.iter().filter(|o| o.verdict == Some(verdict)).count();
            let none = all.iter().filter(|o| o.verdict.is_none()).count();
            let silent = all.iter().filter(|o| is_silent_failure(o)).count();
            let hits = all.iter().filter(|o| o.covered == Some(true)).count();
            let said = all.iter().filter(|o| o.covered.is_some()).count();
            let good = || all.iter().filter(|o| o.verdict == Some(Verdict::Good));
            let worst = good().map(|o| o.largest_sigmas).fold(0.0, f64::max);
            let worst_mm = good().map(|o| 1e3 * o.largest_m).fold(0.0, f64::max);
            println!(
                "  {preset:<14} {:>4}  {:>4} {:>4} {:>5} {:>5} {:>4}  {:>6.1} %  {worst:>10.1} {worst_mm:>6.1}  {silent:>6}",
                all.len(),
                count(Verdict::Good),
                count(Verdict::Weak),
                count(Verdict::Ambiguous),
                count(Verdict::Degenerate),
                none,
                100.0 * hits as f64 / said.max(1) as f64,
            );
            result[which].0 += silent;
            if WELL_POSED.iter().any(|well| well.name() == *preset) {
                covered += hits;
                told += said;
            }
        }
        result[which].1 = covered as f64 / told.max(1) as f64;
        println!("  well-posed presets: the 95 % region covers {:.1} %", 100.0 * result[which].1);
    }
    result
}

#[test]
fn nothing_is_silently_wrong_in_a_short_campaign() {
    let [published, robust] = summarise(&run(48));
    assert_eq!((published.0, robust.0), (0, 0), "silent failures");
    assert!(robust.1 > 0.8, "coverage {:.2}", robust.1);
}

#[test]
#[ignore = "a minute in release; prints the table"]
fn nothing_is_silently_wrong_in_a_thousand_deployments() {
    let [published, robust] = summarise(&run(1000));
    assert_eq!((published.0, robust.0), (0, 0), "silent failures");
}
