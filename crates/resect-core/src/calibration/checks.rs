//! Checks of an answer of any method: its σ, and the control points and inter-prism distances that it does not use.

use super::joint::SurveyPoses;
use super::method_answer::MethodAnswer;
use super::{Method, TransformSigma, Verdict, Witness};
use crate::calibration::distance_errors_m;
use crate::calibration::followed_prisms::several_prisms;
use crate::calibration::misfits::control_points_apart_m;
use crate::deployment::findings::answers::published_answer_far_apart;
use crate::deployment::findings::checks::{
    drive_contradicts, drive_fits_poorly, points_leave_direction_free, points_weak,
};
use crate::deployment::{
    ControlPoint, ControlPointSet, Deployment, Finding, Rig, TrackFrame, findings,
};
use crate::geometry::RigidTransform;
use crate::network::{PerStation, Prism};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// An answer whose largest standard deviation exceeds this is weak (m). Source: the paper's good deployments reach a few
/// millimetres, its failed ones two centimetres (Vaidis et al. 2022).
pub const WEAK_SIGMA_M: f64 = 0.020;
/// A direction with a larger standard deviation is unconstrained (m).
pub const FREE_SIGMA_M: f64 = 0.5;
/// Control points or tracks that fit worse contain more than noise (m, rms). Measured: good sets of points have 3 to 5 mm, tracks
/// under 10 mm.
pub const POOR_POINT_FIT_M: f64 = 0.015;
/// Corresponding points never fit worse than this (m, rms).
pub const HOPELESS_FIT_M: f64 = 0.1;
/// Largest median of the distance errors in a good run (m). Measured: such runs have 1 to 2 mm.
pub const POOR_FIT_M: f64 = 0.005;
/// σ of the difference of two readings of a control point (m): ranges, centring, angles at a hundred metres.
const CONTROL_POINT_SIGMA_M: f64 = 0.005;
/// σ of the inter-prism distances by a good answer (m): noise and interpolation.
const DISTANCE_SIGMA_M: f64 = 0.003;
/// Data that disagrees by this many times the expected difference contradicts the answer.
const CONTRADICTION: f64 = 3.0;

/// Largest plausible shift of the published answer by instrument errors (m). Simulated: in drives with all of them, a few
/// centimetres.
const FAR_APART_M: f64 = 0.15;

/// Returns the doubt about a joint estimate that is far from the published answer to the same readings.
pub fn far_apart(
    published: &PerStation<RigidTransform>,
    joint: &PerStation<RigidTransform>,
) -> Option<(Verdict, Finding)> {
    let apart_m =
        |station: usize| (published[station].translation_m - joint[station].translation_m).norm();
    let (station, apart_m) = (1..joint.len())
        .map(|station| (station, apart_m(station)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    (apart_m > FAR_APART_M).then(|| (Verdict::Weak, published_answer_far_apart(station, apart_m)))
}

/// Checks an answer of method A, B or C, or of one prism, by its σ, and by the control points and distances that it does not use.
///
/// `rms_m` is the root mean square of its point errors. `survey` are the poses when the control points were measured, for a joint
/// estimate of drive and control points: two independent data sets that confirm each other unless a set-up changed.
pub fn check_with_unused_data<D>(
    answer: &mut MethodAnswer<D>,
    rms_m: f64,
    deployment: &Deployment,
    triplets: &Triplets,
    survey: Option<&SurveyPoses>,
) {
    let mut doubts = Vec::new();
    let sigma = answer.sigma();
    let largest_m = sigma.as_ref().map_or(f64::INFINITY, |sigma| {
        sigma.iter().map(|s| s.translation_m.max()).fold(0.0, f64::max)
    });
    // A poor fit increases σ too; then the layout of the points is not the cause.
    let fits = rms_m < POOR_POINT_FIT_M;
    if largest_m > FREE_SIGMA_M && (fits || sigma.is_none()) {
        doubts.push((Verdict::Degenerate, points_leave_direction_free()));
    } else if largest_m > WEAK_SIGMA_M {
        doubts.push((Verdict::Weak, points_weak(largest_m, fits)));
    }
    if let Some(sigma) = &sigma {
        let transforms = &answer.station1_from_station;
        let at_survey = survey.map_or_else(
            || (transforms.clone(), sigma.clone()),
            |survey| (survey.transforms(), survey.sigma()),
        );
        // Method B uses the control points itself.
        if answer.method != Method::StaticGcp
            && let Some(apart_m) =
                control_points_apart_m(deployment.comparable_control_points(), &at_survey.0)
        {
            let is_unchanged = survey.is_none_or(|survey| survey.change.is_none());
            match control_points_contradict(deployment, &at_survey.0, &at_survey.1) {
                Some(finding) => doubts.push((Verdict::Weak, finding)),
                None if is_unchanged && apart_m < WEAK_SIGMA_M => {
                    answer.checked_by.push(Witness::ControlPoints);
                }
                None => {}
            }
        }
        if answer.method != Method::DynamicGcp
            // Methods A and B estimate the frames of the stations themselves.
            && deployment.track_frame == TrackFrame::Own
            && let Some(rig) = deployment.rig.as_ref().filter(|_| !triplets.is_empty())
        {
            let followed = &several_prisms(deployment, triplets);
            match distances_contradict((rig, followed), triplets, transforms, sigma) {
                Some(finding) => doubts.push((Verdict::Weak, finding)),
                None => answer.checked_by.push(Witness::Distances),
            }
        }
    }
    for (verdict, finding) in doubts {
        answer.judgement.lower(verdict, finding);
    }
}

/// Returns the finding that control points disagree by more than their noise and the answer's σ allow.
///
/// Then a point or a station has moved, or the answer has a bias that its method does not model.
pub fn control_points_contradict(
    deployment: &Deployment,
    station1_from_station: &PerStation<RigidTransform>,
    sigma: &PerStation<TransformSigma>,
) -> Option<Finding> {
    let mut worst: Option<(f64, f64, &ControlPointSet)> = None;
    for set in deployment.comparable_control_points().iter().filter(|set| !set.pillars) {
        let Some(median_m) = median(set.disagreements_m(station1_from_station)) else { continue };
        let expected_m = expected_m(sigma, middle_range_m(set), CONTROL_POINT_SIGMA_M);
        if median_m > CONTRADICTION * expected_m && worst.is_none_or(|(known, ..)| median_m > known)
        {
            worst = Some((median_m, expected_m, set));
        }
    }
    let (median_m, expected_m, worst_set) = worst?;
    let worst_point = furthest_apart(&worst_set.points, station1_from_station);
    Some(findings::checks::control_points_contradict(
        &worst_set.file,
        median_m,
        expected_m,
        worst_point,
    ))
}

/// Returns the marker of the point with the largest disagreement of two stations.
fn furthest_apart(
    points: &[ControlPoint],
    station1_from_station: &PerStation<RigidTransform>,
) -> Option<i64> {
    let worst_m =
        |point: &ControlPoint| point.disagreements_m(station1_from_station).fold(0.0, f64::max);
    points.iter().max_by(|a, b| worst_m(a).total_cmp(&worst_m(b))).map(|point| point.marker)
}

/// Returns the finding that inter-prism distances of the drive contradict the answer, or fit worse than in any good answer (1 to 2
/// mm).
fn distances_contradict(
    (rig, followed): (&Rig, &PerStation<Prism>),
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
    sigma: &PerStation<TransformSigma>,
) -> Option<Finding> {
    let known_m = &rig.inter_prism_m;
    let errors_m = distance_errors_m(triplets, station1_from_station, followed, known_m);
    let median_m = median(errors_m.into_iter().flatten().map(f64::abs))?;
    let range_m = triplets.points_m[0][triplets.len() / 2].norm();
    let expected_m = expected_m(sigma, range_m, DISTANCE_SIGMA_M);
    if median_m > CONTRADICTION * expected_m {
        Some(drive_contradicts(median_m, expected_m))
    } else if median_m > POOR_FIT_M {
        Some(drive_fits_poorly(median_m, expected_m))
    } else {
        None
    }
}

/// Returns the expected disagreement of two stations at a range (m): σ of the answer, at least `floor_m`.
fn expected_m(sigma: &PerStation<TransformSigma>, range_m: f64, floor_m: f64) -> f64 {
    sigma
        .iter()
        .map(|s| s.translation_m.norm_squared() + (s.yaw_rad * range_m).powi(2))
        .fold(floor_m.powi(2), f64::max)
        .sqrt()
}

fn middle_range_m(set: &ControlPointSet) -> f64 {
    let readings = set.points.iter().flat_map(|point| &point.readings).flatten();
    median(readings.map(|polar| polar.range_m)).unwrap_or(0.0)
}
