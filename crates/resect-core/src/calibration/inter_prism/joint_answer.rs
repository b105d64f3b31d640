//! Evaluation of the joint estimate by method D: fit, minima and mirror twin on the corrected readings.

use super::mirror::Choice;
use super::published::{self, Published};
use super::used::Used;
use super::{
    CentredTriplets, FEWEST_TRIPLETS, Minimum, NormalEquations, PrismNetwork, basin, gross_errors,
    same_solution,
};
use crate::calibration::joint::JointEstimate;
use crate::calibration::{Basin, ResolvedBy, Verdict};
use crate::deployment::findings::answers::other_minimum_fits_better;
use crate::deployment::{ControlPointSet, Finding};
use crate::network::PerStation;

/// The published method's solution on the corrected readings, with the joint estimate as its answer.
pub struct JointAnswer {
    pub solution: Published,
    /// The corrected triplets that are kept.
    pub data: CentredTriplets,
    /// Times of the kept triplets (s); `None` if none is rejected.
    pub kept_s: Option<Vec<f64>>,
    /// Another minimum that is chosen on the corrected readings.
    pub fits_better: Option<Basin>,
}

impl JointAnswer {
    /// The mirror twin of the estimate, if neither the rig nor control points exclude it.
    pub fn undecided_twin(&self) -> Option<&Basin> {
        let Choice { answer, mirror, .. } = &self.solution.choice;
        let is_decided = matches!(mirror.resolved_by, ResolvedBy::Rig | ResolvedBy::ControlPoints);
        mirror.twin.as_ref().filter(|twin| !is_decided && twin.is_mirrored(answer))
    }

    /// Decides between the estimate and its twin, by the cost of the twin beyond that of the estimate (σ²); `None` leaves it open.
    pub fn decide(&mut self, twin: Basin, excess: Option<f64>) {
        let answer = self.solution.choice.answer.clone();
        self.fits_better = None;
        self.solution.choice = match excess {
            Some(excess) => Choice::of_likelihood(answer, twin, excess),
            None => Choice::undecided(answer, twin),
        };
    }

    /// The doubt that the joint estimate is the right minimum: the corrections exchanged answer and twin.
    pub fn doubt(&self) -> Option<(Verdict, Finding)> {
        self.fits_better
            .as_ref()
            .and(self.solution.choice.mirror.cost_ratio)
            .map(|cost_ratio| (Verdict::Ambiguous, other_minimum_fits_better(cost_ratio)))
    }
}

/// Solves the corrected readings by the published method, with the estimated distances.
///
/// The estimate has converged. A drive that does not determine the answer by itself has no other minimum to choose.
pub fn solve(
    estimate: &JointEstimate,
    (network, heights_m): (&PrismNetwork, Option<&PerStation<f64>>),
    control_points: &[ControlPointSet],
    used: &Used<'_>,
    is_determined_by_drive: bool,
) -> JointAnswer {
    let level = &estimate.station1_from_station;
    let (time_s, interval) = used.instants();
    let mut points_m = used.points_m();
    estimate.correct(&time_s, &interval, &mut points_m);
    let network = &network.with_estimates(estimate);
    // Gross outliers must not move the minima.
    let fitting = gross_errors::fitting_triplets(&points_m, level, network);
    let mut kept_s = None;
    if fitting.len() >= FEWEST_TRIPLETS {
        kept_s = Some(fitting.iter().map(|i| time_s[*i]).collect());
        points_m.iter_mut().for_each(|points| keep(points, &fitting));
    }
    let data = CentredTriplets::from_points(points_m, network);
    let mut solution = published::solve(heights_m, control_points, &data, None);
    let parameters = data.parameters(level);
    let normal = NormalEquations::at(&data, &parameters);
    solution.answer = Minimum { parameters, normal, converged: true, passes: 1 };
    let answer = basin(&data, &solution.answer);
    let other = solution.choice.answer.clone();
    let same = |basin: &Basin| same_solution(&basin.station1_from_station, level);
    if let Some(own) = solution.basins.iter_mut().find(|basin| same(basin)) {
        own.clone_from(&answer);
    }
    // Cost ratios are relative to the joint estimate's cost in all tables and sentences.
    if !is_determined_by_drive {
        solution.basins = vec![answer.clone()];
        solution.choice = Choice::of_control_points(answer);
        return JointAnswer { solution, data, kept_s, fits_better: None };
    }
    if same(&other) {
        solution.choice = solution.choice.with_answer(answer);
        return JointAnswer { solution, data, kept_s, fits_better: None };
    }
    solution.choice.mirror.cost_ratio = Some(other.mean_square_m2 / answer.mean_square_m2);
    solution.choice.mirror.twin = Some(other.clone());
    solution.choice.answer = answer;
    // These findings are about the other minimum.
    solution.choice.findings.clear();
    JointAnswer { solution, data, kept_s, fits_better: Some(other) }
}

/// Keeps the values at some indices, in their order.
fn keep<T: Copy>(values: &mut Vec<T>, indices: &[usize]) {
    for (to, from) in indices.iter().enumerate() {
        values[to] = values[*from];
    }
    values.truncate(indices.len());
}
