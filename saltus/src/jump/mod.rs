//! The main job: a jump planned, simulated and judged.

pub(crate) mod envelope;
pub(crate) mod execute;
// Long: `cargo xtask suites`.
#[cfg(all(test, feature = "mujoco"))]
mod fuzz;
pub(crate) mod judge;
pub(crate) mod log;
pub(crate) mod measure;
pub(crate) mod plant;
pub(crate) mod programs;
pub(crate) mod report;
pub(crate) mod strip;

pub(crate) use jump_planner::robot::{OWNER_COUNT as OWNERS, State};
pub(crate) use jump_planner::{FOOT_COUNT, JOINTS, Node, state};

/// The robot in its lab.
pub(crate) type World = crate::lab::Ground<JOINTS, OWNERS>;
/// What the machine is told.
pub(crate) type Observed = jump_machine::Observation<f64, JOINTS, FOOT_COUNT>;
