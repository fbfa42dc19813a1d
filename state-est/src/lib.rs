#![doc = include_str!("../README.md")]
#![no_std]

mod estimator;
mod feet;
mod filter;
mod sample;
mod settings;

pub use estimator::{Estimate, Estimator, State, Status};
pub use feet::Foot;
pub use sample::{Fault, Sample};
pub use settings::Settings;
