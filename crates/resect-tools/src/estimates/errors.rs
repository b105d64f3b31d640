//! Errors of an estimate, each with the covariance of the ground truth at that instant.

use nalgebra::{Matrix3, Vector3};

use super::fit::Fit;
use super::matched_pose::MatchedPose;
use resect_core::statistics::tables::{CHI_SQUARE_95_OF_2, CHI_SQUARE_95_OF_3, NORMAL_95};

/// Error of an estimate at one instant, in the ground truth's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct EpochError {
    /// Time (s, in the ground truth's time).
    pub time_s: f64,
    /// True position of the estimate's body (m).
    pub true_position_m: Vector3<f64>,
    /// Estimate minus truth (m), and the rotation vector from the truth to the estimate (rad).
    pub position_m: Vector3<f64>,
    pub rotation_rad: Option<Vector3<f64>>,
    /// Covariances of the ground truth itself: of the body's position (m²) and rotation (rad²); `None` if it states none.
    pub covariance_m2: Option<Matrix3<f64>>,
    pub covariance_rad2: Option<Matrix3<f64>>,
    /// Largest contradiction of the readings around the instant with the rig (m); `None` for a trajectory.
    pub contradiction_m: Option<f64>,
}

impl EpochError {
    /// Root of the ground truth's mean variance of the axes that are compared (m); `None` if it states none.
    pub fn sigma_m(&self) -> Option<f64> {
        Some(mean_variance(&self.covariance_m2?).max(0.0).sqrt())
    }

    /// Returns true if the position error is not significant: it is within the ground truth's own 95 % confidence region.
    /// `None` if the ground truth states no uncertainty.
    pub fn is_undecided(&self) -> Option<bool> {
        Some(is_within(&self.position_m, &self.covariance_m2?))
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

/// An error, and the covariance of the ground truth there.
struct Significance {
    error: Vector3<f64>,
    covariance: Matrix3<f64>,
}

/// Summarises errors and the covariance of the ground truth at each; `None` if it states no uncertainty.
pub fn against_sigma(errors: &[EpochError]) -> Option<AgainstSigma> {
    let positions: Vec<Significance> = errors
        .iter()
        .filter_map(|e| Some(Significance { error: e.position_m, covariance: e.covariance_m2? }))
        .collect();
    if positions.is_empty() {
        return None;
    }
    let count = positions.len() as f64;
    let mean = |of: &dyn Fn(&Significance) -> f64| positions.iter().map(of).sum::<f64>() / count;
    let rotations: Vec<Significance> = errors
        .iter()
        .filter_map(|e| {
            Some(Significance { error: e.rotation_rad?, covariance: e.covariance_rad2? })
        })
        .collect();
    let turned = |of: &dyn Fn(&Significance) -> f64| {
        let sum: f64 = rotations.iter().map(of).sum();
        (!rotations.is_empty()).then(|| sum / rotations.len() as f64)
    };
    let open = mean(&|position| position.covariance.trace());
    let square = mean(&|position| position.error.norm_squared());
    Some(AgainstSigma {
        sigma_m: mean(&|position| mean_variance(&position.covariance)).sqrt(),
        sigma_rad: turned(&|turn| mean_variance(&turn.covariance)).map(f64::sqrt),
        undecided: mean(&|position| f64::from(is_within(&position.error, &position.covariance))),
        undecided_rotation: turned(&|turn| f64::from(is_within(&turn.error, &turn.covariance))),
        of_truth: if square > 0.0 { (open / square).min(1.0) } else { 1.0 },
    })
}

/// Returns true for the axes that a projection to a plane leaves out.
fn left_out_axes(covariance: &Matrix3<f64>) -> [bool; 3] {
    [0, 1, 2].map(|axis| covariance.row(axis).iter().all(|element| *element == 0.0))
}

/// Mean variance of the axes that are compared.
fn mean_variance(covariance: &Matrix3<f64>) -> f64 {
    let compared = left_out_axes(covariance).iter().filter(|is_left_out| !**is_left_out).count();
    covariance.trace() / compared.max(1) as f64
}

/// Returns true if an error is within the 95 % confidence region. A projected error has two components or one.
fn is_within(error: &Vector3<f64>, covariance: &Matrix3<f64>) -> bool {
    let left_out = left_out_axes(covariance);
    let mut covariance = *covariance;
    for axis in (0..3).filter(|axis| left_out[*axis]) {
        if error[axis] != 0.0 {
            return false;
        }
        covariance[(axis, axis)] = 1.0;
    }
    let limit = match left_out.iter().filter(|is_left_out| **is_left_out).count() {
        0 => CHI_SQUARE_95_OF_3,
        1 => CHI_SQUARE_95_OF_2,
        _ => NORMAL_95 * NORMAL_95,
    };
    covariance.cholesky().is_some_and(|root| error.dot(&root.solve(error)) <= limit)
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
pub fn errors(matched: &[MatchedPose], fit: &Fit) -> Vec<EpochError> {
    let error = |MatchedPose { pose, truth, .. }: &MatchedPose| {
        let [placed_m, true_position_m] = fit.both_positions_m(pose, truth);
        let rotation = truth.rotation.as_ref();
        let rotation_rad = fit
            .both_orientations(pose, truth)
            .map(|[estimated, actual]| (estimated * actual.inverse()).scaled_axis());
        // A rotation of the vehicle moves the body by its lever arm: δ(p + R l) = δp − [R l]× θ.
        let by_lever_arm = rotation.zip(fit.lever_arm_m).and_then(|(rotation, lever_m)| {
            let by_turn = -(rotation.orientation * lever_m).cross_matrix();
            let common = by_turn * rotation.with_position;
            let turning = by_turn * rotation.covariance_rad2? * by_turn.transpose();
            Some(turning + common + common.transpose())
        });
        let covariance_m2 =
            truth.covariance_m2.map(|position| position + by_lever_arm.unwrap_or_default());
        let covariance_rad2 = rotation.and_then(|rotation| rotation.covariance_rad2);
        let project =
            |covariance| fit.plane.map_or(covariance, |plane| plane.project_covariance(covariance));
        let project_rotation = |covariance| {
            fit.plane.map_or(covariance, |plane| plane.project_rotation_covariance(&covariance))
        };
        EpochError {
            time_s: truth.time_s,
            true_position_m,
            position_m: placed_m - true_position_m,
            rotation_rad,
            covariance_m2: covariance_m2.map(project),
            covariance_rad2: covariance_rad2.map(project_rotation),
            contradiction_m: truth.contradiction_m,
        }
    };
    matched.iter().map(error).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_projected_error_has_the_confidence_region_of_its_components() {
        let plane = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
        let line = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, 1.0));
        for (error, covariance, is_inside) in [
            (Vector3::new(2.4, 0.0, 0.0), plane, true),
            (Vector3::new(2.5, 0.0, 0.0), plane, false),
            (Vector3::new(0.0, 0.0, 1.9), line, true),
            (Vector3::new(0.0, 0.0, 2.0), line, false),
            (Vector3::new(2.7, 0.0, 0.0), Matrix3::identity(), true),
            (Vector3::new(0.0, 0.1, 0.0), line, false),
        ] {
            assert_eq!(is_within(&error, &covariance), is_inside, "{error} {covariance}");
        }
        assert_eq!([mean_variance(&plane), mean_variance(&line)], [1.0, 1.0]);
    }

    #[test]
    fn the_driven_way_is_that_of_the_truth_from_one_error_to_the_next() {
        let at = |x: f64, y: f64| EpochError {
            time_s: x,
            true_position_m: Vector3::new(x, y, 0.0),
            position_m: Vector3::repeat(9.0),
            rotation_rad: None,
            covariance_m2: None,
            covariance_rad2: None,
            contradiction_m: None,
        };
        assert_eq!(
            driven_m(&[at(0.0, 0.0), at(3.0, 4.0), at(3.0, 4.0), at(4.0, 4.0)]),
            [0.0, 5.0, 5.0, 6.0]
        );
        assert_eq!(driven_m(&[]), [0.0; 0]);
    }
}
