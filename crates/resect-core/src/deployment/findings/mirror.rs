//! Findings about the mirror twin of an answer.

use crate::deployment::kinds;
use crate::deployment::{Finding, Remedy, Unit};

pub fn mirror_same_height() -> Finding {
    Finding::new(
        kinds::MIRROR_SAME_HEIGHT,
        "the prisms are at the same height, so the mirrored solution is the answer itself",
    )
}

pub fn mirror_ruled_out() -> Finding {
    Finding::new(
        kinds::MIRROR_RULED_OUT,
        "no mirror ambiguity: pitch and roll exclude the mirrored solution",
    )
}

/// The evidence that decides between the answer and its twin.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum MirrorWitness {
    Rig,
    ControlPoints,
    Cost,
    Nothing,
}

/// A mirror twin with its difference in height and its cost over that of the answer. `is_contradicted` is true if the cost
/// clearly contradicts the evidence.
pub fn mirror_twin(
    witness: MirrorWitness,
    apart_m: f64,
    cost_ratio: f64,
    is_contradicted: bool,
) -> Finding {
    let (kind, decision) = match witness {
        MirrorWitness::Rig => {
            (kinds::MIRROR_RESOLVED_BY_RIG, "decided by the rig (which prism is higher)")
        }
        MirrorWitness::ControlPoints => {
            (kinds::MIRROR_RESOLVED_BY_CONTROL_POINTS, "decided by the control points")
        }
        MirrorWitness::Cost => (kinds::MIRROR_RESOLVED_BY_COST, "decided by the cost"),
        MirrorWitness::Nothing => (kinds::MIRROR_UNRESOLVED, "not resolved"),
    };
    let kind = if is_contradicted { kinds::MIRROR_UNRESOLVED } else { kind };
    Finding::new(
        kind,
        if cost_ratio < 1.0 {
            format!(
                "mirror ambiguity {decision}, although the mirrored solution, {apart_m:.2} m away in height, fits better \
                 ({cost_ratio:.2} times the cost)"
            )
        } else {
            format!(
                "mirror ambiguity {decision}: the mirrored solution, {apart_m:.2} m away in height, has {cost_ratio:.2} times \
                 the cost"
            )
        },
    )
    .quantity("apart", apart_m, Unit::Metre)
    .quantity("cost_ratio", cost_ratio, Unit::Ratio)
}

/// A mirror twin with its difference in height, whose χ² of all readings is larger than that of the answer by `excess`; infinite without a
/// minimum.
pub fn mirror_by_likelihood(apart_m: f64, excess: f64) -> Finding {
    let twin = format!("the mirrored solution, {apart_m:.2} m away in height,");
    let message = if excess.is_finite() {
        format!(
            "mirror ambiguity decided by all readings: with {twin} their χ² is {excess:.0} larger"
        )
    } else {
        format!(
            "mirror ambiguity decided by all readings: from {twin} they lead back to the answer"
        )
    };
    let finding = Finding::new(kinds::MIRROR_RESOLVED_BY_LIKELIHOOD, message);
    let finding = finding.quantity("apart", apart_m, Unit::Metre);
    if excess.is_finite() {
        finding.quantity("chi_square_excess", excess, Unit::Ratio)
    } else {
        finding
    }
}

/// `witness` is the name of the evidence.
pub fn mirror_witness_contradicted(witness: &str) -> Finding {
    Finding::new(
        kinds::MIRROR_WITNESS_CONTRADICTED,
        format!(
            "the {witness} and the cost clearly contradict each other about the mirrored solution; check the order of the prisms"
        ),
    )
    .with(Remedy::Corrections)
}

pub fn mirror_needs_witness() -> Finding {
    Finding::new(
        kinds::MIRROR_NEEDS_WITNESS,
        "to resolve the mirror ambiguity, add calibration_raw.csv (heights of the prisms) or control points, or drive over \
         uneven ground",
    )
    .with(Remedy::GiveRig)
    .with(Remedy::GiveControlPoints)
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        mirror_same_height(),
        mirror_ruled_out(),
        mirror_twin(MirrorWitness::Rig, 0.4, 1.2, false),
        mirror_twin(MirrorWitness::ControlPoints, 0.4, 1.2, false),
        mirror_twin(MirrorWitness::Cost, 0.4, 4.2, false),
        mirror_twin(MirrorWitness::Nothing, 0.4, 1.2, false),
        mirror_twin(MirrorWitness::Rig, 0.4, 0.1, true),
        mirror_by_likelihood(0.4, 1093.6),
        mirror_by_likelihood(0.4, f64::INFINITY),
        mirror_witness_contradicted("rig"),
        mirror_needs_witness(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirrored_solution_that_fits_better_is_named_as_such() {
        let message =
            |cost_ratio| mirror_twin(MirrorWitness::Rig, 0.73, cost_ratio, false).to_string();
        assert!(
            message(0.39)
                .contains("although the mirrored solution, 0.73 m away in height, fits better")
        );
        assert!(message(2.76).ends_with("has 2.76 times the cost"));
    }
}
