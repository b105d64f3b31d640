//! Evaluation of trajectories of other systems.

use std::path::PathBuf;
use std::sync::Arc;

use nalgebra::Vector3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use resect_core::analysis::{Analyst, Settings};
use resect_core::deployment::Deployment;
use resect_core::network::MOST_STATIONS;
use resect_core::progress::Progress;
use resect_io::estimate_file;
use resect_report::estimates;
use resect_tools::estimates::{
    Body, EstimatesJudgement, GroundTruth, Judged, Options, judge, station_index,
};
use serde_json::Value;

use crate::arrays::{plain, set_column, set_points};
use crate::deployment::DeploymentHandle;
use crate::failure::{Failure, raised};
use crate::interruptible::interruptible;
use crate::keywords::{choice, convention, of_estimate, settings};

/// Options of the comparison.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct EvaluationOptions {
    align: String,
    time_offset_s: Option<f64>,
    body: BodyOption,
    as_evo: bool,
    convention: String,
    /// The station whose prism alone is the ground truth.
    truth_station: Option<usize>,
}

#[derive(FromPyObject)]
enum BodyOption {
    #[pyo3(transparent)]
    Word(String),
    #[pyo3(transparent)]
    Lever([f64; 3]),
}

/// Everything that Python shows of an evaluation.
struct Evaluated {
    json: Value,
    text: String,
    judgement: EstimatesJudgement,
}

impl EvaluationOptions {
    fn options(&self) -> Result<Options, Failure> {
        if self.time_offset_s.is_some_and(|offset_s| !offset_s.is_finite()) {
            return Err(Failure::new(
                "time_offset_s is not finite; give seconds, or None to estimate it",
            ));
        }
        let body = match &self.body {
            BodyOption::Word(word) if word == "found" => Body::Found,
            BodyOption::Word(word) if word == "same" => Body::Same,
            BodyOption::Lever(lever_m) if lever_m.iter().all(|value| value.is_finite()) => {
                Body::Lever(Vector3::from(*lever_m))
            }
            _ => return Err(Failure::new("body: give found, same, or three numbers in metres")),
        };
        let options = Options {
            alignment: choice("align", &self.align)?,
            time_offset_s: self.time_offset_s,
            body,
            convention: convention("convention", &self.convention)?,
            ..Options::default()
        };
        Ok(if self.as_evo { options.as_evo() } else { options })
    }

    /// Returns the index of the station that is the ground truth.
    fn station(&self) -> Result<Option<usize>, Failure> {
        match self.truth_station {
            Some(number) if !(1..=MOST_STATIONS).contains(&number) => Err(Failure(format!(
                "truth_station is {number}; stations are 1 to {MOST_STATIONS}"
            ))),
            station => Ok(station.map(|number| number - 1)),
        }
    }
}

/// Compares estimates with a deployment or with the trajectory that is its ground truth.
#[pyfunction]
pub fn evaluate<'py>(
    py: Python<'py>,
    paths: Vec<PathBuf>,
    against: &DeploymentHandle,
    options: EvaluationOptions,
    given: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let settings = raised(settings(given))?;
    let against = Arc::clone(&against.deployment);
    let evaluated = interruptible(py, move |progress| {
        evaluated(&paths, &against, &options, &settings, progress)
    })?;
    let table = PyDict::new(py);
    table.set_item("json", plain(py, &evaluated.json)?)?;
    table.set_item("text", evaluated.text)?;
    let errors = PyDict::new(py);
    for judged in &evaluated.judgement.judged {
        errors.set_item(&judged.estimate.name, error_arrays(py, judged)?)?;
    }
    table.set_item("errors", errors)?;
    Ok(table)
}

fn evaluated(
    paths: &[PathBuf],
    against: &Arc<Deployment>,
    options: &EvaluationOptions,
    settings: &Settings,
    progress: &Progress,
) -> Result<Evaluated, Failure> {
    let station = options.station()?;
    let options = options.options()?;
    if paths.is_empty() {
        return Err(Failure::new("no estimates; give at least one file"));
    }
    let mut read = Vec::new();
    for path in paths {
        read.extend(estimate_file::read(path)?.into_iter().map(|one| (one, options)));
    }
    if against.ground_truth.is_some() && station.is_some() {
        let line = "truth_station is for a deployment, and the ground truth is a trajectory";
        return Err(Failure::new(line));
    }
    let analysis = Analyst::new(Arc::clone(against)).run_while(settings, progress)?;
    let station = station.map(|index| station_index(against, index + 1));
    let station = station.transpose().map_err(|why| Failure(why.to_string()))?;
    let truth = GroundTruth::of(against, &analysis, station);
    if let (GroundTruth::Deployment { .. }, Err(error)) = (&truth, &analysis.answer) {
        return Err(Failure::of_calibration(error));
    }
    let judgement = judge(&truth, read);
    if judgement.judged.is_empty() {
        let whys: Vec<String> =
            judgement.unjudged.iter().map(|(_, why)| of_estimate(why).0).collect();
        return Err(Failure(whys.join("; ")));
    }
    let json = estimates::json(&truth, &judgement);
    let text = estimates::text(&truth, &judgement);
    Ok(Evaluated { json, text, judgement })
}

/// Returns the error at each epoch; an array without values is left out.
fn error_arrays<'py>(py: Python<'py>, judged: &Judged) -> PyResult<Bound<'py, PyDict>> {
    let errors = &judged.errors;
    let table = PyDict::new(py);
    set_column(&table, "time_s", errors.iter().map(|error| error.time_s))?;
    set_points(&table, "true_position_m", errors.iter().map(|error| &error.true_position_m))?;
    set_points(&table, "position_error_m", errors.iter().map(|error| &error.position_m))?;
    let turns: Option<Vec<_>> = errors.iter().map(|error| error.rotation_rad.as_ref()).collect();
    if let Some(turns) = turns {
        set_points(&table, "rotation_error_rad", turns)?;
    }
    let sigmas_m: Option<Vec<f64>> = errors.iter().map(|error| error.sigma_m()).collect();
    if let Some(sigmas_m) = sigmas_m {
        set_column(&table, "truth_sigma_m", sigmas_m)?;
    }
    Ok(table)
}
