#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "mjcf")]
extern crate std;

mod collide;
mod contact;
mod error;
mod joints;
#[cfg(feature = "mjcf")]
mod mjcf;
#[cfg(feature = "mujoco")]
mod mujoco;
mod native;
mod settings;
mod shape;
mod simulator;
mod terrain;

pub use collide::{MOST_SHAPES, effective_mass, gaps, self_contacts};
pub use contact::{ContactLaw, ContactMass, ContactState};
pub use error::Error;
pub use joints::Stops;
#[cfg(feature = "mjcf")]
pub use mjcf::{Geom, mjcf};
#[cfg(feature = "mujoco")]
pub use mujoco::{ModelRefused, MujocoSimulator, mujoco_version};
pub use native::NativeSimulator;
pub use rbd_core::Shape;
pub use settings::Settings;
pub use simulator::Simulator;
pub use terrain::{Block, Terrain, Touch};
