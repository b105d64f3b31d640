//! Dependence of the answers on one threshold: the paper's dynamic method and the joint estimate, calibrated anew for each value.

use std::sync::Arc;

use rayon::prelude::*;

use super::StudyError;
use super::sensitivity::Sweep;
use super::study::{Group, Quantiles, Series, Study};
use crate::findings::studies::deployment_left_out;
use crate::palette;
use resect_core::analysis::Settings;
use resect_core::calibration;
use resect_core::calibration::{CalibrationSettings, Method, Offer, Verdict};
use resect_core::deployment::Deployment;
use resect_core::evaluation;
use resect_core::evaluation::known_distances_m;
use resect_core::pipeline;
use resect_core::pipeline::{PipelineSettings, Triplets};
use resect_core::progress::Progress;

/// The answers that are compared: of the paper's dynamic method (D, or C with one prism), and the joint estimate.
const ANSWERS: usize = 2;

/// A deployment with the triplets on which all answers are judged.
struct SweptDeployment<'a> {
    deployment: &'a Deployment,
    triplets: Arc<Triplets>,
}

/// Absolute distance errors of one answer (mm), or the reason why there is none, in a few words.
type AnswerErrors = Result<Vec<f64>, String>;

/// Calibrates for every value of the parameter, and judges the answers by the inter-prism errors of the same triplets: those of the
/// settings without the change.
pub fn sweep_answers(
    deployments: &[Arc<Deployment>],
    settings: &Settings,
    sweep: &Sweep,
    progress: &Progress,
) -> Result<Study, StudyError> {
    sweep.check(&settings.pipeline).map_err(StudyError::Nothing)?;
    let judged = deployments.iter().map(|deployment| SweptDeployment {
        deployment,
        triplets: pipeline::run(deployment, &settings.pipeline).triplets,
    });
    let (judged, without): (Vec<_>, Vec<_>) = judged.partition(|one| !one.triplets.is_empty());
    let findings = without
        .iter()
        .map(|one| deployment_left_out(&format!("{}: no triplets", one.deployment.name)))
        .collect();
    if judged.is_empty() {
        return Err(StudyError::Nothing("no deployment has triplets to be judged on".to_owned()));
    }
    let values = sweep.values();
    progress.expect(values.len() as u64);
    let groups = values.par_iter().map(|value| {
        let pipeline = sweep.with(&settings.pipeline, *value);
        let pooled = progress.step(|| pooled_errors_mm(&judged, &pipeline, settings))?;
        let box_of = |errors: AnswerErrors| Quantiles::of(errors?).ok_or_else(|| "no data".into());
        Ok(Group {
            label: sweep.label_of(*value),
            note: String::new(),
            boxes: pooled.into_iter().map(box_of).collect(),
        })
    });
    let groups = groups.collect::<Result<Vec<_>, StudyError>>()?;
    let names = match &judged[..] {
        [one] => one.deployment.name.clone(),
        several => format!("{} deployments", several.len()),
    };
    Ok(Study {
        name: format!("sweep-answers-{}", sweep.parameter.flag()),
        title: format!("Sensitivity of the answers to {}", sweep.parameter.setting().title),
        subtitle: format!("{names}; calibrated for each value, judged on the same triplets"),
        value_label: "inter-prism error (mm)".to_owned(),
        group_label: sweep.axis_label(&settings.pipeline),
        series: ["published method", "joint estimate"]
            .into_iter()
            .zip(palette::ANSWERS)
            .map(|(name, rgb)| Series { name: name.to_owned(), rgb })
            .collect(),
        groups,
        levels: Vec::new(),
        findings,
        settings: *settings,
    })
}

/// Errors of both answers of all deployments; without an answer of one deployment there are none.
fn pooled_errors_mm(
    judged: &[SweptDeployment<'_>],
    pipeline: &PipelineSettings,
    settings: &Settings,
) -> [AnswerErrors; ANSWERS] {
    let mut pools = [const { Ok(Vec::new()) }; ANSWERS];
    for one in judged {
        let triplets = pipeline::run(one.deployment, pipeline).triplets;
        let offer = Offer::of(one.deployment, &triplets);
        let methods = [offer.published_method(), Method::Joint];
        for (pool, method) in pools.iter_mut().zip(methods) {
            let errors = one.errors_mm(&triplets, method, &offer, settings);
            *pool = std::mem::replace(pool, Ok(Vec::new())).and_then(|mut pool| {
                pool.extend(errors?);
                Ok(pool)
            });
        }
    }
    pools
}

impl SweptDeployment<'_> {
    /// Calibrates by one method with the triplets of the changed settings.
    fn errors_mm(
        &self,
        triplets: &Triplets,
        method: Method,
        offer: &Offer,
        settings: &Settings,
    ) -> AnswerErrors {
        let chosen = CalibrationSettings { method: Some(method), ..settings.calibration };
        let answer = calibration::solve(self.deployment, triplets, &chosen, offer)
            .map_err(|_| "no answer".to_owned())?;
        if answer.verdict == Verdict::Degenerate {
            return Err("degenerate".to_owned());
        }
        let distances_m = known_distances_m(self.deployment, &offer.followed);
        let distances_m = (&offer.followed, distances_m.as_ref());
        let transforms = &answer.station1_from_station;
        let evaluation =
            evaluation::evaluate(self.deployment, &self.triplets, distances_m, transforms);
        Ok(evaluation.distance_errors_mm.into_iter().flatten().collect())
    }
}
