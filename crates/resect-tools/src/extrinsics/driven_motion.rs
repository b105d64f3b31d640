//! Motion of a body during a drive: duration, path, accelerations, main axis of rotation.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::estimates::EstimatedPose;

/// DrivenMotion of body a during the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenMotion {
    pub duration_s: f64,
    pub path_m: f64,
    /// Axis of a about which it turned most, as a unit vector in a.
    pub main_axis: Vector3<f64>,
    /// Root mean square change of the velocity within a second (m/s²); `None` if poses are further apart.
    pub acceleration_m_per_s2: Option<f64>,
}

/// Returns path, duration, accelerations and the main axis of rotation of poses in order of time.
pub fn driven_motion(poses: &[EstimatedPose]) -> DrivenMotion {
    let duration_s = match poses {
        [first, .., last] => last.time_s - first.time_s,
        _ => 0.0,
    };
    let path_m = poses.windows(2).map(|two| (two[1].position_m - two[0].position_m).norm()).sum();
    let mut turns = Matrix3::zeros();
    // A second apart: shorter steps are noise.
    for (pose, later) in a_second_apart(poses) {
        if let (Some(from), Some(to)) = (pose.orientation, later.orientation) {
            let turn: Vector3<f64> = (from.inverse() * to).scaled_axis();
            turns += turn * turn.transpose();
        }
    }
    let eigen = SymmetricEigen::new(turns);
    let axis: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    let velocities: Vec<EstimatedPose> = a_second_apart(poses)
        .map(|(pose, later)| EstimatedPose {
            time_s: pose.time_s,
            position_m: (later.position_m - pose.position_m) / (later.time_s - pose.time_s),
            orientation: None,
        })
        .collect();
    let squares: Vec<f64> = a_second_apart(&velocities)
        .map(|(one, later)| {
            ((later.position_m - one.position_m) / (later.time_s - one.time_s)).norm_squared()
        })
        .collect();
    let acceleration_m_per_s2 =
        (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt());
    DrivenMotion {
        duration_s,
        path_m,
        main_axis: axis * axis[axis.iamax()].signum(),
        acceleration_m_per_s2,
    }
}

/// Pairs of poses a second apart, and at most two.
fn a_second_apart(
    poses: &[EstimatedPose],
) -> impl Iterator<Item = (&EstimatedPose, &EstimatedPose)> {
    poses.iter().filter_map(|pose| {
        let next = poses.partition_point(|later| later.time_s < pose.time_s + 1.0);
        let later = poses.get(next)?;
        (later.time_s < pose.time_s + 2.0).then_some((pose, later))
    })
}
