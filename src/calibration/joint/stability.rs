//! Whether stations and clocks stayed as they were: the likeliest step of each, at any time of the drive.
//!
//! Where slow states may walk as far as the data leads them, the mean after a time less the mean before it is an estimate of
//! a step at that time, with its covariance. A station that turns and moves has four numbers for it, station 1 through the
//! other two; a clock has one. The step that explains most, by χ², is the one that is told.

use nalgebra::{SMatrix, SVector, Vector3};
use rayon::prelude::*;

use super::chain::{Columns, Data, Factor, SlowPrecisions, SlowPriors};
use super::unknowns::{Constants, SLOW_CLOCKS, SLOW_RANGES, Slow};
use crate::calibration::inter_prism::Estimate;

/// Poses of stations 2 and 3, and their clocks.
const STEPPING: usize = SLOW_RANGES;
/// How much further than usual states may walk, and clocks in any case (s).
const FREEDOM: f64 = 30.0;
const FREE_CLOCK_S: f64 = 0.03;
/// Times that are tried, at most; then every part about the best one.
const MOST_CUTS: usize = 12;
/// A step is at least this clear at the nearest of them.
const PROMISING: f64 = 0.4;
/// Fewer parts on a side tell nothing.
const FEWEST_PARTS: usize = 2;
/// χ² of a step that chance hardly makes, at any of the times, with four numbers and with one.
const STATION_CHI_SQUARE: f64 = 45.0;
const CLOCK_CHI_SQUARE: f64 = 36.0;

/// A station, or its clock, that was not the same before and after.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// 0 to 2.
    pub station: usize,
    /// The first part after it.
    pub part: usize,
    /// From the first part's middle on (s).
    pub after_s: f64,
    pub what: Stepped,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Stepped {
    /// Turned about z (rad) and moved (m, station 1's frame).
    Station { turned_rad: Estimate, moved_m: [Estimate; 3] },
    /// Stamps later by this much (s).
    Clock(Estimate),
}

impl Step {
    /// How far the station moved (m).
    pub fn moved_m(&self) -> Option<Estimate> {
        let Stepped::Station { moved_m, .. } = &self.what else { return None };
        let vector = Vector3::from(moved_m.each_ref().map(|axis| axis.value));
        let value = vector.norm();
        let along = vector / value.max(1e-12);
        let sigma = (0..3).map(|k| (along[k] * moved_m[k].sigma).powi(2)).sum::<f64>().sqrt();
        Some(Estimate { value, sigma })
    }
}

/// What a search for steps looks at.
pub struct Search<'a> {
    pub data: &'a Data,
    /// With all priors.
    pub precision: &'a Constants,
    pub priors: &'a SlowPriors,
    pub part_times_s: &'a [f64],
    /// Where everything is taken to be, and the constants less their priors.
    pub slow: &'a [Slow],
    pub from_priors: &'a Constants,
    /// Steps that are known already, by their first part.
    pub known: &'a [usize],
    /// Of station 2 and 3 from station 1 (m).
    pub places_m: [Vector3<f64>; 2],
}

/// The clearest step that is not known yet.
pub fn clearest_step(search: &Search<'_>) -> Option<Step> {
    let parts = search.part_times_s.len();
    if parts < 2 * FEWEST_PARTS {
        return None;
    }
    let free = SlowPriors {
        settling: search.priors.settling * FREEDOM.powi(2),
        clocks_s2: FREE_CLOCK_S.powi(2),
        ..search.priors.clone()
    };
    let slow_priors = SlowPrecisions::new(&free, search.part_times_s)?;
    let factor = Factor::new(search.data, search.precision, &slow_priors)?;
    let mut gradient = search.data.gradient.clone();
    gradient.constants += search.precision.component_mul(search.from_priors);
    let pulls = slow_priors.times(search.slow);
    gradient.slow.iter_mut().zip(&pulls).for_each(|(slow, pull)| *slow += pull);
    let step = factor.solve(&gradient);
    let slow: Vec<Slow> = search.slow.iter().zip(&step.slow).map(|(at, step)| at - step).collect();
    let found = Columns { slow, constants: Constants::zeros() };
    let best = |cuts: Vec<usize>| {
        let all: Vec<_> =
            cuts.into_par_iter().filter_map(|cut| best_at(search, &factor, &found, cut)).collect();
        all.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let stride = parts.div_ceil(MOST_CUTS);
    let cuts = (FEWEST_PARTS..=parts - FEWEST_PARTS).step_by(stride).collect();
    let (coarse_clarity, coarse) = best(cuts)?;
    if coarse_clarity < PROMISING {
        return None;
    }
    let about = coarse.part.saturating_sub(stride)..(coarse.part + stride).min(parts);
    let (clarity, step) = best(about.collect())?;
    (clarity > 1.0).then_some(step)
}

/// The best step at a time, with its χ² over what is asked of it.
fn best_at(
    search: &Search<'_>,
    factor: &Factor,
    found: &Columns<1>,
    cut: usize,
) -> Option<(f64, Step)> {
    let parts = search.part_times_s.len();
    let from = search.known.iter().copied().filter(|known| *known <= cut).max().unwrap_or(0);
    let to = search.known.iter().copied().filter(|known| *known > cut).min().unwrap_or(parts);
    if cut < from + FEWEST_PARTS || to < cut + FEWEST_PARTS {
        return None;
    }
    let mut wanted = Columns::<STEPPING>::zeros(parts);
    for part in from..to {
        let share = if part < cut { -1.0 / (cut - from) as f64 } else { 1.0 / (to - cut) as f64 };
        (0..STEPPING).for_each(|k| wanted.slow[part][(k, k)] = share);
    }
    let covariance = wanted.dot(&factor.solve(&wanted));
    let steps = wanted.dot(found);
    let precision = covariance.cholesky()?.inverse();
    let after_s =
        0.5 * (search.part_times_s[cut - 1] + search.part_times_s[cut]) - search.part_times_s[0];
    let mut best: Option<(f64, Step)> = None;
    let mut offer = |clarity: f64, station: usize, what: Stepped| {
        if best.as_ref().is_none_or(|(other, _)| clarity > *other) {
            best = Some((clarity, Step { station, part: cut, after_s, what }));
        }
    };
    for station in 0..3 {
        let (turned, late) = shapes(station, &search.places_m);
        if let Some((chi_square, at, covariance)) = fit(&turned, &precision, &steps) {
            let estimate =
                |k: usize| Estimate { value: at[k], sigma: covariance[(k, k)].max(0.0).sqrt() };
            let what = Stepped::Station {
                turned_rad: estimate(3),
                moved_m: [estimate(0), estimate(1), estimate(2)],
            };
            offer(chi_square / STATION_CHI_SQUARE, station, what);
        }
        if let Some((chi_square, at, covariance)) = fit(&late, &precision, &steps) {
            let by_s = Estimate { value: at[0], sigma: covariance[(0, 0)].max(0.0).sqrt() };
            offer(chi_square / CLOCK_CHI_SQUARE, station, Stepped::Clock(by_s));
        }
    }
    best
}

/// What the slow states do when a station moves (x, y, z) and turns, and when its stamps are later.
fn shapes(
    station: usize,
    places_m: &[Vector3<f64>; 2],
) -> (SMatrix<f64, STEPPING, 4>, SMatrix<f64, STEPPING, 1>) {
    let mut turned = SMatrix::<f64, STEPPING, 4>::zeros();
    let mut late = SMatrix::<f64, STEPPING, 1>::zeros();
    match station.checked_sub(1) {
        Some(slot) => {
            (0..4).for_each(|k| turned[(4 * slot + k, k)] = 1.0);
            late[SLOW_CLOCKS + slot] = 1.0;
        }
        None => {
            for slot in 0..2 {
                (0..4).for_each(|k| turned[(4 * slot + k, k)] = -1.0);
                let arm = Vector3::z().cross(&places_m[slot]);
                turned.fixed_view_mut::<3, 1>(4 * slot, 3).copy_from(&-arm);
                late[SLOW_CLOCKS + slot] = -1.0;
            }
        }
    }
    (turned, late)
}

/// Least squares of the steps by some numbers: the χ² that they explain, the numbers, their covariance.
fn fit<const N: usize>(
    shape: &SMatrix<f64, STEPPING, N>,
    precision: &SMatrix<f64, STEPPING, STEPPING>,
    steps: &SVector<f64, STEPPING>,
) -> Option<(f64, SVector<f64, N>, SMatrix<f64, N, N>)> {
    let weighted = precision * shape;
    let covariance = shape.tr_mul(&weighted).cholesky()?.inverse();
    let pull = weighted.tr_mul(steps);
    let numbers = covariance * pull;
    Some((pull.dot(&numbers), numbers, covariance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector4;

    #[test]
    fn a_turn_of_station_1_is_one_of_both_others() {
        let places_m = [Vector3::new(10.0, 0.0, 0.0), Vector3::new(0.0, 20.0, 0.0)];
        let (turned, late) = shapes(0, &places_m);
        let by = turned * Vector4::new(0.0, 0.0, 0.0, 1e-3);
        // The world turns the other way about station 1, and the others with it.
        assert!((by.fixed_rows::<3>(0) - Vector3::new(0.0, -0.01, 0.0)).norm() < 1e-12, "{by}");
        assert!((by.fixed_rows::<3>(4) - Vector3::new(0.02, 0.0, 0.0)).norm() < 1e-12, "{by}");
        assert_eq!((by[3], by[7]), (-1e-3, -1e-3));
        assert_eq!((late[8], late[9]), (-1.0, -1.0));
    }
}
