//! The refined answer as an answer of its own: its fit, minima and mirror twin on the readings that it put right.

use super::published::{self, Published};
use super::used::Used;
use super::{
    CentredTriplets, FEWEST_TRIPLETS, Minimum, NormalEquations, Refinement, basin, gross_errors,
    same_solution,
};
use crate::calibration::{Basin, Loss, Verdict};
use crate::deployment::{ControlPointSet, Finding, Rig};
use crate::geometry::{LevelTransform, RigidTransform};

/// The refined answer with what is beside it.
pub struct RefinedAnswer {
    pub found: Published,
    /// The triplets that were put right and kept.
    pub data: CentredTriplets,
    /// Times of the triplets that it keeps (s), where it sets others aside that cannot be right.
    pub kept_s: Option<Vec<f64>>,
    pub doubt: Option<(Verdict, Finding)>,
}

/// What the published method finds on the triplets as the refinement puts them right (clocks, prism constant, tilts, and
/// its distances), with the refined transforms in the place of its answer.
///
/// A doubt where the two are not the same minimum: then what was estimated exchanges answer and twin.
pub fn solve(
    refined: &Refinement,
    rig: &Rig,
    control_points: &[ControlPointSet],
    used: &Used<'_>,
    loss: Loss,
) -> RefinedAnswer {
    let level = refined.station1_from_station.map(|transform| LevelTransform {
        translation_m: transform.translation_m,
        yaw_rad: transform.yaw_rad(),
    });
    let mut points_m = refined.corrected_points_m(used);
    for station in 1..3 {
        let station1_from_upright = RigidTransform::from(level[station]);
        let upright_from_station =
            station1_from_upright.inverse().then_from(&refined.station1_from_station[station]);
        for point in &mut points_m[station] {
            *point = upright_from_station.apply(point);
        }
    }
    let inter_prism_m =
        refined.distances_m.map_or(rig.inter_prism_m, |all| all.map(|distance| distance.value));
    let rig = Rig { inter_prism_m, ..rig.clone() };
    let mut kept_s = None;
    if loss != Loss::Squared {
        // What a robust loss sets aside must not lead the minima astray.
        let placed = level.map(RigidTransform::from);
        let fitting = gross_errors::fitting_triplets(&points_m, &placed, &inter_prism_m);
        if fitting.len() >= FEWEST_TRIPLETS {
            let (time_s, _) = used.instants();
            kept_s = Some(fitting.iter().map(|i| time_s[*i]).collect());
            points_m.iter_mut().for_each(|points| keep(points, &fitting));
        }
    }
    let data = CentredTriplets::from_points(points_m, inter_prism_m);
    let mut found = published::solve(&rig, control_points, &data, None);
    let parameters = data.parameters(&level);
    let normal = NormalEquations::at(&data, &parameters);
    // Whether the refinement itself converged is judged apart.
    found.answer = Minimum { parameters, normal, converged: true, passes: 1 };
    let answer = basin(&data, &found.answer);
    let other = found.choice.answer;
    let same = |basin: &Basin| same_solution(&basin.station1_from_station, &level);
    if let Some(own) = found.basins.iter_mut().find(|basin| same(basin)) {
        *own = answer;
    }
    // Costs over the answer's are over the refined answer's: they have to be the same in every table and sentence.
    if same(&other) || !refined.converged {
        found.choice = found.choice.with_answer(answer);
        return RefinedAnswer { found, data, kept_s, doubt: None };
    }
    found.choice.answer = answer;
    found.choice.mirror.twin = Some(other);
    found.choice.mirror.cost_ratio = Some(other.mean_square_m2 / answer.mean_square_m2);
    // What they say is about the other one.
    found.choice.findings.clear();
    let finding = Finding::warning(
        "with all that was estimated taken into account another minimum fits better than this answer; nothing decides \
         between them",
    );
    RefinedAnswer { found, data, kept_s, doubt: Some((Verdict::Ambiguous, finding)) }
}

/// Leaves some of the values, in their order.
fn keep<T: Copy>(values: &mut Vec<T>, indices: &[usize]) {
    for (to, from) in indices.iter().enumerate() {
        values[to] = values[*from];
    }
    values.truncate(indices.len());
}
