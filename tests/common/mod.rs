//! Helpers that several test binaries share.

#![allow(dead_code, reason = "each test binary uses a part")]

pub mod slam;

use std::path::PathBuf;

use nalgebra::Vector3;
use resect_core::analysis::{Analysis, Analyst, Answer, Settings};
use resect_core::calibration::{Calibration, Method};
use resect_core::deployment::Deployment;
use resect_core::geometry::{LevelTransform, RigidTransform, wrap_to_pi};
use resect_core::network::PerStation;
use resect_tools::simulation::{EPOCH_S, Scenario, Settling, Simulated, simulate_scenario};

/// Returns a folder or file of the field data, which is never in the repository; `None`, with a message, if it is absent.
///
/// For tests that can use other data as well.
pub fn field_data(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/datasets").join(name);
    if path.exists() {
        Some(path)
    } else {
        eprintln!("skipped: {} is not here", path.display());
        None
    }
}

/// Returns the same for tests of field data alone, which `build.rs` ignores with a message if it is absent.
pub fn of_field(name: &str) -> PathBuf {
    field_data(name).expect("../shared/datasets has it")
}

pub fn sample_folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("crates/resect-io/assets/samples").join(name)
}

/// Runs the full analysis, without caches.
pub fn analyse(deployment: &Deployment, settings: &Settings) -> Analysis {
    Analyst::new(deployment.clone().into()).run(settings)
}

/// Returns the default settings with this method.
pub fn by(method: Method) -> Settings {
    let mut settings = Settings::default();
    settings.calibration.method = Some(method);
    settings
}

/// Returns the paper's settings: method D alone.
pub fn published() -> Settings {
    by(Method::InterPrism)
}

pub fn answer(analysis: &Analysis) -> &Answer {
    analysis.answer.as_ref().expect("an answer")
}

/// Asserts that two transforms agree within tolerances (m, rad).
#[track_caller]
pub fn assert_close(
    found: &(impl Copy + Into<RigidTransform>),
    expected: &(impl Copy + Into<RigidTransform>),
    metres: [f64; 3],
    radians: f64,
) {
    let (found, expected): (RigidTransform, RigidTransform) = ((*found).into(), (*expected).into());
    let off = found.translation_m - expected.translation_m;
    let turned = wrap_to_pi(found.yaw_rad() - expected.yaw_rad());
    assert!(
        (0..3).all(|axis| off[axis].abs() <= metres[axis]) && turned.abs() <= radians,
        "off by {off:?} m and {turned} rad: {found:?} instead of {expected:?}"
    );
}

/// Returns the errors of (x, y, z, yaw) of stations 2 and 3 relative to their stated σ.
#[track_caller]
pub fn normalised(analysis: &Analysis, truth: &PerStation<LevelTransform>) -> [f64; 8] {
    off_in_sigmas(&answer(analysis).calibration, truth)
}

/// Returns the same for a calibration.
#[track_caller]
pub fn off_in_sigmas(calibration: &Calibration, truth: &PerStation<LevelTransform>) -> [f64; 8] {
    let sigma = calibration.sigma.as_ref().expect("nothing is free");
    std::array::from_fn(|k| {
        let (station, part) = (k / 4 + 1, k % 4);
        let (found, truth) = (&calibration.station1_from_station[station], &truth[station]);
        let sigma = &sigma[station];
        if part == 3 {
            wrap_to_pi(found.yaw_rad() - truth.yaw_rad) / sigma.yaw_rad
        } else {
            (found.translation_m - truth.translation_m)[part] / sigma.translation_m[part]
        }
    })
}

/// Returns the root mean square of each component over many runs.
pub fn rms_by_component(runs: &[[f64; 8]]) -> [f64; 8] {
    std::array::from_fn(|k| {
        (runs.iter().map(|run| run[k].powi(2)).sum::<f64>() / runs.len() as f64).sqrt()
    })
}

/// Duration of each of two runs, and of the pause between them (s).
const RUN_S: f64 = 200.0;
const BETWEEN_RUNS_S: f64 = 20.0;

/// Returns two runs of one set-up, with settlings of stations in between: one drive with a pause, cut there.
pub fn two_runs(scenario: Scenario, seed: u64, between: &[Settling]) -> [Simulated; 2] {
    let duration_s = 2.0 * RUN_S + BETWEEN_RUNS_S;
    let mut scenario = Scenario { duration_s, ..scenario }.draw_errors(seed);
    scenario.pauses_s.push([RUN_S, RUN_S + BETWEEN_RUNS_S]);
    scenario.errors.settling.extend_from_slice(between);
    let whole = simulate_scenario(&scenario, seed);
    let middle_s = EPOCH_S + RUN_S + 0.5 * BETWEEN_RUNS_S;
    [true, false].map(|first| {
        let mut run = whole.clone();
        run.records.retain(|record| (record.measurement.time_s < middle_s) == first);
        run
    })
}

/// Returns a rotation and displacement of a station (0 to 2) between two runs.
pub fn knock(station: usize, turn_rad: f64, move_m: [f64; 3]) -> Settling {
    Settling {
        station,
        from_s: RUN_S + 0.5 * BETWEEN_RUNS_S,
        over_s: 0.0,
        turn_rad,
        move_m: Vector3::from(move_m),
        lean_rad: [0.0; 2],
    }
}
