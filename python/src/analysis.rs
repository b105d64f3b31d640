//! An answer: its JSON, its text, its residuals and its trajectory.

use std::sync::Arc;

use nalgebra::Vector3;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use resect_core::analysis::{Analysis, Answer};
use resect_core::deployment::Deployment;
use resect_core::evaluation::requested_trajectory::{
    LARGEST_RATE_HZ, TrajectoryRequest, requested_trajectory,
};
use resect_core::evaluation::vehicle::Instants;
use resect_report::{json, text, trace};

use crate::arrays::{plain, set_column};
use crate::failure::{Failure, times_in_words};
use crate::interruptible::interruptible;
use crate::keywords::{of_request, with_keywords};
use crate::trajectory::requested_arrays;

/// An answer of a deployment.
#[pyclass(frozen, module = "resect._native")]
pub struct AnalysisHandle(pub Arc<AnsweredDeployment>);

/// A deployment with its answer.
pub struct AnsweredDeployment {
    pub deployment: Arc<Deployment>,
    pub analysis: Analysis,
    pub answer: Arc<Answer>,
    pub load_ms: f64,
}

/// Options of a trajectory.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct TrajectoryOptions {
    rate: Option<f64>,
    times_s: Option<Vec<f64>>,
    max_error_m: Option<f64>,
    max_sigma_m: Option<f64>,
    max_sigma_rad: Option<f64>,
    lever_arm_m: Option<[f64; 3]>,
    frame: String,
}

#[pymethods]
impl AnalysisHandle {
    /// Returns the object that `resect calibrate --json` prints.
    fn json<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let answered = Arc::clone(&self.0);
        let value = interruptible(py, move |_| {
            let AnsweredDeployment { deployment, analysis, answer, load_ms } = &*answered;
            Ok(json::calibration(deployment, analysis, answer, *load_ms))
        })?;
        plain(py, &value)
    }

    /// Returns the trace that `resect calibrate --trace --json` adds; `None` without a joint estimate.
    fn trace<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.0.answer.calibration.trace().map(|it| plain(py, &trace::json(it))).transpose()
    }

    /// Returns the text that `resect calibrate` prints.
    fn text(&self, py: Python<'_>) -> PyResult<String> {
        let answered = Arc::clone(&self.0);
        interruptible(py, move |_| {
            let AnsweredDeployment { deployment, analysis, answer, .. } = &*answered;
            Ok(text::calibration(deployment, analysis, answer, with_keywords))
        })
    }

    /// Returns the distance errors of the prisms at each triplet; columns of unknown distances are left out.
    fn residuals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let AnsweredDeployment { analysis, answer, .. } = &*self.0;
        let triplets = analysis.triplets();
        let table = PyDict::new(py);
        set_column(&table, "time_s", triplets.time_s.iter().copied())?;
        table.set_item("interval", PyArray1::from_slice(py, &triplets.interval))?;
        for (pair, errors_mm) in answer.evaluation.distance_errors_mm.each() {
            if errors_mm.len() == triplets.len() {
                let name = format!("error_{}{}_mm", pair.first, pair.second);
                set_column(&table, &name, errors_mm.iter().copied())?;
            }
        }
        Ok(table)
    }

    /// Returns the poses of the vehicle, or the positions of the one prism.
    fn trajectory<'py>(
        &self,
        py: Python<'py>,
        options: TrajectoryOptions,
    ) -> PyResult<Bound<'py, PyDict>> {
        let answered = Arc::clone(&self.0);
        let requested = interruptible(py, move |_| {
            let request = options.request()?;
            let AnsweredDeployment { deployment, analysis, answer, .. } = &*answered;
            check_times(deployment, options.times_s.as_deref().unwrap_or_default())?;
            let (triplets, followed) = (analysis.triplets(), &analysis.offer.followed);
            requested_trajectory(deployment, triplets, followed, &answer.calibration, &request)
                .map_err(|why| of_request(&why))
        })?;
        requested_arrays(py, &requested)
    }
}

/// Refuses times that all lie outside of the drive; no times are not refused.
fn check_times(deployment: &Deployment, times_s: &[f64]) -> Result<(), Failure> {
    let (Some(start_s), Some(end_s)) = (deployment.start_s(), deployment.end_s()) else {
        return Ok(());
    };
    let is_outside = |time_s: &f64| !(start_s..=end_s).contains(time_s);
    match times_in_words(deployment).filter(|_| !times_s.is_empty()) {
        Some(times) if times_s.iter().all(is_outside) => {
            Err(Failure(format!("times_s lies outside of the drive, which is {times}")))
        }
        _ => Ok(()),
    }
}

impl TrajectoryOptions {
    /// Returns the request, or the first invalid option.
    fn request(&self) -> Result<TrajectoryRequest<'_>, Failure> {
        let instants = match (&self.times_s, self.rate) {
            (Some(_), Some(_)) => {
                return Err(Failure::new("rate and times_s exclude each other; give one"));
            }
            (Some(times_s), None) if !times_s.iter().all(|time_s| time_s.is_finite()) => {
                return Err(Failure::new("times_s has values that are not finite; give seconds"));
            }
            (Some(times_s), None) => Instants::At(times_s),
            (None, Some(hz)) if hz > 0.0 && hz <= LARGEST_RATE_HZ => Instants::Rate(hz),
            (None, Some(hz)) => {
                let line =
                    format!("rate is {hz} Hz; it must be above 0 and {LARGEST_RATE_HZ} at most");
                return Err(Failure(line));
            }
            (None, None) => Instants::Usual,
        };
        let mut request = TrajectoryRequest { instants, ..TrajectoryRequest::default() };
        let limits = &mut request.limits;
        for (name, given, limit) in [
            ("max_error_m", self.max_error_m, &mut limits.inter_prism_error_m),
            ("max_sigma_m", self.max_sigma_m, &mut limits.sigma.position_m),
            ("max_sigma_rad", self.max_sigma_rad, &mut limits.sigma.orientation_rad),
        ] {
            let Some(given) = given else { continue };
            if !(given > 0.0 && given.is_finite()) {
                return Err(Failure(format!("{name} is {given}; it must be above zero")));
            }
            *limit = given;
        }
        if let Some(lever_arm_m) = self.lever_arm_m {
            if !lever_arm_m.iter().all(|value| value.is_finite()) {
                return Err(Failure::new(
                    "lever_arm_m has values that are not finite; give metres",
                ));
            }
            request.lever_arm_m = Some(Vector3::from(lever_arm_m));
        }
        request.is_in_site_frame = match &*self.frame {
            "station1" => false,
            "control-points" => true,
            other => {
                return Err(Failure(format!(
                    "unknown frame `{other}`; give station1 or control-points"
                )));
            }
        };
        Ok(request)
    }
}
