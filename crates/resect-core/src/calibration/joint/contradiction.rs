//! Errors that were said to be smaller than those of instruments in the field, where the data says otherwise.
//!
//! Who sets the size of an error to nothing says that there is none. An estimate that is told so cannot find it, and
//! [`super::strain`] cannot see it: the prior leaves nothing to be moved. So it is asked what the data would say if the sizes
//! were the usual ones, which takes one more solution of the same equations (a score test: Rao 1948).

use nalgebra::SMatrix;

use super::chain_factor::Factor;
use super::pass::{Estimates, Model, Pass, with_priors};
use super::strain::LEAST_TOLD;
use super::unknowns::{CLOCKS, CONSTANTS, Constants, precisions};
use crate::calibration::{ErrorSizes, Estimate};

/// An error of which the data says more than was said to be there.
#[derive(Clone, Debug, PartialEq)]
pub struct Contradiction {
    /// The error's place among the constants.
    pub place: usize,
    /// What the data alone says of it.
    pub found: Estimate,
    /// How far that is from what was said (σ of both).
    pub sigmas: f64,
}

impl<const LOCAL: usize, const ROW: usize> Pass<LOCAL, ROW> {
    /// How far the data is from all that was said to be smaller than usual; nothing of what it could not tell anyway.
    pub fn contradictions(&self, model: &Model, at: &Estimates) -> Vec<Contradiction> {
        let usual = precisions(&ErrorSizes::default());
        let looser = model.precision.zip_map(&usual, f64::min);
        if looser == model.precision {
            return Vec::new();
        }
        let loose = Model { precision: looser, start: model.start, priors: model.priors.clone() };
        let right = with_priors(&self.linear, &loose, &self.slow_priors, at);
        let found = Factor::new(&self.linear.data, &looser, &self.slow_priors, right);
        let Some((factor, step)) = found else { return Vec::new() };
        let moved = at.constants - step.constants - model.start;
        let said = &model.precision;
        (CLOCKS..CONSTANTS)
            .filter(|place| looser[*place] < said[*place])
            .filter_map(|place| contradiction(place, &moved, &factor.of_constants(), &looser, said))
            .collect()
    }
}

/// `moved` and `covariance` are by the looser prior.
fn contradiction(
    place: usize,
    moved: &Constants,
    covariance: &SMatrix<f64, CONSTANTS, CONSTANTS>,
    looser: &Constants,
    said: &Constants,
) -> Option<Contradiction> {
    let told = 1.0 - covariance[(place, place)] * looser[place];
    if told < LEAST_TOLD {
        return None;
    }
    // Without that prior.
    let value = moved[place] / told;
    let variance = covariance[(place, place)] / told;
    let sigmas = value / (variance + said[place].recip()).sqrt();
    Some(Contradiction { place, found: Estimate { value, sigma: variance.sqrt() }, sigmas })
}

#[cfg(test)]
mod tests {
    use super::super::unknowns::INDICES;
    use super::*;

    /// A usual prior of variance 4 and a reading of 10 with variance 4, where a variance of 5 was said.
    #[test]
    fn what_was_said_is_held_against_the_data_alone() {
        let (mut looser, mut said) = (Constants::zeros(), Constants::zeros());
        (looser[INDICES], said[INDICES]) = (0.25, 0.2);
        let mut covariance = SMatrix::zeros();
        covariance[(INDICES, INDICES)] = 2.0;
        let mut moved = Constants::zeros();
        moved[INDICES] = 5.0;
        let found = contradiction(INDICES, &moved, &covariance, &looser, &said).expect("told");
        assert!((found.found.value - 10.0).abs() < 1e-12);
        assert!((found.found.sigma - 2.0).abs() < 1e-12);
        assert!((found.sigmas - 10.0 / 3.0).abs() < 1e-12);
    }
}
