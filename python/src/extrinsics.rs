//! Extrinsic calibration of two bodies by their trajectories.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use resect_io::estimate_file::read_truth;
use resect_io::gnss_solution::SolutionChoice;
use resect_report::extrinsics::{extrinsics_copy, extrinsics_json, extrinsics_text};
use resect_report::named_transform::TransformFormat;
use resect_tools::estimates::{Options, TrajectoryAlignment};
use resect_tools::extrinsics::{Extrinsics, estimate_extrinsics};

use crate::arrays::plain;
use crate::failure::Failure;
use crate::interruptible::interruptible;
use crate::keywords::convention;

/// A trajectory with its topic in a bag, and the convention of its file.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct BodyFile {
    path: PathBuf,
    topic: Option<String>,
    convention: String,
}

/// Estimates the pose of the second body in the first one.
#[pyfunction]
pub fn extrinsics<'py>(
    py: Python<'py>,
    bodies: [BodyFile; 2],
    time_offset_s: Option<f64>,
    free_scale: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let extrinsics = interruptible(py, move |_| calibrated(&bodies, time_offset_s, free_scale))?;
    let table = PyDict::new(py);
    table.set_item("json", plain(py, &extrinsics_json(&extrinsics))?)?;
    table.set_item("text", extrinsics_text(&extrinsics))?;
    let copies = PyDict::new(py);
    for format in TransformFormat::ALL {
        copies.set_item(format.name(), extrinsics_copy(&extrinsics, None, format))?;
    }
    table.set_item("copies", copies)?;
    Ok(table)
}

fn calibrated(
    bodies: &[BodyFile; 2],
    time_offset_s: Option<f64>,
    free_scale: bool,
) -> Result<Extrinsics, Failure> {
    if time_offset_s.is_some_and(|offset_s| !offset_s.is_finite()) {
        return Err(Failure::new(
            "time_offset_s is not finite; give seconds, or None to estimate it",
        ));
    }
    let [of_body, of_other] =
        bodies.each_ref().map(|file| convention("conventions", &file.convention));
    let read = |file: &BodyFile| {
        read_truth(&file.path, file.topic.as_deref(), SolutionChoice::Best).map_err(Failure::from)
    };
    let [body, other] = bodies.each_ref().map(read);
    let alignment = match free_scale {
        true => TrajectoryAlignment::Similarity,
        false => TrajectoryAlignment::Rigid,
    };
    let options = Options { alignment, time_offset_s, convention: of_other?, ..Options::default() };
    estimate_extrinsics([body?, other?], &options, of_body?).map_err(|why| Failure(why.to_string()))
}
