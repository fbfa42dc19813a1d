//! The two push-off controllers of paper B and one for flight and landing, each a short composition of tasks, contacts and
//! limits.
//!
//! What the paper writes as equalities on the centre of mass and the angular momentum are costs here, with a weight that is
//! stated: on 10 to 27 % of plausible states the equalities contradict contacts and limits, and then nothing comes out at
//! all. How far each was from holding is part of the answer ([`Residuals`]).

mod landing;
mod surplus;
mod torque;
mod velocity;

pub use landing::{Absorption, Landing, LandingReference, LandingSettings};
pub use torque::{TorqueJump, TorqueJumpSettings, TorqueTick};
pub use velocity::{VelocityJump, VelocityJumpSettings, VelocityTick};

use nalgebra::Vector3;
use so3::Scalar;

/// Where the centre of mass shall be in this tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComReference<T: Scalar> {
    /// Position in the world, m.
    pub position_w: Vector3<T>,
    /// Velocity, m/s.
    pub velocity_w: Vector3<T>,
    /// Acceleration, m/s².
    pub acceleration_w: Vector3<T>,
}

/// By how much the rows missed that the paper writes as equalities: at the level of velocities in m/s and kg m²/s, at
/// the level of torques in m/s² and N m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residuals<T> {
    /// Largest entry of the centre of mass's rows, eqs. (3b) and (6b).
    pub com: T,
    /// Largest entry of the angular momentum's rows, eqs. (3d) and (6d).
    pub momentum: T,
}

/// Largest |aᵢ − bᵢ|.
pub(crate) fn distance<T: Scalar, const R: usize>(a: &[T; R], b: &[T; R]) -> T {
    a.iter().zip(b).fold(T::ZERO, |m, (a, b)| {
        so3::math::max(m, so3::math::abs(*a - *b))
    })
}
