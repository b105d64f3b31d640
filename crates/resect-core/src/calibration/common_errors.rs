//! Covariance of errors that all readings of a station share, and of the settling of tripods.
//!
//! More readings do not average them out, and residuals show only a part of them. They are those of the table of unknowns of the joint
//! estimate ([`super::joint::unknown`]), with the σ of their priors.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

use super::instrument::PRISM_CONSTANT_SIGMA_M;
use super::joint::prior_conflict::{CRITICAL_SIGMAS, LEAST_INFORMATION};
use super::joint::unknown::{Effect, Owner, UNKNOWNS, Unknown};
use super::joint::{Sight, relative_settling};
use super::{ErrorSizes, Estimate};
use crate::deployment::Finding;
use crate::deployment::findings::instruments::{NamedError, instrument_error_implausible};
use crate::geometry::{RigidTransform, wrap_to_pi};
use crate::network::{Number, PerStation, Station};

/// Share of each error that is put into the points: the answer then changes in proportion.
pub const SHARE: f64 = 1e-3;
/// Least size of a residual (m).
const LEAST_RESIDUAL_M: f64 = 1e-4;

/// Displaces a point that a station read, in its own frame (m).
pub type Displacement<'a> = dyn Fn(Station, &Vector3<f64>) -> Vector3<f64> + 'a;

/// The alignment of displaced points.
pub struct Displaced {
    pub station1_from_station: PerStation<RigidTransform>,
    /// Residuals (m).
    pub residuals_m: Vec<f64>,
}

impl Displaced {
    /// The alignment of points with these residuals (m).
    pub fn new(
        station1_from_station: PerStation<RigidTransform>,
        residuals_m: &[Vector3<f64>],
    ) -> Self {
        let coordinates = residuals_m.iter().flat_map(|residual_m| <[f64; 3]>::from(*residual_m));
        Self { station1_from_station, residuals_m: coordinates.collect() }
    }
}

/// Effect of the shared errors on an answer.
pub struct CommonErrors {
    /// Covariance of (x, y, z, yaw) of stations 2, 3, … (m, rad).
    pub covariance: DMatrix<f64>,
    /// Errors of instruments that the residuals show, and their distances from their priors (σ).
    shown: Vec<(Station, &'static Unknown, Estimate, f64)>,
    sizes: ErrorSizes,
}

impl CommonErrors {
    /// Returns the finding of the least plausible error. The answer is biased by it.
    pub fn doubt(&self) -> Option<Finding> {
        let critical = self.shown.iter().filter(|(.., sigmas)| sigmas.abs() > CRITICAL_SIGMAS);
        let largest = critical.max_by(|a, b| a.3.abs().total_cmp(&b.3.abs()));
        largest.map(|(station, unknown, estimate, sigmas)| {
            let named = NamedError {
                sentence: &unknown.sentence_of(&station.to_string()),
                station: Some(station.index()),
                quantity: unknown.quantity,
                estimate: *estimate,
                prior_sigma: unknown.precision(&self.sizes).sqrt().recip(),
            };
            instrument_error_implausible(&named, 0.0, sigmas.abs())
        })
    }
}

/// Returns the effect of the shared errors, by aligning with each error.
///
/// Residuals limit the errors, of which the answer is not freed. With its moves M, those R of the residuals r, and their variance s², the
/// covariance is `M (P + b bᵀ) Mᵀ` with `P = (1 + Rᵀ R / s²)⁻¹` and `b = P Rᵀ r / s²`. `independent` is the number of independent
/// residuals. `further` are alignments with [`SHARE`] σ of other errors.
pub fn effect(
    sizes: &ErrorSizes,
    stations: usize,
    independent: usize,
    further: &[Displaced],
    align: impl Fn(&Displacement<'_>) -> Option<Displaced>,
) -> Option<CommonErrors> {
    let without = align(&|_, point| *point)?;
    let (mut of_answer, mut of_residuals) = (Vec::new(), Vec::new());
    let mut add = |with: &Displaced| {
        of_answer.push(pose_change(with, &without) / SHARE);
        of_residuals.push(residual_change(with, &without) / SHARE);
    };
    further.iter().for_each(&mut add);
    // All prisms are of one type.
    add(&align(&|_, point| point + SHARE * PRISM_CONSTANT_SIGMA_M * Sight::to(point).along)?);
    let mut named = Vec::new();
    for own in (0..stations).map(Station::at) {
        for unknown in UNKNOWNS.iter().filter(|unknown| unknown.owner == Owner::Station) {
            let sigma = SHARE * unknown.precision(sizes).sqrt().recip();
            named.push((own, *unknown));
            let displaced = |point: &Vector3<f64>| match unknown.effect {
                Effect::Reading(error) => point + (error.correction_m)(&Sight::to(point)) * sigma,
                Effect::Lean(axis) => Rotation3::new(Vector3::ith(axis, sigma)) * point,
                _ => *point,
            };
            add(&align(&|station, point| if station == own { displaced(point) } else { *point })?);
        }
    }
    let [of_answer, of_residuals] =
        [of_answer, of_residuals].map(|moves: Vec<DVector<f64>>| DMatrix::from_columns(&moves));
    let count = without.residuals_m.len().max(1) as f64;
    let residuals_m = DVector::from_vec(without.residuals_m);
    let variance_m2 = residuals_m.norm_squared() / count;
    let weight = independent as f64 / count / variance_m2.max(LEAST_RESIDUAL_M.powi(2));
    let shown = of_residuals.tr_mul(&of_residuals) * weight;
    let left = (DMatrix::identity(shown.nrows(), shown.nrows()) + shown).cholesky()?.inverse();
    let biases = &left * of_residuals.tr_mul(&residuals_m) * weight;
    let first = biases.len() - named.len();
    let show = |(index, (station, unknown)): (usize, (Station, &'static Unknown))| {
        let index = first + index;
        let (bias, variance) = (biases[index], left[(index, index)]);
        let sigma = unknown.precision(sizes).sqrt().recip();
        let estimate = Estimate { value: bias * sigma, sigma: variance.sqrt() * sigma };
        let is_shown = 1.0 - variance > LEAST_INFORMATION;
        is_shown.then(|| (station, unknown, estimate, bias / (1.0 - variance).sqrt()))
    };
    let shown = named.into_iter().enumerate().filter_map(show).collect();
    let by_errors = left + &biases * biases.transpose();
    let covariance = &of_answer * by_errors * of_answer.transpose();
    Some(CommonErrors { covariance, shown, sizes: *sizes })
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
    DVector::from_iterator(with.residuals_m.len(), both.map(|(with, without)| with - without))
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
