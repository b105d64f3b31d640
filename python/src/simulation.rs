//! Simulated deployments.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use resect_io::simulation_files;
use resect_report::json::transform_of;
use resect_tools::simulation::{Preset, Simulated, simulate_scenario};
use serde_json::Value;

use crate::arrays::plain;
use crate::deployment::DeploymentHandle;
use crate::failure::{Failure, raised};
use crate::interruptible::interruptible;
use crate::trajectory::pose_arrays;
use resect_core::evaluation::requested_trajectory::LARGEST_RATE_HZ;

/// A simulated deployment with its ground truth.
#[pyclass(frozen, module = "resect._native")]
pub struct SimulationHandle {
    simulated: Arc<Simulated>,
}

#[pymethods]
impl SimulationHandle {
    /// Reads the simulated files.
    fn deployment(&self, py: Python<'_>) -> PyResult<DeploymentHandle> {
        let simulated = Arc::clone(&self.simulated);
        interruptible(py, move |_| {
            Ok(DeploymentHandle::new(simulation_files::open(&simulated)?, 0.0))
        })
    }

    /// Returns the true transforms at set-up, in the form of a calibration's.
    fn transforms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let truth = self.simulated.station1_from_station_at(0.0);
        plain(py, &Value::from([1, 2].map(|k| transform_of(k + 1, &truth[k], None)).to_vec()))
    }

    /// Returns the true poses at a rate (1/s).
    fn trajectory<'py>(&self, py: Python<'py>, rate: f64) -> PyResult<Bound<'py, PyDict>> {
        let simulated = Arc::clone(&self.simulated);
        let trajectory = interruptible(py, move |_| match rate > 0.0 && rate <= LARGEST_RATE_HZ {
            true => Ok(simulated.true_trajectory(1.0 / rate)),
            false => Err(Failure(format!(
                "rate is {rate} Hz; it must be above 0 and {LARGEST_RATE_HZ} at most"
            ))),
        })?;
        let table = pose_arrays(py, &trajectory)?;
        table.set_item("frame", "frame of station 1")?;
        table.set_item("vehicle", "x ahead, y left, z up; origin on the ground")?;
        Ok(table)
    }

    /// Writes the files of the deployment, and its truth.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let simulated = Arc::clone(&self.simulated);
        interruptible(py, move |_| Ok(simulation_files::write_folder(&simulated, &folder)?))
    }
}

/// Simulates a preset.
#[pyfunction]
pub fn simulate(
    py: Python<'_>,
    preset: &str,
    seed: u64,
    field_errors: bool,
) -> PyResult<SimulationHandle> {
    let preset = raised(preset_named(preset))?;
    interruptible(py, move |_| {
        let scenario = match field_errors {
            true => preset.scenario().with_field_errors(seed),
            false => preset.scenario().draw_errors(seed),
        };
        let simulated = Arc::new(simulate_scenario(&scenario, seed));
        Ok(SimulationHandle { simulated })
    })
}

/// Returns the preset with a name.
pub fn preset_named(name: &str) -> Result<Preset, Failure> {
    Preset::ALL.into_iter().find(|preset| preset.name() == name).ok_or_else(|| {
        let names = Preset::ALL.map(Preset::name).join(", ");
        Failure(format!("unknown preset `{name}`; presets are {names}"))
    })
}
