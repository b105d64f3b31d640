//! Covariance of errors that all readings of a station share, and of the settling of tripods.
//!
//! More readings do not average them out, and residuals show only a part of them. They are those of the table of unknowns of the joint
//! estimate ([`super::joint::unknown`]), with the σ of their priors.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

use super::ErrorSizes;
use super::instrument::PRISM_CONSTANT_SIGMA_M;
use super::joint::unknown::{Effect, Owner, UNKNOWNS};
use super::joint::{Sight, relative_settling};
use crate::geometry::{RigidTransform, wrap_to_pi};
use crate::network::{Number, PerStation, Station};

/// Least size of a residual (m).
const LEAST_RESIDUAL_M: f64 = 1e-4;

/// Displaces a point that a station read, in its own frame (m).
pub type Displacement<'a> = dyn Fn(Station, &Vector3<f64>) -> Vector3<f64> + 'a;

/// The alignment of displaced points.
pub struct Displaced {
    pub station1_from_station: PerStation<RigidTransform>,
    /// Residuals of all points (m).
    pub residuals_m: Vec<Vector3<f64>>,
}

/// Returns the covariance of (x, y, z, yaw) of stations 2, 3, … that the shared errors cause (m, rad), by aligning with each error
/// of 1 σ.
///
/// Residuals limit the errors, of which the answer is not freed. With its moves M, those R of the residuals r, and their variance s², the
/// covariance is `M (P + b bᵀ) Mᵀ` with `P = (1 + Rᵀ R / s²)⁻¹` and `b = P Rᵀ r / s²`. `independent` is the number of points whose
/// residuals are independent.
pub fn covariance(
    sizes: &ErrorSizes,
    stations: usize,
    independent: usize,
    align: impl Fn(&Displacement<'_>) -> Option<Displaced>,
) -> Option<DMatrix<f64>> {
    let without = align(&|_, point| *point)?;
    let (mut of_answer, mut of_residuals) = (Vec::new(), Vec::new());
    let mut add = |displace: &Displacement<'_>| -> Option<()> {
        let with = align(displace)?;
        of_answer.push(pose_change(&with, &without));
        of_residuals.push(residual_change(&with, &without));
        Some(())
    };
    // All prisms are of one type.
    add(&|_, point| point + PRISM_CONSTANT_SIGMA_M * Sight::to(point).along)?;
    for own in (0..stations).map(Station::at) {
        for unknown in UNKNOWNS.iter().filter(|unknown| unknown.owner == Owner::Station) {
            let sigma = unknown.precision(sizes).sqrt().recip();
            let displaced = |point: &Vector3<f64>| match unknown.effect {
                Effect::Reading(error) => point + (error.correction_m)(&Sight::to(point)) * sigma,
                Effect::Lean(axis) => Rotation3::new(Vector3::ith(axis, sigma)) * point,
                _ => *point,
            };
            add(&|station, point| if station == own { displaced(point) } else { *point })?;
        }
    }
    let [of_answer, of_residuals] =
        [of_answer, of_residuals].map(|moves: Vec<DVector<f64>>| DMatrix::from_columns(&moves));
    let points = without.residuals_m.len().max(1) as f64;
    let residuals_m: Vec<f64> =
        without.residuals_m.iter().flat_map(|residual_m| <[f64; 3]>::from(*residual_m)).collect();
    let residuals_m = DVector::from_vec(residuals_m);
    let variance_m2 = residuals_m.norm_squared() / (3.0 * points);
    let weight = independent as f64 / points / variance_m2.max(LEAST_RESIDUAL_M.powi(2));
    let shown = of_residuals.tr_mul(&of_residuals) * weight;
    let left = (DMatrix::identity(shown.nrows(), shown.nrows()) + shown).cholesky()?.inverse();
    let biases = &left * of_residuals.tr_mul(&residuals_m) * weight;
    Some(&of_answer * (left + &biases * biases.transpose()) * of_answer.transpose())
}

/// Change of (x, y, z, yaw) of stations 2, 3, … (m, rad).
fn pose_change(with: &Displaced, without: &Displaced) -> DVector<f64> {
    let [with, without] = [with, without].map(|it| &it.station1_from_station);
    DVector::from_fn(4 * (without.len() - 1), |k, _| {
        let (with, without) = (&with[k / 4 + 1], &without[k / 4 + 1]);
        match k % 4 {
            3 => wrap_to_pi(with.yaw_rad() - without.yaw_rad()),
            axis => with.translation_m[axis] - without.translation_m[axis],
        }
    })
}

/// Change of the residuals (m).
fn residual_change(with: &Displaced, without: &Displaced) -> DVector<f64> {
    let both = with.residuals_m.iter().zip(&without.residuals_m);
    let change_m: Vec<f64> =
        both.flat_map(|(with, without)| <[f64; 3]>::from(with - without)).collect();
    DVector::from_vec(change_m)
}

/// Returns the covariance of (x, y, z, yaw) of stations 2, 3, … by the settling of all tripods from a survey to the drive (m, rad).
pub fn settling(
    sizes: &ErrorSizes,
    station1_from_station: &PerStation<RigidTransform>,
) -> DMatrix<f64> {
    let others = station1_from_station.iter().skip(1);
    let poses: Vec<f64> = others
        .flat_map(|pose| [pose.translation_m.x, pose.translation_m.y, pose.translation_m.z, 0.0])
        .collect();
    let slots = station1_from_station.len() - 1;
    relative_settling(sizes, &DVector::from_vec(poses), slots)
}
