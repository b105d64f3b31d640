//! The way from triplets to an answer: by which method, beside which other, and held against what.

use crate::deployment::findings::answers::{published_answer_missing, tracks_not_transformed};

use super::{
    Calibration, CalibrationError, CalibrationSettings, Method, Offer, Targets, Verdict, Witness,
    checks, disagreements, dynamic_gcp, inter_prism, sense, static_gcp, two_point,
};
use crate::deployment::{Deployment, TrackFrame};
use crate::pipeline::Triplets;
use crate::progress::Progress;
use crate::stopwatch::Stopwatch;

/// Calibrates a deployment by the method of the settings: the joint estimate if they name none.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
) -> Result<Calibration, CalibrationError> {
    solve_while(deployment, triplets, settings, offer, &Progress::default())
}

/// Calibrates like [`solve`] until `progress` is cancelled, which ends it with [`CalibrationError::Cancelled`].
pub fn solve_while(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
    match settings.method.unwrap_or_default() {
        Method::Joint => jointly_beside_published(deployment, triplets, settings, offer, progress),
        method => {
            let answer = answer_by(method, deployment, triplets, settings, offer, progress)?;
            let tried = &mut sense::Tried::default();
            checked(answer, deployment, triplets, settings, offer, tried, progress)
        }
    }
}

/// With so many triplets the paper's method takes a hundredth of the joint estimate's time, and side by side both would take
/// room for all of them.
const LONG: usize = 100_000;

/// Calibrates by the joint estimate, and by the paper's method for the same data, so that the paper's numbers are there, and
/// what moved them.
fn jointly_beside_published(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
    let started = Stopwatch::start();
    let published_method = offer.published_method();
    let by = |method: Method| {
        let settings = settings.with_method(method);
        answer_by(method, deployment, triplets, &settings, offer, progress)
    };
    let (published, joint) = if triplets.len() < LONG {
        rayon::join(|| by(published_method), || by(Method::Joint))
    } else {
        (by(published_method), by(Method::Joint))
    };
    progress.check()?;
    // What one check has tried serves the other.
    let mut tried = sense::Tried::default();
    let mut checked = |answer: Result<Calibration, CalibrationError>, method: Method| {
        let settings = settings.with_method(method);
        checked(answer?, deployment, triplets, &settings, offer, &mut tried, progress)
    };
    let published = checked(published, published_method);
    progress.check()?;
    let mut joint = match (checked(joint, Method::Joint), &published) {
        (Err(why), Ok(_)) if why != CalibrationError::Cancelled => {
            let (why, published) = (Box::new(why), published_method);
            return Err(CalibrationError::NoJointEstimate { why, published });
        }
        (joint, _) => joint?,
    };
    match published {
        Ok(published) => joint.published = Some(Box::new(published)),
        Err(why) => {
            let method = published_method.to_string();
            joint.findings.push(published_answer_missing(&method, &why.finding()));
        }
    }
    joint.solve_ms = started.elapsed_ms() - joint.prior_ms;
    Ok(joint)
}

/// The answer of a method by itself.
fn answer_by(
    method: Method,
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
    let answer = match method {
        Method::TwoPoint => two_point::solve(deployment, triplets, offer),
        Method::StaticGcp => static_gcp::solve(deployment, triplets, settings, offer),
        Method::DynamicGcp => dynamic_gcp::solve(deployment, triplets, settings, offer),
        Method::InterPrism => inter_prism::solve(deployment, triplets, settings, offer, progress),
        Method::Joint => estimate_jointly(deployment, triplets, settings, offer, progress),
    };
    answer.map_err(|error| match (error, &deployment.rig) {
        (CalibrationError::NoTriplets { deployment: name, mut why }, Some(rig)) => {
            if let Some(misread) = sense::explain_no_triplets(deployment, rig) {
                why = format!("{why}; {misread}");
            }
            CalibrationError::NoTriplets { deployment: name, why }
        }
        (error, _) => error,
    })
}

/// An answer held against all that could contradict it.
fn checked(
    mut calibration: Calibration,
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    tried: &mut sense::Tried,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
    if calibration.inter_prism().is_some() {
        hold_against_control_points(&mut calibration, deployment, settings, offer);
    }
    sense::check(&mut calibration, deployment, triplets, offer, tried, progress)?;
    for doubt in deployment.findings.iter().filter(|finding| finding.kind.is_doubt()) {
        calibration.verdict = calibration.verdict.max(Verdict::Weak);
        calibration.findings.push(doubt.clone());
    }
    if calibration.placing_tracks(deployment).is_none() {
        calibration.findings.push(tracks_not_transformed());
    }
    Ok(calibration)
}

/// The joint estimate of one prism or of three, which starts from the published method.
fn estimate_jointly(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
    if offer.targets != Targets::OnePrism {
        return inter_prism::solve_jointly(deployment, triplets, settings, offer, progress);
    }
    if offer.lack(Method::Joint).is_some() {
        return Err(CalibrationError::lacking(deployment, Method::Joint, offer));
    }
    dynamic_gcp::solve_jointly(deployment, triplets, settings, offer, progress)
}

/// Method B on the control points, where there are any, as a witness of an answer from inter-prism distances.
fn hold_against_control_points(
    calibration: &mut Calibration,
    deployment: &Deployment,
    settings: &CalibrationSettings,
    offer: &Offer,
) {
    if offer.lack(Method::StaticGcp).is_some() || deployment.track_frame == TrackFrame::Common {
        return;
    }
    let Ok(by_points) = static_gcp::solve(deployment, &Triplets::default(), settings, offer) else {
        return;
    };
    let disagreements = disagreements(&by_points, calibration, deployment);
    let agrees = calibration.sigma.is_some_and(|sigma| {
        let transforms = &calibration.station1_from_station;
        checks::control_points_contradict(deployment, transforms, &sigma).is_none()
    });
    // Points that do not hold an answer of their own agree with anything.
    if by_points.verdict == Verdict::Good && agrees && disagreements.is_empty() {
        calibration.checked_by.push(Witness::ControlPoints);
    }
    for disagreement in disagreements {
        calibration.verdict = calibration.verdict.max(Verdict::Weak);
        calibration.findings.push(disagreement.finding());
    }
}
