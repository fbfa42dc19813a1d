#![doc = include_str!("../README.md")]
#![no_std]

mod balance;
mod centring;
mod event;
mod hold;
pub mod humanoid;
mod interface;
mod jump;
mod load;
mod machine;
mod observation;
mod pre_landing;
mod push_off;
pub mod regulator;
mod settings;
mod supervisor;
mod unloading;
mod workspace;

pub use centring::Centring;
pub use interface::{JumpMachine, Tick};
pub use jump::{Jump, Refusal};
pub use load::Load;
pub use machine::{Machine, Work};
pub use observation::Observation;
pub use settings::Settings;
pub use unloading::Unloading;
pub use workspace::Workspace;
