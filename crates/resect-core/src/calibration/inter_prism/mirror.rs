//! Choice between an answer and its mirror twin.
//!
//! On level ground all distances stay the same when the prisms of the other stations are mirrored in the horizontal plane through
//! station 1's prism. The stations then move vertically by twice the height difference. The heights of the prisms on the rig or control
//! points exclude one of the two. If the vehicle pitched and rolled, the cost excludes it.

use super::basin::heights_apart_m;
use crate::calibration::misfits::control_points_apart_m;
use crate::calibration::{Basin, Mirror, ResolvedBy};
use crate::deployment::findings::mirror::{
    MirrorWitness, mirror_by_likelihood, mirror_needs_witness, mirror_ruled_out,
    mirror_same_height, mirror_twin, mirror_witness_contradicted,
};
use crate::deployment::{ControlPointSet, Finding};
use crate::geometry::RigidTransform;
use crate::network::PerStation;

/// Cost ratio from which the cost alone decides: a clock offset or a wrong distance can change a ratio by tens of per cent.
pub const DECISIVE_COST_RATIO: f64 = 2.0;
/// Cost ratio from which the cost contradicts other data, so that the answer is ambiguous.
const CONTRADICTING_COST_RATIO: f64 = 3.0;
/// Prisms with a smaller height difference (m) have no significant twin.
const LEVEL_RIG_M: f64 = 1e-3;
/// Ratio of the misfits to heights or control points from which these decide.
const DECISIVE_FIT_RATIO: f64 = 2.0;

/// The chosen answer, with its reasons.
#[derive(Clone)]
pub struct Choice {
    pub answer: Basin,
    /// True if the answer is the twin, not the lowest minimum.
    pub twin_is_real: bool,
    pub mirror: Mirror,
    pub findings: Vec<Finding>,
    /// True if two kinds of data contradict each other, or none decides.
    pub ambiguous: bool,
}

impl Choice {
    /// The choice of control points that determine the answer where the drive does not, so that it has no separate minima.
    pub fn of_control_points(answer: Basin) -> Self {
        let resolved_by = ResolvedBy::ControlPoints;
        let mirror = Mirror { twin: None, cost_ratio: None, resolved_by };
        Self { answer, twin_is_real: false, mirror, findings: Vec::new(), ambiguous: false }
    }

    /// The choice of a joint estimate that fits all readings better than its twin, by so much (σ²).
    pub fn of_likelihood(answer: Basin, twin: Basin, excess: f64) -> Self {
        let apart_m = heights_apart_m(&answer.station1_from_station, &twin.station1_from_station);
        let findings = vec![mirror_by_likelihood(apart_m, excess)];
        let cost_ratio = Some(twin.mean_square_m2 / answer.mean_square_m2);
        let mirror = Mirror { twin: Some(twin), cost_ratio, resolved_by: ResolvedBy::Likelihood };
        Self { answer, twin_is_real: false, mirror, findings, ambiguous: false }
    }

    /// The choice of an answer whose twin nothing excludes.
    pub fn undecided(answer: Basin, twin: Basin) -> Self {
        between(ResolvedBy::Nothing, false, answer, twin)
    }

    /// Returns the same choice with another fit of its answer, to whose cost the ratios then refer.
    pub fn with_answer(self, answer: Basin) -> Self {
        let Some(twin) = self.mirror.twin else { return Self { answer, ..self } };
        let witness = match self.mirror.resolved_by {
            ResolvedBy::Cost if !is_decisive(&answer, &twin) => ResolvedBy::Nothing,
            witness => witness,
        };
        between(witness, self.twin_is_real, answer, twin)
    }
}

/// Chooses between the lowest minimum and its twin.
///
/// `heights_m` are the heights of station 1's prism above that of each station by a reading of the rig (m).
pub fn choose(
    heights_m: Option<&PerStation<f64>>,
    control_points: &[ControlPointSet],
    lowest: Basin,
    twin: Option<Basin>,
) -> Choice {
    let Some(twin) = twin else {
        let heights_m = lowest.height_differences_m.iter().copied();
        let height_m = heights_m.map(f64::abs).fold(0.0, f64::max);
        let (resolved_by, finding) = if height_m < LEVEL_RIG_M {
            (ResolvedBy::Nothing, mirror_same_height())
        } else {
            (ResolvedBy::Cost, mirror_ruled_out())
        };
        let mirror = Mirror { twin: None, cost_ratio: None, resolved_by };
        let findings = vec![finding];
        return Choice { answer: lowest, twin_is_real: false, mirror, findings, ambiguous: false };
    };
    let (witness, twin_is_real) = if let Some(decided) = by_rig(heights_m, &lowest, &twin) {
        (ResolvedBy::Rig, decided)
    } else if let Some(decided) = by_control_points(control_points, &lowest, &twin) {
        (ResolvedBy::ControlPoints, decided)
    } else if is_decisive(&lowest, &twin) {
        (ResolvedBy::Cost, false)
    } else {
        (ResolvedBy::Nothing, twin.mean_square_m2 < lowest.mean_square_m2)
    };
    let (answer, other) = if twin_is_real { (twin, lowest) } else { (lowest, twin) };
    between(witness, twin_is_real, answer, other)
}

/// Returns true if the cost alone decides.
fn is_decisive(answer: &Basin, twin: &Basin) -> bool {
    twin.mean_square_m2 >= DECISIVE_COST_RATIO * answer.mean_square_m2
}

/// Returns the choice that a kind of data made, with its findings.
fn between(witness: ResolvedBy, twin_is_real: bool, answer: Basin, other: Basin) -> Choice {
    let cost_ratio = other.mean_square_m2 / answer.mean_square_m2;
    let apart_m = heights_apart_m(&answer.station1_from_station, &other.station1_from_station);
    let decisive = match witness {
        ResolvedBy::Rig => MirrorWitness::Rig,
        ResolvedBy::ControlPoints => MirrorWitness::ControlPoints,
        ResolvedBy::Cost | ResolvedBy::Likelihood => MirrorWitness::Cost,
        ResolvedBy::Nothing => MirrorWitness::Nothing,
    };
    let contradicted = cost_ratio < 1.0 / CONTRADICTING_COST_RATIO;
    let ambiguous = witness == ResolvedBy::Nothing || contradicted;
    let mut findings = vec![mirror_twin(decisive, apart_m, cost_ratio, contradicted)];
    if contradicted {
        findings.push(mirror_witness_contradicted(witness.name().unwrap_or("witness")));
    } else if ambiguous {
        findings.push(mirror_needs_witness());
    }
    let mirror = Mirror { twin: Some(other), cost_ratio: Some(cost_ratio), resolved_by: witness };
    Choice { answer, twin_is_real, mirror, findings, ambiguous }
}

/// Returns true if the rig's heights fit the twin better, false if the lowest minimum; `None` if undecided.
fn by_rig(heights_m: Option<&PerStation<f64>>, lowest: &Basin, twin: &Basin) -> Option<bool> {
    let heights_m = heights_m?;
    let misfit = |basin: &Basin| {
        let both = basin.height_differences_m.iter().zip(heights_m);
        both.map(|(found, measured)| (found - measured).powi(2)).sum::<f64>().sqrt()
    };
    better(misfit(lowest), misfit(twin))
}

/// Returns true if the control points fit the twin better, false if the lowest minimum; `None` if undecided.
fn by_control_points(
    control_points: &[ControlPointSet],
    lowest: &Basin,
    twin: &Basin,
) -> Option<bool> {
    let misfit = |basin: &Basin| {
        let transforms = basin.station1_from_station.map(|level| RigidTransform::from(*level));
        control_points_apart_m(control_points, &transforms)
    };
    better(misfit(lowest)?, misfit(twin)?)
}

fn better(lowest: f64, twin: f64) -> Option<bool> {
    if twin > DECISIVE_FIT_RATIO * lowest {
        Some(false)
    } else if lowest > DECISIVE_FIT_RATIO * twin {
        Some(true)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::LevelTransform;
    use crate::network::{Number, Station};

    fn basin(height_m: f64, mean_square_m2: f64) -> Basin {
        Basin {
            station1_from_station: [LevelTransform::IDENTITY; 3].into(),
            mean_square_m2,
            height_differences_m: [0.0, height_m, height_m].into(),
        }
    }

    /// Heights of a rig whose prism 1 is this high above both others.
    fn heights(prism1_above_m: f64) -> PerStation<f64> {
        [0.0, prism1_above_m, prism1_above_m].into()
    }

    #[test]
    fn the_rig_overrules_a_slightly_lower_cost() {
        let choice = choose(Some(&heights(0.4)), &[], basin(-0.38, 1.0), Some(basin(0.38, 1.3)));
        assert_eq!(choice.mirror.resolved_by, ResolvedBy::Rig);
        assert_eq!(choice.answer.height_differences_m[Station::at(1)], 0.38);
        assert!(!choice.ambiguous);
    }

    #[test]
    fn the_rig_against_a_clear_cost_is_ambiguous() {
        let choice = choose(Some(&heights(0.4)), &[], basin(-0.38, 1.0), Some(basin(0.38, 9.0)));
        assert!(choice.ambiguous);
    }

    #[test]
    fn without_a_witness_equal_costs_stay_ambiguous_and_unequal_ones_decide() {
        let choice = choose(None, &[], basin(0.4, 1.0), Some(basin(-0.4, 1.1)));
        assert_eq!(choice.mirror.resolved_by, ResolvedBy::Nothing);
        assert!(choice.ambiguous);
        let choice = choose(None, &[], basin(0.4, 1.0), Some(basin(-0.4, 4.0)));
        assert_eq!(choice.mirror.resolved_by, ResolvedBy::Cost);
        assert!(!choice.ambiguous);
    }

    #[test]
    fn a_corrected_answer_is_what_the_twin_is_compared_with() {
        let choice = choose(None, &[], basin(0.4, 1.0), Some(basin(-0.4, 8.0)));
        let corrected = choice.with_answer(basin(0.41, 2.0));
        assert_eq!(corrected.mirror.cost_ratio, Some(4.0));
        assert_eq!(corrected.findings[0].value("cost_ratio"), Some(4.0));
        let fits_as_badly = corrected.with_answer(basin(0.41, 5.0));
        assert_eq!(fits_as_badly.mirror.resolved_by, ResolvedBy::Nothing);
        assert!(fits_as_badly.ambiguous);
    }

    #[test]
    fn a_flat_rig_is_no_witness() {
        let choice = choose(Some(&heights(0.0)), &[], basin(0.1, 1.0), Some(basin(-0.1, 1.1)));
        assert_eq!(choice.mirror.resolved_by, ResolvedBy::Nothing);
    }
}
