//! Opening of deployments, their readings, and the pipeline.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use resect_core::analysis::Analyst;
use resect_core::deployment::{Deployment, Track};
use resect_core::pipeline::{PipelineOutput, SampleFate, StagedPipeline};
use resect_io::source::{Source, TrajectoryFile};
use resect_io::truth;
use resect_report::json;
use serde_json::json;

use crate::analysis::{AnalysisHandle, AnsweredDeployment};
use crate::arrays::{plain, set_column, set_points, set_stack};
use crate::failure::{Failure, raised, times_in_words};
use crate::interruptible::interruptible;
use crate::keywords::{choice, convention, extras, settings};

/// An open deployment.
#[pyclass(frozen, module = "resect._native")]
pub struct DeploymentHandle {
    pub deployment: Arc<Deployment>,
    load_ms: f64,
}

impl DeploymentHandle {
    pub fn new(deployment: Deployment, load_ms: f64) -> Self {
        Self { deployment: Arc::new(deployment), load_ms }
    }
}

#[pymethods]
impl DeploymentHandle {
    /// Returns what is known without a calibration, as in the JSON of a calibration.
    fn about<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let deployment = &self.deployment;
        plain(
            py,
            &json!({
                "name": deployment.name,
                "stations": deployment.tracks.len(),
                "track_frame": deployment.track_frame,
                "inter_prism_m": deployment.rig.as_ref().map(|rig| &rig.inter_prism_m),
                "start_s": deployment.start_s(),
                "end_s": deployment.end_s(),
                "findings": json::findings(&deployment.findings),
            }),
        )
    }

    /// Returns the readings of a station (from 0).
    fn track<'py>(&self, py: Python<'py>, station: usize) -> PyResult<Bound<'py, PyDict>> {
        let no_station = || Failure::new(format!("no station {}", station + 1));
        let track = raised(self.deployment.tracks.as_slice().get(station).ok_or_else(no_station))?;
        let readings = &track.measurements;
        let table = PyDict::new(py);
        set_column(&table, "time_s", readings.iter().map(|reading| reading.time_s))?;
        set_column(&table, "range_m", readings.iter().map(|reading| reading.range_m))?;
        set_column(&table, "azimuth_rad", readings.iter().map(|reading| reading.azimuth_rad))?;
        set_column(&table, "zenith_rad", readings.iter().map(|reading| reading.zenith_rad))?;
        let positions_m: Vec<_> =
            readings.iter().map(|reading| track.position_m(reading)).collect();
        set_points(&table, "position_m", &positions_m)?;
        table.set_item("prism_constant_m", track.prism_constant_m)?;
        table.set_item("name", track.name.as_deref())?;
        Ok(table)
    }

    /// Runs the pipeline alone.
    fn run_pipeline<'py>(
        &self,
        py: Python<'py>,
        given: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let settings = raised(settings(given))?;
        let deployment = Arc::clone(&self.deployment);
        let output = interruptible(py, move |progress| {
            let mut pipeline = StagedPipeline::default();
            Ok(pipeline.run_while(&deployment, &settings.pipeline, progress)?)
        })?;
        pipeline_arrays(py, &output)
    }

    /// Runs pipeline, calibration and evaluation.
    fn calibrate(&self, py: Python<'_>, given: &Bound<'_, PyDict>) -> PyResult<AnalysisHandle> {
        let settings = raised(settings(given))?;
        let (deployment, load_ms) = (Arc::clone(&self.deployment), self.load_ms);
        interruptible(py, move |progress| {
            let mut analyst = Analyst::new(Arc::clone(&deployment));
            let analysis = analyst.run_while(&settings, progress)?;
            let answer =
                analysis.answer.clone().map_err(|error| Failure::of_calibration(&error))?;
            let answered = AnsweredDeployment { deployment, analysis, answer, load_ms };
            Ok(AnalysisHandle(Arc::new(answered)))
        })
    }
}

/// Opens a deployment; `given` has the fields of `Extras`.
#[pyfunction]
pub fn open(
    py: Python<'_>,
    path: PathBuf,
    given: &Bound<'_, PyDict>,
) -> PyResult<DeploymentHandle> {
    let extras = raised(extras(given))?;
    interruptible(py, move |progress| {
        let started = Instant::now();
        let has_span = extras.corrections.span_s.is_some();
        let deployment = Source::at(path).with(extras).open(progress)?;
        if has_span
            && let Some(times) = times_in_words(&deployment).filter(|_| uses_none(&deployment))
        {
            return Err(Failure(format!("span_s contains no reading; the drive is {times}")));
        }
        Ok(DeploymentHandle::new(deployment, started.elapsed().as_secs_f64() * 1e3))
    })
}

/// Returns true if all readings are left out.
fn uses_none(deployment: &Deployment) -> bool {
    let is_used =
        |track: &Track| (0..track.measurements.len()).any(|index| !track.is_left_out(index));
    !deployment.tracks.iter().any(is_used)
}

/// A ground truth that is a trajectory: its topic in a bag, and the convention of its file.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TruthOptions {
    topic: Option<String>,
    solutions: String,
    convention: String,
}

/// Opens a deployment, or a trajectory that is the ground truth.
#[pyfunction]
pub fn open_truth(
    py: Python<'_>,
    path: PathBuf,
    options: TruthOptions,
    given: &Bound<'_, PyDict>,
) -> PyResult<DeploymentHandle> {
    let extras = raised(extras(given))?;
    interruptible(py, move |progress| {
        let file = TrajectoryFile {
            solutions: choice("truth_solutions", &options.solutions)?,
            convention: convention("truth_convention", &options.convention)?,
            ..TrajectoryFile::at(path, options.topic)
        };
        let deployment = truth::open_truth(file, extras, progress)?;
        Ok(DeploymentHandle::new(deployment, 0.0))
    })
}

/// Returns triplets, and the fate of each reading as an index of `fate_names`.
fn pipeline_arrays<'py>(py: Python<'py>, output: &PipelineOutput) -> PyResult<Bound<'py, PyDict>> {
    let triplets = &output.triplets;
    let table = PyDict::new(py);
    set_column(&table, "time_s", triplets.time_s.iter().copied())?;
    table.set_item("interval", PyArray1::from_slice(py, &triplets.interval))?;
    let count = triplets.len();
    let points = (0..count).flat_map(|index| triplets.triplet_m(index));
    let values: Vec<f64> = points.flat_map(|point| [point.x, point.y, point.z]).collect();
    set_stack(&table, "points_m", values, [count, triplets.points_m.len(), 3])?;
    set_column(&table, "speed_m_per_s", triplets.speed_m_per_s.iter().copied())?;
    let codes = output.fates.iter().map(|fates| {
        let code =
            |fate: &SampleFate| SampleFate::ALL.iter().position(|own| own == fate).unwrap_or(0);
        PyArray1::from_iter(py, fates.each.iter().map(code))
    });
    table.set_item("fates", PyList::new(py, codes)?)?;
    table.set_item("fate_names", SampleFate::ALL.map(SampleFate::label))?;
    table.set_item("intervals", output.kept_intervals.len())?;
    Ok(table)
}
