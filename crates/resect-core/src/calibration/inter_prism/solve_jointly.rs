//! The joint estimate of several prisms: from the published answer to the estimate from the readings, with its verdict.

use std::borrow::Cow;
use std::sync::Arc;

use super::joint_answer::JointAnswer;
use super::joint_minimum::MinimumSearch;
use super::published::Published;
use super::screening::{Screened, Screening};
use super::uncertainty::Uncertainty;
use super::unjudged::UnjudgedAnswer;
use super::{
    FirstSolution, InterPrismDetails, StartingPoint, followed_another, gross_errors, uncertainty,
};
use crate::calibration::followed_prisms::schedule;
use crate::calibration::joint::{
    self, JointEstimate, JointInput, Layout, RigDistances, SolverStatus,
};
use crate::calibration::joint_data::{JointData, contradicting_runs};
use crate::calibration::joint_failure::{JointFailure, JointResult};
use crate::calibration::method_answer::MethodAnswer;
use crate::calibration::{
    CalibrationError, CalibrationSettings, ErrorSizes, Method, Offer, Verdict, checks,
};
use crate::deployment::findings::outliers::{prism_changed, span_left_out};
use crate::deployment::{Deployment, Finding, kinds};
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;
use crate::progress::Progress;

/// Calibrates by the joint estimate of several prisms. If it fails, the answer is that of method D.
pub fn solve_jointly(
    start: StartingPoint<'_>,
    deployment: &Deployment,
    all: &JointData<'_>,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<MethodAnswer<(JointResult, InterPrismDetails)>, CalibrationError> {
    let StartingPoint { rig, network, published } = start;
    let triplets = all.triplets;
    let layout = &Arc::new(Layout::of_schedule(&schedule(deployment, &offer.followed)));
    let screening = Screening { deployment, rig, network: &network, triplets, settings, progress };
    let (screened, survey) = rayon::join(
        || screening.screened(published),
        || joint::adjust_survey::of_deployment(deployment, layout, settings),
    );
    let Screened { published, data, used } = screened?;
    let prior_ms = published.prior_ms;
    let plain = published.choice.answer.station1_from_station.clone();
    let start_answer = UnjudgedAnswer::published(published, &data, &used, settings);
    drop(data);
    let sizes = ErrorSizes { inter_prism_m: settings.inter_prism_sigma_m, ..settings.errors };
    let is_determined_by_drive = start_answer.uncertainty.covariance.is_some();
    let by_survey = || Some(survey.as_ref()?.poses(&sizes)?.0);
    // A direction that is unobservable for the published answer is so for the joint estimate, unless control points determine it.
    let start = if is_determined_by_drive { Some(plain) } else { by_survey() };
    let mut runs = Vec::new();
    let estimated = match start {
        Some(start) => {
            let input = JointInput {
                layout,
                published: &start,
                rig: RigDistances::new(rig, layout, settings.evidence.rig),
                survey: survey.clone(),
                is_determined_by_drive,
                sizes: &sizes,
            };
            let heights_m = network.height_differences_m(rig);
            let (readings, contradicting) = all.fitting(deployment, &offer.followed, &start);
            runs = contradicting;
            let search = MinimumSearch {
                input: &input,
                deployment,
                network: &network,
                heights_m: heights_m.as_ref(),
                readings: &readings,
                used: &used,
                progress,
            };
            search.estimate()?
        }
        None => Err(JointFailure::before_first_step(SolverStatus::UnobservableStart)),
    };
    let (estimate, evaluated) = match estimated {
        Ok(estimated) => estimated,
        Err(failure) => {
            let published = all.of_published;
            return in_place_of_joint(failure, deployment, published, settings, offer, progress);
        }
    };
    progress.check()?;
    let (mut answer, kept_s, mut doubts) = unjudged(start_answer, &estimate, evaluated);
    let observability = answer.observability();
    let mut judgement = answer.judge(deployment, &observability, estimate.survey.as_ref());
    joint::findings::add_notes(&mut judgement.findings, &estimate, Some(rig));
    judgement.findings.extend(contradicting_runs(&runs, triplets.time_s[0]));
    let kept_s = kept_s.map_or_else(|| used.instants().0, Cow::Owned);
    let explain = |span_s: [f64; 2]| {
        let (network, placed) = (network.with_estimates(&estimate), &answer.station1_from_station);
        let start_s = triplets.time_s[0];
        match followed_another::prism_changes(triplets, placed, &network, rig, span_s) {
            Some(changes) => prism_changed(&changes, deployment, start_s),
            None => span_left_out(span_s, start_s),
        }
    };
    // The joint estimate takes readings, which are counted instead of triplets.
    let left_out = gross_errors::left_out(&triplets.time_s, &kept_s, explain);
    let is_told = |(_, finding): &(Verdict, Finding)| finding.kind != kinds::OUTLIERS_LEFT_OUT;
    doubts.extend(left_out.into_iter().filter(is_told));
    judgement.put_first(doubts);
    Ok(MethodAnswer {
        method: Method::Joint,
        station1_from_station: answer.station1_from_station.clone(),
        covariance: answer.uncertainty.covariance.clone(),
        judgement,
        checked_by: Vec::new(),
        details: (Ok(estimate), answer.into_details(observability)),
        prior_ms,
    })
}

/// Returns the answer of method D in place of a joint estimate that failed.
fn in_place_of_joint(
    failure: JointFailure,
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<MethodAnswer<(JointResult, InterPrismDetails)>, CalibrationError> {
    let first = FirstSolution::new(deployment, triplets, settings, offer, progress);
    let published = first
        .and_then(|first| super::solve::solve(first, deployment, triplets, settings, progress));
    let published = published.map_err(|why| failure.without_published(why))?;
    Ok(published.in_place_of_joint(failure))
}

/// The joint estimate before its verdict, the times of its kept triplets (s; `None` if none is rejected), and the doubts about it.
type UnjudgedEstimate = (UnjudgedAnswer, Option<Vec<f64>>, Vec<(Verdict, Finding)>);

/// Returns the joint estimate before its verdict, on the corrected readings, from the published answer that it started from.
fn unjudged(
    start: UnjudgedAnswer,
    estimate: &JointEstimate,
    evaluated: JointAnswer,
) -> UnjudgedEstimate {
    let doubt = evaluated.doubt();
    let JointAnswer { solution, data, kept_s, .. } = evaluated;
    let published = Published { findings: start.published.findings, ..solution };
    let minimum = &published.answer;
    let fitting = gross_errors::inliers(&published.thinned, &minimum.parameters);
    let covariance = estimate.covariance.clone();
    let uncertainty = Uncertainty {
        has_control_points: estimate.survey.is_some(),
        ..uncertainty::of_covariance(&data, &fitting, minimum, covariance)
    };
    let station1_from_station =
        estimate.station1_from_station.map(|level| RigidTransform::from(*level));
    let mut doubts = Vec::new();
    if start.uncertainty.covariance.is_some() {
        doubts.extend(checks::far_apart(&start.station1_from_station, &station1_from_station));
    }
    doubts.extend(doubt);
    doubts.extend(joint::findings::doubts(estimate));
    let prior_search = start.prior_search;
    let answer =
        UnjudgedAnswer { published, prior_search, fitting, uncertainty, station1_from_station };
    (answer, kept_s, doubts)
}
