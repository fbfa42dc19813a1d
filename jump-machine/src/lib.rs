#![doc = include_str!("../README.md")]
#![no_std]

mod event;
pub mod humanoid;
mod interface;
mod jump;
mod machine;
mod observation;
mod settings;
mod supervisor;

pub use interface::{JumpMachine, Tick};
pub use jump::{Jump, Refusal};
pub use machine::{Machine, Work};
pub use observation::Observation;
pub use settings::Settings;
