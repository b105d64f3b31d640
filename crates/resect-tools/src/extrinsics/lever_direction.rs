//! Directions of a lever arm, and how well a motion determines each.

use nalgebra::{Matrix3, SymmetricEigen, UnitQuaternion, Vector3};

use crate::estimates::fit::{LEAST_GAIN, LEVER_SIGMA_M};

/// Direction of the lever arm in body a, with errors that are independent of those along the other two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeverDirection {
    /// Unit vector in body a.
    pub direction: Vector3<f64>,
    /// Standard deviation of the lever arm along it (m).
    pub sigma_m: f64,
    /// Root mean square change of the direction in a's frame during the drive, 0 to 1; for small angles it is that of the rotations across
    /// the direction (rad).
    pub turned: f64,
}

impl LeverDirection {
    /// Returns true if the motion determines the direction better than the prior of the lever arm does.
    pub fn is_determined(&self) -> bool {
        self.sigma_m < LEAST_GAIN * LEVER_SIGMA_M
    }
}

/// Returns the principal directions of the covariance of a lever arm (m², in body a), that with the largest σ first.
pub fn lever_directions(
    covariance_m2: &Matrix3<f64>,
    orientations: &[UnitQuaternion<f64>],
) -> [LeverDirection; 3] {
    let count = orientations.len().max(1) as f64;
    let sum = orientations.iter().fold(Matrix3::zeros(), |sum, orientation| {
        sum + orientation.to_rotation_matrix().into_inner()
    });
    let mean = sum / count;
    let eigen = SymmetricEigen::new(*covariance_m2);
    let mut directions: [LeverDirection; 3] = std::array::from_fn(|index| {
        let direction: Vector3<f64> = eigen.eigenvectors.column(index).into_owned();
        // The largest component is positive: the sign of an eigenvector is arbitrary.
        let direction = direction * direction[direction.iamax()].signum();
        LeverDirection {
            direction,
            sigma_m: eigen.eigenvalues[index].max(0.0).sqrt(),
            // The mean square of |R d − mean|² is 1 − |mean|², since |R d| = 1.
            turned: (1.0 - (mean * direction).norm_squared()).max(0.0).sqrt(),
        }
    });
    directions.sort_by(|a, b| b.sigma_m.total_cmp(&a.sigma_m));
    directions
}
