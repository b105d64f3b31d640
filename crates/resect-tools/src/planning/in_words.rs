//! Summary of a prediction: a verdict and findings.

use super::Plan;
use super::locks::{Lock, LockFailure, WhyNotRead};
use super::prediction::Prediction;
use crate::findings::planning::{
    LostReadings, PlannedDirections, plan_directions_weak, plan_far_end,
    plan_leaves_direction_free, plan_leaves_directions_free, plan_mirror_needs_reading,
    plan_mirror_unresolved, plan_readings_lost, plan_resolves_mirror, plan_weak,
};
use resect_core::calibration::Verdict;
use resect_core::calibration::inter_prism::DECISIVE_COST_RATIO;
use resect_core::calibration::inter_prism::observability::{Hold, Observability};
use resect_core::deployment::Finding;
use resect_core::network::Prism;
use resect_core::pipeline::{OutlierReason, Thresholds};

/// Largest σ above which a calibration is weak (m).
const WEAK_SIGMA_M: f64 = 0.020;
/// Smallest difference of prism heights (m) for which a static reading of the prisms resolves the mirror twin.
const TOLD_HEIGHT_M: f64 = 0.02;
/// Share of readings lost to lock failures that is worth a warning.
const MANY: f64 = 0.02;

/// Returns the predicted verdict on such a drive, with its reasons.
pub fn judged(plan: &Plan, prediction: &Prediction) -> (Verdict, Vec<Finding>) {
    let mut verdict = Verdict::Good;
    let mut findings = Vec::new();
    let mut say = |at_least: Verdict, finding: Finding| {
        verdict = verdict.max(at_least);
        findings.push(finding);
    };
    if let Some(observability) = &prediction.observability {
        for (at_least, finding) in directions(observability) {
            say(at_least, finding);
        }
    } else if prediction.held.is_none() {
        say(Verdict::Degenerate, plan_leaves_direction_free());
    }
    if let Some(held) = &prediction.held {
        let largest_m = held.sigma.iter().map(|s| s.translation_m.max()).fold(0.0, f64::max);
        if largest_m > WEAK_SIGMA_M {
            say(Verdict::Weak, plan_weak(largest_m));
        }
        let far = &held.far_end;
        say(Verdict::Good, plan_far_end(far.station, far.sigma_m, plan.target_mm * 1e-3));
    }
    if let Some(finding) = mirror(plan, prediction) {
        say(Verdict::Good, finding);
    }
    for (station, lock) in prediction.locks.iter().enumerate() {
        for finding in failures(station, lock, prediction.readings[station], plan) {
            say(Verdict::Good, finding);
        }
    }
    (verdict, findings)
}

fn directions(observability: &Observability) -> Vec<(Verdict, Finding)> {
    let shape = observability.drive.name().replace('-', " ");
    let advice = observability.advice;
    let (free, weak) = (observability.words(Hold::Free), observability.words(Hold::Weak));
    let mut found = Vec::new();
    let planned = |directions| PlannedDirections { shape: &shape, directions, advice };
    if !free.is_empty() {
        found.push((Verdict::Degenerate, plan_leaves_directions_free(planned(&free))));
    }
    if !weak.is_empty() {
        found.push((Verdict::Weak, plan_directions_weak(planned(&weak))));
    }
    found
}

fn mirror(plan: &Plan, prediction: &Prediction) -> Option<Finding> {
    let ratio = prediction.mirror_cost_ratio?;
    if ratio >= DECISIVE_COST_RATIO {
        return Some(plan_resolves_mirror(ratio));
    }
    let first_m = plan.rig.prisms_m[Prism::default()].z;
    let heights_m = plan.rig.prisms_m.iter().map(|prism_m| (prism_m.z - first_m).abs());
    let apart_m = heights_m.fold(0.0, f64::max);
    Some(if apart_m > TOLD_HEIGHT_M {
        plan_mirror_needs_reading(ratio)
    } else {
        plan_mirror_unresolved(ratio)
    })
}

/// Returns a finding for each kind of failure of a station, with the times of its longest span.
fn failures(station: usize, lock: &Lock, readings: usize, plan: &Plan) -> Vec<Finding> {
    let mut kinds: Vec<WhyNotRead> = Vec::new();
    for failure in &lock.failures {
        if !kinds.contains(&failure.why) {
            kinds.push(failure.why);
        }
    }
    let of_kind = |why: WhyNotRead| {
        let own: Vec<&LockFailure> = lock.failures.iter().filter(|f| f.why == why).collect();
        let lost: usize = own.iter().map(|failure| failure.readings).sum();
        let longest = own.iter().max_by_key(|failure| failure.readings)?;
        let reason = match why {
            WhyNotRead::TooNear | WhyNotRead::TooFar => format!(
                "its prism is out of reach ({:.1} to {:.0} m)",
                plan.instrument.reach_m[0], plan.instrument.reach_m[1]
            ),
            WhyNotRead::Hidden(prism) => format!("prism {prism} blocks the line of sight"),
            WhyNotRead::TooFast(reason) => {
                let Thresholds { tau_r_m_per_s, tau_a_deg_per_s, tau_e_deg_per_s, .. } =
                    plan.thresholds;
                let (rate, limit) = match reason {
                    OutlierReason::Range => ("range", format!("τ_r ({tau_r_m_per_s} m/s)")),
                    OutlierReason::Azimuth => ("azimuth", format!("τ_a ({tau_a_deg_per_s}°/s)")),
                    OutlierReason::Zenith => {
                        ("zenith angle", format!("τ_e ({tau_e_deg_per_s}°/s)"))
                    }
                };
                format!(
                    "its {rate} changes faster than {limit}, so the outlier filter rejects it: drive more slowly there, or further \
                     from the station"
                )
            }
        };
        Some(plan_readings_lost(&LostReadings {
            station,
            count: lost,
            span_s: longest.span_s,
            reason: &reason,
            are_many: lost as f64 > MANY * readings.max(1) as f64,
        }))
    };
    kinds.into_iter().filter_map(of_kind).collect()
}
