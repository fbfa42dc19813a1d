#![doc = include_str!("../README.md")]
#![no_std]

mod estimator;
mod filter;
mod sample;
mod settings;

pub use estimator::{Estimate, Estimator, Foot, State, Status};
pub use sample::{Fault, Sample};
pub use settings::Settings;
