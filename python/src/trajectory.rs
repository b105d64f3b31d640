//! Trajectories as arrays.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use resect_core::calibration::joint::prism_motion::PrismInstant;
use resect_core::evaluation::requested_trajectory::{RequestedMotion, RequestedTrajectory};
use resect_core::evaluation::trajectory::Trajectory;

use crate::arrays::{set_column, set_points, set_stack};

/// Returns the arrays of a requested trajectory, with its frame.
pub fn requested_arrays<'py>(
    py: Python<'py>,
    requested: &RequestedTrajectory,
) -> PyResult<Bound<'py, PyDict>> {
    let table = match &requested.motion {
        RequestedMotion::Poses { trajectory, vehicle } => {
            let table = pose_arrays(py, trajectory)?;
            table.set_item("vehicle", vehicle.in_words())?;
            table
        }
        RequestedMotion::Prism(positions) => prism_arrays(py, positions)?,
    };
    table.set_item("frame", requested.frame_in_words())?;
    Ok(table)
}

/// Returns the arrays of poses.
pub fn pose_arrays<'py>(py: Python<'py>, trajectory: &Trajectory) -> PyResult<Bound<'py, PyDict>> {
    let poses = &trajectory.poses;
    let count = poses.len();
    let table = PyDict::new(py);
    set_column(&table, "time_s", poses.iter().map(|pose| pose.time_s))?;
    set_points(&table, "position_m", poses.iter().map(|pose| &pose.position_m))?;
    let quaternions = poses.iter().map(|pose| pose.orientation.quaternion());
    let values: Vec<f64> = quaternions.flat_map(|q| [q.i, q.j, q.k, q.w]).collect();
    set_stack(&table, "quaternion_xyzw", values, [count, 4])?;
    // Symmetric, so rows are columns.
    let values: Vec<f64> = poses.iter().flat_map(|pose| &pose.covariance).copied().collect();
    set_stack(&table, "covariance", values, [count, 6, 6])?;
    set_column(&table, "inter_prism_error_m", poses.iter().map(|pose| pose.inter_prism_error_m))?;
    let twists: Option<Vec<_>> = poses.iter().map(|pose| pose.twist.as_ref()).collect();
    if let Some(twists) = twists {
        set_points(&table, "velocity_m_per_s", twists.iter().map(|twist| &twist.velocity_m_per_s))?;
        set_points(&table, "rate_rad_per_s", twists.iter().map(|twist| &twist.rate_rad_per_s))?;
    }
    table.set_item("dropped", trajectory.dropped)?;
    Ok(table)
}

/// Returns the arrays of the positions of one prism, which have no orientation.
fn prism_arrays<'py>(py: Python<'py>, positions: &[PrismInstant]) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    set_column(&table, "time_s", positions.iter().map(|at| at.time_s))?;
    set_points(&table, "position_m", positions.iter().map(|at| &at.position_m))?;
    let values: Vec<f64> =
        positions.iter().flat_map(|at| &at.position_covariance).copied().collect();
    set_stack(&table, "covariance", values, [positions.len(), 3, 3])?;
    set_points(&table, "velocity_m_per_s", positions.iter().map(|at| &at.velocity_m_per_s))?;
    Ok(table)
}
