//! What several test files share.

#![allow(dead_code, reason = "each test file uses a part")]

use std::path::PathBuf;

use resect::analysis::{Analysis, Analyst, Answer, Settings};
use resect::calibration::{Calibration, Method};
use resect::deployment::Deployment;
use resect::geometry::{LevelTransform, RigidTransform, wrap_to_pi};

/// A folder or file of the field data, which is never part of the repository; `None` (said aloud) where it is
/// not there.
pub fn field_data(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/datasets").join(name);
    if path.exists() {
        Some(path)
    } else {
        eprintln!("skipped: {} is not here", path.display());
        None
    }
}

pub fn sample_folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/samples").join(name)
}

/// The one path, from a fresh start.
pub fn analyse(deployment: &Deployment, settings: &Settings) -> Analysis {
    Analyst::new(deployment.clone().into()).run(settings)
}

/// The default settings but for the method.
pub fn by(method: Method) -> Settings {
    let mut settings = Settings::default();
    settings.calibration.method = Some(method);
    settings
}

/// Those of the paper: method D, and nothing beyond.
pub fn published() -> Settings {
    by(Method::InterPrism)
}

pub fn answer(analysis: &Analysis) -> &Answer {
    analysis.answer.as_ref().expect("an answer")
}

/// Asserts that two transforms agree within metres and radians.
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

/// Errors of (x, y, z, yaw) of stations 2 and 3 over their stated σ.
#[track_caller]
pub fn normalised(analysis: &Analysis, truth: &[LevelTransform; 3]) -> [f64; 8] {
    off_in_sigmas(&answer(analysis).calibration, truth)
}

/// The same of a calibration by itself.
#[track_caller]
pub fn off_in_sigmas(calibration: &Calibration, truth: &[LevelTransform; 3]) -> [f64; 8] {
    let sigma = calibration.sigma.expect("nothing is free");
    std::array::from_fn(|k| {
        let (station, part) = (k / 4 + 1, k % 4);
        let (found, truth) = (&calibration.station1_from_station[station], &truth[station]);
        let sigma = &sigma[station - 1];
        if part == 3 {
            wrap_to_pi(found.yaw_rad() - truth.yaw_rad) / sigma.yaw_rad
        } else {
            (found.translation_m - truth.translation_m)[part] / sigma.translation_m[part]
        }
    })
}

/// Root mean square of each component over many runs.
pub fn rms_by_component(runs: &[[f64; 8]]) -> [f64; 8] {
    std::array::from_fn(|k| {
        (runs.iter().map(|run| run[k].powi(2)).sum::<f64>() / runs.len() as f64).sqrt()
    })
}
