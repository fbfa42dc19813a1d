//! Spatial motion vectors: velocities and accelerations.

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use nalgebra::Vector3;
use so3::Scalar;
use so3::math::mul_add;

use super::cross;
use super::six::six_vector;

/// A spatial velocity or acceleration, expressed in one frame and about its origin.
///
/// Acceleration here is *spatial* (the derivative of the coordinates of the velocity in the moving
/// frame); see [`Motion::to_classical`] for that of a material point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<T> {
    /// Velocity or acceleration of the point at the frame's origin, m/s or m/s².
    pub linear: Vector3<T>,
    /// Angular velocity or acceleration, rad/s or rad/s².
    pub angular: Vector3<T>,
}

six_vector!(Motion);

impl<T: Scalar> Motion<T> {
    /// Motion × motion: how `other` changes because its frame moves with `self`.
    ///
    /// (v, ω) × (v′, ω′) = (ω × v′ + v × ω′, ω × ω′).
    #[inline(always)]
    #[must_use]
    pub fn cross(&self, other: &Self) -> Self {
        Self {
            linear: cross(&self.angular, &other.linear) + cross(&self.linear, &other.angular),
            angular: cross(&self.angular, &other.angular),
        }
    }

    /// Motion ×* force, the dual of [`Motion::cross`]: (ω × f, ω × n + v × f).
    #[inline(always)]
    #[must_use]
    pub fn cross_force(&self, force: &super::Force<T>) -> super::Force<T> {
        super::Force {
            linear: cross(&self.angular, &force.linear),
            angular: cross(&self.angular, &force.angular) + cross(&self.linear, &force.linear),
        }
    }

    /// Power of a force on this velocity, or work on a displacement: v·f + ω·n, in W or J.
    #[inline(always)]
    #[must_use]
    pub fn dot(&self, force: &super::Force<T>) -> T {
        let dot = |a: &Vector3<T>, b: &Vector3<T>| mul_add(a.z, b.z, mul_add(a.y, b.y, a.x * b.x));
        dot(&self.linear, &force.linear) + dot(&self.angular, &force.angular)
    }

    /// Velocity of the point at `pos`, in the frame's axes: v + ω × r, in m/s.
    #[inline(always)]
    #[must_use]
    pub fn at_point(&self, pos: &Vector3<T>) -> Vector3<T> {
        self.linear + cross(&self.angular, pos)
    }

    /// Classical acceleration of the point at the origin, from this spatial acceleration and the
    /// velocity of the same frame: a + ω × v.
    #[inline(always)]
    #[must_use]
    pub fn to_classical(&self, velocity: &Self) -> Self {
        Self {
            linear: self.linear + cross(&velocity.angular, &velocity.linear),
            angular: self.angular,
        }
    }

    /// Spatial acceleration from this classical one: the inverse of [`Motion::to_classical`].
    #[inline(always)]
    #[must_use]
    pub fn to_spatial(&self, velocity: &Self) -> Self {
        Self {
            linear: self.linear - cross(&velocity.angular, &velocity.linear),
            angular: self.angular,
        }
    }
}
