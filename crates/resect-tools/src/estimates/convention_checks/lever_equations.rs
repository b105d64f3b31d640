//! Linear equations of positions with a lever arm, a small motion of the frame, and a time offset.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use crate::estimates::matched_pose::{MatchedPose, PoseTwist};
use resect_core::geometry::RigidTransform;

/// Unknowns: lever arm (m), translation (m), small rotation (rad) and time offset (s).
pub const LEVER_UNKNOWNS: usize = 10;
pub const TIME_OFFSET: usize = 9;
/// Share of the normal matrix that constrains directions which the drive does not determine.
const RIDGE: f64 = 1e-9;

/// Returns the derivatives of a position by the unknowns. `lever_axes` are the body's axes in the frame of the position, and `arm_m` the
/// position relative to the point about which the frame turns.
pub fn position_rows(
    lever_axes: &Matrix3<f64>,
    arm_m: &Vector3<f64>,
    velocity_m_per_s: &Vector3<f64>,
) -> SMatrix<f64, 3, LEVER_UNKNOWNS> {
    let mut rows = SMatrix::<f64, 3, LEVER_UNKNOWNS>::zeros();
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
pub fn solve<const N: usize>(
    mut normal: SMatrix<f64, N, N>,
    right: &SVector<f64, N>,
) -> Option<SVector<f64, N>> {
    let ridge = RIDGE * normal.trace();
    (0..N).for_each(|k| normal[(k, k)] += ridge);
    let mut solution = *right;
    normal.cholesky()?.solve_mut(&mut solution);
    Some(solution)
}
