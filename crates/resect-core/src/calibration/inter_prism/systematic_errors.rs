//! Effect on method D of errors that all readings of a station share: those of its instrument, its clock and its latency, and of the
//! distances of the rig.
//!
//! A share of each error is put into some triplets, and the answer follows by one Gauss–Newton step. Residuals limit the errors as for the
//! other methods ([`crate::calibration::common_errors`]).

use nalgebra::Vector3;

use super::{CentredTriplets, Minimum, NormalEquations};
use crate::calibration::common_errors::{self, CommonErrors, Displaced, SHARE};
use crate::calibration::joint::unknown::{CLOCK_OFFSET, LATENCY};
use crate::calibration::{CalibrationSettings, ErrorSizes, time_blocks};
use crate::geometry::RigidTransform;
use crate::network::{Number, Pair, PerStation, Station};

/// Triplets that are enough.
const ENOUGH: usize = 300;

/// Returns the effect of these errors and of the settling of tripods; `None` if the minimum is flat.
pub fn estimate(
    data: &CentredTriplets,
    (time_s, interval): (&[f64], &[u32]),
    answer: &Minimum,
    settings: &CalibrationSettings,
) -> Option<CommonErrors> {
    let sizes = &settings.errors;
    let step = data.len().div_ceil(ENOUGH).max(1);
    let instants: Vec<usize> = (0..data.len()).step_by(step).collect();
    let some = data.select(&instants);
    let inverse = NormalEquations::at(&some, &answer.parameters).matrix.cholesky()?.inverse();
    let solve = |displaced: &CentredTriplets| {
        let gradient = NormalEquations::at(displaced, &answer.parameters).gradient;
        let parameters = &answer.parameters - &inverse * gradient;
        Displaced {
            station1_from_station: displaced
                .transforms(&parameters)
                .map(|level| RigidTransform::from(*level)),
            residuals_m: displaced.distance_errors_m(&parameters),
        }
    };
    let mut further: Vec<Displaced> = Vec::new();
    let velocities = data.velocities_m_per_s(&instants, time_s, interval);
    for station in (0..data.centre_m.len()).map(Station::at) {
        for error_m in timing_errors_m(&some, station, &velocities[station], sizes) {
            further.push(solve(&some.moved(station, &error_m)));
        }
    }
    for prisms in data.network.prism_pairs() {
        further.push(solve(&some.with_longer(prisms, SHARE * settings.inter_prism_sigma_m)));
    }
    let blocks = time_blocks::of(time_s, interval).len();
    let independent = blocks * data.network.residuals();
    let mut common =
        common_errors::effect(sizes, data.centre_m.len(), independent, &further, |displace| {
            Some(solve(&some.displaced(displace)))
        })?;
    let placed = data.transforms(&answer.parameters).map(|level| RigidTransform::from(*level));
    // Variance of a random walk's mean about its start is a third of that of its end.
    common.covariance += common_errors::settling(sizes, &placed) / 3.0;
    Some(common)
}

/// Displacements of a station's points by a late clock, which station 1 does not have, and by old angles (m).
fn timing_errors_m(
    data: &CentredTriplets,
    station: Station,
    velocities_m_per_s: &[Vector3<f64>],
    sizes: &ErrorSizes,
) -> Vec<Vec<Vector3<f64>>> {
    let [clock_s, latency_s] =
        [&CLOCK_OFFSET, &LATENCY].map(|unknown| SHARE / unknown.precision(sizes).sqrt());
    let late = velocities_m_per_s.iter().map(|velocity| velocity * clock_s).collect();
    let old = velocities_m_per_s.iter().zip(data.points_m(station)).map(|(velocity, point_m)| {
        let along = point_m.normalize();
        (velocity - along * along.dot(velocity)) * latency_s
    });
    let old = old.collect();
    if station == Station::FIRST { vec![old] } else { vec![late, old] }
}

impl CentredTriplets {
    /// Points of a station (m, its own frame).
    fn points_m(&self, station: Station) -> impl Iterator<Item = Vector3<f64>> {
        let [x, y, z] = &self.coordinates[station];
        let centred = x.iter().zip(y).zip(z).map(|((x, y), z)| Vector3::new(*x, *y, *z));
        centred.map(move |point_m| point_m + self.centre_m[station])
    }

    /// Velocities at some instants (m/s); zero at the ends of intervals.
    fn velocities_m_per_s(
        &self,
        instants: &[usize],
        time_s: &[f64],
        interval: &[u32],
    ) -> PerStation<Vec<Vector3<f64>>> {
        self.coordinates.map(|station| {
            let point_m = |i: usize| Vector3::from_fn(|axis, _| station[axis][i]);
            let velocity = |i: &usize| {
                let (start, end) = (i.saturating_sub(1), (i + 1).min(self.len() - 1));
                let apart_s = time_s[end] - time_s[start];
                let is_inside = interval[start] == interval[end] && apart_s > 0.0;
                let moved_m = point_m(end) - point_m(start);
                if is_inside { moved_m / apart_s } else { Vector3::zeros() }
            };
            instants.iter().map(velocity).collect()
        })
    }

    /// Returns the triplets with a longer distance between two prisms.
    pub fn with_longer(&self, prisms: Pair, by_m: f64) -> Self {
        let mut longer = self.clone();
        let pairs = longer.network.pairs.iter_mut();
        pairs.filter(|pair| pair.prisms == Some(prisms)).for_each(|pair| pair.distance_m += by_m);
        longer
    }

    /// Returns the triplets with displaced points of one station (m), relative to the same centroids.
    fn moved(&self, station: Station, by_m: &[Vector3<f64>]) -> Self {
        let mut moved = self.clone();
        for (axis, list) in moved.coordinates[station].iter_mut().enumerate() {
            list.iter_mut().zip(by_m).for_each(|(value, by_m)| *value += by_m[axis]);
        }
        moved
    }

    /// Returns the triplets with points that an error displaces, relative to the same centroids.
    fn displaced(&self, displace: &common_errors::Displacement<'_>) -> Self {
        let displaced = |station: Station| {
            self.points_m(station).map(move |point_m| displace(station, &point_m) - point_m)
        };
        let stations = (0..self.centre_m.len()).map(Station::at);
        stations.fold(self.clone(), |triplets, station| {
            triplets.moved(station, &displaced(station).collect::<Vec<_>>())
        })
    }
}
