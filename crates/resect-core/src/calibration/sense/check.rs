//! The sense check of one answer.

use super::explanation::{self, Tried};
use super::shown::{Agreement, Shown, Witnesses};
use crate::calibration::misfits::control_points_apart_m;
use crate::calibration::{Calibration, Method, Offer, Verdict, Witness};
use crate::deployment::Deployment;
use crate::deployment::findings::checks::{rig_heights_contradict, rig_orientation_contradicts};
use crate::network::Prism;
use crate::pipeline::Triplets;
use crate::progress::{Cancelled, Progress};

/// Number of triplets from which the orientation of the prisms is computed.
const THINNED: usize = 300;

/// Compares an answer for several prisms with the rig, and names the misreading that explains a contradiction.
pub fn check(
    calibration: &mut Calibration,
    deployment: &Deployment,
    triplets: &Triplets,
    offer: &Offer,
    tried: &mut Tried,
    progress: &Progress,
) -> Result<(), Cancelled> {
    let Some(rig) = &deployment.rig else { return Ok(()) };
    let nothing_to_hold = calibration.placing_tracks(deployment).is_none();
    if calibration.method == Method::DynamicGcp || Prism::is_one(&offer.followed) || nothing_to_hold
    {
        return Ok(());
    }
    let step = triplets.len().div_ceil(THINNED).max(1);
    let some = triplets.select(&(0..triplets.len()).step_by(step).collect::<Vec<_>>());
    let points = deployment.comparable_control_points();
    let followed = &offer.followed;
    let Some(mut shown) =
        Shown::of((rig, followed), points, &some, &calibration.station1_from_station)
    else {
        return Ok(());
    };
    shown.control_points_m = control_points_apart_m(points, &calibration.survey_transforms());
    let of_noise = calibration.inter_prism().and_then(|details| details.noise_sigma.clone());
    let sigma = of_noise.or_else(|| calibration.sigma.clone());
    let witnesses = Witnesses::new((rig, followed), sigma.as_ref());
    let (area, heights) = (witnesses.area(&shown), witnesses.heights(&shown));
    let contradictions = [
        (area == Some(Agreement::Contradicts)).then(|| {
            rig_orientation_contradicts(
                shown.area_m2.unwrap_or(0.0),
                witnesses.area_m2().unwrap_or(0.0),
            )
        }),
        (heights == Some(Agreement::Contradicts)).then(|| {
            rig_heights_contradict(&shown.heights_m, &witnesses.heights_m().unwrap_or_default())
        }),
    ];
    for finding in contradictions.into_iter().flatten() {
        calibration.verdict = calibration.verdict.max(Verdict::Weak);
        calibration.findings.push(finding);
    }
    // Heights alone do not determine the sense, and a nearly collinear rig has none.
    if area == Some(Agreement::Agrees) && heights != Some(Agreement::Contradicts) {
        calibration.checked_by.push(Witness::Rig);
    }
    let doubted =
        [area, heights, Some(Witnesses::distances(&shown)), Witnesses::control_points(&shown)]
            .into_iter()
            .flatten()
            .any(|agreement| agreement > Agreement::Agrees);
    if doubted {
        let answer = (&shown, sigma.as_ref());
        let explanations =
            explanation::explain(deployment, rig, triplets, answer, tried, progress)?;
        for (place, finding) in explanations.into_iter().enumerate() {
            if finding.severity > crate::deployment::Severity::Note {
                calibration.verdict = calibration.verdict.max(Verdict::Weak);
            }
            calibration.findings.insert(place, finding);
        }
    }
    Ok(())
}
