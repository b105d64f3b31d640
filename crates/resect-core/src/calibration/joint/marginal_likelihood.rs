//! Marginal likelihood of the data by the variances of slow states, with which those of ranges and clocks are estimated.
//!
//! Minus twice its logarithm is (18) of [`super`], with the gradient g at the states s. The chain is eliminated for several priors in
//! parallel, some blocks at a time. No more than one row of each factor is in memory.

use rayon::prelude::*;

use super::chain::{ChainEquations, ChainRow, ChainVector};
use super::chain_factor::{ChainElimination, chain_shape};
use super::priors::Priors;
use super::random_walks::{
    GaussMarkov, PROCESS_SIGMAS_M, PROCESS_TIMES_S, SlowPrecisions, SlowPriors,
};
use super::state_vector::{Constants, Slow, StateVector};
use crate::linear_algebra::bordered_rows::{RowShape, forward_substitute};
use crate::progress::{Cancelled, Progress};

/// Multiples of the prior variance of the clocks' random walks that are tried. Field: up to 6 ms in a drive, as of clocks that a time
/// server steers.
const CLOCK_MULTIPLES: [f64; 3] = [10.0, 100.0, 1000.0];
/// Largest standard deviation of errors across the sights and upward (m). Field: facets cause 1 to 4 mm; larger errors are
/// leans.
const MOST_ACROSS_M: f64 = 0.0045;
/// The variance of the clocks changes only if twice the logarithm of the likelihood gains more. Textbook: the 95 % quantile of χ² with
/// one degree of freedom is 3.8.
const LEAST_GAIN: f64 = 4.0;

/// Access to one of the processes.
type ProcessField = fn(&mut SlowPriors) -> &mut GaussMarkov;

/// Replaces the processes of errors of ranges, across the sights, and upward, one after the other, by likelier ones: first by the standard
/// deviation with the largest marginal likelihood, then by the correlation time with it, and again if that is another one.
///
/// Each search descends on the grid from the present process, so that a process that fits costs two or three likelihoods.
pub fn choose_processes(
    normal: &ChainEquations,
    priors: &mut Priors,
    state: &StateVector,
    progress: &Progress,
) -> Result<(), Cancelled> {
    let fields: [(f64, ProcessField); 3] = [
        (f64::INFINITY, |slow| &mut slow.ranges),
        (MOST_ACROSS_M, |slow| &mut slow.across),
        (MOST_ACROSS_M, |slow| &mut slow.upward),
    ];
    for (most_m, field) in fields {
        let sigmas = PROCESS_SIGMAS_M.iter().take_while(|sigma_m| **sigma_m <= most_m).count();
        let mut slow = priors.slow.clone();
        let cell = grid_cell(field(&mut slow));
        let costs = |cells: &[[usize; 2]]| {
            let with_process = |cell: &[usize; 2]| {
                let mut slow = priors.slow.clone();
                *field(&mut slow) = process_of(*cell);
                slow
            };
            let tried: Vec<SlowPriors> = cells.iter().map(with_process).collect();
            let costs = minus_two_ln_likelihoods(&tried, normal, priors, state, progress)?;
            Ok(costs.into_iter().map(|cost| cost.unwrap_or(f64::INFINITY)).collect())
        };
        let mut search =
            GridSearch { counts: [sigmas, PROCESS_TIMES_S.len()], costs, known: Vec::new() };
        let by_sigma = search.descend(cell, 0)?;
        let by_time = search.descend(by_sigma, 1)?;
        let likeliest = if by_time == by_sigma { by_time } else { search.descend(by_time, 0)? };
        *field(&mut priors.slow) = process_of(likeliest);
    }
    Ok(())
}

/// Returns the process of a cell: the index of its standard deviation, and of its correlation time.
fn process_of([sigma, time]: [usize; 2]) -> GaussMarkov {
    GaussMarkov { sigma_m: PROCESS_SIGMAS_M[sigma], correlation_s: PROCESS_TIMES_S[time] }
}

/// Returns the cell of a process; that of the smallest one if it is not on the grid.
fn grid_cell(process: &GaussMarkov) -> [usize; 2] {
    let index = |all: &[f64], value: f64| all.iter().position(|tried| *tried == value);
    let sigma = index(&PROCESS_SIGMAS_M, process.sigma_m);
    let time = index(&PROCESS_TIMES_S, process.correlation_s);
    sigma.zip(time).map_or([0, 1], |(sigma, time)| [sigma, time])
}

/// Search for the smallest cost on a grid. `costs` returns those of several cells at once.
struct GridSearch<F> {
    /// Number of cells along both axes.
    counts: [usize; 2],
    costs: F,
    /// The cells whose costs are known.
    known: Vec<([usize; 2], f64)>,
}

impl<F: FnMut(&[[usize; 2]]) -> Result<Vec<f64>, Cancelled>> GridSearch<F> {
    /// Moves to the better neighbour along an axis until neither is better.
    fn descend(&mut self, mut cell: [usize; 2], axis: usize) -> Result<[usize; 2], Cancelled> {
        loop {
            let last = self.counts[axis] - 1;
            let along = cell[axis].saturating_sub(1)..=(cell[axis] + 1).min(last);
            let near = along.map(|index| {
                let mut near = cell;
                near[axis] = index;
                near
            });
            let near: Vec<[usize; 2]> = near.collect();
            let is_new = |cell: &&[usize; 2]| self.known.iter().all(|(known, _)| known != *cell);
            let new: Vec<[usize; 2]> = near.iter().filter(is_new).copied().collect();
            let costs = (self.costs)(&new)?;
            self.known.extend(new.into_iter().zip(costs));
            let is_near = |(cell, _): &&([usize; 2], f64)| near.contains(cell);
            let best = self.known.iter().filter(is_near).min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((best, _)) = best.copied() else { return Ok(cell) };
            if best == cell {
                return Ok(cell);
            }
            cell = best;
        }
    }
}

/// Returns the variance of the clocks' random walks with the largest marginal likelihood (s²), or that of the prior unless the gain is
/// significant.
pub fn likeliest_clocks_s2(
    normal: &ChainEquations,
    priors: &Priors,
    state: &StateVector,
    prior_s2: f64,
    progress: &Progress,
) -> Result<f64, Cancelled> {
    let mut tried_s2 = vec![prior_s2];
    tried_s2.extend(CLOCK_MULTIPLES.map(|multiple| multiple * prior_s2));
    let slow = |clocks_s2: &f64| SlowPriors { clocks_s2: *clocks_s2, ..priors.slow.clone() };
    let slow: Vec<SlowPriors> = tried_s2.iter().map(slow).collect();
    let costs = minus_two_ln_likelihoods(&slow, normal, priors, state, progress)?;
    let Some(by_prior) = costs[0] else { return Ok(prior_s2) };
    let (mut least, mut likeliest_s2) = (by_prior - LEAST_GAIN, prior_s2);
    for (cost, tried_s2) in costs.into_iter().zip(tried_s2).skip(1) {
        if let Some(cost) = cost.filter(|cost| *cost < least) {
            (least, likeliest_s2) = (cost, tried_s2);
        }
    }
    Ok(likeliest_s2)
}

/// Returns minus twice the logarithm of the marginal likelihood by each of some priors, less a constant; `None` where the normal
/// matrix is not positive definite.
fn minus_two_ln_likelihoods(
    tried: &[SlowPriors],
    normal: &ChainEquations,
    priors: &Priors,
    state: &StateVector,
    progress: &Progress,
) -> Result<Vec<Option<f64>>, Cancelled> {
    let precisions: Vec<Option<SlowPrecisions>> =
        tried.iter().map(|slow| SlowPrecisions::of_drive(slow, normal.drive())).collect();
    let mut likelihoods: Vec<Option<MarginalLikelihood<'_>>> = precisions
        .par_iter()
        .map(|slow| Some(MarginalLikelihood::new(slow.as_ref()?, normal, priors, state)))
        .collect();
    for chunk in normal.matrix.chunks() {
        progress.check()?;
        let rows = normal.matrix.rows(chunk.clone());
        likelihoods.par_iter_mut().for_each(|slot| {
            let Some(mut likelihood) = slot.take() else { return };
            let mut rows = chunk.clone().zip(rows.iter());
            let is_definite = rows.all(|(block, row)| likelihood.eliminate(row, block).is_some());
            *slot = is_definite.then_some(likelihood);
        });
    }
    Ok(likelihoods.into_iter().map(|likelihood| likelihood?.cost(normal, priors)).collect())
}

/// The marginal likelihood, as far as the chain has been eliminated.
struct MarginalLikelihood<'a> {
    slow_precisions: &'a SlowPrecisions,
    data_gradient: &'a ChainVector,
    slow: &'a [Slow],
    shape: RowShape,
    elimination: ChainElimination<'a>,
    /// Gradient of the next block and of the constants, after elimination of the blocks before.
    own: Slow,
    constants: Vec<f64>,
    /// The last term of (18).
    explained: f64,
    /// `sᵀ P_s s`.
    prior_square: f64,
}

impl<'a> MarginalLikelihood<'a> {
    fn new(
        slow_precisions: &'a SlowPrecisions,
        normal: &'a ChainEquations,
        priors: &Priors,
        state: &'a StateVector,
    ) -> Self {
        let (shape, data_gradient) = (chain_shape(&normal.drive().layout), &normal.gradient);
        let gradient = &data_gradient.constants + priors.gradient(&state.constants);
        let mut constants = gradient.as_slice().to_vec();
        constants.resize(shape.border, 0.0);
        let mut likelihood = Self {
            slow_precisions,
            data_gradient,
            slow: &state.slow,
            shape,
            elimination: ChainElimination::new(shape, slow_precisions),
            own: Slow::zeros(shape.size),
            constants,
            explained: 0.0,
            prior_square: 0.0,
        };
        likelihood.own = likelihood.gradient(0).unwrap_or_else(|| Slow::zeros(shape.size));
        likelihood
    }

    /// Gradient of a block's slow states; adds their prior square.
    fn gradient(&mut self, block: usize) -> Option<Slow> {
        let slow = self.slow.get(block)?;
        let prior_gradient = self.slow_precisions.multiply(self.slow, block);
        self.prior_square += slow.dot(&prior_gradient);
        Some(prior_gradient + &self.data_gradient.slow[block])
    }

    /// Eliminates the next block; `None` if it is not positive definite.
    fn eliminate(&mut self, row: &ChainRow, block: usize) -> Option<()> {
        let next = self.gradient(block + 1);
        let mut next = next.unwrap_or_else(|| Slow::zeros(self.shape.size));
        let rows = self.elimination.eliminate(row, block)?;
        let (own, after) = (self.own.as_mut_slice(), next.as_mut_slice());
        forward_substitute(rows, self.shape, own, after, &mut self.constants);
        self.explained += self.own.norm_squared();
        self.own = next;
        Some(())
    }

    /// Minus twice the logarithm of the likelihood, less a constant, once all blocks are eliminated.
    fn cost(self, normal: &ChainEquations, priors: &Priors) -> Option<f64> {
        let corner = &normal.matrix.constants;
        let (factor, ln_determinant) = self.elimination.constants(corner, &priors.information())?;
        let gradient = Constants::from_column_slice(&self.constants[..corner.ncols()]);
        let explained = self.explained + gradient.dot(&factor.solve(&gradient));
        Some(ln_determinant + self.prior_square - explained) // (18)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_on_the_grid_finds_the_minimum_and_asks_for_each_cost_once() {
        let mut asked = Vec::new();
        let costs = |cells: &[[usize; 2]]| {
            asked.extend_from_slice(cells);
            let cost =
                |[sigma, time]: &[usize; 2]| sigma.abs_diff(3) as f64 + time.abs_diff(0) as f64;
            Ok(cells.iter().map(cost).collect())
        };
        let mut search = GridSearch { counts: [5, 4], costs, known: Vec::new() };
        let by_sigma = search.descend([0, 1], 0).expect("not cancelled");
        assert_eq!(by_sigma, [3, 1]);
        assert_eq!(search.descend(by_sigma, 1).expect("not cancelled"), [3, 0]);
        let mut once = asked.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), asked.len(), "{asked:?}");
    }

    #[test]
    fn costs_that_are_all_infinite_end_a_search() {
        let costs = |cells: &[[usize; 2]]| Ok(vec![f64::INFINITY; cells.len()]);
        let mut search = GridSearch { counts: [5, 4], costs, known: Vec::new() };
        search.descend([2, 1], 0).expect("not cancelled");
    }
}
