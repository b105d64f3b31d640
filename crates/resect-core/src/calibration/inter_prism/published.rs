//! The published solution: a prior, all minima, and the choice between the mirror twins.

use crate::deployment::findings::outliers::{prior_search_elsewhere, prior_search_unconfirmed};

use super::minima::{self, Minima, THINNED};
use super::mirror::{self, Choice};
use super::used::Used;
use super::{
    CentredTriplets, Minimum, Parameters, PriorSearch, SquaredCost, basin, closed_form_priors,
    prior_search, same_solution,
};
use crate::calibration::Basin;
use crate::deployment::{ControlPointSet, Finding};
use crate::network::PerStation;
use crate::stopwatch::Stopwatch;

/// Solution of the published method on some triplets.
#[derive(Clone)]
pub struct Published {
    pub thinned: CentredTriplets,
    /// The published answer on all of the data: the lowest minimum, or its mirror twin if that is the real one.
    pub answer: Minimum,
    pub choice: Choice,
    pub basins: Vec<Basin>,
    /// The best minimum other than the answer and its twin, and its cost over the lowest.
    pub rival: Option<(Parameters, f64)>,
    pub prior_search: Option<PriorSearch>,
    pub findings: Vec<Finding>,
    pub prior_ms: f64,
}

/// Solves by the published method, from the closed-form priors, and from a search of the prior if `search` has triplets for it.
///
/// `heights_m` are the heights of station 1's prism above that of each station by a reading of the rig (m).
pub fn solve(
    heights_m: Option<&PerStation<f64>>,
    control_points: &[ControlPointSet],
    data: &CentredTriplets,
    search: Option<&Used<'_>>,
) -> Published {
    let started = Stopwatch::start();
    let mut findings = Vec::new();
    let thinned = data.thinned(THINNED);
    let squared = SquaredCost::of(&thinned);
    let mut prior_search = None;
    let priors = match search {
        None => closed_form_priors(&squared),
        Some(used) => {
            let search = prior_search::search(&used.triplets(), &data.network);
            if !search.agreed {
                findings.push(prior_search_unconfirmed());
            }
            let mut priors = vec![data.parameters(&search.chosen)];
            // A failed search must not decide alone.
            priors.extend(closed_form_priors(&squared));
            prior_search = Some(search);
            priors
        }
    };
    let prior_ms = started.elapsed_ms();
    let minima = minima::find(data, &thinned, &squared, &priors);
    let basins = minima.basins(data);
    let Minima { lowest, twin, others } = minima;
    let choice = mirror::choose(
        heights_m,
        control_points,
        basin(data, &lowest),
        twin.as_ref().map(|twin| basin(data, twin)),
    );
    let answer = match twin {
        Some(twin) if choice.twin_is_real => twin,
        _ => lowest,
    };
    findings.extend(prior_search.as_ref().and_then(|search| astray(search, &choice)));
    let rival = others.first().cloned();
    Published { thinned, answer, choice, basins, rival, prior_search, findings, prior_ms }
}

/// Returns the finding that the search of the prior converged to another minimum.
fn astray(search: &PriorSearch, choice: &Choice) -> Option<Finding> {
    let answer = &choice.answer.station1_from_station;
    if same_solution(&search.chosen, answer) {
        return None;
    }
    let apart_m = search
        .chosen
        .iter()
        .zip(answer)
        .map(|(chosen, answer)| (chosen.translation_m - answer.translation_m).norm())
        .fold(0.0, f64::max);
    Some(prior_search_elsewhere(apart_m))
}
