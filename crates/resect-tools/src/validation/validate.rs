//! The validation of an earlier calibration by another run.

use std::sync::Arc;

use super::earlier::{Earlier, first_doubt};
use super::metric::{self, MetricThere};
use super::moved::{self, Difference};
use super::outcome::{Cause, Outcome};
use crate::findings::validation::{
    compared_in_unknown_frame, compared_without_joint_estimate, earlier_calibration_weak,
    rig_differs_from_earlier,
};
use resect_core::analysis::{Analysis, Answer};
use resect_core::calibration::{Method, Verdict};
use resect_core::deployment::{Deployment, Finding, TrackFrame};
use resect_core::evaluation::known_distances_m;
use resect_core::geometry::{LevelTransform, RigidTransform};
use resect_core::network::{Number, PerStation};

/// Largest standard deviation of a conclusive difference (m); a calibration with a larger one is weak as well.
const COARSE_SIGMA_M: f64 = 0.020;
/// Displacement (m) and rotation (rad) beyond which a station was set up elsewhere, not knocked.
const CARRIED_M: f64 = 0.3;
const CARRIED_RAD: f64 = 0.05;
/// Distances that differ by more than this (σ) belong to different rigs.
const OTHER_RIG_SIGMAS: f64 = 3.0;

/// Result of the validation of a calibration by a run, with its evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Validation {
    /// Names of the earlier calibration and of the run.
    pub earlier: String,
    pub deployment: String,
    pub outcome: Outcome,
    /// Limits of the validation.
    pub caveats: Vec<Finding>,
    /// Verdict on the run's own calibration; `None` without one.
    pub own_verdict: Option<Verdict>,
    /// `None` if a calibration or its covariance is missing, or if they refer to different frames.
    pub difference: Option<Difference>,
    /// `None` in the same cases, and if the rig's distances are unknown.
    pub metric: Option<MetricThere>,
}

/// Returns the run without its control points, to be analysed for [`validate`].
///
/// Control points are read before or after a drive, so a move of a station in between makes them contradict the drive. The
/// validation is about the drive.
pub fn drive_alone(deployment: &Arc<Deployment>) -> Arc<Deployment> {
    if deployment.control_points.is_empty() {
        return Arc::clone(deployment);
    }
    let mut alone = Deployment::clone(deployment);
    alone.control_points.clear();
    Arc::new(alone)
}

/// Tests whether an earlier calibration holds for a run. `own` is the analysis of the run that [`drive_alone`] returns.
pub fn validate(earlier: &Earlier, deployment: &Deployment, own: &Analysis) -> Validation {
    let answer = own.answer.as_deref().map_err(ToString::to_string);
    let mut validation = Validation {
        earlier: earlier.name.clone(),
        deployment: deployment.name.clone(),
        outcome: Outcome::Holds,
        caveats: caveats(earlier, deployment, own),
        own_verdict: answer.as_ref().ok().map(|answer| answer.calibration.verdict),
        difference: None,
        metric: None,
    };
    if let Ok(answer) = &answer
        && !in_other_frames(earlier, deployment)
        && has_same_stations(earlier, answer)
    {
        let level = |transforms: &PerStation<RigidTransform>| {
            transforms.map(|to| LevelTransform::new(to.translation_m, to.yaw_rad()))
        };
        let errors = &own.settings.calibration.errors;
        let [before, after] =
            [&earlier.station1_from_station, &answer.calibration.station1_from_station].map(level);
        let both = earlier.covariance.as_ref().zip(answer.calibration.covariance.as_ref());
        let covariance = both
            .map(|(before_one, own_one)| before_one + own_one + moved::settled(&before, errors));
        validation.difference =
            covariance.and_then(|covariance| Difference::between(&before, &after, covariance));
        if let (Some(difference), Some(known_m)) =
            (&validation.difference, known_distances_m(deployment, &own.offer.followed))
        {
            let followed = &own.offer.followed;
            validation.metric =
                metric::metric_there(earlier, answer, difference, &known_m, followed);
        }
    }
    validation.outcome = outcome(earlier, deployment, &answer, &validation);
    validation
}

fn in_other_frames(earlier: &Earlier, deployment: &Deployment) -> bool {
    earlier.frame().is_some_and(|frame| frame != deployment.track_frame)
}

fn has_same_stations(earlier: &Earlier, answer: &Answer) -> bool {
    earlier.station1_from_station.len() == answer.calibration.station1_from_station.len()
}

fn outcome(
    earlier: &Earlier,
    deployment: &Deployment,
    answer: &Result<&Answer, String>,
    found: &Validation,
) -> Outcome {
    let cannot = |why: String| Outcome::CannotBeTold(why);
    if in_other_frames(earlier, deployment) {
        return cannot(
            "the runs have different frames: the stations' own in one, a common frame of the tracks in the other"
                .to_owned(),
        );
    }
    let answer = match answer {
        Ok(answer) if !has_same_stations(earlier, answer) => {
            return cannot(format!(
                "the earlier calibration has {} stations, the run has {}",
                earlier.station1_from_station.len(),
                answer.calibration.station1_from_station.len()
            ));
        }
        Ok(answer) => &answer.calibration,
        Err(why) => return cannot(format!("the run has no calibration of its own: {why}")),
    };
    if answer.verdict != Verdict::Good {
        let why = first_doubt(&answer.findings);
        return cannot(with_doubt("the run's own calibration is", answer.verdict, why.as_deref()));
    }
    if earlier.verdict > Verdict::Weak {
        return cannot(with_doubt(
            "the earlier calibration is",
            earlier.verdict,
            earlier.doubt.as_deref(),
        ));
    }
    let Some(difference) = &found.difference else {
        return cannot(
            "one of the two calibrations has no σ to test the difference with".to_owned(),
        );
    };
    if difference.rejects() {
        return Outcome::DoesNotHold(if difference.reaches(CARRIED_M, CARRIED_RAD) {
            Cause::OtherSetUp
        } else {
            difference.cause()
        });
    }
    if found.metric.as_ref().is_some_and(MetricThere::is_worse) {
        return Outcome::DoesNotHold(Cause::Metric);
    }
    let sigma_m = difference.largest_sigma_m();
    if sigma_m > COARSE_SIGMA_M {
        return cannot(format!(
            "σ of the difference is up to {:.0} mm, too large to detect a relevant move",
            sigma_m * 1e3
        ));
    }
    Outcome::Holds
}

/// Formats a verdict with its reason: "the run's own calibration is weak: …".
fn with_doubt(of: &str, verdict: Verdict, doubt: Option<&str>) -> String {
    let why = doubt.map_or(String::new(), |doubt| format!(": {doubt}"));
    format!("{of} {}{why}", verdict.name())
}

/// Returns findings on limits that the tests do not cover.
fn caveats(earlier: &Earlier, deployment: &Deployment, own: &Analysis) -> Vec<Finding> {
    let mut caveats = Vec::new();
    if earlier.verdict == Verdict::Weak {
        let verdict = with_doubt("", earlier.verdict, earlier.doubt.as_deref());
        caveats.push(earlier_calibration_weak(verdict.trim_start()));
    }
    let requested = own.settings.calibration.method.unwrap_or_default();
    let own_method =
        own.answer.as_ref().map_or(requested, |answer| answer.calibration.answered_by());
    for (which, method) in
        [("earlier calibration", earlier.method), ("run's own calibration", own_method)]
    {
        if method != Method::Joint {
            caveats.push(compared_without_joint_estimate(which, &method.to_string()));
        }
    }
    if earlier.frame() == Some(TrackFrame::Common) && deployment.track_frame == TrackFrame::Common {
        caveats.push(compared_in_unknown_frame());
    }
    if let (Some(before), Some(rig)) = (&earlier.inter_prism_m, &deployment.rig) {
        let sigma_m = 2_f64.sqrt() * own.settings.calibration.inter_prism_sigma_m;
        for ((pair, before_m), now_m) in before.each().zip(&rig.inter_prism_m) {
            let (pair, before_m, now_m) = (pair.index(), *before_m, *now_m);
            if (now_m - before_m).abs() > OTHER_RIG_SIGMAS * sigma_m {
                caveats.push(rig_differs_from_earlier(pair, before_m, now_m));
            }
        }
    }
    caveats
}
