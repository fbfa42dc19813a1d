#![doc = include_str!("../README.md")]
#![no_std]

mod controller;
mod detector;
mod face;
mod forces;
mod inertia_shaping;
mod least_squares;
mod limits;
mod observer;
mod posture;
mod program;
mod retraction;
mod settings;
mod shortening;
mod touchdown;
mod wrench;

pub use controller::{Command, Landing, Outcome, Workspace};
pub use dense_qp::Status;
pub use detector::{Detector, DetectorState};
pub use inertia_shaping::{InertiaShaping, Turning};
pub use least_squares::solve_damped;
pub use observer::{ForceObserver, ObserverState};
pub use posture::PreLanding;
pub use program::Program;
pub use retraction::Retraction;
pub use settings::{Settings, Target};
pub use shortening::Shortening;
pub use touchdown::{ContactFilter, TouchdownState};
