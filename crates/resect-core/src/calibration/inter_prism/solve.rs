//! Method D from triplets to an answer that is judged, step by step.

use std::borrow::Cow;

use super::diagnosis::{self, Evidence};
use super::observability::Observability;
use super::published::{self, Published};
use super::refinement::{self, Refinement, SuspectedClocks};
use super::uncertainty::{self, Uncertainty};
use super::used::Used;
use super::{
    CentredTriplets, FEWEST_TRIPLETS, InterPrismDetails, PriorSearch, gross_errors, observability,
    refined_answer, refinement_in_words,
};
use crate::calibration::method::why_no_triplets;
use crate::calibration::{
    Calibration, CalibrationError, CalibrationSettings, Details, ErrorSizes, Loss, Method, Offer,
    PriorMethod, Targets, Verdict, checks, clocks_in_words, joint,
};
use crate::deployment::{Deployment, Finding, Rig};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::pipeline::Triplets;
use crate::progress::Progress;
use crate::stopwatch::Stopwatch;

/// Rounds of leaving out what does not fit the answer; the second one is usually the last.
const MOST_SCREENINGS: usize = 4;

/// What is asked.
struct Task<'a> {
    deployment: &'a Deployment,
    rig: &'a Rig,
    settings: &'a CalibrationSettings,
    progress: &'a Progress,
}

/// Calibrates by the inter-prism distances, unless `progress` is cancelled on the way.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
    let rig = what_it_takes(deployment, triplets, offer)?;
    let task = Task { deployment, rig, settings, progress };
    let started = Stopwatch::start();
    let (published, data, used) = published_answer(&task, triplets)?;
    let prior_ms = published.prior_ms;
    let plain = published.choice.answer.station1_from_station;
    let (mut found, suspected) = rayon::join(
        || Found::published(&task, published, &data, &used),
        || suspected_clocks(&task, &used, &plain),
    );
    drop(data);
    let refinement = match found.uncertainty.covariance {
        Some(_) => refined(&task, &used, &plain)?,
        // Where a direction is free, there is nothing to refine.
        None => None,
    };
    progress.check()?;
    if let Some(refined) = &refinement {
        found.refine(&task, refined, &used);
    }
    let observability = observability::observe(
        &found.fitting,
        &found.published.answer.parameters,
        &found.uncertainty,
    );
    let mut judgement = found.judged(&task, &observability);
    judgement.doubt(found.pull_of_gross_errors.take());
    if let Some(clocks) = suspected.filter(|_| found.uncertainty.covariance.is_some()) {
        judgement.doubt(clocks_in_words::suspicions(&clocks.offsets_s));
        judgement.doubt(clocks_in_words::suspected_jumps(&clocks.jumps_s));
    }
    judgement.add_refinement(&task, refinement.as_ref());
    let kept_s = found.kept_s.take().map_or_else(|| used.instants().0, Cow::Owned);
    found.doubts.extend(gross_errors::left_out(&triplets.time_s, &kept_s));
    judgement.put_first(found.doubts);
    let Published { choice, basins, .. } = found.published;
    Ok(Calibration {
        method: Method::InterPrism,
        station1_from_station: found.station1_from_station,
        sigma: found.uncertainty.sigma(),
        covariance: found.uncertainty.covariance,
        verdict: judgement.verdict,
        findings: judgement.findings,
        checked_by: Vec::new(),
        details: Details::InterPrism(Box::new(InterPrismDetails {
            basin: choice.answer,
            mirror: choice.mirror,
            observability,
            basins,
            prior_search: found.prior_search,
            refinement,
        })),
        published: None,
        prior_ms,
        solve_ms: started.elapsed_ms() - prior_ms,
    })
}

/// The rig, where all else that the method takes is there as well.
fn what_it_takes<'a>(
    deployment: &'a Deployment,
    triplets: &Triplets,
    offer: &Offer,
) -> Result<&'a Rig, CalibrationError> {
    let name = || deployment.name.clone();
    if triplets.is_empty() {
        let why = why_no_triplets(deployment);
        return Err(CalibrationError::NoTriplets { deployment: name(), why });
    }
    if offer.targets == Targets::OnePrism {
        return Err(CalibrationError::lacking(deployment, Method::InterPrism, offer));
    }
    if triplets.len() < FEWEST_TRIPLETS {
        let (found, needed) = (triplets.len(), FEWEST_TRIPLETS);
        return Err(CalibrationError::TooFewTriplets { deployment: name(), found, needed });
    }
    deployment.rig.as_ref().ok_or_else(|| CalibrationError::NoRig { deployment: name() })
}

/// The paper's answer, and the triplets that it rests on.
///
/// A robust loss is for errors like noise with long tails; what cannot be right at all must not lead it astray, and is left
/// out before.
fn published_answer<'a>(
    task: &Task<'_>,
    triplets: &'a Triplets,
) -> Result<(Published, CentredTriplets, Used<'a>), CalibrationError> {
    let points = task.deployment.comparable_control_points();
    let solve = |used: &Used<'_>, data: &CentredTriplets| {
        let search = (task.settings.prior == PriorMethod::Search).then_some(used);
        published::solve(task.rig, points, data, search)
    };
    let mut used = Used::all(triplets);
    let mut data = used.centred(task.rig.inter_prism_m);
    let mut published = solve(&used, &data);
    task.progress.check()?;
    for _ in 0..if task.settings.loss == Loss::Squared { 0 } else { MOST_SCREENINGS } {
        let answer = published.choice.answer.station1_from_station.map(RigidTransform::from);
        let kept =
            gross_errors::fitting_triplets(&triplets.points_m, &answer, &task.rig.inter_prism_m);
        if kept.len() == used.len() || kept.len() < FEWEST_TRIPLETS {
            break;
        }
        used = Used::some(triplets, kept);
        drop(data);
        data = used.centred(task.rig.inter_prism_m);
        published = solve(&used, &data);
    }
    Ok((published, data, used))
}

/// Clocks that seem off, where they are not estimated.
fn suspected_clocks(
    task: &Task<'_>,
    used: &Used<'_>,
    plain: &[LevelTransform; 3],
) -> Option<SuspectedClocks> {
    let settings = task.settings;
    let ask = || {
        refinement::suspected_clocks(
            &used.triplets(),
            plain,
            &task.rig.inter_prism_m,
            settings.inter_prism_sigma_m,
        )
    };
    (!settings.estimate.clocks).then(ask).flatten()
}

/// What goes beyond the paper, where it was asked for and the data holds it.
fn refined(
    task: &Task<'_>,
    used: &Used<'_>,
    plain: &[LevelTransform; 3],
) -> Result<Option<Refinement>, CalibrationError> {
    let Task { settings, progress, .. } = task;
    let inter_prism_m = &task.rig.inter_prism_m;
    if settings.method == Some(Method::Joint) {
        let sizes = ErrorSizes { inter_prism_m: settings.inter_prism_sigma_m, ..settings.errors };
        let found =
            joint::estimate(&|| used.triplets(), plain, Some(inter_prism_m), &sizes, progress)?;
        Ok(found.map(|found| Refinement::from_joint(found, plain)))
    } else if settings.has_parts() {
        Ok(refinement::refine(&used.triplets(), plain, inter_prism_m, settings, progress))
    } else {
        Ok(None)
    }
}

/// An answer that is not judged yet.
struct Found {
    published: Published,
    prior_search: Option<PriorSearch>,
    /// The triplets whose distances fit.
    fitting: CentredTriplets,
    uncertainty: Uncertainty,
    station1_from_station: [RigidTransform; 3],
    /// Times of the triplets that it rests on (s), where these are fewer than those of the published answer.
    kept_s: Option<Vec<f64>>,
    /// The answer's own evidence against it.
    doubts: Vec<(Verdict, Finding)>,
    /// What is wild and was not left out.
    pull_of_gross_errors: Option<Finding>,
}

impl Found {
    fn published(
        task: &Task<'_>,
        mut published: Published,
        data: &CentredTriplets,
        used: &Used<'_>,
    ) -> Self {
        let (time_s, interval) = used.instants();
        let fitting = observability::fitting(&published.thinned, &published.answer.parameters);
        let uncertainty = uncertainty::estimate(
            data,
            &fitting,
            &time_s,
            &interval,
            &published.answer,
            task.settings,
        );
        let plain = published.choice.answer.station1_from_station;
        Self {
            pull_of_gross_errors: pull_of_gross_errors(task, &published, data, &uncertainty),
            prior_search: published.prior_search.take(),
            published,
            fitting,
            uncertainty,
            station1_from_station: plain.map(RigidTransform::from),
            kept_s: None,
            doubts: Vec::new(),
        }
    }

    /// Puts the refined answer in the place of the published one from here on, on the readings that it put right.
    fn refine(&mut self, task: &Task<'_>, refined: &Refinement, used: &Used<'_>) {
        let points = task.deployment.comparable_control_points();
        let answer = refined_answer::solve(refined, task.rig, points, used, task.settings.loss);
        let findings = std::mem::replace(&mut self.published, answer.found).findings;
        self.published.findings = findings;
        self.kept_s = answer.kept_s;
        let found = &self.published;
        self.fitting = observability::fitting(&found.thinned, &found.answer.parameters);
        self.uncertainty = uncertainty::of_covariance(
            &answer.data,
            &self.fitting,
            &found.answer,
            refined.covariance,
        );
        self.pull_of_gross_errors =
            pull_of_gross_errors(task, found, &answer.data, &self.uncertainty);
        let published =
            std::mem::replace(&mut self.station1_from_station, refined.station1_from_station);
        if refined.joint.is_some() {
            self.doubts.extend(checks::far_apart(&published, &refined.station1_from_station));
        }
        let inter_prism_m = &task.rig.inter_prism_m;
        self.doubts.extend(answer.doubt);
        self.doubts.extend(checks::unconverged(refined.converged));
        self.doubts.extend(refinement_in_words::doubts(refined, inter_prism_m, task.settings));
        self.doubts.extend(refined.joint.iter().flat_map(|joint| joint::in_words::doubts(joint)));
    }

    fn judged(&mut self, task: &Task<'_>, observability: &Observability) -> Judgement {
        let mut findings = std::mem::take(&mut self.published.findings);
        let evidence = Evidence {
            deployment: task.deployment,
            thinned: &self.published.thinned,
            answer: &self.published.answer,
            rival: self.published.rival,
            uncertainty: &self.uncertainty,
            observability,
            choice: &self.published.choice,
            station1_from_station: &self.station1_from_station,
            sigma: self.uncertainty.sigma(),
        };
        let verdict = diagnosis::judge(&evidence, &mut findings);
        Judgement { verdict, findings }
    }
}

/// How far what is wild and was not left out pulls an answer by least squares.
fn pull_of_gross_errors(
    task: &Task<'_>,
    published: &Published,
    data: &CentredTriplets,
    uncertainty: &Uncertainty,
) -> Option<Finding> {
    let is_plain = task.settings.loss == Loss::Squared;
    let sigma = uncertainty.sigma();
    let Published { thinned, answer, .. } = published;
    is_plain.then(|| gross_errors::pull(data, thinned, answer, sigma.as_ref())).flatten()
}

/// A verdict, and why it is that.
struct Judgement {
    verdict: Verdict,
    findings: Vec<Finding>,
}

impl Judgement {
    fn doubt(&mut self, more: impl IntoIterator<Item = Finding>) {
        for finding in more {
            self.verdict = self.verdict.max(Verdict::Weak);
            self.findings.push(finding);
        }
    }

    fn add_refinement(&mut self, task: &Task<'_>, refinement: Option<&Refinement>) {
        let Some(refined) = refinement else {
            if task.settings.method == Some(Method::Joint) || task.settings.has_parts() {
                let line =
                    "nothing was refined: the data does not hold all that was to be estimated";
                self.doubt([Finding::warning(line)]);
            }
            return;
        };
        if refined.joint.is_none() {
            self.doubt(refinement_in_words::uneven_clocks(refined));
        }
        self.findings.extend(refinement_in_words::findings(refined, &task.rig.inter_prism_m));
        let of_joint = refined.joint.iter().flat_map(|joint| joint::in_words::findings(joint));
        self.findings.extend(of_joint);
    }

    /// Doubts come first, in their order; what doubts nothing comes last.
    fn put_first(&mut self, doubts: Vec<(Verdict, Finding)>) {
        for (to, finding) in doubts.into_iter().rev() {
            self.verdict = self.verdict.max(to);
            let at = if to == Verdict::Good { self.findings.len() } else { 0 };
            self.findings.insert(at, finding);
        }
    }
}
