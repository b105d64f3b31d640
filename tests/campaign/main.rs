//! Random simulated deployments over presets and error sources: how often the stated region covers the truth, how good
//! the estimates are, and whether anything is ever silently wrong.
//!
//! The short version runs always; the whole one, which prints the table, on request:
//! `cargo test --release --no-default-features --test campaign -- --ignored --nocapture`

#![allow(clippy::print_stdout, reason = "the table is the point")]

#[path = "../common/mod.rs"]
mod common;
mod cramer_rao;

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

#[test]
#[ignore = "experiment"]
fn efficiency() {
    use resect::pipeline::Interpolation;
    let count: u64 = std::env::var("N").ok().and_then(|n| n.parse().ok()).unwrap_or(50);
    let drawn =
        cramer_rao::Drawn { tilt_rad: ARCSECOND_RAD, distance_m: 0.0005, prism_constant_m: 0.0 };
    for preset in WELL_POSED {
        let rows: Vec<_> = (0..count)
            .into_par_iter()
            .map(|seed| {
                let seed = seed + 1000 * preset as u64;
                let simulated = simulate_scenario(&random_scenario(preset, seed), seed);
                let deployment = simulated.deployment().expect("valid");
                let truth = &simulated.truth.station1_from_station;
                let mut all = Vec::new();
                let mut bound = None;
                for (robust, wnoa, weigh) in [(1, 0, 0), (2, 0, 0)] {
                    let mut settings = Settings::default();
                    if robust > 0 {
                        settings.calibration = CalibrationSettings::robust();
                    }
                    if wnoa == 1 {
                        settings.pipeline.interpolation = Interpolation::Wnoa;
                    }
                    settings.calibration.weigh_by_noise = weigh == 1;
                    if robust > 1 {
                        settings.calibration.continuous_time = true;
                        settings.calibration.estimate.tilt = robust == 3;
                    }
                    let analysis = analyse(&deployment, &settings);
                    bound.get_or_insert_with(|| cramer_rao::bound(&simulated, &analysis, &drawn));
                    let calibration = &analysis.answer.as_ref().expect("answer").calibration;
                    let e = SVector::<f64, 8>::from_fn(|k, _| {
                        let (found, truth) =
                            (&calibration.station1_from_station[k / 4 + 1], &truth[k / 4 + 1]);
                        match k % 4 {
                            3 => wrap_to_pi(found.yaw_rad() - truth.yaw_rad),
                            axis => found.translation_m[axis] - truth.translation_m[axis],
                        }
                    });
                    all.push((e, calibration.covariance));
                }
                (all, bound.unwrap())
            })
            .collect();
        println!("{}", preset.name());
        for (seed, r) in rows.iter().enumerate() {
            let z = |w: usize| {
                (r.0[w].0.iter().enumerate().map(|(k, e)| e * e / r.1[(k, k)]).sum::<f64>() / 8.0)
                    .sqrt()
            };
            if z(1) > 2.0 {
                println!("seed {seed}: {:.1} {:.1}", z(0), z(1));
            }
        }
        for (which, name) in ["robust", "continuous"].iter().enumerate() {
            print!("  {name:<20}");
            for k in 0..8 {
                let err: f64 = rows.iter().map(|r| r.0[which].0[k].powi(2)).sum();
                let crb: f64 = rows.iter().map(|r| r.1[(k, k)]).sum();
                print!(" {:6.2}", (err / crb).sqrt());
            }
            let mut maha: Vec<f64> = rows
                .iter()
                .filter_map(|r| {
                    let e = r.0[which].0;
                    Some((e.transpose() * r.0[which].1?.cholesky()?.inverse() * e)[0])
                })
                .collect();
            maha.sort_by(f64::total_cmp);
            let cover =
                100.0 * maha.iter().filter(|m| **m < CHI2_95).count() as f64 / maha.len() as f64;
            let z: Vec<f64> = (0..8)
                .map(|k| {
                    let s: f64 = rows
                        .iter()
                        .filter_map(|r| Some(r.0[which].0[k].powi(2) / r.0[which].1?[(k, k)]))
                        .sum();
                    (s / maha.len() as f64).sqrt()
                })
                .collect();
            print!("   cover {cover:5.1} z");
            z.iter().for_each(|z| print!(" {z:4.2}"));
            println!();
        }
        print!("  crb mm/mrad         ");
        for k in 0..8 {
            let crb: f64 = rows.iter().map(|r| r.1[(k, k)]).sum::<f64>() / rows.len() as f64;
            print!(" {:6.2}", 1e3 * crb.sqrt());
        }
        println!();
    }
}

#[test]
#[ignore = "experiment"]
fn look() {
    let simulated = simulate_scenario(&random_scenario(Preset::Warthog, 7), 7);
    println!("{:?}", simulated.scenario.errors);
    println!("{:?}", simulated.scenario.noise);
    let deployment = simulated.deployment().expect("valid");
    let mut settings = Settings::default();
    settings.calibration = CalibrationSettings::robust();
    settings.calibration.continuous_time = true;
    let analysis = analyse(&deployment, &settings);
    let c = &analysis.answer.as_ref().unwrap().calibration;
    println!("{:?}", analysis.pipeline.kept_intervals);
    println!("{:?}", c.verdict);
    c.findings.iter().for_each(|f| println!("{}", f.message));
    println!("{:?}\n{:?}", c.station1_from_station, c.sigma);
    println!("{:?}", simulated.truth.station1_from_station);
    let t = &analysis.pipeline.triplets;
    let e = resect::calibration::inter_prism::distance_errors_m(
        t,
        &simulated.truth.station1_from_station.map(Into::into),
        &simulated.truth.inter_prism_m,
    );
    for (i, s) in t.time_s.iter().enumerate() {
        if (0..3).any(|p| e[p][i].abs() > 0.05) {
            println!(
                "{:.2} {} {:?}",
                s - 1_760_000_000.0,
                t.interval[i],
                e.each_ref().map(|e| e[i])
            );
        }
    }
}
