#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "fused")]
extern crate std;

mod error;
pub mod euler;
mod exp_log;
mod hat;
mod interpolate;
mod jacobian;
pub mod math;
mod orthonormalize;
pub mod quat;
mod rotation_error;
mod scalar;
pub mod small_angle;
mod taylor;

pub use error::Error;
pub use exp_log::{
    exp, exp_with_jacobian, log, log_near, log_with_jacobian_inverse, rotation_about,
};
pub use hat::{hat, vee};
pub use interpolate::Geodesic;
pub use jacobian::{left_jacobian, left_jacobian_inverse, right_jacobian, right_jacobian_inverse};
pub use nalgebra;
pub use nalgebra::{Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};
pub use orthonormalize::{nearest_rotation, orthogonality_defect, orthonormalize_step};
pub use rotation_error::{ERROR_SMOOTHING, rotation_error, rotation_error_smoothed};
pub use scalar::Scalar;
pub use taylor::{
    exp_taylor4, exp_taylor4_defect, exp_taylor4_derivatives, exp_taylor4_error_bound,
};
