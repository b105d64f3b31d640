//! Alignment of an estimate's frame by plain least squares.

use nalgebra::Vector3;

use super::fit::Fit;
use crate::estimates::matched_pose::MatchedPose;
use crate::estimates::options::TrajectoryAlignment;
use crate::estimates::unfit::Unfit;
use resect_core::geometry::{align_rigid, align_similar};

/// Fewest pairs by which a frame is aligned.
pub const FEWEST_POINTS: usize = 4;

/// Aligns the frame by plain least squares, with fixed clock and lever arm.
pub fn align(
    fit: &mut Fit,
    pairs: &[MatchedPose],
    alignment: TrajectoryAlignment,
) -> Result<(), Unfit> {
    if pairs.len() < FEWEST_POINTS {
        return Err(Unfit::FewEpochs);
    }
    if alignment == TrajectoryAlignment::None {
        return Ok(());
    }
    let [true_m, body_m] = both_m(fit, pairs);
    let aligned = match alignment {
        TrajectoryAlignment::Similarity => align_similar(&true_m, &body_m),
        _ => align_rigid(&true_m, &body_m).map(|transform| (transform, 1.0)),
    };
    (fit.truth_from_estimate, fit.scale) = aligned.ok_or(Unfit::OnALine)?;
    Ok(())
}

/// Aligns the frame by plain least squares with fixed scale, clock and lever arm; does nothing for an estimate in the ground truth's frame.
pub fn align_rigidly(
    fit: &mut Fit,
    pairs: &[MatchedPose],
    alignment: TrajectoryAlignment,
) -> Result<(), Unfit> {
    if alignment == TrajectoryAlignment::None {
        return Ok(());
    }
    let [true_m, mut body_m] = both_m(fit, pairs);
    body_m.iter_mut().for_each(|body_m| *body_m *= fit.scale);
    fit.truth_from_estimate = align_rigid(&true_m, &body_m).ok_or(Unfit::OnALine)?;
    Ok(())
}

/// Positions of the compared point by the ground truth, and by the estimate in its own frame without the scale (m).
fn both_m(fit: &Fit, pairs: &[MatchedPose]) -> [Vec<Vector3<f64>>; 2] {
    let lever_m = fit.lever_arm_m.unwrap_or_default();
    let true_m: Vec<Vector3<f64>> = pairs
        .iter()
        .map(|MatchedPose { truth, .. }| match &truth.rotation {
            Some(rotation) => truth.position_m + rotation.orientation * lever_m,
            None => truth.position_m,
        })
        .collect();
    let body_m: Vec<Vector3<f64>> = pairs
        .iter()
        .map(|MatchedPose { pose, truth, .. }| match (&truth.rotation, pose.orientation) {
            // The length of the lever arm does not depend on the scale.
            (None, Some(own)) => pose.position_m + own * lever_m / fit.scale,
            _ => pose.position_m,
        })
        .collect();
    [true_m, body_m]
}
