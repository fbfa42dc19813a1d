//! The jump of a quadruped along a plan (paper A), in closed loop and judged.

pub mod envelope;
pub mod execute;
// Long: `cargo xtask suites`.
#[cfg(all(test, feature = "mujoco"))]
mod fuzz;
pub mod judge;
pub mod linked;
pub mod log;
pub mod measure;
mod planned;
pub mod plant;
pub mod programs;
mod series;

pub use planned::Planned;
pub use series::{Next, run_in_a_row};

pub use jump_planner::robot::{OWNER_COUNT as OWNERS, State};
pub use jump_planner::{FOOT_COUNT, JOINTS, Node, state};

/// The robot in its lab.
pub type World = crate::lab::Ground<JOINTS, OWNERS>;
/// What the machine is told.
pub type Observed = jump_machine::Observation<f64, JOINTS, FOOT_COUNT>;
