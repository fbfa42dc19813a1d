//! NumPy arrays in and out. What comes in may be anything that NumPy makes an array of numbers of; its size is checked by name.

use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArray3, PyArrayLikeDyn, PyArrayMethods};
use pyo3::{Bound, PyResult, Python};

use crate::errors::bad;

/// Numbers that a user gives.
pub(crate) type Numbers<'py> = PyArrayLikeDyn<'py, f64, AllowTypeChange>;
/// A list of numbers.
pub(crate) type List<'py> = Bound<'py, PyArray1<f64>>;
/// A table of numbers.
pub(crate) type Table<'py> = Bound<'py, PyArray2<f64>>;
/// A list of tables.
pub(crate) type Tables<'py> = Bound<'py, PyArray3<f64>>;

/// Exactly `K` numbers.
pub(crate) fn vector<const K: usize>(name: &str, x: &Numbers<'_>) -> PyResult<[f64; K]> {
    let mut out = [0.0; K];
    for (to, from) in out.iter_mut().zip(shaped(name, x, &[K])?) {
        *to = from;
    }
    Ok(out)
}

/// Any numbers of this shape, row by row.
fn shaped(name: &str, x: &Numbers<'_>, wanted: &[usize]) -> PyResult<Vec<f64>> {
    let given = x.as_array();
    if given.shape() != wanted {
        return Err(bad(format!(
            "{name}: must have shape {}, not {}",
            shape(wanted),
            shape(given.shape())
        )));
    }
    Ok(given.iter().copied().collect())
}

/// `count` numbers.
pub(crate) fn numbers(name: &str, x: &Numbers<'_>, count: usize) -> PyResult<Vec<f64>> {
    shaped(name, x, &[count])
}

/// A matrix of this shape, row by row.
pub(crate) fn matrix(name: &str, x: &Numbers<'_>, sizes: [usize; 2]) -> PyResult<Vec<f64>> {
    shaped(name, x, &sizes)
}

/// As Python writes a shape.
fn shape(sizes: &[usize]) -> String {
    match sizes {
        [one] => format!("({one},)"),
        _ => {
            let sizes: Vec<String> = sizes.iter().map(usize::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

/// An array of one dimension.
pub(crate) fn list<'py>(py: Python<'py>, x: &[f64]) -> List<'py> {
    PyArray1::from_slice(py, x)
}

/// An array whose rows are these.
pub(crate) fn table<'py, R: AsRef<[f64]>>(
    py: Python<'py>,
    columns: usize,
    rows: impl IntoIterator<Item = R>,
) -> PyResult<Table<'py>> {
    let mut count = 0;
    let mut all = Vec::new();
    for row in rows {
        all.extend_from_slice(row.as_ref());
        count += 1;
    }
    PyArray1::from_vec(py, all).reshape([count, columns])
}

/// An array of tables with `sizes`, each row by row.
pub(crate) fn tables<'py>(
    py: Python<'py>,
    [n, m]: [usize; 2],
    all: Vec<f64>,
) -> PyResult<Tables<'py>> {
    let count = all.len() / (n * m);
    PyArray1::from_vec(py, all).reshape([count, n, m])
}
