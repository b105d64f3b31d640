//! How likely the data is by what may be known of slow changes beforehand: how far ranges wander, and clocks walk.
//!
//! The chain is eliminated by several priors side by side, some parts at a time; of none more than one part's rows are there.

use rayon::prelude::*;

use super::chain::{Block, Columns, Linear};
use super::chain_rows::{Elimination, forward};
use super::drive::Drive;
use super::pass::{Estimates, Model, pulled_constants};
use super::slow_priors::{SlowPrecisions, SlowPriors, Wander};
use super::unknowns::{CONSTANTS, Constants, SLOW, Slow};
use crate::progress::{Cancelled, Progress};

/// Wanderings of ranges that are tried.
pub const WANDER_SIGMAS_M: [f64; 7] = [1e-4, 4e-4, 8e-4, 0.0014, 0.0025, 0.0045, 0.008];
pub const WANDER_TIMES_S: [f64; 3] = [3.0, 12.0, 50.0];
/// How many times the variance that was known beforehand clocks may walk: up to 6 ms in a drive, as those do that a time
/// server steers. By chance twice the logarithm of the likelihood gains no more than this.
const CLOCKS_WALK_MORE: [f64; 3] = [10.0, 100.0, 1000.0];
const LEAST_GAIN: f64 = 4.0;

/// The wandering of ranges that makes what was read likeliest, the motion being what it is.
pub fn likeliest(
    linear: &Linear,
    model: &Model,
    drive: &Drive,
    at: &Estimates,
    progress: &Progress,
) -> Result<Wander, Cancelled> {
    let best = |all: &[Wander], otherwise: Wander| {
        let priors = |wander: &Wander| SlowPriors { wander: *wander, ..model.priors.clone() };
        let priors: Vec<SlowPriors> = all.iter().map(priors).collect();
        let found = unlikeliness(&priors, linear, model, drive, at, progress)?;
        let likely = found.iter().zip(all).filter_map(|(found, wander)| Some(((*found)?, *wander)));
        let best = likely.min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(best.map_or(otherwise, |(_, wander)| wander))
    };
    let now = model.priors.wander;
    let first = best(&WANDER_SIGMAS_M.map(|sigma_m| Wander { sigma_m, ..now }), now)?;
    // What hardly wanders tells no time.
    if first.sigma_m == WANDER_SIGMAS_M[0] {
        return Ok(first);
    }
    best(&WANDER_TIMES_S.map(|correlation_s| Wander { correlation_s, ..first }), first)
}

/// The variance of how far clocks walk that makes what was read likeliest (s²), the motion being what it is; the one that
/// was known beforehand, unless the data speaks against it.
pub fn likeliest_clocks_s2(
    linear: &Linear,
    model: &Model,
    drive: &Drive,
    at: &Estimates,
    progress: &Progress,
) -> Result<f64, Cancelled> {
    let known_s2 = model.priors.clocks_s2;
    let mut tried_s2 = vec![known_s2];
    tried_s2.extend(CLOCKS_WALK_MORE.map(|more| more * known_s2));
    let priors = |clocks_s2: &f64| SlowPriors { clocks_s2: *clocks_s2, ..model.priors.clone() };
    let priors: Vec<SlowPriors> = tried_s2.iter().map(priors).collect();
    let found = unlikeliness(&priors, linear, model, drive, at, progress)?;
    let Some(as_known) = found[0] else { return Ok(known_s2) };
    let (mut least, mut likeliest_s2) = (as_known - LEAST_GAIN, known_s2);
    for (found, tried_s2) in found.into_iter().zip(tried_s2).skip(1) {
        if let Some(found) = found.filter(|found| *found < least) {
            (least, likeliest_s2) = (found, tried_s2);
        }
    }
    Ok(likeliest_s2)
}

/// Twice the negative logarithm of how likely the data is by each of some priors, but for what is the same by all; `None`
/// where one leaves a direction free.
fn unlikeliness(
    all: &[SlowPriors],
    linear: &Linear,
    model: &Model,
    drive: &Drive,
    at: &Estimates,
    progress: &Progress,
) -> Result<Vec<Option<f64>>, Cancelled> {
    let precisions: Vec<Option<SlowPrecisions>> =
        all.iter().map(|priors| SlowPrecisions::new(priors, &drive.part_times_s)).collect();
    let mut likelihoods: Vec<Option<Likelihood<'_>>> = precisions
        .par_iter()
        .map(|priors| Some(Likelihood::new(priors.as_ref()?, &linear.gradient, model, at)))
        .collect();
    for some in linear.data.chunks() {
        progress.check()?;
        let blocks = linear.data.blocks(some.clone());
        likelihoods.par_iter_mut().for_each(|likelihood| {
            let all = some.clone().zip(blocks.iter());
            let go_on = |one: &mut Likelihood<'_>| {
                all.into_iter().all(|(part, block)| one.eliminate(block, part).is_some())
            };
            *likelihood = likelihood.take().and_then(|mut one| go_on(&mut one).then_some(one));
        });
    }
    let found = |one: Option<Likelihood<'_>>| one?.found(linear, model);
    Ok(likelihoods.into_iter().map(found).collect())
}

/// How likely the data is by some priors, as far as the chain has been eliminated.
struct Likelihood<'a> {
    priors: &'a SlowPrecisions,
    of_data: &'a Columns<1>,
    slow: &'a [Slow],
    elimination: Elimination<'a>,
    /// The gradient of the part that comes next, and of the constants, less what the parts before it took.
    own: [[f64; 1]; SLOW],
    constants: [[f64; 1]; CONSTANTS],
    /// `gᵀH⁻¹g` of the gradient g with the normal matrix H of data and priors.
    explained: f64,
    /// The square of the slow states by the priors.
    held: f64,
}

impl<'a> Likelihood<'a> {
    fn new(
        priors: &'a SlowPrecisions,
        of_data: &'a Columns<1>,
        model: &Model,
        at: &'a Estimates,
    ) -> Self {
        let constants = of_data.constants + pulled_constants(model, at);
        let mut begun = Self {
            priors,
            of_data,
            slow: &at.slow,
            elimination: Elimination::new(priors),
            own: [[0.0]; SLOW],
            constants: constants.transpose().data.0,
            explained: 0.0,
            held: 0.0,
        };
        begun.own = begun.gradient(0).unwrap_or([[0.0]; SLOW]);
        begun
    }

    /// The gradient of a part's slow states.
    fn gradient(&mut self, part: usize) -> Option<[[f64; 1]; SLOW]> {
        let slow = self.slow.get(part)?;
        let pull = self.priors.pull(self.slow, part);
        self.held += slow.dot(&pull);
        Some((self.of_data.slow[part] + pull).transpose().data.0)
    }

    /// Eliminates the next part; `None` where a direction stays free.
    fn eliminate(&mut self, block: &Block, part: usize) -> Option<()> {
        let mut next = self.gradient(part + 1);
        let rows = self.elimination.eliminate(block, part)?;
        forward(rows, &mut self.own, next.as_mut(), &mut self.constants);
        self.explained += self.own.iter().map(|[value]| value * value).sum::<f64>();
        self.own = next.unwrap_or(self.own);
        Some(())
    }

    fn found(self, linear: &Linear, model: &Model) -> Option<f64> {
        let by_data = &linear.data.constants;
        let (constants, log_determinant) = self.elimination.constants(by_data, &model.precision)?;
        let rest = Constants::from_column_slice(self.constants.as_flattened());
        let explained = self.explained + rest.dot(&constants.solve(&rest));
        Some(log_determinant + self.held - explained)
    }
}
