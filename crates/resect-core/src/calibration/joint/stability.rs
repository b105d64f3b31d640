//! Whether stations and clocks stayed as they were: the likeliest step of each, at any time of the drive.
//!
//! Slow states walk from part to part by as much as the priors let them. How far the data wants one of these walks to go
//! beyond that is told by its smoothed value alone (de Jong & Penzer 1998, "Diagnosing shocks in time series"), so that one
//! factorisation tests all times. A station that turns and moves has four numbers for it, station 1 through the other two; a
//! clock has one. The step that explains most, by χ², is the one that is told.

use nalgebra::{SMatrix, SVector, Vector3};
use rayon::prelude::*;

use super::chain::Columns;
use super::chain_factor::Factor;
use super::slow_priors::{SlowPrecisions, Walk};
use super::unknowns::{SLOW_CLOCKS, SLOW_RANGES, Slow};
use crate::calibration::Estimate;

/// Poses of stations 2 and 3, and their clocks.
const STEPPING: usize = SLOW_RANGES;
/// χ² of a step that chance hardly makes, at any of the times, with four numbers and with one.
const STATION_CHI_SQUARE: f64 = 28.0;
/// χ² of a slow walk of one of three stations that chance hardly makes, with four numbers and at one time.
const DRIFT_CHI_SQUARE: f64 = 20.0;
const CLOCK_CHI_SQUARE: f64 = 25.0;

/// A station, or its clock, that was not the same before and after.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The station, 0 to 2.
    pub station: usize,
    /// The first part after it.
    pub part: usize,
    /// Time of the step, after the first part's middle (s).
    pub after_s: f64,
    /// Whether the step took the whole drive, from its first part to its last.
    pub slowly: bool,
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
    pub factor: &'a Factor,
    pub slow_priors: &'a SlowPrecisions,
    /// The slow states of each part, where everything is best.
    pub slow: &'a [Slow],
    pub part_times_s: &'a [f64],
    /// Steps of stations, and of clocks, that are known already, by their first part.
    pub known: [&'a [usize]; 2],
    /// Vector from station 1 to stations 2 and 3 (m).
    pub places_m: [Vector3<f64>; 2],
}

/// The clearest step that is not known yet.
pub fn clearest_step(search: &Search<'_>) -> Option<Step> {
    let walks = search.factor.of_walks();
    let all =
        walks.par_iter().enumerate().filter_map(|(index, left)| best_at(search, index + 1, left));
    let (clarity, step) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (clarity > 1.0).then_some(step)
}

/// The best step at a time, with its χ² over what is asked of it; `left` is the walk's covariance.
fn best_at(search: &Search<'_>, cut: usize, left: &Walk) -> Option<(f64, Step)> {
    let [is_moved, is_late] = search.known.map(|known| known.contains(&cut));
    let by_priors = search.slow_priors.of_walk(cut);
    let (precision, pull) = beyond_priors(search, cut - 1, cut, &by_priors, left);
    let after_s =
        0.5 * (search.part_times_s[cut - 1] + search.part_times_s[cut]) - search.part_times_s[0];
    let mut best: Option<(f64, Step)> = None;
    let mut offer = |clarity: f64, station: usize, what: Stepped| {
        if best.as_ref().is_none_or(|(other, _)| clarity > *other) {
            best = Some((clarity, Step { station, part: cut, after_s, slowly: false, what }));
        }
    };
    for station in 0..3 {
        let (turned, late) = shapes(station, &search.places_m);
        if !is_moved && let Some((chi_square, numbers)) = fit(&turned, &precision, &pull) {
            offer(chi_square / STATION_CHI_SQUARE, station, of_station(numbers));
        }
        if !is_late && let Some((chi_square, [by_s])) = fit(&late, &precision, &pull) {
            offer(chi_square / CLOCK_CHI_SQUARE, station, Stepped::Clock(by_s));
        }
    }
    best
}

/// The station that moved most clearly between the first part of the drive and the last, as slowly as that lets it.
pub fn clearest_drift(search: &Search<'_>) -> Option<Step> {
    let last = search.part_times_s.len() - 1;
    let by_priors = search.slow_priors.of_whole_walk()?;
    let left = left_of_walk(search, 0, last);
    let (precision, pull) = beyond_priors(search, 0, last, &by_priors, &left);
    let of = |station: usize| {
        let (chi_square, numbers) = fit(&shapes(station, &search.places_m).0, &precision, &pull)?;
        let what = of_station(numbers);
        Some((chi_square, Step { station, part: last, after_s: 0.0, slowly: true, what }))
    };
    let clearest = (0..3).filter_map(of).max_by(|a, b| a.0.total_cmp(&b.0));
    clearest.filter(|(chi_square, _)| *chi_square > DRIFT_CHI_SQUARE).map(|(_, drift)| drift)
}

/// Normal matrix and right-hand side of a walk θ from a part to a later one, without any prior of θ.
///
/// With Q⁻¹ the precision that the priors give this walk w, and C what is left of its variance with the data, they are
/// Q⁻¹ − Q⁻¹CQ⁻¹ and Q⁻¹w.
fn beyond_priors(
    search: &Search<'_>,
    from: usize,
    to: usize,
    by_priors: &Walk,
    left: &Walk,
) -> (Walk, SVector<f64, STEPPING>) {
    let walk = search.slow[to] - search.slow[from];
    (by_priors - by_priors * left * by_priors, by_priors * walk.fixed_rows::<STEPPING>(0))
}

/// The step as measured by a solution in which it has room, the search's priors being those without that room.
pub fn measured(search: &Search<'_>, step: &Step) -> Option<Step> {
    // What the data leaves open, and the walk that there would be in any case.
    let left = left_of_walk(search, step.part - 1, step.part)
        + search.slow_priors.of_walk(step.part).cholesky()?.inverse();
    let precision = left.cholesky()?.inverse();
    let walk = search.slow[step.part] - search.slow[step.part - 1];
    let pull = precision * walk.fixed_rows::<STEPPING>(0);
    let (turned, late) = shapes(step.station, &search.places_m);
    let what = match step.what {
        Stepped::Station { .. } => of_station(fit(&turned, &precision, &pull)?.1),
        Stepped::Clock(_) => Stepped::Clock(fit(&late, &precision, &pull)?.1[0]),
    };
    Some(Step { what, ..step.clone() })
}

/// Covariance of the walk from a part to a later one, with priors and data.
fn left_of_walk(search: &Search<'_>, from: usize, to: usize) -> Walk {
    let mut walked = Columns::<STEPPING>::zeros(search.part_times_s.len());
    for k in 0..STEPPING {
        walked.slow[to][(k, k)] = 1.0;
        walked.slow[from][(k, k)] = -1.0;
    }
    let found = search.factor.solve(walked);
    (found.slow[to] - found.slow[from]).fixed_rows::<STEPPING>(0).into_owned()
}

fn of_station([x_m, y_m, z_m, turned_rad]: [Estimate; 4]) -> Stepped {
    Stepped::Station { turned_rad, moved_m: [x_m, y_m, z_m] }
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

/// The χ² that a step of this shape explains, and its numbers.
fn fit<const N: usize>(
    shape: &SMatrix<f64, STEPPING, N>,
    precision: &Walk,
    pull: &SVector<f64, STEPPING>,
) -> Option<(f64, [Estimate; N])> {
    let covariance = shape.tr_mul(&(precision * shape)).cholesky()?.inverse();
    let pull = shape.tr_mul(pull);
    let numbers = covariance * pull;
    let estimate =
        |k: usize| Estimate { value: numbers[k], sigma: covariance[(k, k)].max(0.0).sqrt() };
    Some((pull.dot(&numbers), std::array::from_fn(estimate)))
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
