#![doc = include_str!("../README.md")]
#![no_std]

mod dynamics;
mod error;
mod exponential;
mod guess;
pub mod onboard;
mod plan;
mod problem;
mod rotation;
mod row;
mod rows;
#[cfg(feature = "clarabel")]
mod sqp;
mod state;
mod transcription;
mod violation;

pub use error::Error;
pub use exponential::Exponential;
pub use problem::{Edge, Foot, Ground, Phase, Problem, Reference, Weights};
pub use row::Row;
pub use rows::row_capacity;
#[cfg(feature = "clarabel")]
pub use sqp::{SqpNode, SqpSolution};
pub use state::{OMEGA, POSITION, ROTATION, State, TIMES, VELOCITY};
pub use violation::{Judgement, Sample};
