//! Inter-prism metric of a run with an earlier calibration, compared with its own calibration.

use nalgebra::{DMatrix, DVector, Vector3};

use super::earlier::Earlier;
use super::moved::Difference;
use resect_core::analysis::Answer;
use resect_core::calibration::distance_errors_m;
use resect_core::evaluation::Spread;
use resect_core::geometry::RigidTransform;
use resect_core::network::{Pair, PerPair, PerStation, Prism};
use resect_core::pipeline::Triplets;

/// Critical value of a standard normal variable, one-sided, at significance level
/// [`LEVEL_OF_ONE`](super::outcome::LEVEL_OF_ONE).
const NORMAL_OF_ONE: f64 = 2.8782;
/// Largest number of triplets for the sensitivity of distances to the transforms; more add no information.
const MOST_TRIPLETS: usize = 2000;

/// Errors of the run's inter-prism distances with the earlier transforms, compared with its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricThere {
    /// Absolute distance errors relative to the measured distances, pooled over the pairs (mm), with the earlier transforms
    /// and with the run's own. Both use the clock and instrument corrections of the run's own calibration.
    pub earlier_mm: Spread,
    pub own_mm: Spread,
    /// Difference between the distances of both (m, rms), and its critical value.
    pub apart_m: f64,
    pub allowed_m: f64,
}

impl MetricThere {
    /// Returns true if the earlier transforms are significantly worse.
    pub fn is_worse(&self) -> bool {
        self.apart_m > self.allowed_m && self.earlier_mm.median > self.own_mm.median
    }
}

/// Returns the metric with both calibrations; `None` without triplets. `known_m` are the measured distances (m).
pub fn metric_there(
    earlier: &Earlier,
    own: &Answer,
    difference: &Difference,
    known_m: &PerPair<f64>,
    followed: &PerStation<Prism>,
) -> Option<MetricThere> {
    let transforms = &own.calibration.station1_from_station;
    let by = |transforms: &PerStation<RigidTransform>| {
        let errors = distance_errors_m(&own.triplets, transforms, followed, known_m);
        Spread::of(errors.iter().flatten().map(|error_m| error_m.abs() * 1e3))
    };
    let follows = follows(&own.triplets, transforms, Prism::is_one(followed))?;
    Some(MetricThere {
        earlier_mm: by(&earlier.station1_from_station)?,
        own_mm: by(transforms)?,
        apart_m: difference.values.dot(&(&follows * &difference.values)).max(0.0).sqrt(),
        allowed_m: allowed_m2(&(&follows * &difference.covariance)).sqrt(),
    })
}

/// Mean of g gᵀ over the distances, with the gradient g of a distance with respect to (x, y, z, yaw) of stations 2, 3, …
///
/// If all stations track one prism, the distance is zero and has no direction; the three coordinates are used instead.
fn follows(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
    one_prism: bool,
) -> Option<DMatrix<f64>> {
    let stations = station1_from_station.len();
    let unknowns = 4 * (stations - 1);
    let mut sum = DMatrix::zeros(unknowns, unknowns);
    let mut distances = 0.0;
    for index in (0..triplets.len()).step_by(triplets.len().div_ceil(MOST_TRIPLETS).max(1)) {
        let placed = station1_from_station
            .zip(&triplets.points_m, |transform, points_m| transform.apply(&points_m[index]));
        for [a, b] in Pair::among(stations).map(Pair::indices) {
            let apart = placed[a] - placed[b];
            let directions = if one_prism {
                vec![Vector3::x(), Vector3::y(), Vector3::z()]
            } else {
                apart.try_normalize(0.0).into_iter().collect()
            };
            for direction in directions {
                let mut g = DVector::zeros(unknowns);
                for (station, sign) in [(a, 1.0), (b, -1.0)] {
                    let Some(slot) = station.checked_sub(1) else { continue };
                    let out = placed[station] - station1_from_station[station].translation_m;
                    g.fixed_rows_mut::<3>(4 * slot).copy_from(&(sign * direction));
                    g[4 * slot + 3] = sign * direction.dot(&Vector3::z().cross(&out));
                }
                sum += &g * g.transpose();
            }
            distances += 1.0;
        }
    }
    (distances > 0.0).then(|| sum / distances)
}

/// Critical value at significance level [`LEVEL_OF_ONE`](super::outcome::LEVEL_OF_ONE) of dᵀA d (m²), for normal d with
/// covariance Σ, from AΣ.
///
/// The distribution is approximated by a shifted multiple of χ² with the same first three moments (Pearson's approximation:
/// Imhof 1961). The cube root of that χ² is nearly normal (Wilson & Hilferty 1931).
fn allowed_m2(follows_covariance: &DMatrix<f64>) -> f64 {
    let squared = follows_covariance * follows_covariance;
    let (first, second) = (follows_covariance.trace(), squared.trace());
    let third = (&squared * follows_covariance).trace();
    let degrees = second.powi(3) / third.powi(2).max(f64::MIN_POSITIVE);
    let spread = 2.0 / (9.0 * degrees);
    let chi_square = degrees * (1.0 - spread + NORMAL_OF_ONE * spread.sqrt()).powi(3);
    first + (second / degrees).sqrt() * (chi_square - degrees)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validation::outcome::LEVEL_OF_ONE;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn what_sigma_allows_is_exceeded_as_often_as_is_said() {
        const DRAWS: usize = 100_000;
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        // Drives determine a few directions well and others hardly.
        for share in [1.0, 0.5, 0.2] {
            let sizes = DVector::from_fn(8, |k, _| f64::powi(share, k as i32));
            let allowed = allowed_m2(&DMatrix::from_diagonal(&sizes.component_mul(&sizes)));
            let beyond = (0..DRAWS)
                .filter(|_| sizes.map(|size| size * normal()).norm_squared() > allowed)
                .count() as f64;
            let expected = LEVEL_OF_ONE * DRAWS as f64;
            assert!((0.7..1.3).contains(&(beyond / expected)), "{share}: {beyond} of {expected}");
        }
    }
}
