#![doc = include_str!("../README.md")]
#![no_std]

mod controller;
mod forces;
mod settings;
mod touchdown;

pub use controller::{Command, Landing, Outcome, Workspace};
pub use settings::{Settings, Target};
pub use touchdown::{ContactFilter, TouchdownState};
