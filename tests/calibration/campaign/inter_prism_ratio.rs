//! Inter-prism metric by everything relative to that by the drive alone, where all errors are of their usual size.
//!
//! The metric is computed from the same readings of the drive, so the drive alone fits it best, and control points cannot improve it.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use resect_core::analysis::{Analysis, Settings};
use resect_core::calibration::Evidence;
use resect_core::statistics::quantile_of_sorted;
use resect_tools::simulation::{ErrorKind, Simulated, simulate_scenario};

use super::{PRESETS, WELL_POSED, pose_errors, scenario_with, set_ups_in_the_middle};
use crate::common::analyse;

/// A drive by everything, relative to the drive alone.
struct Ratio {
    inter_prism: f64,
    /// Ratio of the largest errors of a set-up's position.
    error: f64,
}

fn ratio(seed: u64) -> Option<Ratio> {
    let preset = PRESETS[(seed % WELL_POSED as u64) as usize];
    let kinds: Vec<ErrorKind> =
        ErrorKind::ALL.into_iter().filter(|kind| *kind != ErrorKind::ClockJumps).collect();
    let mut scenario = scenario_with(preset, seed, &kinds).draw_errors(seed);
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5e7);
    scenario.control_point_sets = rng.random_range(1..4);
    let simulated = simulate_scenario(&scenario, seed);
    let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
    let mut drive_alone = Settings::default();
    drive_alone.calibration.evidence = Evidence { control_points: false, ..Evidence::ALL };
    let everything = analyse(&deployment, &Settings::default());
    let drive = analyse(&deployment, &drive_alone);
    let inter_prism_mm = |analysis: &Analysis| {
        Some(analysis.answer.as_ref().ok()?.evaluation.inter_prism_mm?.median)
    };
    Some(Ratio {
        inter_prism: inter_prism_mm(&everything)? / inter_prism_mm(&drive)?,
        error: largest_error_m(&everything, &simulated)? / largest_error_m(&drive, &simulated)?,
    })
}

fn largest_error_m(analysis: &Analysis, simulated: &Simulated) -> Option<f64> {
    let calibration = &analysis.answer.as_ref().ok()?.calibration;
    let error = pose_errors(&calibration.station1_from_station, &set_ups_in_the_middle(simulated));
    let norm = |station: usize| error.fixed_rows::<3>(4 * station).norm();
    Some(norm(0).max(norm(1)))
}

#[test]
#[ignore = "a minute in release; prints the quantiles"]
fn everything_costs_little_of_the_inter_prism_metric() {
    let all: Vec<Ratio> = (0..300).into_par_iter().filter_map(ratio).collect();
    println!("{} drives; by everything, relative to the drive alone", all.len());
    println!("quantile   inter-prism metric   largest error of a position");
    let mut of_metric: Vec<f64> = all.iter().map(|one| one.inter_prism).collect();
    let mut of_error: Vec<f64> = all.iter().map(|one| one.error).collect();
    of_metric.sort_by(f64::total_cmp);
    of_error.sort_by(f64::total_cmp);
    for share in [0.05, 0.5, 0.95, 0.99, 1.0] {
        let [metric, error] =
            [&of_metric, &of_error].map(|of| quantile_of_sorted(of, share).unwrap_or(f64::NAN));
        println!("{:6.0} %   {metric:18.3}   {error:27.3}", 100.0 * share);
    }
    let above = of_metric.iter().filter(|ratio| **ratio > 1.1).count();
    assert!(above * 50 <= all.len(), "{above} of {} drives above 1.1", all.len());
}
