//! Random halves of the control points, so that an answer is judged on points that it has not used.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use resect_core::analysis::Settings;
use resect_core::deployment::{ControlPointSet, Deployment};
use resect_core::statistics::median;

use crate::common::analyse;

const HALVES: u64 = 10;
const SEED: u64 = 36;

/// A deployment with a random half of the control points of each set, and the other half.
pub struct ControlPointHalf {
    deployment: Deployment,
    left_out: Vec<ControlPointSet>,
}

/// Returns ten random halves; none if no control points can be compared with the drive.
pub fn control_point_halves(deployment: &Deployment) -> Vec<ControlPointHalf> {
    if deployment.comparable_control_points().iter().all(|set| set.pillars) {
        return Vec::new();
    }
    let half = |stream: u64| {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        rng.set_stream(stream);
        ControlPointHalf::draw(deployment, &mut rng)
    };
    (0..HALVES).map(half).collect()
}

impl ControlPointHalf {
    /// Draws half of the points of each set. Pillars stay complete, because the metric excludes them.
    fn draw(deployment: &Deployment, rng: &mut ChaCha8Rng) -> Self {
        let mut deployment = deployment.clone();
        let mut left_out = Vec::new();
        for set in deployment.control_points.iter_mut().filter(|set| !set.pillars) {
            set.points.shuffle(rng);
            let points = set.points.split_off(set.points.len().div_ceil(2));
            left_out.push(ControlPointSet { points, ..set.clone() });
        }
        Self { deployment, left_out }
    }

    /// Calibrates with this half and returns the control-point metric of the other one (mm); `None` without an answer.
    pub fn left_out_mm(&self, settings: &Settings) -> Option<f64> {
        let analysis = analyse(&self.deployment, settings);
        let transforms = analysis.answer.ok()?.calibration.survey_transforms();
        let distances_m = self.left_out.iter().flat_map(|set| set.disagreements_m(&transforms));
        median(distances_m.map(|distance_m| 1e3 * distance_m))
    }
}
