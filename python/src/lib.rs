//! The native half of the Python package `saltus`: the crates of the workspace behind NumPy arrays and exceptions.
//!
//! Doc comments of what Python sees are its docstrings; types stand in `saltus/_saltus.pyi`, and `stubtest` compares both.

mod arrays;
mod coordinates;
mod errors;
mod robot;

/// What Python imports.
#[pyo3::pymodule]
mod _saltus {
    #[pymodule_export]
    use super::robot::Robot;
}
