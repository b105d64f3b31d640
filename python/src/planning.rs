//! Predictions for drives before they are driven.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use resect_core::analysis::{Analyst, Settings};
use resect_core::planning::{Plan, improvements, predict};
use resect_io::{plan_file, way_file};
use resect_report::planning;
use serde_json::Value;

use crate::arrays::plain;
use crate::deployment::DeploymentHandle;
use crate::failure::{Failure, raised, released};
use crate::keywords::settings;
use crate::simulation::preset_named;

/// Source of a plan, and changes of it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct PlanOptions {
    file: Option<PathBuf>,
    preset: Option<String>,
    seed: u64,
    way: Option<PathBuf>,
    target_mm: Option<f64>,
}

/// Predicts a drive by a plan's file, by a preset, or else by a past deployment.
#[pyfunction]
pub fn plan<'py>(
    py: Python<'py>,
    past: Option<&DeploymentHandle>,
    options: PlanOptions,
    given: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let settings = raised(settings(given))?;
    let (json, text) = released(py, || predicted(past, &options, &settings))?;
    let table = PyDict::new(py);
    table.set_item("json", plain(py, &json)?)?;
    table.set_item("text", text)?;
    Ok(table)
}

fn predicted(
    past: Option<&DeploymentHandle>,
    options: &PlanOptions,
    settings: &Settings,
) -> Result<(Value, String), Failure> {
    let mut plan = match (past, &options.file, &options.preset) {
        (Some(past), None, None) => {
            let analysis = Analyst::new(past.deployment.clone()).run(settings);
            Plan::from_analysis(&past.deployment, &analysis)?
        }
        (None, Some(file), None) => plan_file::read(file)?,
        (None, None, Some(preset)) => Plan::from_preset(preset_named(preset)?, options.seed),
        _ => return Err(Failure::new("give one source: a plan or a deployment, or preset")),
    };
    if let Some(target_mm) = options.target_mm {
        plan.target_mm = target_mm;
        plan.check().map_err(Failure::remedied)?;
    }
    if let Some(way) = &options.way {
        way_file::read(way)?.lay(&mut plan);
        let senseless = |(what, remedy)| Failure(format!("{}: {what}; {remedy}", way.display()));
        plan.check().map_err(senseless)?;
    }
    let prediction = predict(&plan)?;
    let better = improvements(&plan)?;
    let json = planning::json(&plan, &prediction, &better);
    Ok((json, planning::text(&plan, &prediction, &better)))
}
