#![doc = include_str!("../README.md")]

pub mod couplings;
pub mod emit;
pub mod error;
pub mod limbs;
pub mod mjcf;
pub mod options;
pub mod robot;
pub mod urdf;

mod canonical;
mod floating;
mod locks;
mod size;
mod tree;

// The vectors and matrices of this crate's interface.
pub use nalgebra;

pub use couplings::JointCoupling;
pub use error::{ImportError, Warning};
pub use options::{InertiaPolicy, MimicPolicy, Options, parse_lock};
pub use robot::{JointInfo, LinkFrame, Robot};
