#![doc = include_str!("../README.md")]
#![no_std]

pub mod abreast;
pub mod algo;
pub mod convert;
pub mod hardware;
pub mod joint;
pub mod linear;
pub mod manifold;
pub mod model;
pub mod reduction;
pub mod robot;
mod shape;
pub mod similarity;
pub mod spatial;
pub mod state;
pub mod table;
pub mod tree;

// The vectors and matrices of this crate's interface: use them from here and the versions agree.
pub use nalgebra;

pub use algo::aba::{AbaWorkspace, aba, aba_with_forces, mass_solve};
pub use algo::aba_derivatives::{
    AbaDerivatives, AbaDerivativesWorkspace, aba_derivatives, aba_derivatives_with_forces,
};
pub use algo::blocks::BlockMatrix;
pub use algo::centroidal::{
    CentroidalMap, CentroidalState, centroidal_bias, centroidal_map, centroidal_momentum_rate,
    centroidal_state,
};
pub use algo::centroidal_derivatives::{
    CentroidalDerivatives, ForceColumns, centroidal_derivatives,
};
pub use algo::com::{
    CenterOfMass, ComJacobian, ComMotion, center_of_mass, com_jacobian, com_motion,
};
pub use algo::contact::{ContactRow, ContactSolution, ContactWorkspace, contact_dynamics, impact};
pub use algo::crba::{MassMatrix, crba};
pub use algo::frame_derivatives::{AccelerationKind, FrameDerivatives, frame_derivatives};
pub use algo::friction::joint_friction;
pub use algo::gravity::generalized_gravity;
pub use algo::jacobian::{FrameJacobian, frame_jacobian, joint_jacobians};
pub use algo::kinematics::{Kinematics, forward_kinematics};
pub use algo::limbs::{LimbEnd, Limbs};
pub use algo::minv::{MassFactors, mass_matrix_inverse};
pub use algo::motion::{
    Axes, BodyMotions, bias_accelerations, forward_accelerations, forward_velocities,
};
pub use algo::rnea::{nonlinear_effects, rnea, rnea_with_forces};
pub use algo::rnea_derivatives::{
    DerivativesWorkspace, RneaDerivatives, rnea_derivatives, rnea_derivatives_with_forces,
};
pub use algo::second_order;
pub use hardware::{Budgets, Contact, ContactShape, Motor};
pub use manifold::{difference, integrate, interpolate};
pub use model::{BaseBody, BaseKind, Body, Frame, JointLimits, Link};
pub use reduction::{CoupledWorkspace, Coupling, Reduction, ReductionError, coupled_dynamics};
pub use robot::Model;
pub use shape::Shape;
pub use similarity::Build;
pub use spatial::{ArticulatedInertia, Force, Inertia, Motion, Symmetric3, Transform};
pub use state::{Configuration, Effort, Posture, Tangent};
pub use table::{TableError, TableModel};
pub use tree::Tree;

/// Standard gravity vector in the world, m/s².
pub const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];
