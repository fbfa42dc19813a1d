#![doc = include_str!("../README.md")]
#![no_std]

mod apart;
mod differentiate;
mod drive;
mod error;
mod friction;
mod gain;
mod guess;
mod judge;
mod map;
mod midpoint;
mod plan;
mod problem;
mod robot;
mod rotation;
mod row;
mod rows;
mod state;
mod stretch;
mod timing;
mod transcription;

pub use apart::{Apart, Segment};
pub use error::Error;
pub use friction::Friction;
pub use gain::Gains;
pub use judge::{Judgement, Sample};
pub use plan::settings;
pub use problem::{Clearance, Foot, Phase, Problem, Weights};
pub use robot::{BASE, BaseCoordinates, EulerOrder, Point, Robot};
pub use row::Row;
pub use rows::row_capacity;
pub use state::{Pose, State};
pub use timing::{FreeTiming, TimedStage, TimedState};
