//! Method D: from triplets to an answer with its verdict.

use super::unjudged::UnjudgedAnswer;
use super::used::Used;
use super::{FirstSolution, InterPrismDetails, clock_check, gross_errors, systematic_errors};
use crate::calibration::common_errors::CommonErrors;
use crate::calibration::method_answer::MethodAnswer;
use crate::calibration::{CalibrationError, CalibrationSettings, Method, clocks_in_words};
use crate::deployment::Deployment;
use crate::pipeline::Triplets;
use crate::progress::Progress;

/// Calibrates by the inter-prism distances, as published.
pub fn solve(
    first: FirstSolution<'_>,
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    progress: &Progress,
) -> Result<MethodAnswer<InterPrismDetails>, CalibrationError> {
    let FirstSolution { network, data, published, .. } = first;
    let used = Used::all(triplets);
    let prior_ms = published.prior_ms;
    let (time_s, interval) = used.instants();
    let instants = (&time_s[..], &interval[..]);
    let systematic = systematic_errors::estimate(&data, instants, &published.answer, settings);
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
    // The verdict is that of the drive's shape; its σ has the errors of the instruments as well.
    judgement.doubt(systematic.as_ref().and_then(CommonErrors::doubt));
    let covariance = answer.uncertainty.covariance.clone();
    let covariance = covariance.zip(systematic).map(|(noise, common)| noise + common.covariance);
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
