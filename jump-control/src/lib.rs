#![doc = include_str!("../README.md")]
#![no_std]

pub mod cartesian;
pub mod com_profile;
pub mod container;
mod crc;
pub mod joint;
pub mod minimum_jerk;
mod payload;
pub mod phase;
pub mod plan;
pub mod sample;
pub mod slew;
pub mod watch;

pub use cartesian::{CartesianGains, CartesianPd};
pub use com_profile::{ComPoint, ComProfile, Curve, takeoff_speed};
pub use crc::Crc32;
pub use joint::{JointCommand, JointGains};
pub use minimum_jerk::MinimumJerk;
pub use payload::PayloadEstimate;
pub use phase::{Event, Phase, TRANSITIONS, next_phase};
pub use plan::{Node, Plan, PlanError, PlannedBase};
pub use sample::{Reference, Torques, sample};
pub use slew::Slew;
pub use watch::{Fault, Measurement, Watch};
