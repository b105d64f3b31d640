//! Rotation of an estimate's body in the vehicle.

use nalgebra::{UnitQuaternion, Vector3};

use super::fit::Fit;
use super::pieces::{BLOCKS, SHORTEST_BLOCK_S};
use crate::estimates::matched_pose::MatchedPose;
use resect_core::statistics::median;

/// Estimates the body's rotation in the vehicle: the median over epochs, with σ from the means of blocks of time.
pub fn turn_body(fit: &mut Fit, pairs: &[MatchedPose], is_same: bool) {
    let each: Option<Vec<(f64, UnitQuaternion<f64>)>> = pairs
        .iter()
        .map(|MatchedPose { pose, truth, .. }| {
            let rotation = truth.rotation.as_ref()?;
            Some((truth.time_s, rotation.orientation.inverse() * fit.placed_orientation(pose)?))
        })
        .collect();
    let Some(each) = each else { return };
    if is_same {
        fit.body_rotation = Some(UnitQuaternion::identity());
        return;
    }
    // Far from the mean rotation, the mean of rotation vectors is not the mean rotation.
    let mut middle = each[each.len() / 2].1;
    let mut left: Vec<Vector3<f64>> = Vec::new();
    for _ in 0..10 {
        left = each.iter().map(|(_, turn)| (turn * middle.inverse()).scaled_axis()).collect();
        let step = Vector3::from_fn(|axis, _| {
            median(left.iter().map(|turn| turn[axis])).unwrap_or_default()
        });
        middle = UnitQuaternion::from_scaled_axis(step) * middle;
        if step.norm() < 1e-12 {
            break;
        }
    }
    fit.body_rotation = Some(middle);
    let (from_s, to_s) = (each[0].0, each[each.len() - 1].0);
    let length_s = ((to_s - from_s) / BLOCKS).max(SHORTEST_BLOCK_S);
    let mut sums: Vec<(f64, Vector3<f64>)> =
        vec![(0.0, Vector3::zeros()); ((to_s - from_s) / length_s) as usize + 1];
    for ((time_s, _), turn) in each.iter().zip(&left) {
        let (count, sum) = &mut sums[((time_s - from_s) / length_s) as usize];
        *count += 1.0;
        *sum += turn;
    }
    let means: Vec<Vector3<f64>> =
        sums.iter().filter(|(count, _)| *count > 0.0).map(|(count, sum)| sum / *count).collect();
    let blocks = means.len() as f64;
    let square: f64 = means.iter().map(Vector3::norm_squared).sum::<f64>() / 3.0;
    fit.body_rotation_sigma_rad =
        (blocks > 1.0).then(|| (square / (blocks * (blocks - 1.0))).sqrt());
}
