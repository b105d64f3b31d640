//! Linear equations of positions with a lever arm, a small motion of the frame, and a time offset.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use crate::estimates::matched_pose::{MatchedPose, PoseTwist};
use resect_core::geometry::RigidTransform;

/// Unknowns: lever arm (m), translation (m), small rotation (rad), time offset (s), and a further one of each caller. The fit has as many columns,
/// so that the program contains one size of matrices.
pub const LEVER_UNKNOWNS: usize = 11;
pub const TIME_OFFSET: usize = 9;
pub const FURTHER: usize = 10;

/// Derivatives of three errors by the unknowns.
pub type LeverRows = SMatrix<f64, 3, LEVER_UNKNOWNS>;
/// Normal equations of the unknowns.
pub type LeverNormal = SMatrix<f64, LEVER_UNKNOWNS, LEVER_UNKNOWNS>;
pub type LeverVector = SVector<f64, LEVER_UNKNOWNS>;
/// Share of the normal matrix that constrains directions which the drive does not determine.
const RIDGE: f64 = 1e-9;

/// Returns the derivatives of a position by the unknowns but the further one. `lever_axes` are the body's axes in the frame of the position, and `arm_m` the
/// position relative to the point about which the frame turns.
pub fn position_rows(
    lever_axes: &Matrix3<f64>,
    arm_m: &Vector3<f64>,
    velocity_m_per_s: &Vector3<f64>,
) -> LeverRows {
    let mut rows = LeverRows::zeros();
    rows.fixed_view_mut::<3, 3>(0, 0).copy_from(lever_axes);
    rows.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
    rows.fixed_view_mut::<3, 3>(0, 6).copy_from(&arm_m.cross_matrix());
    rows.fixed_view_mut::<3, 1>(0, TIME_OFFSET).copy_from(velocity_m_per_s);
    rows
}

/// Velocity (m/s) and rotation rate (rad/s) of the one of the two that was interpolated, in the ground truth's frame.
pub fn motion(
    pair: &MatchedPose,
    truth_from_estimate: &RigidTransform,
    scale: f64,
) -> [Vector3<f64>; 2] {
    match pair.pose_twist {
        Some(PoseTwist { velocity_m_per_s, rate_rad_per_s }) => [
            truth_from_estimate.rotate(&(scale * velocity_m_per_s)),
            truth_from_estimate.rotate(&rate_rad_per_s),
        ],
        None => [
            pair.truth.velocity_m_per_s,
            pair.truth.rotation.as_ref().map_or(Vector3::zeros(), |turn| turn.rate_rad_per_s),
        ],
    }
}

/// Solves normal equations, of which some directions may not be determined; `None` if they are not finite.
pub fn solve(mut normal: LeverNormal, right: &LeverVector) -> Option<LeverVector> {
    let ridge = RIDGE * normal.trace();
    (0..LEVER_UNKNOWNS).for_each(|k| normal[(k, k)] += ridge);
    Some(normal.cholesky()?.solve(right))
}
