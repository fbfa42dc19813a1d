#![doc = include_str!("../README.md")]
#![no_std]

pub mod cartesian;
pub mod com_profile;
pub mod container;
pub mod joint;
pub mod minimum_jerk;
pub mod phase;
pub mod plan;
pub mod sample;
pub mod slew;
pub mod steady;
pub mod watch;
mod weigh;

pub use cartesian::{CartesianGains, CartesianPd};
pub use com_profile::{ComPoint, ComProfile, Curve, takeoff_speed};
pub use joint::{JointCommand, JointGains};
pub use minimum_jerk::MinimumJerk;
pub use phase::{Event, Phase, TRANSITIONS, next_phase};
pub use plan::{Node, Plan, PlanError, PlannedBase};
pub use sample::{Reference, Torques, sample};
pub use slew::Slew;
pub use steady::Steady;
pub use watch::{Fault, Measurement, Watch};
pub use weigh::Scales;
