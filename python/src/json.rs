//! What the crates tell as JSON, as Python's own objects.

use pyo3::types::{PyAnyMethods, PyModule};
use pyo3::{Bound, PyAny, PyResult, Python};
use serde_json::Value;

/// Dictionaries, lists and numbers.
pub(crate) fn object<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    PyModule::import(py, "json")?
        .getattr("loads")?
        .call1((value.to_string(),))
}
