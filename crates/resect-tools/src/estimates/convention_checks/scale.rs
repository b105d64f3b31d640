//! A scale of an estimate that is the same in each segment of the drive.

use nalgebra::Vector3;

use super::lever_equations::{FURTHER, LeverNormal, LeverVector, position_rows, solve};
use crate::estimates::fit::Fit;
use crate::estimates::matched_pose::MatchedPose;
use resect_core::calibration::Estimate;
use resect_core::geometry::align_similar;

/// Segments of the drive, of equal numbers of poses, and fewest poses of each.
const SEGMENTS: usize = 8;
const FEWEST: usize = 15;
/// A scale is significant above this multiple of its σ. Student's t of 7 degrees of freedom exceeds 4 once in 200 drives.
const SIGNIFICANT: f64 = 4.0;
/// Smallest scale that is reported: a map grid differs by several hundred parts per million, and temperatures by tens.
const SMALLEST: f64 = 1e-4;

/// Largest scale that segments show: the path lengths of the whole drive show larger ones, which on a circle a lever arm seems to explain.
const LARGEST: f64 = 0.1;

/// Returns the scale of the estimate relative to the ground truth, minus one, with σ; `None` if it is not significant.
///
/// Each segment is aligned by itself, so that drift from one segment to the next does not count. The σ is from the scatter of the
/// segments. Noise makes lengths longer: half of that effect is added.
pub fn significant_scale(pairs: &[MatchedPose], fit: &Fit) -> Option<Estimate> {
    let length = pairs.len() / SEGMENTS;
    if length < FEWEST {
        return None;
    }
    let lever_step_m = lever_step_m(pairs, fit).unwrap_or_default();
    let fit =
        Fit { lever_arm_m: fit.lever_arm_m.map(|lever_m| lever_m + lever_step_m), ..fit.clone() };
    let mut scales = Vec::new();
    for segment in pairs.chunks_exact(length).take(SEGMENTS) {
        let (placed_m, truth_m): (Vec<Vector3<f64>>, Vec<Vector3<f64>>) =
            segment.iter().map(|pair| fit.both_positions_m(&pair.pose, &pair.truth).into()).unzip();
        let (_, to_truth) = align_similar(&truth_m, &placed_m)?;
        let (_, to_estimate) = align_similar(&placed_m, &truth_m)?;
        let centre_m = truth_m.iter().sum::<Vector3<f64>>() / length as f64;
        let extent_m2: f64 =
            truth_m.iter().map(|truth_m| (truth_m - centre_m).norm_squared()).sum();
        // The regressions on either side enclose the scale: each is too small by the noise of its own regressor.
        let longer = (to_estimate / to_truth).sqrt();
        let noise = 0.5 * (1.0 - to_estimate * to_truth).max(0.0);
        scales.push((extent_m2, longer * fit.scale.recip() - 1.0, noise));
    }
    let weight: f64 = scales.iter().map(|(weight, ..)| weight).sum();
    let mean = |value: &dyn Fn(&(f64, f64, f64)) -> f64| {
        scales.iter().map(|scale| scale.0 * value(scale)).sum::<f64>() / weight
    };
    let value = mean(&|(_, scale, _)| *scale);
    let scatter: f64 =
        scales.iter().map(|(weight, scale, _)| (weight * (scale - value)).powi(2)).sum();
    let count = scales.len() as f64;
    let sigma = (scatter * count / (count - 1.0)).sqrt() / weight;
    let noise = mean(&|(_, _, noise)| *noise);
    let is_significant = value.abs() > SMALLEST && value.abs() > SIGNIFICANT * sigma + noise;
    (is_significant && value.abs() < LARGEST).then_some(Estimate { value, sigma })
}

/// Returns the change of the lever arm if the scale is free; `None` if the lever arm was not estimated. A fit without a scale shifts the
/// lever arm to explain it.
fn lever_step_m(pairs: &[MatchedPose], fit: &Fit) -> Option<Vector3<f64>> {
    fit.lever_arm_sigma_m?;
    let both_m = |pair: &MatchedPose| fit.both_positions_m(&pair.pose, &pair.truth);
    let centre_m =
        pairs.iter().map(|pair| both_m(pair)[0]).sum::<Vector3<f64>>() / pairs.len() as f64;
    let (mut normal, mut right) = (LeverNormal::zeros(), LeverVector::zeros());
    for pair in pairs {
        let [placed_m, true_m] = both_m(pair);
        let arm_m = placed_m - centre_m;
        // The lever arm is added to the ground truth if that has orientations, otherwise to the estimate.
        let lever = match &pair.truth.rotation {
            Some(rotation) => -rotation.orientation.to_rotation_matrix().into_inner(),
            None => fit.placed_orientation(&pair.pose)?.to_rotation_matrix().into_inner(),
        };
        let mut rows = position_rows(&lever, &arm_m, &pair.truth.velocity_m_per_s);
        rows.set_column(FURTHER, &arm_m);
        normal += rows.transpose() * rows;
        right += rows.transpose() * (true_m - placed_m);
    }
    Some(solve(normal, &right)?.fixed_rows::<3>(0).into_owned())
}
