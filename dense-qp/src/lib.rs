#![doc = include_str!("../README.md")]
#![no_std]

mod access;
mod basis;
mod elimination;
mod error;
mod factor;
mod kernels;
mod problem;
mod residual;
mod settings;
mod solver;
mod tiles;
mod workspace;

pub use error::Error;
pub use problem::Problem;
pub use residual::{Infeasibility, Residual, infeasibility, kkt_residual};
pub use settings::Settings;
pub use solver::{resume, solve, solve_warm};
pub use workspace::{Constraint, Side, Solution, Status, Workspace};
