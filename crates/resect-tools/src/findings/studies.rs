//! Findings about trajectories that are judged, and about the deployments of a study.

use crate::findings::kinds;
use resect_core::deployment::{Finding, Remedy, Subject, Unit};

/// `clock_s` is the time of the trajectory minus that of the ground truth.
pub fn estimate_clock_far_off(estimate: &str, clock_s: f64) -> Finding {
    Finding::new(
        kinds::ESTIMATE_CLOCK_FAR_OFF,
        format!(
            "{estimate}: its clock is off by {clock_s:.0} s; estimate and ground truth were aligned by speed alone: check that \
             both are of one drive"
        ),
    )
    .about(Subject::Named(estimate.to_owned()))
    .quantity("clock_offset", clock_s, Unit::Second)
}

/// `by_s` is the step of the trajectory's clock against that of the ground truth, at a time from the start (s).
pub fn estimate_clock_stepped(estimate: &str, by_s: f64, after_s: f64) -> Finding {
    let direction = if by_s > 0.0 { "forward" } else { "back" };
    Finding::new(
        kinds::ESTIMATE_CLOCK_STEPPED,
        format!(
            "{estimate}: at {after_s:.0} s its clock is set {direction} by {:.2} s against that of the ground truth; one time offset \
             does not fit",
            by_s.abs()
        ),
    )
    .about(Subject::Named(estimate.to_owned()))
    .quantity("clock_step", by_s, Unit::Second)
    .quantity("time", after_s, Unit::Second)
}

/// `per_s` is the change of the trajectory's clock against that of the ground truth in each second; `convention` corrects it.
pub fn estimate_clock_drifts(estimate: &str, per_s: f64, convention: &str) -> Finding {
    Finding::new(
        kinds::ESTIMATE_CLOCK_DRIFTS,
        format!(
            "{estimate}: its clock gains {:+.2} ms each second on that of the ground truth; one time offset does not fit \
             (--convention {convention})",
            1e3 * per_s
        ),
    )
    .about(Subject::Named(estimate.to_owned()))
    .quantity("clock_rate", per_s, Unit::Ratio)
}

/// `sigma_s` is the jitter of the stamps of the trajectory against those of the ground truth (s).
pub fn estimate_stamps_jitter(estimate: &str, sigma_s: f64) -> Finding {
    Finding::new(
        kinds::ESTIMATE_STAMPS_JITTER,
        format!(
            "{estimate}: its stamps jitter by about {:.0} ms (1 σ) against those of the ground truth; the time offset is their mean",
            1e3 * sigma_s
        ),
    )
    .about(Subject::Named(estimate.to_owned()))
    .quantity("jitter", sigma_s, Unit::Second)
}

/// `sigma_s` is the size of slow changes of the time offset (s).
pub fn estimate_clock_wanders(estimate: &str, sigma_s: f64) -> Finding {
    Finding::new(
        kinds::ESTIMATE_CLOCK_WANDERS,
        format!(
            "{estimate}: its clock wanders by about {:.0} ms (1 σ) within minutes against that of the ground truth; the time offset is \
             its mean",
            1e3 * sigma_s
        ),
    )
    .about(Subject::Named(estimate.to_owned()))
    .quantity("wander", sigma_s, Unit::Second)
}

/// `times_longer` is the ratio of the trajectory's length to the ground truth's; `why` states it in words.
pub fn estimate_scale_off(estimate: &str, times_longer: f64, why: &str) -> Finding {
    Finding::new(kinds::ESTIMATE_SCALE_OFF, format!("{estimate}: {why}"))
        .about(Subject::Named(estimate.to_owned()))
        .quantity("times_longer", times_longer, Unit::Ratio)
}

/// `points` is the number of times at which both are known.
pub fn estimate_few_points(estimate: &str, points: usize) -> Finding {
    Finding::new(
        kinds::ESTIMATE_FEW_POINTS,
        format!(
            "{estimate}: time offset and lever arm are taken as zero, because only {points} of its times have ground truth"
        ),
    )
    .about(Subject::Named(estimate.to_owned()))
    .quantity("points", points as f64, Unit::Count)
}

pub fn estimate_not_judged(why: &str, remedy: Option<Remedy>) -> Finding {
    let finding = Finding::new(kinds::ESTIMATE_NOT_JUDGED, format!("not judged: {why}"))
        .about(Subject::Named(why.to_owned()));
    remedy.into_iter().fold(finding, Finding::with)
}

pub fn deployment_left_out(why: &str) -> Finding {
    Finding::new(kinds::DEPLOYMENT_LEFT_OUT, format!("{why} (left out)"))
        .about(Subject::Named(why.to_owned()))
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        estimate_clock_far_off("slam", 120.0),
        estimate_clock_stepped("slam", 0.7, 214.0),
        estimate_clock_drifts("slam", 1e-3, "time=0.999001"),
        estimate_stamps_jitter("slam", 0.05),
        estimate_clock_wanders("slam", 0.2),
        estimate_scale_off("slam", 1.3, "it is 1.30 times as long as the drive"),
        estimate_few_points("slam", 7),
        estimate_not_judged("slam: it has too few poses (3)", Some(Remedy::JointEstimate)),
        deployment_left_out("drive: method B needs control points"),
    ]
}
