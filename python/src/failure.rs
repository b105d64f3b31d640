//! Errors as Python exceptions.

use pyo3::prelude::*;
use resect_core::calibration::CalibrationError;
use resect_core::deployment::Deployment;
use resect_core::deployment::printable::printable;

use crate::keywords::with_keywords;

pyo3::create_exception!(
    resect,
    ResectError,
    pyo3::exceptions::PyValueError,
    "An input that resect cannot use: one line with the place, the reason and a remedy, as the program prints it."
);

/// Reason why a call fails, as one line.
#[derive(Debug)]
pub struct Failure(pub String);

impl Failure {
    pub fn new(line: impl Into<String>) -> Self {
        Self(line.into())
    }

    /// A mistake with its remedy.
    pub fn remedied((what, remedy): (String, &str)) -> Self {
        Self(format!("{what}; {remedy}"))
    }

    /// A calibration that is not possible, with its remedies as keyword arguments.
    pub fn of_calibration(error: &CalibrationError) -> Self {
        Self(with_keywords(&error.finding()))
    }
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}

/// Returns the exception of a failure.
pub fn raised<T>(result: Result<T, Failure>) -> PyResult<T> {
    result.map_err(|Failure(line)| ResectError::new_err(printable(&line)))
}

/// Returns the times of a drive for an error: "1669750466.0 to 1669750822.4 s"; `None` without readings.
pub fn times_in_words(deployment: &Deployment) -> Option<String> {
    let (start_s, end_s) = (deployment.start_s()?, deployment.end_s()?);
    Some(format!("{start_s:.1} to {end_s:.1} s"))
}
