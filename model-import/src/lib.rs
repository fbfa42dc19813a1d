#![doc = include_str!("../README.md")]

pub mod emit;
pub mod error;
pub mod limbs;
pub mod options;
pub mod robot;
pub mod urdf;

mod canonical;
mod locks;
mod tree;

pub use error::{ImportError, Warning};
pub use options::{InertiaPolicy, MimicPolicy, Options, parse_lock};
pub use robot::{JointInfo, LinkFrame, Robot};
