//! Predictions for drives before they are driven.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use resect_core::analysis::{Analyst, Settings};
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::{plan_file, way_file};
use resect_report::planning;
use resect_tools::planning::{Plan, improvements, predict};
use serde_json::Value;

use crate::arrays::plain;
use crate::deployment::DeploymentHandle;
use crate::failure::{Failure, raised};
use crate::interruptible::interruptible;
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
    let past = past.map(|past| Arc::clone(&past.deployment));
    let (json, text) =
        interruptible(py, move |progress| predicted(past.as_ref(), &options, &settings, progress))?;
    let table = PyDict::new(py);
    table.set_item("json", plain(py, &json)?)?;
    table.set_item("text", text)?;
    Ok(table)
}

fn predicted(
    past: Option<&Arc<Deployment>>,
    options: &PlanOptions,
    settings: &Settings,
    progress: &Progress,
) -> Result<(Value, String), Failure> {
    let mut plan = match (past, &options.file, &options.preset) {
        (Some(past), None, None) => {
            let analysis = Analyst::new(Arc::clone(past)).run_while(settings, progress)?;
            Plan::from_analysis(past, &analysis)?
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
    let better = improvements(&plan, progress)?;
    let json = planning::json(&plan, &prediction, &better);
    Ok((json, planning::text(&plan, &prediction, &better)))
}
