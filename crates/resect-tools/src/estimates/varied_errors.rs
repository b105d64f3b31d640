//! Changes of an estimate's errors if clock, lever arm and body are wrong by their σ.

use nalgebra::{SVector, UnitQuaternion, Vector3};

use super::errors::{self, EpochError};
use super::fit::{self, Fit, FitCovariance};
use super::matched_pose::MatchedPose;
use super::options::Options;

/// Number of quantities in a covariance of a fit.
const FITTED: usize = 7;

/// Change of an error of position (m) and of orientation (rad; zero without orientations).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorChange {
    pub position_m: Vector3<f64>,
    pub rotation_rad: Vector3<f64>,
}

/// The estimate with one combination of clock, lever arm and body changed by one σ.
pub struct VariedEstimate {
    pub fit: Fit,
    pub matched: Vec<MatchedPose>,
}

/// Returns the estimate changed by one σ in each independent combination of clock, lever arm and body, and aligned again. The squares of
/// the changes of any number add up to its variance.
pub fn varied_estimates<'a>(
    matched: &'a [MatchedPose],
    fit: &'a Fit,
    options: &'a Options,
) -> impl Iterator<Item = VariedEstimate> + 'a {
    let first = options.align_first.unwrap_or(usize::MAX).min(matched.len());
    independent_changes(&fit.covariance).into_iter().filter_map(move |change| {
        let later_s = change[fit::CLOCK];
        let matched: Vec<MatchedPose> = matched.iter().map(|pair| later(pair, later_s)).collect();
        let mut fit = fit.clone();
        if let Some(lever_m) = &mut fit.lever_arm_m {
            *lever_m += change.fixed_rows::<3>(0);
        }
        if let Some(body) = &mut fit.body_rotation {
            let turn = change.fixed_rows::<3>(fit::BODY).into_owned();
            *body = UnitQuaternion::from_scaled_axis(turn) * *body;
        }
        // The same points were aligned before.
        fit::align(&mut fit, &matched[..first], options.alignment).ok()?;
        Some(VariedEstimate { fit, matched })
    })
}

/// Returns the changes of the errors of a varied estimate.
pub fn changes(varied: &VariedEstimate, errors: &[EpochError]) -> Vec<ErrorChange> {
    let by = |(changed, error): (EpochError, &EpochError)| ErrorChange {
        position_m: changed.position_m - error.position_m,
        rotation_rad: changed
            .rotation_rad
            .zip(error.rotation_rad)
            .map_or(Vector3::zeros(), |(changed_rad, error_rad)| changed_rad - error_rad),
    };
    errors::errors(&varied.matched, &varied.fit).into_iter().zip(errors).map(by).collect()
}

/// Returns errors with changes.
pub fn changed(errors: &[EpochError], changes: &[ErrorChange]) -> Vec<EpochError> {
    let by = |(error, change): (&EpochError, &ErrorChange)| EpochError {
        position_m: error.position_m + change.position_m,
        rotation_rad: error.rotation_rad.map(|turn| turn + change.rotation_rad),
        ..error.clone()
    };
    errors.iter().zip(changes).map(by).collect()
}

/// Returns vectors whose outer products add up to a covariance; none for what was not estimated.
fn independent_changes(covariance: &FitCovariance) -> Vec<SVector<f64, FITTED>> {
    // Metres, seconds and radians are brought to one size.
    let sigmas = covariance.diagonal().map(|variance| variance.max(0.0).sqrt());
    let inverse = sigmas.map(|sigma| if sigma > 0.0 { sigma.recip() } else { 0.0 });
    let [of_sigmas, of_inverse] = [sigmas, inverse].map(|it| FitCovariance::from_diagonal(&it));
    let eigen = (of_inverse * covariance * of_inverse).symmetric_eigen();
    let axes = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
    axes.filter(|(value, _)| **value > 1e-9)
        .map(|(value, axis)| of_sigmas * axis * value.sqrt())
        .collect()
}

/// Returns a pair with a ground truth that is later by some time (s).
fn later(pair: &MatchedPose, later_s: f64) -> MatchedPose {
    let mut pair = pair.clone();
    if let Some(twist) = pair.pose_twist {
        // The estimate was interpolated: a later ground truth is an earlier estimate.
        pair.pose.position_m -= twist.velocity_m_per_s * later_s;
        let turn = UnitQuaternion::from_scaled_axis(-twist.rate_rad_per_s * later_s);
        pair.pose.orientation = pair.pose.orientation.map(|orientation| turn * orientation);
        return pair;
    }
    pair.truth.position_m += pair.truth.velocity_m_per_s * later_s;
    if let Some(rotation) = &mut pair.truth.rotation {
        let turn = UnitQuaternion::from_scaled_axis(rotation.rate_rad_per_s * later_s);
        rotation.orientation = turn * rotation.orientation;
    }
    pair
}
