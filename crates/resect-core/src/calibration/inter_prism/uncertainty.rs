//! Covariance of the answer, which accounts for correlated errors of interpolated points.
//!
//! Ten triplets a second from 2.5 readings a second share their errors, and so do the chords of one bend. The inverse of JᵀJ alone
//! is therefore several times too small. The [`sandwich`] assumes only that blocks of consecutive time are independent. Errors of
//! the inter-prism distances affect every triplet alike, so no residual shows them; they are propagated with their own σ.

use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

use super::prism_network::{UNKNOWNS_PER_STATION, first_unknown};
use super::{CentredTriplets, Minimum, NormalEquations, Parameters};
use crate::calibration::{CalibrationSettings, TransformSigma, time_blocks};
use crate::network::PerStation;
use crate::statistics::sandwich;
use crate::statistics::sandwich::Block;

/// The sandwich needs clearly more blocks than unknowns.
const FEWEST_BLOCKS: usize = 16;
/// Readings a second that the fallback assumes to be independent.
const READINGS_HZ: f64 = 2.5;
/// Triplets that are enough to propagate errors of the distances.
const ENOUGH: usize = 1000;
/// Ratio of the smallest to the largest scaled eigenvalue of JᵀJ below which a direction is unobservable, so no σ is returned.
/// Drives with bends reach 2e-2 and more. Simulated: at 2e-5 (twelve seconds of driving) answers have errors of ten times the
/// linearised σ.
pub const FREE_DIRECTION: f64 = 1e-4;

/// Covariance of the answer and observability of its directions.
pub struct Uncertainty {
    /// Covariance of (x, y, z, yaw) of station 2 to station 1's frame, then of each further one (m, rad); `None` if a direction is
    /// unobservable.
    pub covariance: Option<DMatrix<f64>>,
    /// Covariance of the centred parameters, yaw in metres at the radius (m²); `None` if a direction is unobservable.
    pub centred_m2: Option<DMatrix<f64>>,
    /// Eigenvalues and eigenvectors of JᵀJ in the same units, without outlier triplets.
    pub spectrum: SymmetricEigen<f64, Dyn>,
    /// True if control points determine the answer with the drive: then σ tells what is weak, and not the shape of the drive.
    pub has_control_points: bool,
    /// Radius of the track: displacement by a radian of yaw (m).
    pub radius_m: f64,
    /// The direction of the largest standard deviation: centred parameters, yaw in metres at the radius.
    pub weakest: DVector<f64>,
    /// Standard deviation along it (m); infinite if unobservable.
    pub weakest_sigma_m: f64,
}

impl Uncertainty {
    /// Returns the standard deviations of each station's transform; zero of station 1.
    pub fn sigma(&self) -> Option<PerStation<TransformSigma>> {
        self.covariance.as_ref().map(TransformSigma::of_covariance)
    }
}

/// Estimates the uncertainty of a minimum on all of `data`, with the times `time_s` (s) and intervals. Observability is computed
/// from `fitting`, the triplets whose distances fit: an outlier makes directions seem observable.
pub fn estimate(
    data: &CentredTriplets,
    fitting: &CentredTriplets,
    time_s: &[f64],
    interval: &[u32],
    answer: &Minimum,
    settings: &CalibrationSettings,
) -> Uncertainty {
    let normal = &answer.normal;
    let blocks = time_blocks::of(time_s, interval);

    let radius_m = super::levenberg_marquardt::track_radius_m(data);
    let spectrum = spectrum(fitting, &answer.parameters, radius_m);
    let free = |spectrum| free(spectrum, radius_m);
    let inverse = is_held(&spectrum)
        .then(|| normal.matrix.clone().cholesky())
        .flatten()
        .map(|cholesky| cholesky.inverse());
    let Some(inverse) = inverse else {
        return free(spectrum);
    };

    let mut centred = if blocks.len() >= FEWEST_BLOCKS {
        let each = blocks.iter().map(|block| {
            let own = NormalEquations::over(data, &answer.parameters, block.clone());
            Block { information: own.matrix, gradient: own.gradient }
        });
        match sandwich::covariance(&each.collect::<Vec<_>>(), None) {
            Some(found) => found,
            None => return free(spectrum),
        }
    } else {
        // Too few blocks for a sandwich: one residual variance with the remaining degrees of freedom, and as many independent
        // triplets as readings.
        let duration_s: f64 = time_s.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap < 1.0).sum();
        let independent = (duration_s * READINGS_HZ).clamp(3.0, data.len() as f64);
        let (residuals, unknowns) = (data.network.residuals(), data.network.unknowns());
        let degrees = (residuals as f64 * independent - unknowns as f64).max(1.0);
        let variance = normal.cost / data.len() as f64 * independent / degrees;
        &inverse * variance * (data.len() as f64 / independent)
    };
    let some = data.thinned(ENOUGH);
    let Some(inverse) = NormalEquations::at(&some, &answer.parameters).matrix.try_inverse() else {
        return free(spectrum);
    };
    for prisms in data.network.prism_pairs() {
        let longer = some.with_longer(prisms, settings.published_distance_sigma_m());
        let pull = NormalEquations::at(&longer, &answer.parameters).gradient
            - NormalEquations::at(&some, &answer.parameters).gradient;
        let moved = &inverse * pull;
        centred += &moved * moved.transpose();
    }

    if centred.iter().any(|entry| !entry.is_finite()) {
        return free(spectrum);
    }

    let jacobian = at_the_stations(data, &answer.parameters);
    let covariance = &jacobian * &centred * jacobian.transpose();
    known(covariance, centred, spectrum, radius_m)
}

/// Returns the uncertainty of an answer whose covariance at the stations is known.
pub fn of_covariance(
    data: &CentredTriplets,
    fitting: &CentredTriplets,
    answer: &Minimum,
    covariance: DMatrix<f64>,
) -> Uncertainty {
    let radius_m = super::levenberg_marquardt::track_radius_m(data);
    let spectrum = spectrum(fitting, &answer.parameters, radius_m);
    // This matrix has ones on its diagonal, so it is invertible.
    let back = at_the_stations(data, &answer.parameters).try_inverse().expect("a shear");
    let centred = &back * &covariance * back.transpose();
    known(covariance, centred, spectrum, radius_m)
}

/// Predicts the uncertainty of an answer before it is estimated, from triplets at the true state. Observability is computed from
/// `data`; `covariance` is the predicted covariance, if there is one.
pub fn foreseen(
    data: &CentredTriplets,
    answer: &Minimum,
    covariance: Option<DMatrix<f64>>,
) -> Uncertainty {
    let radius_m = super::levenberg_marquardt::track_radius_m(data);
    let spectrum = spectrum(data, &answer.parameters, radius_m);
    match covariance.filter(|_| is_held(&spectrum)) {
        Some(covariance) => of_covariance(data, data, answer, covariance),
        None => free(spectrum, radius_m),
    }
}

fn is_held(spectrum: &SymmetricEigen<f64, Dyn>) -> bool {
    spectrum.eigenvalues.min() > FREE_DIRECTION * spectrum.eigenvalues.max()
}

fn free(spectrum: SymmetricEigen<f64, Dyn>, radius_m: f64) -> Uncertainty {
    Uncertainty {
        covariance: None,
        centred_m2: None,
        weakest: spectrum.eigenvectors.column(spectrum.eigenvalues.imin()).into_owned(),
        weakest_sigma_m: f64::INFINITY,
        spectrum,
        has_control_points: false,
        radius_m,
    }
}

fn known(
    covariance: DMatrix<f64>,
    centred: DMatrix<f64>,
    spectrum: SymmetricEigen<f64, Dyn>,
    radius_m: f64,
) -> Uncertainty {
    let unscale = yaw_in_metres(centred.nrows(), 1.0 / radius_m);
    let centred_m2 = &unscale * centred * &unscale;
    let in_metres = centred_m2.clone().symmetric_eigen();
    let worst = in_metres.eigenvalues.imax();
    Uncertainty {
        covariance: Some(covariance),
        centred_m2: Some(centred_m2),
        weakest: in_metres.eigenvectors.column(worst).into_owned(),
        weakest_sigma_m: in_metres.eigenvalues[worst].max(0.0).sqrt(),
        spectrum,
        has_control_points: false,
        radius_m,
    }
}

/// Returns eigenvalues and eigenvectors of JᵀJ, with yaw in metres at the track's radius, so that directions are comparable.
fn spectrum(
    fitting: &CentredTriplets,
    parameters: &Parameters,
    radius_m: f64,
) -> SymmetricEigen<f64, Dyn> {
    let scale = yaw_in_metres(parameters.len(), radius_m);
    (&scale * NormalEquations::at(fitting, parameters).matrix * &scale).symmetric_eigen()
}

/// Returns the diagonal matrix that divides yaws by a radius (m).
fn yaw_in_metres(unknowns: usize, radius_m: f64) -> DMatrix<f64> {
    DMatrix::from_fn(unknowns, unknowns, |i, j| match (i == j, i % UNKNOWNS_PER_STATION) {
        (true, 3) => 1.0 / radius_m,
        (true, _) => 1.0,
        _ => 0.0,
    })
}

/// Jacobian of (translation, yaw) with respect to the centred parameters: t = t' − R c + const, so ∂t/∂ψ = −R' c.
fn at_the_stations(data: &CentredTriplets, parameters: &Parameters) -> DMatrix<f64> {
    let mut jacobian = DMatrix::identity(parameters.len(), parameters.len());
    for (station, centre_m) in data.centre_m.each() {
        if let Some(first) = first_unknown(station) {
            let turned = data.pose(parameters, station).rotate(centre_m);
            jacobian[(first, first + 3)] = turned.y;
            jacobian[(first + 1, first + 3)] = -turned.x;
        }
    }
    jacobian
}
