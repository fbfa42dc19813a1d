//! Spatial algebra: motions, forces, inertias and transforms as distinct types.
//!
//! All 6-vectors are linear first. A [`Motion`] and a [`Force`] do not add to each other, and each
//! changes frame by its own rule, so mixing them up does not compile:
//!
//! ```compile_fail
//! use rbd_core::spatial::{Force, Motion};
//! let _ = Motion::<f64>::ZERO + Force::<f64>::ZERO;
//! ```

mod articulated;
mod force;
mod inertia;
mod motion;
mod six;
mod symmetric;
mod transform;

pub use articulated::ArticulatedInertia;
pub use force::Force;
pub use inertia::Inertia;
pub use motion::Motion;
pub use symmetric::Symmetric3;
pub use transform::Transform;
