#![doc = include_str!("../README.md")]
#![no_std]

mod contact;
mod error;
mod joints;
mod native;
mod settings;
mod simulator;
mod terrain;

pub use contact::{ContactLaw, ContactSphere, ContactState};
pub use error::Error;
pub use joints::Stops;
pub use native::NativeSimulator;
pub use settings::Settings;
pub use simulator::Simulator;
pub use terrain::{Block, Terrain, Touch};
