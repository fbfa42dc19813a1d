//! Every integration test of the crate in one program: linked once.
#![allow(clippy::unwrap_used, reason = "tests")]

mod atan;
mod cases;
mod euler;
mod exp_log;
mod jacobian;
mod math;
mod oracle;
mod orthonormalize;
mod quat;
mod rotation_error;
mod sin_cos;
mod small_angle;
mod taylor;
