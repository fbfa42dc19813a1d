#![doc = include_str!("../README.md")]
#![no_std]

pub mod cartesian;
pub mod joint;
pub mod phase;
pub mod plan;
pub mod sample;
pub mod watch;

pub use cartesian::{CartesianGains, CartesianPd};
pub use joint::{JointCommand, JointGains};
pub use phase::{Event, Phase, TRANSITIONS, next_phase};
pub use plan::{Node, Plan, PlanError};
pub use sample::{Reference, Torques, sample};
pub use watch::{Fault, Measurement, Watch};
