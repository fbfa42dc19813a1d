#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "mjcf")]
extern crate std;

mod collide;
mod contact;
#[cfg(feature = "mjcf")]
mod engine;
mod error;
mod joints;
#[cfg(feature = "mujoco")]
mod linked;
#[cfg(feature = "mjcf")]
mod mjcf;
#[cfg(feature = "mjcf")]
mod mujoco;
mod native;
mod settings;
mod shape;
mod simulator;
mod terrain;

pub use collide::{MOST_SHAPES, effective_mass, gap, gaps, overlaps, self_contacts};
pub use contact::{ContactLaw, ContactMass, ContactState};
#[cfg(feature = "mjcf")]
pub use engine::{Compile, ContactPoint, Engine, EngineFailed, NoEngine};
pub use error::Error;
pub use joints::Stops;
#[cfg(feature = "mujoco")]
pub use linked::{linked, mujoco_version};
#[cfg(feature = "mjcf")]
pub use mjcf::{Geom, mjcf};
#[cfg(feature = "mjcf")]
pub use mujoco::MujocoSimulator;
pub use native::NativeSimulator;
pub use rbd_core::Shape;
pub use settings::Settings;
pub use simulator::Simulator;
pub use terrain::{Block, Terrain, Touch};
