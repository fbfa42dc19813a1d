//! The lab: how a real robot, its motors, its sensors, its link and its ground differ from what was planned with.
//!
//! [`Disturbance`] says by how much, in keys that stand in [one table](keys) with the lab's ranges and their reasons; the other parts
//! are what it does to torques and measurements on their way between the machine and a simulator. All of it serves every robot.

mod disturbance;
mod ground;
mod inertia;
mod interface;
pub mod keys;
mod link;
mod motors;
mod sensors;

pub use disturbance::{Disturbance, Lab, PlantArgument};
pub use ground::{Ground, Plant};
pub use inertia::robot;
pub use interface::{Boards, Interface, board_torques};
pub use keys::Key;
pub use link::Link;
pub use motors::{Motors, copper_loss};
pub use sensors::{Encoders, FootSensors};
