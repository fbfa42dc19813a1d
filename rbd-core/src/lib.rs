#![doc = include_str!("../README.md")]
#![no_std]

pub mod algo;
pub mod joint;
pub mod linear;
pub mod model;
pub mod spatial;
pub mod state;
pub mod table;
pub mod tree;

pub use algo::aba::{AbaWorkspace, aba};
pub use algo::crba::{MassMatrix, crba};
pub use algo::kinematics::{Kinematics, forward_kinematics};
pub use algo::rnea::{generalized_gravity, nonlinear_effects, rnea, rnea_with_forces};
pub use model::{BaseBody, BaseKind, Body, Frame, JointLimits, Link};
pub use spatial::{ArticulatedInertia, Force, Inertia, Motion, Symmetric3, Transform};
pub use state::{Configuration, Effort, Posture, Tangent};
pub use table::{TableError, TableModel};
pub use tree::Tree;

/// Standard gravity vector in the world, m/s².
pub const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];
