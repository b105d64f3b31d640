//! The sense check of one answer.

use super::explanation::{self, Tried};
use super::shown::{Agreement, Shown, Witnesses};
use crate::calibration::{Calibration, Method, Offer, Targets, Verdict, Witness};
use crate::deployment::{Deployment, Finding, Remedy};
use crate::pipeline::Triplets;
use crate::progress::{Cancelled, Progress};

/// Triplets that show which way round the prisms lie.
const THINNED: usize = 300;

/// Holds an answer about three prisms against the rig, and names the misreading that explains a contradiction.
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
    if calibration.method == Method::DynamicGcp
        || offer.targets == Targets::OnePrism
        || nothing_to_hold
    {
        return Ok(());
    }
    let step = triplets.len().div_ceil(THINNED).max(1);
    let some = triplets.select(&(0..triplets.len()).step_by(step).collect::<Vec<_>>());
    let points = deployment.comparable_control_points();
    let Some(shown) = Shown::of(rig, points, &some, &calibration.station1_from_station) else {
        return Ok(());
    };
    let witnesses = Witnesses::new(rig, calibration.sigma.as_ref());
    let (area, heights) = (witnesses.area(&shown), witnesses.heights(&shown));
    let contradictions = [
        (area == Some(Agreement::Contradicts)).then(|| area_in_words(&witnesses, &shown)),
        (heights == Some(Agreement::Contradicts)).then(|| heights_in_words(&witnesses, &shown)),
    ];
    for line in contradictions.into_iter().flatten() {
        calibration.verdict = calibration.verdict.max(Verdict::Weak);
        calibration.findings.push(Finding::warning(line).with(Remedy::PutRight));
    }
    // Heights alone tell no sense, and a thin rig has none.
    if area == Some(Agreement::Agrees) && heights != Some(Agreement::Contradicts) {
        calibration.checked_by.push(Witness::Rig);
    }
    let doubted =
        [area, heights, Some(Witnesses::distances(&shown)), Witnesses::control_points(&shown)]
            .into_iter()
            .flatten()
            .any(|agreement| agreement > Agreement::Agrees);
    if doubted {
        let sigma = calibration.sigma.as_ref();
        let found = explanation::explain(deployment, rig, triplets, sigma, tried, progress)?;
        for (place, finding) in found.into_iter().enumerate() {
            if finding.severity > crate::deployment::Severity::Note {
                calibration.verdict = calibration.verdict.max(Verdict::Weak);
            }
            calibration.findings.insert(place, finding);
        }
    }
    Ok(())
}

fn area_in_words(witnesses: &Witnesses<'_>, shown: &Shown) -> String {
    let known_m2 = witnesses.area_m2().unwrap_or(0.0);
    let way = |area_m2: f64| if area_m2 > 0.0 { "counter-clockwise" } else { "clockwise" };
    format!(
        "seen from above, prisms 1, 2, 3 lie {} in this answer ({:+.3} m²) and {} in the reading of the rig ({known_m2:+.3} \
         m²): azimuths run the other way, or two stations are exchanged",
        way(shown.area_m2),
        shown.area_m2,
        way(known_m2),
    )
}

fn heights_in_words(witnesses: &Witnesses<'_>, shown: &Shown) -> String {
    let known_m = witnesses.heights_m().unwrap_or_default();
    format!(
        "prism 1 stands {:+.3} and {:+.3} m above prisms 2 and 3 in this answer, {:+.3} and {:+.3} m in the reading of the \
         rig, more than the vehicle tilts; check which station tracked which prism",
        shown.heights_m[0], shown.heights_m[1], known_m[0], known_m[1]
    )
}
