//! Comparison of the calibration methods by both metrics (Vaidis et al. 2022, section "Calibration comparison").

use std::sync::Arc;

use rayon::prelude::*;

use super::split::{SplitPlan, Splits};
use super::study::{Group, Level, Quantiles, Series, Study};
use super::{INSTRUMENT_NOISE_MM, StudyError};
use crate::palette;
use resect_core::analysis::{Analysis, Analyst, Answer, Settings};
use resect_core::calibration;
use resect_core::calibration::{
    CalibrationSettings, Disagreement, Method, Recommendation, recommend,
};
use resect_core::deployment::{ControlPointSet, Deployment};
use resect_core::evaluation;
use resect_core::evaluation::gnss;
use resect_core::progress::Progress;

const METHODS: usize = Method::ALL.len();

/// Answers of one deployment, on all of its data.
#[derive(Clone, Debug)]
pub struct Compared {
    pub deployment: String,
    /// The answers in the order of [`Method::ALL`], or the reason why there is none.
    pub answers: [Result<Arc<Answer>, String>; METHODS],
    pub disagreements: Vec<Disagreement>,
    /// The recommendation by the joint estimate; `None` without its answer.
    pub recommendation: Option<Recommendation>,
}

/// The study, and the answers behind it.
#[derive(Clone, Debug)]
pub struct Comparison {
    pub study: Study,
    pub deployments: Vec<Compared>,
}

/// Evaluates every method that the data allows by both metrics.
pub fn compare(
    deployments: &[Arc<Deployment>],
    settings: &Settings,
    splits: Option<Splits>,
    progress: &Progress,
) -> Result<Comparison, StudyError> {
    if deployments.is_empty() {
        return Err(StudyError::Nothing("no deployment to compare methods on".to_owned()));
    }
    progress.expect(deployments.len() as u64);
    let each = deployments
        .par_iter()
        .map(|deployment| progress.step(|| one(deployment, settings, splits)))
        .collect::<Result<Vec<_>, _>>()?;

    if each.iter().all(|(compared, _)| compared.answers.iter().all(Result::is_err)) {
        let name = &each[0].0.deployment;
        let why = each[0].0.answers.iter().find_map(|answer| answer.as_ref().err());
        return Err(StudyError::Nothing(format!(
            "{name}: no method can run; {} {}",
            Method::Joint,
            each[0].0.answers[Method::Joint as usize]
                .as_ref()
                .err()
                .or(why)
                .map_or("lacks data", String::as_str)
        )));
    }
    let mut findings = Vec::new();
    for (compared, _) in &each {
        for disagreement in &compared.disagreements {
            let own = disagreement.finding();
            let is_one_of_several = each.len() > 1;
            findings.push(if is_one_of_several { own.within(&compared.deployment) } else { own });
        }
    }
    let groups = Method::ALL
        .iter()
        .enumerate()
        .map(|(index, method)| group(*method, index, &each))
        .collect();
    let data = match deployments {
        [one] => one.name.clone(),
        several => format!("{} deployments", several.len()),
    };
    let judged = splits.map_or("each method judged on its own data".to_owned(), |splits| {
        format!(
            "solved with 75 %, judged on the 25 % left out, {} random splits, seed {}",
            splits.repeats, splits.seed
        )
    });
    let mut levels = gnss_level(deployments).into_iter().collect::<Vec<_>>();
    levels.push(Level {
        label: format!("RTS range noise {INSTRUMENT_NOISE_MM:.0} mm"),
        value: INSTRUMENT_NOISE_MM,
    });
    let study = Study {
        name: "comparison".to_owned(),
        title: "Calibration methods by both metrics".to_owned(),
        subtitle: format!("{data}; {judged}"),
        value_label: "error (mm)".to_owned(),
        group_label: "calibration".to_owned(),
        series: ["control points", "inter-prism distances"]
            .into_iter()
            .zip(palette::METRICS)
            .map(|(name, rgb)| Series { name: name.to_owned(), rgb })
            .collect(),
        groups,
        levels,
        findings,
        settings: *settings,
    };
    let deployments = each.into_iter().map(|(compared, _)| compared).collect();
    Ok(Comparison { study, deployments })
}

/// Absolute errors (mm): of control points, of inter-prism distances.
type BothErrors = [Vec<f64>; 2];

fn one(
    deployment: &Arc<Deployment>,
    settings: &Settings,
    splits: Option<Splits>,
) -> (Compared, [BothErrors; METHODS]) {
    let mut analyst = Analyst::new(Arc::clone(deployment));
    let mut errors: [BothErrors; METHODS] = Default::default();
    let answers = Method::ALL.map(|method| {
        let mut settings = *settings;
        settings.calibration.method = Some(method);
        let analysis = analyst.run(&settings);
        errors[method as usize] = judge(deployment, &analysis, &settings.calibration, splits);
        match (&analysis.answer, analysis.offer.lack(method)) {
            (Ok(answer), _) => Ok(Arc::clone(answer)),
            (Err(_), Some(lack)) => Err(format!("needs {lack}")),
            (Err(error), None) => Err(error.to_string()),
        }
    });
    let disagreements = disagreements(&answers, deployment);
    let joint = answers[Method::Joint as usize].as_ref().ok();
    let recommendation = joint.map(|answer| recommend(&answer.calibration, deployment));
    let deployment = deployment.name.clone();
    (Compared { deployment, answers, disagreements, recommendation }, errors)
}

/// Errors of one method by both metrics.
fn judge(
    deployment: &Deployment,
    analysis: &Analysis,
    settings: &CalibrationSettings,
    splits: Option<Splits>,
) -> BothErrors {
    let triplets = &analysis.pipeline.triplets;
    let followed = &analysis.offer.followed;
    let mut errors = BothErrors::default();
    if analysis.answer.is_err() {
        return errors;
    }
    let plan = SplitPlan::new(deployment, triplets, splits);
    for [train, test] in plan.parts(deployment, triplets) {
        let answer =
            calibration::solve(&train.deployment, &train.triplets, settings, &analysis.offer);
        // A subset may have too few points for the method; the other splits judge it.
        let Ok(answer) = answer else { continue };
        let (_, evaluation) =
            evaluation::evaluate_answer(&test.deployment, &test.triplets, followed, &answer);
        let points: &[ControlPointSet] = if answer.method.is_from_tracks() {
            test.deployment.comparable_control_points()
        } else {
            &test.deployment.control_points
        };
        let points = points.iter().filter(|set| !set.pillars);
        let transforms = answer.survey_transforms();
        errors[0].extend(points.flat_map(|set| set.disagreements_m(&transforms)).map(|m| m * 1e3));
        errors[1].extend(evaluation.distance_errors_mm.into_iter().flatten());
    }
    errors
}

fn group(method: Method, index: usize, each: &[(Compared, [BothErrors; METHODS])]) -> Group {
    let solved = each.iter().filter(|(compared, _)| compared.answers[index].is_ok()).count();
    let pooled = |metric: usize| -> Vec<f64> {
        each.iter().flat_map(|(_, errors)| errors[index][metric].iter().copied()).collect()
    };
    let mut answers = each.iter().filter_map(|(compared, _)| compared.answers[index].as_ref().ok());
    let is_one_station = answers.all(|answer| answer.calibration.station1_from_station.len() == 1);
    let why = match solved {
        0 => ["not possible with this data"; 2],
        _ if is_one_station => ["needs two stations"; 2],
        _ => ["no control points", "no distances"],
    };
    Group {
        label: method.label(),
        note: match (solved, each) {
            // A missing box shows its reason instead.
            (0, _) => String::new(),
            (_, [(compared, _)]) => failure_note(&compared.answers[index]),
            (solved, all) => format!("{solved} of {} deployments", all.len()),
        },
        boxes: (0..2)
            .map(|metric| Quantiles::of(pooled(metric)).ok_or_else(|| why[metric].to_owned()))
            .collect(),
    }
}

/// Names the method that answers instead of a joint estimate that failed; empty otherwise.
fn failure_note(answer: &Result<Arc<Answer>, String>) -> String {
    let calibration = answer.as_ref().ok().map(|answer| &answer.calibration);
    let failed = calibration.filter(|calibration| calibration.joint_failure().is_some());
    failed.map_or_else(String::new, |failed| format!("answer of {}", failed.answered_by()))
}

/// Median error of the distances between RTK antennas, with which the stations are compared.
fn gnss_level(deployments: &[Arc<Deployment>]) -> Option<Level> {
    let mut errors_mm = Vec::new();
    for deployment in deployments {
        let known = deployment.rig.as_ref().and_then(|rig| rig.inter_antenna_m);
        if let (Some(antennas), Some(known)) = (&deployment.gnss, known) {
            let fixes = antennas.each_ref().map(Vec::as_slice);
            let result = gnss::inter_antenna(fixes, &known);
            errors_mm.extend(result.errors_mm.into_iter().flatten());
        }
    }
    let median = Quantiles::of(errors_mm)?.median;
    Some(Level { label: format!("RTK GNSS antennas {median:.1} mm"), value: median })
}

/// All pairs of answers that differ by more than their σ allow. A joint estimate that failed is the answer of another method.
fn disagreements(
    answers: &[Result<Arc<Answer>, String>; METHODS],
    deployment: &Deployment,
) -> Vec<Disagreement> {
    let mut found = Vec::new();
    for first in 0..METHODS {
        for second in first + 1..METHODS {
            if let (Ok(a), Ok(b)) = (&answers[first], &answers[second])
                && b.calibration.joint_failure().is_none()
            {
                found.extend(calibration::disagreements(
                    &a.calibration,
                    &b.calibration,
                    deployment,
                ));
            }
        }
    }
    found
}
