//! Residuals of one epoch, and their derivatives.

use nalgebra::{Matrix3, SMatrix, UnitQuaternion, Vector3};

use super::fit::Fit;
use super::neighbours::Neighbours;
use super::state::{
    BY_CLOCK, BY_ORIENTATION, BY_POSITION, BY_SLOW_CLOCK, BY_TRANSLATION, FitState, WANDERING,
};
use super::unknowns::{BODY, BY_TRUTH, CLOCK, COLUMNS, SCALE};
use crate::estimates::matched_pose::{MatchedPose, PoseTwist};

/// Derivatives of three residuals by the unknowns and by what wanders. Those by the lever arm come twice: by the orientations of each
/// trajectory.
pub type ByUnknowns = SMatrix<f64, 3, COLUMNS>;
pub type ByWandering = SMatrix<f64, 3, WANDERING>;

/// Three residuals, ground truth minus estimate, with their derivatives.
pub struct EpochRow {
    pub residual: Vector3<f64>,
    pub by_wandering: ByWandering,
    pub by_unknowns: ByUnknowns,
}

/// Residuals of an epoch in the ground truth's frame.
pub struct EpochRows {
    /// Residual of the position (m).
    pub position: EpochRow,
    /// Residual of the orientation (rad); `None` if either has none, or the body's rotation is not estimated.
    pub rotation: Option<EpochRow>,
    /// Position of the compared point by the estimate (m). The frame turns about it.
    pub placed_m: Vector3<f64>,
}

/// Returns the residuals with the frame of the state, and a clock that is later by some time (s).
pub fn epoch_rows(
    pair: &MatchedPose,
    state: &FitState,
    later_s: f64,
    neighbours: &Neighbours,
) -> EpochRows {
    let (MatchedPose { pose, truth, .. }, fit) = (pair, &state.fit);
    let [placed_m, mut true_m] = fit.both_positions_m(pose, truth);
    let [mut lever_by_estimate, mut lever_by_truth] = [Matrix3::zeros(); 2];
    let mut by_turn = Matrix3::zeros();
    let orientation = fit.placed_orientation(pose);
    if let Some(rotation) = &truth.rotation {
        let by_estimate = orientation.zip(fit.body_rotation);
        let vehicle =
            by_estimate.map_or(rotation.orientation, |(body, turn)| body * turn.inverse());
        lever_by_estimate = vehicle.to_rotation_matrix().into_inner();
        lever_by_truth = rotation.orientation.to_rotation_matrix().into_inner();
        if state.is_turned_by_estimate {
            let lever_m = fit.lever_arm_m.unwrap_or_default();
            true_m += (lever_by_estimate - lever_by_truth) * lever_m;
            by_turn = -(lever_by_estimate * lever_m).cross_matrix();
        }
    } else if let Some(orientation) = pose.orientation {
        let axes = |orientation: UnitQuaternion<f64>| {
            -(state.aligned * orientation.to_rotation_matrix()).into_inner()
        };
        lever_by_estimate = axes(neighbours.orientation.unwrap_or(orientation));
        lever_by_truth = axes(orientation);
    }
    let twist = compared_twist(pair, state, neighbours.twist);
    let velocity = twist.velocity_m_per_s;
    true_m += velocity * later_s;
    let mut position = EpochRow {
        residual: true_m - placed_m,
        by_wandering: ByWandering::zeros(),
        by_unknowns: ByUnknowns::zeros(),
    };
    let minus = -Matrix3::identity();
    position.by_wandering.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_turn);
    position.by_wandering.fixed_view_mut::<3, 3>(0, BY_TRANSLATION).copy_from(&minus);
    position.by_wandering.fixed_view_mut::<3, 3>(0, BY_POSITION).copy_from(&minus);
    for clock in [BY_CLOCK, BY_SLOW_CLOCK] {
        position.by_wandering.set_column(clock, &velocity);
    }
    position.by_unknowns.fixed_view_mut::<3, 3>(0, 0).copy_from(&lever_by_estimate);
    let mut by_truth = position.by_unknowns.fixed_view_mut::<3, 3>(0, BY_TRUTH);
    by_truth.copy_from(&lever_by_truth);
    position.by_unknowns.set_column(CLOCK, &velocity);
    // Between the positions of both, by the noise of each: noise would count as motion, and make the other seem too short.
    let own_m = fit.truth_from_estimate.rotate(&(fit.scale * (pose.position_m - state.pivot_m)));
    let from_pivot_m = own_m + state.share_of_estimate * position.residual;
    position.by_unknowns.set_column(SCALE, &-from_pivot_m);
    let turned = truth.rotation.as_ref().zip(fit.body_rotation).zip(orientation);
    let rotation = turned.map(|((rotation, body), orientation)| {
        let rate = twist.rate_rad_per_s;
        let later = UnitQuaternion::from_scaled_axis(rate * later_s) * rotation.orientation;
        let mut row = EpochRow {
            residual: (later * body * orientation.inverse()).scaled_axis(),
            by_wandering: ByWandering::zeros(),
            by_unknowns: ByUnknowns::zeros(),
        };
        row.by_wandering.fixed_view_mut::<3, 3>(0, 0).copy_from(&minus);
        row.by_wandering.fixed_view_mut::<3, 3>(0, BY_ORIENTATION).copy_from(&minus);
        for clock in [BY_CLOCK, BY_SLOW_CLOCK] {
            row.by_wandering.set_column(clock, &rate);
        }
        row.by_unknowns.set_column(CLOCK, &rate);
        let axes = rotation.orientation.to_rotation_matrix().into_inner();
        row.by_unknowns.fixed_view_mut::<3, 3>(0, BODY).copy_from(&axes);
        row
    });
    EpochRows { position, rotation, placed_m }
}

/// Motion of the compared point in the ground truth's frame, by both trajectories. If the estimate is interpolated, a later ground truth is an earlier
/// estimate.
fn compared_twist(pair: &MatchedPose, state: &FitState, stamped: Option<PoseTwist>) -> PoseTwist {
    let (of_truth, of_estimate) = match pair.pose_twist {
        Some(twist) => (stamped, Some(twist)),
        None => (Some(pair.truth.twist()), stamped),
    };
    let of_truth = of_truth.map(|twist| twist_by_truth(pair, &state.fit, twist));
    let of_estimate = of_estimate.map(|twist| twist_by_estimate(pair, &state.fit, twist));
    let (stamped, interpolated) = match pair.pose_twist {
        Some(_) => (of_truth, of_estimate),
        None => (of_estimate, of_truth),
    };
    let interpolated = interpolated.unwrap_or_default();
    let stamped = stamped.unwrap_or(interpolated);
    let mean = |stamped: Vector3<f64>, interpolated: Vector3<f64>| {
        interpolated.lerp(&stamped, state.share_of_stamped)
    };
    PoseTwist {
        velocity_m_per_s: mean(stamped.velocity_m_per_s, interpolated.velocity_m_per_s),
        rate_rad_per_s: mean(stamped.rate_rad_per_s, interpolated.rate_rad_per_s),
    }
}

fn twist_by_truth(pair: &MatchedPose, fit: &Fit, twist: PoseTwist) -> PoseTwist {
    let [_, true_m] = fit.both_positions_m(&pair.pose, &pair.truth);
    let by_turn = twist.rate_rad_per_s.cross(&(true_m - pair.truth.position_m));
    PoseTwist { velocity_m_per_s: twist.velocity_m_per_s + by_turn, ..twist }
}

fn twist_by_estimate(pair: &MatchedPose, fit: &Fit, twist: PoseTwist) -> PoseTwist {
    let rate_rad_per_s = fit.truth_from_estimate.rotate(&twist.rate_rad_per_s);
    let mut velocity_m_per_s =
        fit.truth_from_estimate.rotate(&(fit.scale * twist.velocity_m_per_s));
    if let (None, Some(orientation)) = (&pair.truth.rotation, fit.placed_orientation(&pair.pose)) {
        let arm_m = orientation * fit.lever_arm_m.unwrap_or_default();
        velocity_m_per_s += rate_rad_per_s.cross(&arm_m);
    }
    PoseTwist { velocity_m_per_s, rate_rad_per_s }
}
