//! Method D: from triplets to an answer with its verdict.

use super::unjudged::{UnjudgedAnswer, required_rig};
use super::used::Used;
use super::{InterPrismDetails, clock_check, gross_errors, published};
use crate::calibration::method_answer::MethodAnswer;
use crate::calibration::{
    CalibrationError, CalibrationSettings, Method, Offer, PriorMethod, clocks_in_words,
};
use crate::deployment::Deployment;
use crate::pipeline::Triplets;
use crate::progress::Progress;

/// Calibrates by the inter-prism distances, as published.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<MethodAnswer<InterPrismDetails>, CalibrationError> {
    let (rig, network) = required_rig(deployment, triplets, offer)?;
    let used = Used::all(triplets);
    let heights_m = network.height_differences_m(rig);
    let data = used.centred(&network);
    let search = (settings.prior == PriorMethod::Search).then_some(&used);
    let points = deployment.comparable_control_points();
    let published = published::solve(heights_m.as_ref(), points, &data, search);
    progress.check()?;
    let prior_ms = published.prior_ms;
    let plain = published.choice.answer.station1_from_station.clone();
    let ((mut answer, pull), suspected) = rayon::join(
        || {
            let answer = UnjudgedAnswer::published(published, &data, &used, settings);
            let sigma = answer.uncertainty.sigma();
            let (thinned, minimum) = (&answer.published.thinned, &answer.published.answer);
            let pull = gross_errors::pull(&data, thinned, minimum, sigma.as_ref());
            (answer, pull)
        },
        || {
            let sigma_m = settings.published_distance_sigma_m();
            clock_check::suspected_clocks(triplets, &plain, &network, sigma_m)
        },
    );
    drop(data);
    progress.check()?;
    let observability = answer.observability();
    let mut judgement = answer.judge(deployment, &observability, None);
    judgement.doubt(pull);
    let covariance = answer.uncertainty.covariance.clone();
    if let Some(clocks) = suspected.filter(|_| covariance.is_some()) {
        judgement.doubt(clocks_in_words::suspicions(&clocks.offsets_s));
        judgement.doubt(clocks_in_words::suspected_jumps(&clocks.jumps_s));
    }
    Ok(MethodAnswer {
        method: Method::InterPrism,
        station1_from_station: answer.station1_from_station.clone(),
        covariance,
        judgement,
        checked_by: Vec::new(),
        details: answer.into_details(observability),
        prior_ms,
    })
}
