//! Errors of an estimate, each with the covariance of the ground truth at that instant.

use nalgebra::{Matrix3, Vector3};

use super::estimate::EstimatedPose;
use super::fit::Fit;
use super::reference::True;
use crate::statistics::tables::CHI_SQUARE_95_OF_3;

/// Error of an estimate at one instant, in station 1's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct EpochError {
    /// Time (s, in the ground truth's time).
    pub time_s: f64,
    /// True position of the estimate's body (m).
    pub true_position_m: Vector3<f64>,
    /// Estimate minus truth (m), and the rotation vector from the truth to the estimate (rad).
    pub position_m: Vector3<f64>,
    pub rotation_rad: Option<Vector3<f64>>,
    /// Covariances of the ground truth itself: of the body's position (m²) and rotation (rad²).
    pub covariance_m2: Matrix3<f64>,
    pub covariance_rad2: Option<Matrix3<f64>>,
    /// Largest contradiction of the readings around the instant with the rig (m).
    pub contradiction_m: f64,
}

impl EpochError {
    /// Root of the mean variance of the three axes (m).
    pub fn sigma_m(&self) -> f64 {
        (self.covariance_m2.trace() / 3.0).max(0.0).sqrt()
    }

    /// Returns true if the position error is not significant: it is within the ground truth's own 95 % confidence region.
    pub fn is_undecided(&self) -> bool {
        is_within(&self.position_m, &self.covariance_m2)
    }
}

/// Errors compared with the ground truth's own standard deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AgainstSigma {
    /// Ground truth's σ along an axis, root mean square (m, rad).
    pub sigma_m: f64,
    pub sigma_rad: Option<f64>,
    /// Share of the epochs at which the error is not significant.
    pub undecided: f64,
    pub undecided_rotation: Option<f64>,
    /// Share of the mean square error that the ground truth's own errors may explain, at most 1.
    pub of_truth: f64,
}

struct Rotation {
    error: Vector3<f64>,
    covariance: Matrix3<f64>,
}

/// Summarises errors and the covariance of the ground truth at each.
pub fn against_sigma(errors: &[EpochError]) -> AgainstSigma {
    let count = errors.len().max(1) as f64;
    let mean = |of: &dyn Fn(&EpochError) -> f64| errors.iter().map(of).sum::<f64>() / count;
    let rotations: Vec<Rotation> = errors
        .iter()
        .filter_map(|e| Some(Rotation { error: e.rotation_rad?, covariance: e.covariance_rad2? }))
        .collect();
    let turned = |of: &dyn Fn(&Rotation) -> f64| {
        let sum: f64 = rotations.iter().map(of).sum();
        (!rotations.is_empty()).then(|| sum / rotations.len() as f64)
    };
    let open = mean(&|error| error.covariance_m2.trace());
    let square = mean(&|error| error.position_m.norm_squared());
    AgainstSigma {
        sigma_m: (open / 3.0).sqrt(),
        sigma_rad: turned(&|turn| turn.covariance.trace() / 3.0).map(f64::sqrt),
        undecided: mean(&|error| f64::from(error.is_undecided())),
        undecided_rotation: turned(&|turn| f64::from(is_within(&turn.error, &turn.covariance))),
        of_truth: if square > 0.0 { (open / square).min(1.0) } else { 1.0 },
    }
}

fn is_within(error: &Vector3<f64>, covariance: &Matrix3<f64>) -> bool {
    covariance.cholesky().is_some_and(|root| error.dot(&root.solve(error)) <= CHI_SQUARE_95_OF_3)
}

/// Distance driven by the body up to each of the errors (m), along straight lines between them.
pub fn driven_m(errors: &[EpochError]) -> Vec<f64> {
    let mut driven_m = 0.0;
    let mut before: Option<&EpochError> = None;
    errors
        .iter()
        .map(|error| {
            if let Some(before) = before.replace(error) {
                driven_m += (error.true_position_m - before.true_position_m).norm();
            }
            driven_m
        })
        .collect()
}

/// Errors of an estimate at each of the matched poses.
pub fn errors(matched: &[(&EstimatedPose, &True)], fit: &Fit) -> Vec<EpochError> {
    let error = |(pose, truth): &(&EstimatedPose, &True)| {
        let [placed_m, true_position_m] = fit.both_positions_m(pose, truth);
        let turned = truth.turned.as_ref();
        let rotation_rad = turned.and_then(|turned| {
            let own = fit.placed_orientation(pose)?;
            Some((own * (turned.orientation * fit.body_rotation?).inverse()).scaled_axis())
        });
        // A rotation of the vehicle moves the body by its lever arm: δ(p + R l) = δp − [R l]× θ.
        let covariance_m2 = match (turned, fit.lever_arm_m) {
            (Some(turned), Some(lever_m)) => {
                let by_turn = -(turned.orientation * lever_m).cross_matrix();
                let common = by_turn * turned.with_position;
                truth.covariance_m2
                    + by_turn * turned.covariance_rad2 * by_turn.transpose()
                    + common
                    + common.transpose()
            }
            _ => truth.covariance_m2,
        };
        EpochError {
            time_s: truth.time_s,
            true_position_m,
            position_m: placed_m - true_position_m,
            rotation_rad,
            covariance_m2,
            covariance_rad2: turned.map(|turned| turned.covariance_rad2),
            contradiction_m: truth.contradiction_m,
        }
    };
    matched.iter().map(error).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_driven_way_is_that_of_the_truth_from_one_error_to_the_next() {
        let at = |x: f64, y: f64| EpochError {
            time_s: x,
            true_position_m: Vector3::new(x, y, 0.0),
            position_m: Vector3::repeat(9.0),
            rotation_rad: None,
            covariance_m2: Matrix3::identity(),
            covariance_rad2: None,
            contradiction_m: 0.0,
        };
        assert_eq!(
            driven_m(&[at(0.0, 0.0), at(3.0, 4.0), at(3.0, 4.0), at(4.0, 4.0)]),
            [0.0, 5.0, 5.0, 6.0]
        );
        assert_eq!(driven_m(&[]), [0.0; 0]);
    }
}
