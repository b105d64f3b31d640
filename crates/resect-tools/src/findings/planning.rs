//! Findings of a plan: predictions of a drive.

use crate::findings::kinds;
use resect_core::deployment::{Finding, Severity, Subject, Unit};

pub fn plan_leaves_direction_free() -> Finding {
    Finding::new(
        kinds::PLAN_LEAVES_DIRECTION_FREE,
        "this drive leaves a direction unobservable: turn, and drive further",
    )
}

/// The shape of the planned drive, the directions and the advice, in words.
#[derive(Clone, Copy)]
pub struct PlannedDirections<'a> {
    pub shape: &'a str,
    pub directions: &'a str,
    pub advice: &'a str,
}

pub fn plan_leaves_directions_free(planned: PlannedDirections<'_>) -> Finding {
    let PlannedDirections { shape, directions, advice } = planned;
    Finding::new(
        kinds::PLAN_LEAVES_DIRECTION_FREE,
        format!("unobservable with this drive ({shape}): {directions}; {advice}"),
    )
    .about(Subject::Named(shape.to_owned()))
}

pub fn plan_directions_weak(planned: PlannedDirections<'_>) -> Finding {
    let PlannedDirections { shape, directions, advice } = planned;
    Finding::new(
        kinds::PLAN_WEAK,
        format!("weakly observable with this drive ({shape}): {directions}; {advice}"),
    )
    .about(Subject::Named(shape.to_owned()))
}

pub fn plan_weak(largest_sigma_m: f64) -> Finding {
    Finding::new(
        kinds::PLAN_WEAK,
        format!("weakly observable: σ up to {:.0} mm at the stations", largest_sigma_m * 1e3),
    )
    .quantity("largest_sigma", largest_sigma_m, Unit::Metre)
}

/// A warning if the target is missed, else a note.
pub fn plan_far_end(station: usize, sigma_m: f64, target_m: f64) -> Finding {
    let severity = if sigma_m > target_m { Severity::Warning } else { Severity::Note };
    Finding::new(
        kinds::PLAN_FAR_END,
        format!(
            "at the far end of the track, σ of station {}'s prism is {:.1} mm; the target is {:.1} mm",
            station + 1,
            sigma_m * 1e3,
            target_m * 1e3
        ),
    )
    .with_severity(severity)
    .about(Subject::Station(station))
    .quantity("sigma", sigma_m, Unit::Metre)
    .quantity("target", target_m, Unit::Metre)
}

pub fn plan_resolves_mirror(cost_ratio: f64) -> Finding {
    Finding::new(
        kinds::PLAN_RESOLVES_MIRROR,
        format!(
            "the drive resolves the mirror ambiguity: the mirrored solution will have about {cost_ratio:.1} times the cost"
        ),
    )
    .quantity("cost_ratio", cost_ratio, Unit::Ratio)
}

pub fn plan_mirror_needs_reading(cost_ratio: f64) -> Finding {
    Finding::new(
        kinds::PLAN_MIRROR_NEEDS_READING,
        format!(
            "the drive does not resolve the mirror ambiguity: the mirrored solution will have only {cost_ratio:.2} times the \
             cost; read the prisms from one static station before the drive (calibration_raw.csv), or drive over a \
             ramp"
        ),
    )
    .quantity("cost_ratio", cost_ratio, Unit::Ratio)
}

pub fn plan_mirror_unresolved(cost_ratio: f64) -> Finding {
    Finding::new(
        kinds::PLAN_MIRROR_UNRESOLVED,
        format!(
            "nothing resolves the mirror ambiguity: the mirrored solution will have only {cost_ratio:.2} times the cost, and the \
             prisms are at nearly the same height; fix them at heights that differ more"
        ),
    )
    .quantity("cost_ratio", cost_ratio, Unit::Ratio)
}

/// Readings of a planned drive that are lost for one reason.
pub struct LostReadings<'a> {
    /// The station, 0 to 2.
    pub station: usize,
    pub count: usize,
    /// The longest span of lost readings (s).
    pub span_s: [f64; 2],
    pub reason: &'a str,
    /// True if their number justifies a warning.
    pub are_many: bool,
}

pub fn plan_readings_lost(lost: &LostReadings<'_>) -> Finding {
    let LostReadings { station, count, span_s: [from_s, to_s], reason, are_many } = *lost;
    let severity = if are_many { Severity::Warning } else { Severity::Note };
    Finding::new(
        kinds::PLAN_READINGS_LOST,
        format!(
            "station {}: {count} readings are lost, most of them from {from_s:.0} to {to_s:.0} s: {reason}",
            station + 1
        ),
    )
    .with_severity(severity)
    .about(Subject::OfStation { station, part: reason.to_owned() })
    .count("readings", count)
    .quantity("from", from_s, Unit::Second)
    .quantity("to", to_s, Unit::Second)
}

pub(super) fn examples() -> Vec<Finding> {
    let planned = PlannedDirections {
        shape: "straight line",
        directions: "station 2 can slide",
        advice: "drive a figure-eight",
    };
    vec![
        plan_leaves_direction_free(),
        plan_leaves_directions_free(planned),
        plan_directions_weak(planned),
        plan_weak(0.03),
        plan_far_end(1, 0.004, 0.002),
        plan_resolves_mirror(4.0),
        plan_mirror_needs_reading(1.2),
        plan_mirror_unresolved(1.2),
        plan_readings_lost(&LostReadings {
            station: 1,
            count: 30,
            span_s: [10.0, 20.0],
            reason: "prism 2 stands in its sight",
            are_many: true,
        }),
    ]
}
