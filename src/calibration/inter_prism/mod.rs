//! Method D: the dynamic inter-prism calibration.
//!
//! Minimises Σ (‖q1−T12 q2‖−α)² + (‖q1−T13 q3‖−β)² + (‖T12 q2−T13 q3‖−γ)² over the translation and yaw of
//! stations 2 and 3 (`paper.tex`, eq. `cost_function_2`).
//!
//! The way to the answer: thinned triplets compressed to a [`squared_cost`] that does not depend on their number → a
//! prior ([`closed_form`] or [`prior_search`]) → [`search`] of all its minima → these on the exact cost, the best one
//! and its mirror twin finished on all triplets ([`minima`]; [`normal_equations`] is the one fused pass over the data)
//! → [`mirror`] decides between the two → [`uncertainty`] → [`observability`] and [`drive_shape`] → [`diagnosis`].
//! What goes beyond the paper is [`refinement`]; its answer then takes the place of the published one in all that follows
//! ([`refined_answer`]).

mod centred;
mod closed_form;
mod compression;
mod diagnosis;
pub mod drive_shape;
pub mod gross_errors;
mod levenberg_marquardt;
mod minima;
mod mirror;
mod motion_in_words;
mod normal_equations;
pub mod observability;
mod prior_search;
mod published;
mod refined_answer;
mod refinement;
pub mod refinement_in_words;
mod search;
mod squared_cost;
mod sums;
mod twins;
mod uncertainty;
mod valley;

use std::borrow::Cow;
use std::time::Instant;

pub use centred::{CentredTriplets, Parameters};
pub use closed_form::closed_form_priors;
use diagnosis::Evidence;
pub use levenberg_marquardt::{Minimum, minimise};
pub use normal_equations::{NormalEquations, distance_pulls};
use observability::Observability;
pub use prior_search::{PriorSearch, SearchRun};
use published::Published;
pub use refinement::{Refinement, Support};
pub use squared_cost::SquaredCost;
pub use twins::Twins;

use super::checks;
use super::joint;
use super::method::why_no_triplets;
use super::{
    Basin, Calibration, CalibrationError, CalibrationSettings, Details, Loss, Method, Mirror,
    Offer, Targets, Verdict,
};
use crate::calibration::ErrorSizes;
use crate::calibration::clocks_in_words;
use crate::deployment::{Deployment, Finding};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::pipeline::Triplets;
use crate::progress::Progress;

/// Eight unknowns, three residuals a triplet: below this there is nothing to average.
const FEWEST_TRIPLETS: usize = 10;
/// Rounds of leaving out what does not fit the answer; the second one is usually the last.
const MOST_SCREENINGS: usize = 4;

/// Two solutions are the same minimum within these; the paper's limits for its prior.
pub const SAME_TRANSLATION_M: f64 = 0.05;
pub const SAME_YAW_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// What only method D knows of its answer.
#[derive(Clone, Debug)]
pub struct InterPrismDetails {
    /// The minimum that is the answer.
    pub basin: Basin,
    pub mirror: Mirror,
    pub observability: Observability,
    /// Every distinct minimum in order of cost, the answer and its twin among them; a valley counts once. The costs of
    /// the others come from about a thousand triplets.
    pub basins: Vec<Basin>,
    /// What the search of the prior did, when it was asked for.
    pub prior_search: Option<PriorSearch>,
    /// What goes beyond the published method, when it was asked for: the answer is then its.
    pub refinement: Option<Refinement>,
}

impl InterPrismDetails {
    /// What one of the minima is.
    pub fn role(&self, basin: &Basin) -> &'static str {
        if *basin == self.basin {
            "answer"
        } else if self.mirror.twin.as_ref() == Some(basin) {
            "mirror twin"
        } else {
            "other"
        }
    }

    /// What one of the minima costs over what the answer costs.
    pub fn cost_ratio(&self, basin: &Basin) -> f64 {
        basin.mean_square_m2 / self.basin.mean_square_m2
    }
}

/// Calibrates by the inter-prism distances, unless `progress` is cancelled on the way.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
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
    let rig =
        deployment.rig.as_ref().ok_or_else(|| CalibrationError::NoRig { deployment: name() })?;

    let started = Instant::now();
    let solve_published = |triplets: &Triplets| {
        published::solve(rig, deployment.comparable_control_points(), triplets, settings.prior)
    };
    let mut published = solve_published(triplets);
    progress.check()?;
    // A robust loss is for errors like noise with long tails; what cannot be right at all must not lead it astray.
    let mut used = Cow::Borrowed(triplets);
    for _ in 0..if settings.loss == Loss::Squared { 0 } else { MOST_SCREENINGS } {
        let answer = published.choice.answer.station1_from_station.map(RigidTransform::from);
        let kept = gross_errors::fitting_triplets(triplets, &answer, &rig.inter_prism_m);
        if kept.len() == used.len() || kept.len() < FEWEST_TRIPLETS {
            break;
        }
        used = Cow::Owned(triplets.select(&kept));
        published = solve_published(&used);
    }
    let mut doubts = Vec::new();
    let (all_s, triplets) = (&triplets.time_s, used.as_ref());
    let mut kept_s = Cow::Borrowed(&triplets.time_s);
    let prior_search = published.prior_search.take();
    let prior_ms = published.prior_ms;
    let plain = published.choice.answer.station1_from_station;
    let mut fitting = observability::fitting(&published.thinned, &published.answer.parameters);
    let mut uncertainty = uncertainty::estimate(
        &published.data,
        &fitting,
        &triplets.time_s,
        &triplets.interval,
        &published.answer,
        settings,
    );
    // Where a direction is free, there is nothing to refine.
    let jointly = settings.method == Some(Method::Joint);
    let refinement = if uncertainty.covariance.is_none() {
        None
    } else if jointly {
        let sizes = ErrorSizes { inter_prism_m: settings.inter_prism_sigma_m, ..settings.errors };
        let distances_m = Some(&rig.inter_prism_m);
        joint::estimate(triplets, &plain, distances_m, &sizes, progress)?
            .map(|found| Refinement::from_joint(found, &plain))
    } else if settings.has_parts() {
        refinement::refine(triplets, &plain, &rig.inter_prism_m, settings, progress)
    } else {
        None
    };
    progress.check()?;
    // From here on the refined answer stands in the place of the published one, on the readings that it put right.
    let mut station1_from_station = plain.map(RigidTransform::from);
    if let Some(refined) = &refinement {
        let points = deployment.comparable_control_points();
        let answer = refined_answer::solve(refined, rig, points, triplets, settings.loss);
        let findings = std::mem::replace(&mut published, answer.found).findings;
        published.findings = findings;
        if let Some(own_s) = answer.kept_s {
            kept_s = Cow::Owned(own_s);
        }
        fitting = observability::fitting(&published.thinned, &published.answer.parameters);
        uncertainty = uncertainty::of_covariance(
            &published.data,
            &fitting,
            &published.answer,
            refined.covariance,
        );
        station1_from_station = refined.station1_from_station;
        doubts.extend(answer.doubt);
        doubts.extend(checks::unconverged(refined.converged));
        doubts.extend(refinement_in_words::doubts(refined, &rig.inter_prism_m, settings));
        doubts.extend(refined.joint.iter().flat_map(|joint| joint::in_words::doubts(joint)));
    }
    let Published { data, thinned, answer, choice, basins, rival, mut findings, .. } = published;
    let sigma = uncertainty.sigma();
    let observability = observability::observe(&fitting, &answer.parameters, &uncertainty);
    let evidence = Evidence {
        deployment,
        thinned: &thinned,
        answer: &answer,
        rival,
        uncertainty: &uncertainty,
        observability: &observability,
        choice: &choice,
        station1_from_station: &station1_from_station,
        sigma,
    };
    let mut verdict = diagnosis::judge(&evidence, &mut findings);
    let mut lower = |to: Verdict, more: Vec<Finding>| {
        verdict = if more.is_empty() { verdict } else { verdict.max(to) };
        findings.extend(more);
    };
    if settings.loss == Loss::Squared {
        let pull = gross_errors::pull(&data, &thinned, &answer, sigma.as_ref());
        lower(Verdict::Weak, pull.into_iter().collect());
    }
    if !settings.estimate.clocks
        && uncertainty.covariance.is_some()
        && let Some(clocks) = refinement::suspected_clocks(
            triplets,
            &plain,
            &rig.inter_prism_m,
            settings.inter_prism_sigma_m,
        )
    {
        lower(Verdict::Weak, clocks_in_words::suspicions(&clocks.offsets_s));
        lower(Verdict::Weak, clocks_in_words::suspected_jumps(&clocks.jumps_s));
    }
    if let Some(refined) = &refinement {
        if refined.joint.is_none() {
            lower(Verdict::Weak, refinement_in_words::uneven_clocks(refined));
        }
        findings.extend(refinement_in_words::findings(refined, &rig.inter_prism_m));
        findings.extend(refined.joint.iter().flat_map(|joint| joint::in_words::findings(joint)));
    } else if jointly || settings.has_parts() {
        let line = "nothing was refined: the data does not hold all that was to be estimated";
        lower(Verdict::Weak, vec![Finding::warning(line)]);
    }
    doubts.extend(gross_errors::left_out(all_s, &kept_s));
    // The answer's own evidence against it comes first.
    for (to, finding) in doubts.into_iter().rev() {
        verdict = verdict.max(to);
        let at = if to == Verdict::Good { findings.len() } else { 0 };
        findings.insert(at, finding);
    }
    Ok(Calibration {
        method: Method::InterPrism,
        station1_from_station,
        sigma,
        covariance: uncertainty.covariance,
        verdict,
        findings,
        checked_by: Vec::new(),
        details: Details::InterPrism(Box::new(InterPrismDetails {
            basin: choice.answer,
            mirror: choice.mirror,
            observability,
            basins,
            prior_search,
            refinement,
        })),
        published: None,
        prior_ms,
        solve_ms: started.elapsed().as_secs_f64() * 1e3 - prior_ms,
    })
}

/// Whether two solutions are the same minimum.
pub fn same_solution(a: &[LevelTransform; 3], b: &[LevelTransform; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| {
        (a.translation_m - b.translation_m).norm() < SAME_TRANSLATION_M
            && crate::geometry::wrap_to_pi(a.yaw_rad - b.yaw_rad).abs() < SAME_YAW_RAD
    })
}

fn basin(data: &CentredTriplets, minimum: &Minimum) -> Basin {
    Basin {
        station1_from_station: data.transforms(&minimum.parameters),
        mean_square_m2: minimum.normal.cost / (3 * data.len()) as f64,
        height_differences_m: data.height_differences_m(&minimum.parameters),
    }
}
