#![doc = include_str!("../README.md")]
#![no_std]

mod event;
mod jump;
mod machine;
mod settings;

pub use jump::{Jump, Refusal};
pub use machine::{Inputs, Machine, Tick, Work};
pub use settings::Settings;
