//! Search for steps of stations and clocks, at any time of the drive.
//!
//! Slow states are random walks from block to block. How far the data pulls an increment beyond its prior follows from its smoothed
//! value and covariance (de Jong & Penzer 1998, "Diagnosing shocks in time series"), so one factorisation tests all times. A step
//! of a station has four parameters, one of station 1 acting through all others; a step of a clock has one. The step with the
//! largest χ² is detected.

use nalgebra::{DMatrix, DVector, Vector4};
use rayon::prelude::*;

use super::chain::ChainVector;
use super::chain_factor::ChainFactor;
use super::height_curvature::HeightCurvature;
use super::random_walks::{SlowPrecisions, WalkMatrix};
use super::state_vector::{Constants, Layout, Slow};
use super::step_fit::{fit, step_jacobians, with_errors};
use crate::calibration::{Estimate, SUPPORTED_SIGMAS};
use crate::network::{Number, Station};

/// Critical χ² of a step of a station at any time of a drive (4 degrees of freedom).
const STATION_CHI_SQUARE: f64 = 38.0;
/// Critical χ² of a step of a clock at any time of a drive (1 degree of freedom).
const CLOCK_CHI_SQUARE: f64 = 34.0;
/// Critical χ² of a drift of one of three stations over the whole drive (4 degrees of freedom).
const DRIFT_CHI_SQUARE: f64 = 20.0;

/// Standard deviation of an error of a sight that changes with the incidence on the prism, along each axis (m): where a vehicle starts to
/// move, it changes at once. Field: facets cause 1 to 4 mm.
const SIGHT_ERROR_M: f64 = 0.0015;
/// Most solutions for components of an increment at a time.
const MOST_SOLUTIONS: usize = 2;
/// Variances of a station's step beside which the data must determine it, as a multiple of those of settling.
const STEP_SETTLING: f64 = 9.0;
/// The same multiple once a step is detected, so that it is measured in all directions.
const DETECTED: f64 = 1e6;
/// Variance of a clock's step beside which the data must determine it (s²).
const STEP_CLOCK_S2: f64 = 25e-6;

/// Heights in a linear function of the states.
pub type HeightsOf<'a> = dyn Fn(&ChainVector) -> DVector<f64> + 'a;

/// A step of a station, or of its clock.
#[derive(Clone, Debug, PartialEq)]
pub struct StationStep {
    pub station: Station,
    /// The first block after the step.
    pub block: usize,
    /// Time of the step, after the middle of the first block (s).
    pub after_s: f64,
    /// True for a drift from the first block to the last.
    pub slowly: bool,
    pub size: StepSize,
}

/// Size of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum StepSize {
    /// Rotation about z (rad) and displacement (m, station 1's frame).
    Station { turned_rad: Estimate, moved_m: [Estimate; 3] },
    /// Increase of the clock offset (s).
    Clock(Estimate),
}

impl StationStep {
    /// Returns true if its size differs from zero.
    pub fn is_significant(&self) -> bool {
        let differs = |size: &Estimate| size.sigmas_from(0.0).abs() >= SUPPORTED_SIGMAS;
        match &self.size {
            StepSize::Station { turned_rad, moved_m } => {
                differs(turned_rad) || moved_m.iter().any(differs)
            }
            StepSize::Clock(by_s) => differs(by_s),
        }
    }

    /// Length of a station's displacement (m).
    pub fn moved_m(&self) -> Option<Estimate> {
        let StepSize::Station { moved_m, .. } = &self.size else { return None };
        Some(Estimate::length_of(moved_m))
    }
}

/// A possible step with its χ².
struct TestedStep {
    chi_square: f64,
    step: StationStep,
}

impl TestedStep {
    /// Returns χ² over the critical one.
    fn significance(&self) -> f64 {
        match self.step.size {
            StepSize::Station { .. } => self.chi_square / STATION_CHI_SQUARE,
            StepSize::Clock(_) => self.chi_square / CLOCK_CHI_SQUARE,
        }
    }
}

/// Input of the search.
pub struct StepSearch<'a> {
    pub layout: &'a Layout,
    pub factor: &'a ChainFactor,
    pub precisions: &'a SlowPrecisions,
    /// Slow states of each block at the solution.
    pub slow: &'a [Slow],
    pub block_times_s: &'a [f64],
    /// First blocks after the known steps of stations, and of clocks.
    pub known_blocks: [&'a [usize]; 2],
    pub constants: &'a Constants,
    /// Variances of one station's settling over a drive (x, y, z, yaw; m², rad²).
    pub settling: Vector4<f64>,
}

impl StepSearch<'_> {
    /// Returns the most significant step that is not known yet.
    ///
    /// `by_incidence` returns the effects of errors that repeat with the incidence on a linear function of the states, and `curvature` that of the cost
    /// for the heights in such functions. Both are costly, and asked for steps alone that are significant without them.
    pub fn most_significant_step(
        &self,
        by_incidence: impl Fn(&ChainVector) -> DVector<f64>,
        curvature: impl Fn(&[ChainVector], &HeightsOf<'_>) -> Option<HeightCurvature>,
    ) -> Option<StationStep> {
        // Station 1 alone moves nothing.
        if self.layout.moved() == 0 {
            return None;
        }
        let covariances = self.factor.increment_covariances();
        let best_of = |steps: Vec<TestedStep>| {
            let all = steps.into_iter().map(|step| (step.significance(), step.step));
            all.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(significance, _)| *significance > 1.0)
        };
        let candidates = covariances.par_iter().enumerate().filter_map(|(index, own)| {
            Some((best_of(self.tested_steps(index + 1, own, None))?.0, index))
        });
        let mut candidates: Vec<(f64, usize)> = candidates.collect();
        candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best: Option<(f64, StationStep)> = None;
        for (largest, index) in candidates {
            if best.as_ref().is_some_and(|(significance, _)| *significance >= largest) {
                break;
            }
            let effects = self.map_increment_solutions(index, index + 1, &by_incidence);
            let effects = DMatrix::from_columns(&effects);
            let mut errors = effects.tr_mul(&effects);
            self.add_curvature(index, &covariances[index], &curvature, &mut errors);
            let step = best_of(self.tested_steps(index + 1, &covariances[index], Some(&errors)));
            let is_better = |(significance, _): &(f64, StationStep)| {
                best.as_ref().is_none_or(|(best, _)| significance > best)
            };
            best = step.filter(is_better).or(best);
        }
        best.map(|(_, step)| step)
    }

    /// Adds to the errors of an increment what the curvature of the cost adds to the covariance of its heights.
    fn add_curvature(
        &self,
        index: usize,
        covariance: &WalkMatrix,
        curvature: impl Fn(&[ChainVector], &HeightsOf<'_>) -> Option<HeightCurvature>,
        errors: &mut WalkMatrix,
    ) {
        // The distances alone are curved.
        if self.layout.prisms() < 2 {
            return;
        }
        let heights: Vec<usize> = (0..self.layout.moved()).map(|slot| 4 * slot + 2).collect();
        let difference = |height: &usize| self.difference(index, index + 1, *height);
        let directions =
            self.factor.solve(&heights.iter().map(difference).collect::<Vec<ChainVector>>());
        let of_increment = |vector: &ChainVector| {
            (&vector.slow[index + 1] - &vector.slow[index]).select_rows(&heights)
        };
        let Some(curvature) = curvature(&directions, &of_increment) else { return };
        let of_heights = covariance.select_rows(&heights).select_columns(&heights);
        let more = curvature.more(&of_heights);
        for (i, row) in heights.iter().enumerate() {
            heights
                .iter()
                .enumerate()
                .for_each(|(k, column)| errors[(*row, *column)] += more[(i, k)]);
        }
    }

    /// Returns the steps before a block that are not known yet; `covariance` is that of the increment, `errors` its part by the incidence.
    fn tested_steps(
        &self,
        block: usize,
        covariance: &WalkMatrix,
        errors: Option<&WalkMatrix>,
    ) -> Vec<TestedStep> {
        let [is_moved, is_late] = self.known_blocks.map(|known| known.contains(&block));
        let precision = self.precisions.increment_precision(block);
        let (normal, right) = self.without_prior(block - 1, block, &precision, covariance);
        let (normal, right) = match errors {
            // The right-hand side of the data has this part of the covariance.
            Some(errors) => with_errors(normal, right, &(&precision * errors * &precision)),
            None => (normal, right),
        };
        let [before_s, after_s] = [self.block_times_s[block - 1], self.block_times_s[block]];
        let after_s = 0.5 * (before_s + after_s) - self.block_times_s[0];
        // A displacement has the errors of single sights, too.
        let of_place = &normal * self.sight_errors_m2() * &normal;
        let (of_place, right_of_place) = with_errors(normal.clone(), right.clone(), &of_place);
        let mut tested = Vec::new();
        for station in self.stations() {
            let mut add = |chi_square: f64, size: StepSize| {
                let step = StationStep { station, block, after_s, slowly: false, size };
                tested.push(TestedStep { chi_square, step });
            };
            let (by_pose, by_clock) = self.jacobians(station);
            let by_pose = (!is_moved)
                .then(|| fit(&by_pose, &of_place, &right_of_place, &self.settling(STEP_SETTLING)));
            if let Some((chi_square, size)) = by_pose.flatten() {
                add(chi_square, station_size(&size));
            }
            let by_clock = (!is_late).then(|| fit(&by_clock, &normal, &right, &[STEP_CLOCK_S2]));
            if let Some((chi_square, size)) = by_clock.flatten() {
                add(chi_square, StepSize::Clock(size[0]));
            }
        }
        tested
    }

    /// Covariance of the displacements of an increment by errors of the sights that change at once.
    fn sight_errors_m2(&self) -> WalkMatrix {
        // Positions are relative to station 1, whose errors they have in common.
        let variance_m2 = |i: usize, k: usize| {
            let is_same_axis = i.max(k) < 4 * self.layout.moved() && i % 4 == k % 4 && i % 4 < 3;
            let both = if i == k { 2.0 } else { 1.0 };
            if is_same_axis { both * SIGHT_ERROR_M.powi(2) } else { 0.0 }
        };
        let walks = self.layout.slow_ranges();
        WalkMatrix::from_fn(walks, walks, variance_m2)
    }

    fn stations(&self) -> impl Iterator<Item = Station> + use<> {
        // A single station has nothing that it moves against.
        let moved = self.layout.moved();
        (0..self.layout.stations()).map(Station::at).filter(move |_| moved > 0)
    }

    fn jacobians(&self, station: Station) -> (WalkMatrix, WalkMatrix) {
        step_jacobians(self.layout, station, self.constants)
    }

    /// A multiple of the variances of settling.
    fn settling(&self, multiple: f64) -> [f64; 4] {
        (self.settling * multiple).into()
    }

    /// Returns the most significant drift of a station from the first block of the drive to the last.
    pub fn most_significant_drift(&self) -> Option<StationStep> {
        let last = self.block_times_s.len() - 1;
        let precision = self.precisions.whole_drive_precision()?;
        let covariance = self.increment_covariance(0, last);
        let (normal, right) = self.without_prior(0, last, &precision, &covariance);
        let drift = |station: Station| {
            let (chi_square, size) =
                fit(&self.jacobians(station).0, &normal, &right, &self.settling(1.0))?;
            let size = station_size(&size);
            Some((
                chi_square,
                StationStep { station, block: last, after_s: 0.0, slowly: true, size },
            ))
        };
        let largest = self.stations().filter_map(drift).max_by(|a, b| a.0.total_cmp(&b.0));
        largest.filter(|(chi_square, _)| *chi_square > DRIFT_CHI_SQUARE).map(|(_, drift)| drift)
    }

    /// Normal matrix and right-hand side of an increment from a block to a later one, without its prior.
    ///
    /// With the prior precision `(ωQ)⁻¹` of the increment Δs, and its covariance C by data and prior, they are (24) of [`super`].
    fn without_prior(
        &self,
        from: usize,
        to: usize,
        precision: &WalkMatrix,
        covariance: &WalkMatrix,
    ) -> (WalkMatrix, DVector<f64>) {
        let right = precision * self.increment(from, to);
        (precision - precision * covariance * precision, right) // (24)
    }

    /// Change of the states that may step from a block to a later one.
    fn increment(&self, from: usize, to: usize) -> DVector<f64> {
        (&self.slow[to] - &self.slow[from]).rows(0, self.layout.slow_ranges()).into_owned()
    }

    /// Returns a step with its size, from its block to a last one, by a solution whose priors allow it; the search's own priors do not.
    pub fn measure(&self, step: &StationStep, last_block: usize) -> Option<StationStep> {
        // Covariance of the increment, and of the random walk that it contains.
        let mut covariance = self.increment_covariance(step.block - 1, last_block);
        for block in step.block..=last_block {
            covariance += self.precisions.increment_precision(block).cholesky()?.inverse();
        }
        let precision = covariance.cholesky()?.inverse();
        let right = &precision * self.increment(step.block - 1, last_block);
        let (by_pose, by_clock) = self.jacobians(step.station);
        let size = match step.size {
            StepSize::Station { .. } => {
                station_size(&fit(&by_pose, &precision, &right, &self.settling(DETECTED))?.1)
            }
            StepSize::Clock(_) => {
                StepSize::Clock(fit(&by_clock, &precision, &right, &[STEP_CLOCK_S2])?.1[0])
            }
        };
        let later_s = self.block_times_s[last_block] - self.block_times_s[step.block];
        Some(StationStep { size, after_s: step.after_s + 0.5 * later_s, ..step.clone() })
    }

    /// Covariance of the increment from a block to a later one, with priors and data.
    fn increment_covariance(&self, from: usize, to: usize) -> WalkMatrix {
        let columns = self.map_increment_solutions(from, to, |solution| {
            (&solution.slow[to] - &solution.slow[from])
                .rows(0, self.layout.slow_ranges())
                .into_owned()
        });
        WalkMatrix::from_fn(columns.len(), columns.len(), |row, column| columns[column][row])
    }

    /// Jacobian of a component of the increment from a block to a later one.
    fn difference(&self, from: usize, to: usize, component: usize) -> ChainVector {
        let mut difference = ChainVector::zeros(self.layout, self.block_times_s.len());
        difference.slow[to][component] = 1.0;
        difference.slow[from][component] = -1.0;
        difference
    }

    /// Maps the solutions for the components of the increment from a block to a later one. Those of a long drive need much memory, so there are
    /// few at a time.
    fn map_increment_solutions<T>(
        &self,
        from: usize,
        to: usize,
        map: impl Fn(&ChainVector) -> T,
    ) -> Vec<T> {
        let difference = |component: &usize| self.difference(from, to, *component);
        let walks: Vec<usize> = (0..self.layout.slow_ranges()).collect();
        let solutions =
            |some: &[usize]| self.factor.solve(&some.iter().map(difference).collect::<Vec<_>>());
        let mapped = walks.chunks(MOST_SOLUTIONS);
        mapped.flat_map(|some| solutions(some).iter().map(&map).collect::<Vec<T>>()).collect()
    }
}

fn station_size(size: &[Estimate]) -> StepSize {
    StepSize::Station { turned_rad: size[3], moved_m: [size[0], size[1], size[2]] }
}
