#![doc = include_str!("../README.md")]
#![no_std]

mod anchor;
mod collision;
mod contact;
mod error;
pub mod jump;
mod limits;
mod program;
mod rows;
mod snapshot;
pub mod task;
mod torque;
mod velocity;

pub use anchor::anchored;
pub use collision::Clearance;
pub use contact::{Contact, Patch};
pub use error::Error;
pub use limits::{Horizon, torque_range};
pub use rows::{Extent, Limit, Limited, Rank, Side};
pub use snapshot::Snapshot;
pub use task::{Gains, Task};
pub use torque::{TorqueAnswer, TorqueQp, Yielded};
pub use velocity::{VelocityAnswer, VelocityQp};
