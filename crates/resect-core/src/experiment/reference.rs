//! The transforms that the pipeline is judged by.
//!
//! The paper judges its pipeline with the static control points' transforms, because those of the dynamic methods come
//! from the very triplets that are judged.

use super::StudyError;
use super::split::{Part, Plan, Splits};
use crate::analysis::Settings;
use crate::calibration;
use crate::calibration::{Method, Offer};
use crate::deployment::findings::studies::deployment_left_out;
use crate::deployment::{Deployment, Finding};
use crate::evaluation;
use crate::evaluation::known_distances_m;
use crate::geometry::RigidTransform;
use crate::pipeline;
use crate::pipeline::PipelineSettings;

/// The method whose transforms judge; `None` takes B where the data allows it, else the paper's dynamic method: the
/// studies are the paper's, and the joint estimate judges only where it is named.
pub type Reference = Option<Method>;

/// A deployment with what its errors are measured by.
pub struct Judge {
    pub method: Method,
    plan: Plan,
    /// The transforms that each training part leads to.
    station1_from_station: Vec<[RigidTransform; 3]>,
    inter_prism_m: Option<[f64; 3]>,
}

impl Judge {
    /// Calibrates with the settings as they are. The findings say what to think of it.
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
                offer.published_method()
            }
        });
        if let Some(lack) = offer.lack(method) {
            return Err(format!("{}: {method} needs {lack}", deployment.name));
        }
        let chosen =
            calibration::CalibrationSettings { method: Some(method), ..settings.calibration };
        let mut findings = Vec::new();
        let mut station1_from_station = Vec::new();
        let plan = Plan::new(deployment, &triplets, splits);
        for [train, _] in plan.parts(deployment, &triplets) {
            let answer = calibration::solve(&train.deployment, &train.triplets, &chosen, &offer)
                .map_err(|error| error.to_string())?;
            let doubts = answer
                .findings
                .into_iter()
                .filter(|f| f.severity > crate::deployment::Severity::Note);
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
                inter_prism_m: known_distances_m(deployment, offer.targets),
            },
            findings,
        ))
    }

    /// Distance errors of what the pipeline makes of the deployment (mm), of unseen triplets if there are splits; and
    /// how many triplets there are.
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

    fn part_errors_mm(&self, part: &Part, transforms: &[RigidTransform; 3]) -> Vec<f64> {
        let Part { deployment, triplets } = part;
        let evaluation = evaluation::evaluate(deployment, triplets, self.inter_prism_m, transforms);
        evaluation.distance_errors_mm.into_iter().flatten().collect()
    }
}

/// A deployment with its judge.
pub type Judged<'a> = (&'a Deployment, Judge);

/// Judges of all deployments; those without one are left out with a finding, and none at all is an error.
pub fn judges<'a>(
    deployments: &'a [std::sync::Arc<Deployment>],
    settings: &Settings,
    reference: Reference,
    splits: Option<Splits>,
) -> Result<(Vec<Judged<'a>>, Vec<Finding>), StudyError> {
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

/// "the transforms of method B, static control points", naming every method in use.
pub fn in_words(judges: &[Judged<'_>], splits: Option<Splits>) -> String {
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
    format!("{data}; by the transforms of {}{unseen}", names.join(" and "))
}

/// Used by the studies of the pipeline: errors of all deployments under one setting.
pub fn pooled(judges: &[Judged<'_>], settings: &PipelineSettings) -> (Vec<f64>, usize) {
    let mut pool = Vec::new();
    let mut count = 0;
    for (deployment, judge) in judges {
        let (errors, triplets) = judge.errors_mm(deployment, settings);
        pool.extend(errors);
        count += triplets;
    }
    (pool, count)
}
