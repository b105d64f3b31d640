//! Reference transforms for the errors of the pipeline.
//!
//! The paper uses the transforms of the static control points, because those of the dynamic methods are estimated from the same
//! triplets.

use super::StudyError;
use super::split::{DataSubset, SplitPlan, Splits};
use crate::findings::studies::deployment_left_out;
use resect_core::analysis::Settings;
use resect_core::calibration;
use resect_core::calibration::{Method, Offer};
use resect_core::deployment::{Deployment, Finding};
use resect_core::evaluation;
use resect_core::evaluation::known_distances_m;
use resect_core::geometry::RigidTransform;
use resect_core::network::{PerPair, PerStation, Prism};
use resect_core::pipeline;
use resect_core::pipeline::PipelineSettings;

/// Method of the reference transforms. `None` selects B if the data allows it, else the paper's dynamic method. The studies are
/// the paper's, so the joint estimate is the reference only of one station, or if it is named.
pub type Reference = Option<Method>;

/// Reference for the errors of a deployment.
pub struct Judge {
    pub method: Method,
    plan: SplitPlan,
    /// Transforms estimated from each training subset.
    station1_from_station: Vec<PerStation<RigidTransform>>,
    followed: PerStation<Prism>,
    inter_prism_m: Option<PerPair<f64>>,
}

impl Judge {
    /// Calibrates with these settings. The findings are the limits of the reference.
    pub fn new(
        deployment: &Deployment,
        settings: &Settings,
        reference: Reference,
        splits: Option<Splits>,
    ) -> Result<(Self, Vec<Finding>), String> {
        let triplets = pipeline::run(deployment, &settings.pipeline).triplets;
        let offer = Offer::of(deployment, &triplets);
        let method = reference.unwrap_or_else(|| {
            if offer.lack(Method::StaticGcp).is_none() {
                Method::StaticGcp
            } else {
                offer.first_method()
            }
        });
        if let Some(lack) = offer.lack(method) {
            return Err(format!("{}: {method} needs {lack}", deployment.name));
        }
        let chosen =
            calibration::CalibrationSettings { method: Some(method), ..settings.calibration };
        let mut findings = Vec::new();
        let mut station1_from_station = Vec::new();
        let plan = SplitPlan::new(deployment, &triplets, splits);
        for [train, _] in plan.parts(deployment, &triplets) {
            let answer = calibration::solve(&train.deployment, &train.triplets, &chosen, &offer)
                .map_err(|error| error.to_string())?;
            let doubts = answer
                .findings
                .into_iter()
                .filter(|f| f.severity > resect_core::deployment::Severity::Note);
            if findings.is_empty() {
                let context = format!("{}, {method}", deployment.name);
                findings.extend(doubts.map(|finding| finding.within(&context)));
            }
            station1_from_station.push(answer.station1_from_station);
        }
        Ok((
            Self {
                method,
                plan,
                station1_from_station,
                inter_prism_m: known_distances_m(deployment, &offer.followed),
                followed: offer.followed.clone(),
            },
            findings,
        ))
    }

    /// Distance errors of the pipeline's triplets (mm), of unseen triplets if there are splits, and the number of triplets.
    pub fn errors_mm(
        &self,
        deployment: &Deployment,
        settings: &PipelineSettings,
    ) -> (Vec<f64>, usize) {
        let triplets = pipeline::run(deployment, settings).triplets;
        let errors = self
            .plan
            .parts(deployment, &triplets)
            .into_iter()
            .zip(&self.station1_from_station)
            .flat_map(|([_, test], transforms)| self.part_errors_mm(&test, transforms))
            .collect();
        (errors, triplets.len())
    }

    fn part_errors_mm(
        &self,
        part: &DataSubset,
        transforms: &PerStation<RigidTransform>,
    ) -> Vec<f64> {
        let DataSubset { deployment, triplets } = part;
        let distances_m = (&self.followed, self.inter_prism_m.as_ref());
        let evaluation = evaluation::evaluate(deployment, triplets, distances_m, transforms);
        evaluation.distance_errors_mm.into_iter().flatten().collect()
    }
}

/// A deployment with its judge.
pub type JudgedDeployment<'a> = (&'a Deployment, Judge);

/// Judges of all deployments. A deployment without one is left out with a finding; it is an error if none has one.
pub fn judges<'a>(
    deployments: &'a [std::sync::Arc<Deployment>],
    settings: &Settings,
    reference: Reference,
    splits: Option<Splits>,
) -> Result<(Vec<JudgedDeployment<'a>>, Vec<Finding>), StudyError> {
    let mut findings = Vec::new();
    let mut judges = Vec::new();
    for deployment in deployments {
        match Judge::new(deployment, settings, reference, splits) {
            Ok((judge, doubts)) => {
                findings.extend(doubts);
                judges.push((deployment.as_ref(), judge));
            }
            Err(why) => findings.push(deployment_left_out(&why)),
        }
    }
    if judges.is_empty() {
        let why: Vec<String> = findings.iter().map(ToString::to_string).collect();
        return Err(StudyError::Nothing(format!(
            "no deployment can be judged: {}",
            why.join("; ")
        )));
    }
    Ok((judges, findings))
}

/// Names every method in use: "the transforms of method B, static control points".
pub fn in_words(judges: &[JudgedDeployment<'_>], splits: Option<Splits>) -> String {
    let used =
        Method::ALL.into_iter().filter(|method| judges.iter().any(|(_, j)| j.method == *method));
    let names: Vec<String> = used.map(Method::in_words).collect();
    let data = match judges.len() {
        1 => judges[0].0.name.clone(),
        count => format!("{count} deployments"),
    };
    let unseen = splits.map_or(String::new(), |splits| {
        format!(
            "; each on the 25 % left out, {} random splits, seed {}",
            splits.repeats, splits.seed
        )
    });
    format!("{data}; transforms of {}{unseen}", names.join(" and "))
}

/// Pooled errors of all deployments with one setting (mm), and the number of triplets.
pub fn pooled(judges: &[JudgedDeployment<'_>], settings: &PipelineSettings) -> (Vec<f64>, usize) {
    let mut pool = Vec::new();
    let mut count = 0;
    for (deployment, judge) in judges {
        let (errors, triplets) = judge.errors_mm(deployment, settings);
        pool.extend(errors);
        count += triplets;
    }
    (pool, count)
}
