//! Rotations for firmware and planners.
#![no_std]

pub mod math;
mod scalar;

pub use nalgebra;
pub use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
pub use scalar::Scalar;
