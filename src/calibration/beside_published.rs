//! The joint estimate with the paper's answer beside it, so that the paper's numbers are there, and what moved them.

use std::time::Instant;

use super::sense::Tried;
use super::{
    Calibration, CalibrationError, CalibrationSettings, Method, Offer, answer_by, checked,
};
use crate::deployment::{Deployment, Finding};
use crate::pipeline::Triplets;
use crate::progress::Progress;

/// Calibrates by the joint estimate, and by the paper's method for the same data.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
    let started = Instant::now();
    let published_method = offer.published_method();
    let by = |method: Method| {
        let settings = settings.plain(method);
        answer_by(method, deployment, triplets, &settings, offer, progress)
    };
    let (published, joint) = rayon::join(|| by(published_method), || by(Method::Joint));
    progress.check()?;
    // What one check has tried serves the other.
    let mut tried = Tried::default();
    let mut checked = |answer: Result<Calibration, CalibrationError>, method: Method| {
        let settings = settings.plain(method);
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
    if settings.has_parts() {
        joint.findings.push(Finding::warning(
            "loss and estimate were not used: they are about the published methods, and the joint estimate has its own",
        ));
    }
    match published {
        Ok(published) => joint.published = Some(Box::new(published)),
        Err(why) => joint.findings.push(Finding::warning(format!(
            "the paper's answer is not there to compare with: {published_method} has none ({why})"
        ))),
    }
    joint.solve_ms = started.elapsed().as_secs_f64() * 1e3 - joint.prior_ms;
    Ok(joint)
}
