//! Sizes of an estimate's noise and drift by the likelihood of its errors.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::drift_sizes::DriftSizes;
use super::instruments::{Instruments, by_instruments};
use super::state::FitState;
use super::wandering_frame::{WanderingPass, pass};
use crate::estimates::matched_pose::MatchedPose;
use resect_core::statistics::sandwich;

/// Factors by which a size is changed in the search, the coarsest first.
/// Effect: the last one is the accuracy of the sizes, which σ follow by its root at most.
const FACTORS: [f64; 3] = [4.0, 2.0, 1.4];
/// Largest number of rounds of the search by each factor.
const MOST_ROUNDS: usize = 3;
/// Least decrease of the cost for which the search goes on. Textbook: 1 is half a standard deviation.
const LEAST_DECREASE: f64 = 0.5;
/// A slow wander of the clock is assumed if a clock without it costs more than this, and if it is larger than the second (s).
/// Effect: a smaller wander is the same as errors that last along the motion. Textbook: a further size has to gain 2 (Akaike's criterion).
const LEAST_GAIN_OF_WANDER: f64 = 2.0;
const LEAST_WANDER_S: f64 = 5e-3;
/// Standard deviation of the logarithm of a size a priori.
/// Effect: sizes that the errors do not show stay usual. Field: systems differ by a factor of ten.
const LN_SIGMA: f64 = 2.3;

/// Returns the sizes with the largest likelihood at the unknowns as they are, beginning with some sizes. Each of the samples counts.
pub fn search(
    usual: DriftSizes,
    mut sizes: DriftSizes,
    samples: &[Vec<MatchedPose>],
    state: &FitState,
    open: &[usize],
) -> DriftSizes {
    let cost = |sizes: &DriftSizes| {
        let unusual = sizes.ln_ratios(&usual).map(|ln| (ln / LN_SIGMA).powi(2));
        let of_samples: Vec<f64> = samples
            .par_iter()
            .map(|pairs| marginal_cost(&pass(pairs, state, sizes, None), state, open))
            .collect();
        of_samples.iter().sum::<f64>() + unusual.iter().sum::<f64>()
    };
    let mut least = cost(&sizes);
    for factor in FACTORS {
        for _ in 0..MOST_ROUNDS {
            let before = least;
            for index in 0..sizes.searched() {
                for factor in [factor, factor.recip()] {
                    let changed = sizes.changed(index, factor);
                    let now = if changed == sizes { f64::INFINITY } else { cost(&changed) };
                    if now < least {
                        (sizes, least) = (changed, now);
                        break;
                    }
                }
            }
            if before - least < LEAST_DECREASE {
                break;
            }
        }
    }
    // A drive has few independent values of a slow wander: one that gains nothing would only widen σ.
    let constant = sizes.without_slow_clock();
    let is_wandering =
        sizes.slow_clock_s > LEAST_WANDER_S && cost(&constant) - least > LEAST_GAIN_OF_WANDER;
    if is_wandering { sizes } else { constant }
}

/// Returns the cost with the unknowns integrated (restricted likelihood: Harville 1977).
fn marginal_cost(pass: &WanderingPass, state: &FitState, open: &[usize]) -> f64 {
    let root = Equations::of(pass, state, open).information.cholesky();
    pass.cost + root.map_or(f64::INFINITY, |root| root.ln_determinant())
}

/// Normal equations of the open unknowns, with their priors.
pub struct Equations {
    pub information: DMatrix<f64>,
    pub gradient: DVector<f64>,
    pub prior: DVector<f64>,
    /// Blocks of time, without priors.
    pub blocks: Vec<sandwich::Block>,
    pub instruments: Instruments,
    /// Transforms derivatives by the instruments.
    pub transform: DMatrix<f64>,
}

impl Equations {
    pub fn of(pass: &WanderingPass, state: &FitState, open: &[usize]) -> Self {
        let instruments = Instruments::of(open, state.is_turned_by_estimate);
        let (blocks, transform) = by_instruments(&pass.blocks, &instruments);
        let prior = state.prior_precision(open);
        let mut information = DMatrix::from_diagonal(&prior);
        let mut gradient = -prior.component_mul(&state.values(open));
        for block in &blocks {
            information += &block.information;
            gradient += &block.gradient;
        }
        Self { information, gradient, prior, blocks, transform, instruments }
    }
}
