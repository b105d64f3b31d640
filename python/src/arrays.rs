//! numpy arrays and plain data for Python.

use nalgebra::Vector3;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use serde_json::Value;

/// Sets a column of numbers, of shape (n,).
pub fn set_column(
    table: &Bound<'_, PyDict>,
    name: &str,
    values: impl IntoIterator<Item = f64>,
) -> PyResult<()> {
    table.set_item(name, PyArray1::from_iter(table.py(), values))
}

/// Sets a stack of arrays of equal shape, with shape (n, …); `values` are row by row.
pub fn set_stack<const D: usize>(
    table: &Bound<'_, PyDict>,
    name: &str,
    values: Vec<f64>,
    shape: [usize; D],
) -> PyResult<()> {
    let py = table.py();
    // numpy's own reshape has a shape of any length.
    let flat = PyArray1::from_vec(py, values);
    table.set_item(name, flat.call_method1("reshape", (shape,))?)
}

/// Sets points as an array of shape (n, 3).
pub fn set_points<'a>(
    table: &Bound<'_, PyDict>,
    name: &str,
    points: impl IntoIterator<Item = &'a Vector3<f64>>,
) -> PyResult<()> {
    let values: Vec<f64> = points.into_iter().flatten().copied().collect();
    let count = values.len() / 3;
    set_stack(table, name, values, [count, 3])
}

/// Returns JSON as dictionaries and lists.
pub fn plain<'py>(py: Python<'py>, json: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(pythonize(py, json)?)
}
