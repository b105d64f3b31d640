//! Verdict of method D, with its reasons.

use nalgebra::Vector3;

use super::drive_shape::PlanView;
use super::mirror::Choice;
use super::motion_in_words::{TrackAxes, describe};
use super::observability::{Hold, Observability};
use super::prism_network::UNKNOWNS_PER_STATION;
use super::uncertainty::Uncertainty;
use super::{CentredTriplets, Minimum, Parameters};
use crate::calibration::checks::{
    FREE_SIGMA_M, POOR_FIT_M, WEAK_SIGMA_M, control_points_contradict,
};
use crate::calibration::joint::SurveyPoses;
use crate::calibration::{ResolvedBy, TransformSigma, Verdict};
use crate::deployment::findings::answers::solver_not_converged;
use crate::deployment::findings::drive::{
    Flat, OpenDirections, distances_fit_poorly, drive_circle, drive_leaves_direction_free,
    drive_standing, drive_straight_line, drive_two_legs, drive_weak, flat_ground, rival_minimum,
    stations_far_from_track, weakest_direction,
};
use crate::deployment::{Deployment, Finding, Severity};
use crate::geometry::RigidTransform;
use crate::network::PerStation;
use crate::statistics::median;

/// Cost ratio below which a minimum that is not the mirror twin makes the answer ambiguous.
const CLOSE_RIVAL: f64 = 2.0;
/// A rival of a drive with two legs is mentioned below this cost ratio.
const NOTABLE_RIVAL: f64 = 10.0;

/// The stations are far from the track if their σ is this many times the largest σ at the track.
const FAR: f64 = 2.0;

/// Input of the verdict.
pub struct DiagnosisInput<'a> {
    pub deployment: &'a Deployment,
    /// Triplets that are sufficient for the track and the size of the errors.
    pub thinned: &'a CentredTriplets,
    pub answer: &'a Minimum,
    pub rival: Option<(Parameters, f64)>,
    pub uncertainty: &'a Uncertainty,
    pub observability: &'a Observability,
    pub choice: &'a Choice,
    /// Answer and its σ.
    pub station1_from_station: &'a PerStation<RigidTransform>,
    pub sigma: Option<PerStation<TransformSigma>>,
    /// Poses when the control points were measured; `None` if they are those of the answer.
    pub survey: Option<&'a SurveyPoses>,
}

/// Judges the answer. Reasons are added to the findings, those of the mirror twin first.
pub fn judge(evidence: &DiagnosisInput<'_>, findings: &mut Vec<Finding>) -> Verdict {
    let DiagnosisInput { thinned, answer, uncertainty, observability, choice, .. } = *evidence;
    findings.splice(0..0, choice.findings.iter().cloned());
    findings.extend(flat(evidence));
    let mut verdict = if choice.ambiguous { Verdict::Ambiguous } else { Verdict::Good };
    let mut lower = |to: Verdict, finding: Finding| {
        verdict = verdict.max(to);
        findings.push(finding);
    };
    if let Some(finding) = plan(evidence) {
        // An answer that depends on one corner is not good, however small σ is: an error of that segment biases all of it.
        let weak = finding.severity > Severity::Note;
        lower(if weak { Verdict::Weak } else { Verdict::Good }, finding);
    }
    if let Some(finding) = rival(evidence) {
        lower(Verdict::Ambiguous, finding);
    }
    let at_survey = match evidence.survey {
        Some(survey) => Some((survey.transforms(), survey.sigma())),
        None => evidence.sigma.clone().map(|sigma| (evidence.station1_from_station.clone(), sigma)),
    };
    let control_points = at_survey.and_then(|(transforms, sigma)| {
        control_points_contradict(evidence.deployment, &transforms, &sigma)
    });
    let doubts = [control_points, poor_fit(evidence)];
    for finding in doubts.into_iter().flatten() {
        lower(Verdict::Weak, finding);
    }
    if !answer.converged {
        lower(Verdict::Weak, solver_not_converged());
    }
    let direction = describe(&TrackAxes::of(thinned), &uncertainty.weakest, false);
    let advice = observability.advice;
    // The weakest direction is judged at the track. The values of σ are for the stations, which may be far away.
    let largest_m = evidence.sigma.as_ref().map_or(f64::INFINITY, |sigma| {
        sigma.iter().map(|s| s.translation_m.max()).fold(uncertainty.weakest_sigma_m, f64::max)
    });
    if uncertainty.weakest_sigma_m > FREE_SIGMA_M {
        let free = observability.words(Hold::Free);
        lower(Verdict::Degenerate, drive_leaves_direction_free(&free, advice));
    } else if largest_m > WEAK_SIGMA_M {
        let are_far = largest_m > FAR * uncertainty.weakest_sigma_m;
        let finding = if are_far {
            stations_far_from_track(largest_m)
        } else {
            drive_weak(&direction, largest_m, advice)
        };
        lower(Verdict::Weak, finding);
    } else {
        findings.push(weakest_direction(&direction, uncertainty.weakest_sigma_m));
    }
    verdict
}

/// Returns the finding that the shape of the drive leaves directions unobservable or weak.
fn plan(evidence: &DiagnosisInput<'_>) -> Option<Finding> {
    let DiagnosisInput { observability, rival, .. } = evidence;
    let open = if evidence.uncertainty.has_control_points {
        OpenDirections::HeldByControlPoints(observability.open_to_drive())
    } else {
        let [free, weak] = [Hold::Free, Hold::Weak].map(|hold| observability.count(hold));
        OpenDirections::Open { free, weak }
    };
    Some(match observability.drive.plan {
        PlanView::Winding => return None,
        PlanView::Standing => drive_standing(open),
        PlanView::StraightLine { length_m, bends_m } => {
            drive_straight_line(open, length_m, bends_m)
        }
        PlanView::Circle { radius_m, driven_rad, .. } => drive_circle(open, radius_m, driven_rad),
        PlanView::TwoLegs { corner_m, turn_rad } => {
            let cost_ratio = rival.as_ref().map(|(_, cost_ratio)| *cost_ratio);
            let cost_ratio = cost_ratio.filter(|cost_ratio| *cost_ratio < NOTABLE_RIVAL);
            drive_two_legs(open, [corner_m.x, corner_m.y], turn_rad, cost_ratio)
        }
    })
}

/// Returns the finding that on flat ground only the rig or control points exclude the mirror twin.
fn flat(evidence: &DiagnosisInput<'_>) -> Option<Finding> {
    let drive = &evidence.observability.drive;
    let mirror = &evidence.choice.mirror;
    if !drive.is_flat() || mirror.twin.is_none() {
        return None;
    }
    let flat = if drive.is_floor() {
        Flat::Floor { relief_m: drive.relief_m }
    } else {
        Flat::Tilt { tilt_rad: drive.tilt_rad }
    };
    Some(flat_ground(flat, mirror.resolved_by != ResolvedBy::Nothing))
}

/// Returns the finding that another minimum, not the mirror twin, fits almost as well as the answer. Control points exclude it.
fn rival(evidence: &DiagnosisInput<'_>) -> Option<Finding> {
    if evidence.uncertainty.has_control_points {
        return None;
    }
    let (rival, cost_ratio) = evidence.rival.as_ref().filter(|(_, ratio)| *ratio < CLOSE_RIVAL)?;
    let apart_m = |rival: &Parameters| {
        let apart = rival - &evidence.answer.parameters;
        let stations = apart.as_slice().chunks_exact(UNKNOWNS_PER_STATION);
        stations.map(|p| Vector3::new(p[0], p[1], p[2]).norm()).fold(0.0, f64::max)
    };
    // The rival's heights may be mirrored too; that difference is not counted.
    let apart_m = apart_m(rival).min(apart_m(&evidence.thinned.mirrored_in_height(rival)));
    Some(rival_minimum(apart_m, *cost_ratio))
}

/// Returns the finding that errors are larger than noise, interpolation and the distances explain.
fn poor_fit(evidence: &DiagnosisInput<'_>) -> Option<Finding> {
    let errors_m = evidence.thinned.distance_errors_m(&evidence.answer.parameters);
    let median_m = median(errors_m.into_iter().map(f64::abs))?;
    (median_m > POOR_FIT_M).then(|| distances_fit_poorly(median_m))
}
