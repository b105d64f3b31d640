//! What a prediction comes down to: a verdict, and sentences for people.

use super::Plan;
use super::locks::{Lock, LockFailure, WhyNotRead};
use super::prediction::Prediction;
use crate::calibration::Verdict;
use crate::calibration::inter_prism::observability::{Hold, Observability};
use crate::deployment::Finding;
use crate::pipeline::{OutlierReason, Thresholds};

/// An answer whose largest σ exceeds this is weak (m), as that of a calibration.
const WEAK_SIGMA_M: f64 = 0.020;
/// A twin that costs less than this many times the answer is not told from it by its cost.
const DECISIVE_COST_RATIO: f64 = 2.0;
/// Prisms that differ by less in height (m) leave a static reading of them undecided as well.
const TOLD_HEIGHT_M: f64 = 0.02;
/// Lock failures of this share of the readings are worth a warning.
const MANY: f64 = 0.02;

/// The verdict that such a drive would end in, with its reasons.
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
        say(
            Verdict::Degenerate,
            Finding::problem("this drive leaves a direction free: turn, and drive further"),
        );
    }
    if let Some(held) = &prediction.held {
        let largest_m = held.sigma.iter().map(|s| s.translation_m.max()).fold(0.0, f64::max);
        if largest_m > WEAK_SIGMA_M {
            let line = format!("weakly held: σ up to {:.0} mm at the stations", largest_m * 1e3);
            say(Verdict::Weak, Finding::warning(line));
        }
        let far = &held.far_end;
        let (sigma_mm, target_mm) = (far.sigma_m * 1e3, plan.target_mm);
        let line = format!(
            "at the far end of the track, station {}'s prism is known to {sigma_mm:.1} mm, where {target_mm:.1} mm are wanted",
            far.station + 1
        );
        say(
            Verdict::Good,
            if sigma_mm > target_mm { Finding::warning(line) } else { Finding::note(line) },
        );
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
    if !free.is_empty() {
        let line = format!("this drive ({shape}) leaves free: {free}; {advice}");
        found.push((Verdict::Degenerate, Finding::problem(line)));
    }
    if !weak.is_empty() {
        let line = format!("this drive ({shape}) holds weakly: {weak}; {advice}");
        found.push((Verdict::Weak, Finding::warning(line)));
    }
    found
}

fn mirror(plan: &Plan, prediction: &Prediction) -> Option<Finding> {
    let ratio = prediction.mirror_cost_ratio?;
    if ratio >= DECISIVE_COST_RATIO {
        let line = format!(
            "the mirror twin in height will cost about {ratio:.1} times the answer: the drive tells them apart"
        );
        return Some(Finding::note(line));
    }
    let heights_m = plan.rig.prisms_m.map(|prism_m| prism_m.z);
    let apart_m = (heights_m[0] - heights_m[1]).abs().max((heights_m[0] - heights_m[2]).abs());
    let line = format!("the mirror twin in height will cost only {ratio:.2} times the answer");
    Some(if apart_m > TOLD_HEIGHT_M {
        Finding::note(format!(
            "{line}: read the three prisms from one static station before the drive (calibration_raw.csv), or drive over a ramp"
        ))
    } else {
        Finding::warning(format!(
            "{line}, and the prisms stand too nearly level to be told apart: fix them at heights that differ more"
        ))
    })
}

/// A sentence for each kind of failure of a station, the times of the longest span in it.
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
        let [from_s, to_s] = longest.span_s;
        let reason = match why {
            WhyNotRead::TooNear | WhyNotRead::TooFar => format!(
                "its prism is out of reach ({:.1} to {:.0} m)",
                plan.instrument.reach_m[0], plan.instrument.reach_m[1]
            ),
            WhyNotRead::Hidden(prism) => format!("prism {} stands in its sight", prism + 1),
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
                    "its {rate} changes faster than {limit}, and the outlier filter drops it: drive more slowly there, or further \
                     from the station"
                )
            }
        };
        let line = format!(
            "station {}: {lost} readings do not count, most of them from {from_s:.0} to {to_s:.0} s: {reason}",
            station + 1
        );
        let is_many = lost as f64 > MANY * readings.max(1) as f64;
        Some(if is_many { Finding::warning(line) } else { Finding::note(line) })
    };
    kinds.into_iter().filter_map(of_kind).collect()
}
