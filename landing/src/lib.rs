#![doc = include_str!("../README.md")]
#![no_std]

mod controller;
mod detector;
mod forces;
mod least_squares;
mod observer;
mod posture;
mod settings;
mod touchdown;

pub use controller::{Command, Landing, Outcome, Workspace};
pub use detector::{Detector, DetectorState};
pub use observer::{ForceObserver, ObserverState};
pub use posture::PreLanding;
pub use settings::{Settings, Target};
pub use touchdown::{ContactFilter, TouchdownState};
