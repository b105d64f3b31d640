//! Findings of a validation: limits of the comparison of two runs.

use crate::findings::kinds;
use resect_core::deployment::{Finding, Subject, Unit};
use resect_core::network::{Number, Pair};

/// `verdict` is that of the earlier calibration, with its reason.
pub fn earlier_calibration_weak(verdict: &str) -> Finding {
    Finding::new(kinds::EARLIER_CALIBRATION_WEAK, format!("the earlier calibration is {verdict}"))
}

/// `which` of the two calibrations, and its method for people.
pub fn compared_without_joint_estimate(which: &str, method: &str) -> Finding {
    Finding::new(
        kinds::COMPARED_WITHOUT_JOINT_ESTIMATE,
        format!(
            "the {which} is by {method}, not by the joint estimate: errors that its σ omits look like a movement"
        ),
    )
    .about(Subject::Named(which.to_owned()))
}

pub fn compared_in_unknown_frame() -> Finding {
    Finding::new(
        kinds::COMPARED_IN_UNKNOWN_FRAME,
        "the tracks of both runs were transformed into one frame by unknown transforms: a difference of these transforms looks \
         like a movement",
    )
}

pub fn rig_differs_from_earlier(pair: usize, before_m: f64, now_m: f64) -> Finding {
    Finding::new(
        kinds::RIG_DIFFERS_FROM_EARLIER,
        format!(
            "the rig is a different one: prisms {} were {before_m:.4} m apart and are {now_m:.4} m apart now",
            Pair::at(pair)
        ),
    )
    .about(Subject::Pair(pair))
    .quantity("earlier", before_m, Unit::Metre)
    .quantity("now", now_m, Unit::Metre)
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        earlier_calibration_weak("weak: the drive is an L"),
        compared_without_joint_estimate("earlier calibration", "method D"),
        compared_in_unknown_frame(),
        rig_differs_from_earlier(1, 0.9, 0.95),
    ]
}
