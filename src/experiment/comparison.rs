//! The calibrations side by side, by both metrics (`paper.tex`, "Calibration comparison").

use std::sync::Arc;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::split::{Plan, Splits};
use super::study::{Group, Level, Quantiles, Series, Study};
use super::{Control, INSTRUMENT_NOISE_MM, StudyError};
use crate::analysis::{Analysis, Analyst, Answer, Settings};
use crate::calibration::{self, CalibrationSettings, Method, Offer, TransformSigma};
use crate::deployment::{Deployment, Finding};
use crate::evaluation::{self, gnss};
use crate::geometry::{RigidTransform, wrap_to_pi};
use crate::palette;

/// Answers this many standard deviations apart disagree.
const DISAGREEMENT_SIGMAS: f64 = 3.0;
/// Differences below what instruments resolve are not worth a word: at the stations, and in the area (m).
const NOTABLE_M: f64 = 0.005;

/// Answers of one deployment, on all of its data.
#[derive(Clone, Debug)]
pub struct Compared {
    pub deployment: String,
    /// In the order of [`Method::ALL`]; or why there is none.
    pub answers: [Result<Arc<Answer>, String>; 4],
    pub disagreements: Vec<Disagreement>,
}

/// Two methods whose answers are further apart than their σ allow, for one station.
#[derive(Clone, Debug, PartialEq)]
pub struct Disagreement {
    pub methods: [Method; 2],
    /// 2 or 3.
    pub station: usize,
    /// Second minus first.
    pub translation_m: [f64; 3],
    pub yaw_rad: f64,
    /// The yaw's difference over the σ of both; `None` where one has no σ.
    pub yaw_sigmas: Option<f64>,
    /// The largest of (x, y, z, yaw) in σ.
    pub largest_sigmas: f64,
    /// How far apart the two put what the station measured (m, rms), and how far away that is on average.
    pub moved_m: f64,
    pub range_m: f64,
}

impl Disagreement {
    /// "B and D disagree about the yaw of station 2 by 0.87 mrad …".
    pub fn in_words(&self) -> String {
        let [first, second] = self.methods.map(Method::letter);
        let mm = self.translation_m.map(|m| m * 1e3);
        let moved = format!(
            "{:.0} mm apart on its track, {:.0} m away on average",
            self.moved_m * 1e3,
            self.range_m
        );
        match self.yaw_sigmas {
            Some(sigmas) if sigmas > DISAGREEMENT_SIGMAS => format!(
                "{first} and {second} disagree about the yaw of station {}: {:+.2} mrad ({:+.3}°), {sigmas:.0} σ apart, \
                 {moved}",
                self.station,
                self.yaw_rad * 1e3,
                self.yaw_rad.to_degrees(),
            ),
            _ => format!(
                "{first} and {second} disagree about the position of station {}: {:+.1}, {:+.1}, {:+.1} mm in x, y, z, \
                 up to {:.0} σ apart, {moved}",
                self.station, mm[0], mm[1], mm[2], self.largest_sigmas,
            ),
        }
    }
}

/// The study's picture, and the answers behind it.
#[derive(Clone, Debug)]
pub struct Comparison {
    pub study: Study,
    pub deployments: Vec<Compared>,
}

/// Every method that the data allows, judged by both metrics.
pub fn compare(
    deployments: &[Arc<Deployment>],
    settings: &Settings,
    splits: Option<Splits>,
    control: &Control,
) -> Result<Comparison, StudyError> {
    if deployments.is_empty() {
        return Err(StudyError::Nothing("no deployment to compare on".to_owned()));
    }
    control.expect(deployments.len());
    let each = deployments
        .par_iter()
        .map(|deployment| control.step(|| one(deployment, settings, splits)))
        .collect::<Result<Vec<_>, _>>()?;

    if each.iter().all(|(compared, _)| compared.answers.iter().all(Result::is_err)) {
        let name = &each[0].0.deployment;
        let why = each[0].0.answers.iter().find_map(|answer| answer.as_ref().err());
        return Err(StudyError::Nothing(format!(
            "{name}: no method can run; D {}",
            each[0].0.answers[3].as_ref().err().or(why).map_or("lacks data", String::as_str)
        )));
    }
    let mut findings = Vec::new();
    for (compared, _) in &each {
        for disagreement in &compared.disagreements {
            let prefix =
                if each.len() > 1 { format!("{}: ", compared.deployment) } else { String::new() };
            findings.push(Finding::warning(prefix + &disagreement.in_words()));
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
    let judged = splits.map_or("each method on the data it was solved with".to_owned(), |splits| {
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
        title: "Calibrations by both metrics".to_owned(),
        subtitle: format!("{data}; {judged}"),
        value_label: "error (mm)".to_owned(),
        group_label: "calibration".to_owned(),
        series: ["control points", "inter-prism distances"]
            .into_iter()
            .zip(palette::SERIES)
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

/// Sizes of errors (mm): of control points, of inter-prism distances.
type BothErrors = [Vec<f64>; 2];

fn one(
    deployment: &Arc<Deployment>,
    settings: &Settings,
    splits: Option<Splits>,
) -> (Compared, [BothErrors; 4]) {
    let mut analyst = Analyst::new(Arc::clone(deployment));
    let mut errors: [BothErrors; 4] = Default::default();
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
    (Compared { deployment: deployment.name.clone(), answers, disagreements }, errors)
}

/// Errors of one method by both metrics.
fn judge(
    deployment: &Deployment,
    analysis: &Analysis,
    settings: &CalibrationSettings,
    splits: Option<Splits>,
) -> BothErrors {
    let triplets = &analysis.pipeline.triplets;
    let Offer { targets, .. } = analysis.offer;
    let mut errors = BothErrors::default();
    if analysis.answer.is_err() {
        return errors;
    }
    let plan = Plan::new(deployment, triplets, splits);
    for [train, test] in plan.parts(deployment, triplets) {
        let answer =
            calibration::solve(&train.deployment, &train.triplets, settings, &analysis.offer);
        // A part may hold too few points for the method; the others judge it.
        let Ok(answer) = answer else { continue };
        let transforms = &answer.station1_from_station;
        let (_, evaluation) =
            evaluation::evaluate_answer(&test.deployment, &test.triplets, targets, &answer);
        let points = test.deployment.control_points.iter().filter(|set| !set.pillars);
        errors[0].extend(points.flat_map(|set| set.disagreements_m(transforms)).map(|m| m * 1e3));
        errors[1].extend(evaluation.distance_errors_mm.into_iter().flatten());
    }
    errors
}

fn group(method: Method, index: usize, each: &[(Compared, [BothErrors; 4])]) -> Group {
    let solved = each.iter().filter(|(compared, _)| compared.answers[index].is_ok()).count();
    let pooled = |metric: usize| -> Vec<f64> {
        each.iter().flat_map(|(_, errors)| errors[index][metric].iter().copied()).collect()
    };
    let why = match solved {
        0 => ["data lacks it", "data lacks it"],
        _ => ["no control points", "no distances"],
    };
    Group {
        label: format!("{}  {}", method.letter(), method.title()),
        note: match (solved, each.len()) {
            (0, _) => "not possible with this data".to_owned(),
            (_, 1) => String::new(),
            (solved, all) => format!("{solved} of {all} deployments"),
        },
        boxes: (0..2)
            .map(|metric| Quantiles::of(pooled(metric)).ok_or_else(|| why[metric].to_owned()))
            .collect(),
    }
}

/// Median error of the distances between RTK antennas: what the stations compete with.
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

/// All pairs of answers that are further apart than their σ allow.
fn disagreements(
    answers: &[Result<Arc<Answer>, String>; 4],
    deployment: &Deployment,
) -> Vec<Disagreement> {
    let mut found = Vec::new();
    for first in 0..4 {
        for second in first + 1..4 {
            let (Ok(a), Ok(b)) = (&answers[first], &answers[second]) else { continue };
            let (a, b) = (&a.calibration, &b.calibration);
            for station in 1..3 {
                let sigmas = [a.sigma, b.sigma].map(|s| s.map(|s| s[station - 1]));
                let transforms =
                    [a.station1_from_station[station], b.station1_from_station[station]];
                let area_m = working_area_m(deployment, station);
                let methods = [Method::ALL[first], Method::ALL[second]];
                found.extend(
                    difference(methods, station, transforms, sigmas, &area_m).filter(|d| {
                        d.largest_sigmas > DISAGREEMENT_SIGMAS && d.moved_m > NOTABLE_M
                    }),
                );
            }
        }
    }
    found
}

fn difference(
    methods: [Method; 2],
    station: usize,
    [a, b]: [RigidTransform; 2],
    sigmas: [Option<TransformSigma>; 2],
    area_m: &[Vector3<f64>],
) -> Option<Disagreement> {
    let (Some(sigma_a), Some(sigma_b)) = (sigmas[0], sigmas[1]) else { return None };
    let count = area_m.len().max(1) as f64;
    let off = b.translation_m - a.translation_m;
    let yaw_rad = wrap_to_pi(b.yaw_rad() - a.yaw_rad());
    let yaw_sigmas = yaw_rad.abs() / sigma_a.yaw_rad.hypot(sigma_b.yaw_rad);
    let axis_sigmas = (0..3).map(|axis| {
        off[axis].abs() / sigma_a.translation_m[axis].hypot(sigma_b.translation_m[axis])
    });
    Some(Disagreement {
        methods,
        station: station + 1,
        translation_m: off.into(),
        yaw_rad,
        yaw_sigmas: Some(yaw_sigmas),
        largest_sigmas: axis_sigmas.fold(yaw_sigmas, f64::max),
        moved_m: (area_m.iter().map(|p| (b.apply(p) - a.apply(p)).norm_squared()).sum::<f64>()
            / count)
            .sqrt(),
        range_m: area_m.iter().map(Vector3::norm).sum::<f64>() / count,
    })
}

/// Places of a station's readings, some hundred of them (m, its own frame).
fn working_area_m(deployment: &Deployment, station: usize) -> Vec<Vector3<f64>> {
    let track = &deployment.tracks[station];
    let step = (track.measurements.len() / 500).max(1);
    track.measurements.iter().step_by(step).map(|m| track.position_m(m)).collect()
}
