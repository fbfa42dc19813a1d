//! The lab: how a real robot, its motors, its sensors, its link and its ground differ from what was planned with.
//!
//! [`Disturbance`] says by how much, in keys that stand in [one table](keys) with the lab's ranges and their reasons; the other parts
//! are what it does to torques and measurements on their way between the machine and a simulator. All of it serves every robot.

mod disturbance;
mod ground;
mod inertia;
mod interface;
pub(crate) mod keys;
mod link;
mod motors;
mod sensors;

pub(crate) use disturbance::{Disturbance, Lab, PlantArgument};
pub(crate) use ground::{Ground, Plant};
pub(crate) use inertia::robot;
pub(crate) use interface::{Boards, Interface};
pub(crate) use keys::Key;
pub(crate) use link::Link;
pub(crate) use motors::{Motors, copper_loss};
pub(crate) use sensors::{Encoders, FootSensors};
