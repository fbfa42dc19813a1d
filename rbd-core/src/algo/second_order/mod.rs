//! Inverse dynamics with contact forces, accelerations and positions of points, and all their derivatives up to the second
//! order, of a robot whose base is a chain of joints that starts in the world.
//!
//! What an optimiser of trajectories asks at one instant. [`Sweep`] goes through the tree once, in world axes, and answers:
//!
//! | quantity | value | first derivatives | second, contracted with multipliers |
//! |---|---|---|---|
//! | efforts τ(q, q̇, q̈, F) | [`Sweep::effort`] | [`Sweep::differentiate`] | [`Sweep::curvature`] |
//! | acceleration of a contact | [`Sweep::slip_rate`] | [`Sweep::acceleration_gradients`] | in the same sum |
//! | position of a point | [`Sweep::place`] | [`Sweep::position_gradient`] | in the same sum |
//!
//! The base's coordinates are joints here, so that `q`, `q̇` and `q̈` are `N` numbers each and every derivative is a partial one:
//! six of them (prismatic x, y, z and three revolute ones) carry a floating base. A base that turns on SO(3) is seen from the middle
//! of its interval: [`Sweep::new`] lets the angles of the turning joints start from any rotation, and at zero angles no chart is
//! singular. [`rnea_derivatives`](crate::rnea_derivatives) has the first derivatives in base axes, in the coordinates of a
//! [`Tangent`](crate::Tangent), for controllers and for comparison with Pinocchio.
//!
//! Contact forces keep their direction in the world while bodies turn, and may act below their point, where a ball touches the
//! ground ([`PointMotion::arm`]). `tests/second_order.rs` holds values to [`rnea_with_forces`](crate::rnea_with_forces) and
//! derivatives to dual numbers and differences, on random trees of every joint kind.

mod contacts;
mod curvature;
mod effort;
mod gradient;
mod moments;
mod rolling;
mod sweep;

pub use contacts::{Contacts, PointMotion};
pub use curvature::{Multipliers, PositionTerms};
pub use effort::EffortJacobian;
pub use gradient::{Gradient, Hessian};
pub use sweep::{JointMotion, Path, Sweep};
