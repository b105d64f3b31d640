//! The refined answer as an answer of its own: its fit, minima and mirror twin on the readings that it put right.

use super::published::{self, Published};
use super::{
    FEWEST_TRIPLETS, Minimum, NormalEquations, Refinement, basin, gross_errors, same_solution,
};
use crate::calibration::{Basin, Loss, PriorMethod, Verdict};
use crate::deployment::{ControlPointSet, Finding, Rig};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::pipeline::Triplets;

/// The refined answer with what is beside it.
pub struct RefinedAnswer {
    pub found: Published,
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
    triplets: &Triplets,
    loss: Loss,
) -> RefinedAnswer {
    let level = refined.station1_from_station.map(|transform| LevelTransform {
        translation_m: transform.translation_m,
        yaw_rad: transform.yaw_rad(),
    });
    let mut upright = refined.corrected(triplets);
    for station in 1..3 {
        let station1_from_upright = RigidTransform::from(level[station]);
        let upright_from_station =
            station1_from_upright.inverse().then_from(&refined.station1_from_station[station]);
        for point in &mut upright.points_m[station] {
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
        let fitting = gross_errors::fitting_triplets(&upright, &placed, &inter_prism_m);
        if fitting.len() >= FEWEST_TRIPLETS {
            upright = upright.select(&fitting);
            kept_s = Some(upright.time_s.clone());
        }
    }
    let mut found = published::solve(&rig, control_points, &upright, PriorMethod::ClosedForm);
    let parameters = found.data.parameters(&level);
    let normal = NormalEquations::at(&found.data, &parameters);
    // Whether the refinement itself converged is judged apart.
    found.answer = Minimum { parameters, normal, converged: true, passes: 1 };
    let answer = basin(&found.data, &found.answer);
    let other = std::mem::replace(&mut found.choice.answer, answer);
    let same = |basin: &Basin| same_solution(&basin.station1_from_station, &level);
    if let Some(own) = found.basins.iter_mut().find(|basin| same(basin)) {
        *own = answer;
    }
    if same(&other) || !refined.converged {
        return RefinedAnswer { found, kept_s, doubt: None };
    }
    found.choice.mirror.twin = Some(other);
    let finding = Finding::warning(
        "with all that was estimated taken into account another minimum fits better than this answer; nothing decides \
         between them",
    );
    RefinedAnswer { found, kept_s, doubt: Some((Verdict::Ambiguous, finding)) }
}
