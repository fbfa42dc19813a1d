#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "std")]
extern crate std;

mod blocking;
mod check;
mod eliminate;
mod equalities;
mod filter;
mod iterate;
mod keep;
mod kernel;
mod line_search;
mod linearised;
mod packed;
mod problem;
mod project;
mod riccati;
mod rows;
mod settings;
mod solver;
mod stage;
mod sweep;
#[cfg(feature = "std")]
mod threads;

pub use blocking::{Blocking, blocking_rows};
pub use check::{DerivativeErrors, derivative_errors};
pub use keep::{Keep, Recomputed};
pub use packed::Packed;
pub use problem::{Derivatives, Dims, Evaluated, Problem, Values};
pub use settings::{Barrier, Error, Progress, Residual, Settings, Solution, Status};
pub use solver::Solver;
pub use stage::{LeanStage, SparseStage, Stage};
