//! The native half of the Python package `saltus`: the crates of the workspace behind NumPy arrays and exceptions.
//!
//! Doc comments of what Python sees are its docstrings; types stand in `saltus/_saltus.pyi`, and `stubtest` compares both.

mod arrays;
mod coordinates;
mod envelope;
mod errors;
mod estimator;
mod icub;
mod json;
mod machine;
mod mujoco;
mod observation;
mod ocp;
mod plan;
mod planner;
mod qp;
mod robot;
mod run;
mod task;
mod wbc;

/// What Python imports.
#[pyo3::pymodule]
mod _saltus {
    #[pymodule_export]
    use super::envelope::{Envelope, envelope};
    #[pymodule_export]
    use super::estimator::Estimator;
    #[pymodule_export]
    use super::icub::{IcubRecord, run_icub};
    #[pymodule_export]
    use super::machine::{Command, Machine, Tick};
    #[pymodule_export]
    use super::observation::Observation;
    #[pymodule_export]
    use super::ocp::{OcpSolution, solve_ocp};
    #[pymodule_export]
    use super::plan::Plan;
    #[pymodule_export]
    use super::planner::plan;
    #[pymodule_export]
    use super::qp::{QpSolution, solve_qp};
    #[pymodule_export]
    use super::robot::Robot;
    #[pymodule_export]
    use super::run::{Record, run};
    #[pymodule_export]
    use super::task::Task;
    #[pymodule_export]
    use super::wbc::{TorqueAnswer, TorqueQp, WbTask};
}
