//! Findings about the mirror twin of an answer.

use crate::deployment::{Finding, FindingKind, Remedy, Unit};

pub fn mirror_same_height() -> Finding {
    Finding::new(
        FindingKind::MirrorSameHeight,
        "the prisms stand at the same height, so the mirror twin is the answer itself",
    )
}

pub fn mirror_ruled_out() -> Finding {
    Finding::new(
        FindingKind::MirrorRuledOut,
        "the mirror twin is no minimum of its own here: pitch and roll rule it out",
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

/// A mirror twin with its distance in height and its cost over that of the answer; `is_contradicted` where the cost says
/// clearly the opposite.
pub fn mirror_twin(
    witness: MirrorWitness,
    apart_m: f64,
    cost_ratio: f64,
    is_contradicted: bool,
) -> Finding {
    let (kind, decision) = match witness {
        MirrorWitness::Rig => {
            (FindingKind::MirrorResolvedByRig, "the rig decides (which prism stands higher)")
        }
        MirrorWitness::ControlPoints => {
            (FindingKind::MirrorResolvedByControlPoints, "the control points decide")
        }
        MirrorWitness::Cost => (FindingKind::MirrorResolvedByCost, "the cost decides"),
        MirrorWitness::Nothing => (FindingKind::MirrorUnresolved, "nothing decides between them"),
    };
    let kind = if is_contradicted { FindingKind::MirrorUnresolved } else { kind };
    Finding::new(
        kind,
        format!(
            "a mirror twin {apart_m:.2} m away in height costs {cost_ratio:.2} times the answer; {decision}"
        ),
    )
    .quantity("apart", apart_m, Unit::Metre)
    .quantity("cost_ratio", cost_ratio, Unit::Ratio)
}

/// `witness` is its name.
pub fn mirror_witness_contradicted(witness: &str) -> Finding {
    Finding::new(
        FindingKind::MirrorWitnessContradicted,
        format!(
            "the {witness} says one solution, the cost clearly the other; check the order of the prisms"
        ),
    )
    .with(Remedy::PutRight)
}

pub fn mirror_needs_witness() -> Finding {
    Finding::new(
        FindingKind::MirrorNeedsWitness,
        "to tell the twins apart, add calibration_raw.csv (heights of the prisms) or control points, or drive over uneven \
         ground",
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
        mirror_witness_contradicted("rig"),
        mirror_needs_witness(),
    ]
}
