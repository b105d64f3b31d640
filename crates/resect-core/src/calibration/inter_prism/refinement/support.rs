//! Whether the data asks for what was estimated.

use nalgebra::DVector;

use super::model::{CLOCKS, DISTANCES, DRIFTS, Matrix, State, TILTS, reduced};
use crate::calibration::Estimated;

/// Whether the data asks for a group of unknowns: Wald's test of their being what they are without estimating them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    pub what: &'static str,
    /// Squared distance of the unknowns from that, in units of their covariance: on average their number, if there is
    /// nothing to them.
    pub chi_square: f64,
    pub unknowns: usize,
    /// Whether that is larger than chance makes it once in a hundred times.
    pub supported: bool,
}

/// 99 % of χ² with one to six degrees of freedom.
const CHI_SQUARE_99: [f64; 6] = [6.635, 9.210, 11.345, 13.277, 15.086, 16.812];

/// What supports each group of unknowns that was estimated.
pub fn support(
    state: &State,
    start: &State,
    covariance: &Matrix,
    chosen: Estimated,
) -> Vec<Support> {
    let groups: [(bool, &str, &[usize]); 4] = [
        (chosen.clocks, "clock offsets", &[CLOCKS, CLOCKS + 1]),
        (chosen.clocks, "clock drifts", &[DRIFTS, DRIFTS + 1]),
        (chosen.distances, "inter-prism distances", &[DISTANCES, DISTANCES + 1, DISTANCES + 2]),
        (chosen.tilt, "tilts", &[TILTS, TILTS + 1, TILTS + 2, TILTS + 3]),
    ];
    let wald = |what: &'static str, places: &[usize]| {
        let off =
            DVector::from_iterator(places.len(), places.iter().map(|p| state[*p] - start[*p]));
        let solved = reduced(covariance, places).cholesky()?.solve(&off);
        let (chi_square, unknowns) = (off.dot(&solved), places.len());
        let supported = chi_square > CHI_SQUARE_99[unknowns - 1];
        Some(Support { what, chi_square, unknowns, supported })
    };
    groups.into_iter().filter(|g| g.0).filter_map(|(_, what, places)| wald(what, places)).collect()
}
