//! Sums over the mass of a subtree, and the linear maps they make.
//!
//! All in world axes about the world's origin. With dm at r, velocity v(r) and acceleration a(r) (gravity
//! included), a subtree is known to inverse dynamics and all its derivatives by
//!
//! ```text
//! m, h = ∫ r, Σ = ∫ r rᵀ, p = ∫ v, K = ∫ v rᵀ, f = (∫ a, ∫ r × a)
//! ```
//!
//! and they add up. Two linear maps of a motion X = (x, ω) are needed: how the force changes with the
//! acceleration, `I X`, and with a motion that the subtree is carried by, `C X`:
//!
//! ```text
//! I X = ∫ (x(r), r × x(r)),     C X = 2 ∫ (ω × v, r × (ω × v)),     x(r) = x + ω × r
//! ```

use core::ops::Add;

use nalgebra::{Matrix3, Vector3};
use so3::{Scalar, hat};

use crate::model::Body;
use crate::spatial::{Force, Motion};

/// a bᵀ.
#[inline(always)]
pub(super) fn outer<T: Scalar>(a: &Vector3<T>, b: &Vector3<T>) -> Matrix3<T> {
    a * b.transpose()
}

/// `∫ r × a` from `∫ a rᵀ`.
#[inline(always)]
pub(super) fn moment_of<T: Scalar>(m: &Matrix3<T>) -> Vector3<T> {
    Vector3::new(m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12)
}

/// tr(M) w − M w.
#[inline(always)]
pub(super) fn turn<T: Scalar>(m: &Matrix3<T>, w: &Vector3<T>) -> Vector3<T> {
    w * m.trace() - m * w
}

/// The sums of one subtree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments<T: Scalar> {
    pub(super) mass: T,
    pub(super) first: Vector3<T>,
    pub(super) second: Matrix3<T>,
    /// ∫ v.
    pub(super) momentum: Vector3<T>,
    /// ∫ v rᵀ.
    pub(super) transport: Matrix3<T>,
    /// Force that the motion takes.
    pub(super) force: Force<T>,
}

impl<T: Scalar> Moments<T> {
    pub(super) fn zero() -> Self {
        Self {
            mass: T::ZERO,
            first: Vector3::zeros(),
            second: Matrix3::zeros(),
            momentum: Vector3::zeros(),
            transport: Matrix3::zeros(),
            force: Force::ZERO,
        }
    }

    /// Of one body at a pose, moving with `v` and accelerating with `a`.
    #[inline(always)]
    pub(super) fn of(
        body: &Body<T>,
        rot: &Matrix3<T>,
        pos: &Vector3<T>,
        v: &Motion<T>,
        a: &Motion<T>,
    ) -> Self {
        let mass = body.mass;
        let [xx, yy, zz, xy, xz, yz] = body.second;
        let about_origin = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let arm = rot * Vector3::from(body.first);
        let cross = outer(&arm, pos);
        let second = rot * about_origin * rot.transpose()
            + cross
            + cross.transpose()
            + outer(pos, pos) * mass;
        let first = arm + pos * mass;
        let momentum = v.linear * mass + v.angular.cross(&first);
        let transport = outer(&v.linear, &first) + hat(&v.angular) * second;
        let forces = a.linear * mass + a.angular.cross(&first) + v.angular.cross(&momentum);
        let spread =
            outer(&a.linear, &first) + hat(&a.angular) * second + hat(&v.angular) * transport;
        Self {
            mass,
            first,
            second,
            momentum,
            transport,
            force: Force::new(forces, moment_of(&spread)),
        }
    }

    /// I X.
    #[inline(always)]
    pub(super) fn inertia(&self, x: &Motion<T>) -> Force<T> {
        Force::new(
            x.linear * self.mass + x.angular.cross(&self.first),
            self.first.cross(&x.linear) + turn(&self.second, &x.angular),
        )
    }

    /// C X; see the module documentation.
    #[inline(always)]
    pub(super) fn carried(&self, x: &Motion<T>) -> Force<T> {
        Force::new(
            x.angular.cross(&self.momentum),
            turn(&self.transport, &x.angular),
        ) * T::TWO
    }

    /// Angular part of Cᵀ Y; its linear part is zero.
    #[inline(always)]
    pub(super) fn carried_transposed(&self, y: &Motion<T>) -> Vector3<T> {
        (self.momentum.cross(&y.linear) + turn(&self.transport.transpose(), &y.angular)) * T::TWO
    }
}

impl<T: Scalar> Add for Moments<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            mass: self.mass + o.mass,
            first: self.first + o.first,
            second: self.second + o.second,
            momentum: self.momentum + o.momentum,
            transport: self.transport + o.transport,
            force: self.force + o.force,
        }
    }
}
