#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "mujoco")]
extern crate std;

mod contact;
mod error;
mod joints;
#[cfg(feature = "mujoco")]
mod mjcf;
#[cfg(feature = "mujoco")]
mod mujoco;
mod native;
mod settings;
mod simulator;
mod terrain;

pub use contact::{ContactLaw, ContactSphere, ContactState};
pub use error::Error;
pub use joints::Stops;
#[cfg(feature = "mujoco")]
pub use mjcf::{Geom, GeomShape, mjcf};
#[cfg(feature = "mujoco")]
pub use mujoco::{ModelRefused, MujocoSimulator, mujoco_version};
pub use native::NativeSimulator;
pub use settings::Settings;
pub use simulator::Simulator;
pub use terrain::{Block, Terrain, Touch};
