//! Composites: what a subtree is and how it moves, as sums of moments over its mass.

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;

use crate::spatial::{Force, Inertia, Motion, Symmetric3, cross};

/// Numbers in a [`Composite`].
pub(super) const COMPOSITE: usize = 28;

/// A subtree moving as it does, in base axes about the base's origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Composite<T> {
    /// Mass moments.
    pub(crate) inertia: Inertia<T>,
    /// p = ∫ ṙ dm.
    pub(crate) momentum: Vector3<T>,
    /// K = ∫ ṙ rᵀ dm.
    pub(crate) stir: Matrix3<T>,
    /// f: net force, without what acts from outside.
    pub(crate) force: Force<T>,
}

impl<T: Scalar> Composite<T> {
    /// One rigid body with this velocity and (spatial) acceleration.
    #[inline(always)]
    pub(super) fn of(inertia: Inertia<T>, v: &Motion<T>, a: &Motion<T>) -> Self {
        let (h, s, w) = (&inertia.first, &inertia.second, &v.angular);
        let momentum = v.linear * inertia.mass + cross(w, h);
        // K = ∫ (v + ω × r) rᵀ dm
        let stir = Matrix3::new(
            v.linear.x * h.x + (w.y * s.xz - w.z * s.xy),
            v.linear.x * h.y + (w.y * s.yz - w.z * s.yy),
            v.linear.x * h.z + (w.y * s.zz - w.z * s.yz),
            v.linear.y * h.x + (w.z * s.xx - w.x * s.xz),
            v.linear.y * h.y + (w.z * s.xy - w.x * s.yz),
            v.linear.y * h.z + (w.z * s.xz - w.x * s.zz),
            v.linear.z * h.x + (w.x * s.xy - w.y * s.xx),
            v.linear.z * h.y + (w.x * s.yy - w.y * s.xy),
            v.linear.z * h.z + (w.x * s.yz - w.y * s.xz),
        );
        let mut own = Self {
            inertia,
            momentum,
            stir,
            force: inertia.mul(a),
        };
        own.force += v.cross_force(&own.momentum_wrench());
        own
    }

    #[inline(always)]
    pub(super) fn pack(&self) -> [T; COMPOSITE] {
        let (i, p, k) = (&self.inertia, &self.momentum, &self.stir);
        let (h, s) = (&i.first, &i.second);
        let (f, n) = (&self.force.linear, &self.force.angular);
        [
            i.mass, h.x, h.y, h.z, s.xx, s.yy, s.zz, s.xy, s.xz, s.yz, p.x, p.y, p.z, //
            k.m11, k.m12, k.m13, k.m21, k.m22, k.m23, k.m31, k.m32, k.m33, //
            f.x, f.y, f.z, n.x, n.y, n.z,
        ]
    }

    #[inline(always)]
    pub(super) fn unpack(x: &[T; COMPOSITE]) -> Self {
        let vector = |i: usize| Vector3::new(x[i], x[i + 1], x[i + 2]);
        Self {
            inertia: Inertia {
                mass: x[0],
                first: vector(1),
                second: Symmetric3::new([x[4], x[5], x[6], x[7], x[8], x[9]]),
            },
            momentum: vector(10),
            stir: Matrix3::new(
                x[13], x[14], x[15], x[16], x[17], x[18], x[19], x[20], x[21],
            ),
            force: Force::new(vector(22), vector(25)),
        }
    }

    /// Momentum about the base's origin; its angular part is the axial part of K: ∫ r × ṙ dm.
    #[inline(always)]
    pub(crate) fn momentum_wrench(&self) -> Force<T> {
        let k = &self.stir;
        Force {
            linear: self.momentum,
            angular: Vector3::new(k.m32 - k.m23, k.m13 - k.m31, k.m21 - k.m12),
        }
    }

    /// B w: wrench of the Coriolis forces when the whole turns with w besides.
    #[inline(always)]
    pub(crate) fn coriolis(&self, w: &Vector3<T>) -> Force<T> {
        let trace = self.stir.m11 + self.stir.m22 + self.stir.m33;
        let moment = w * trace - self.stir * w;
        Force {
            linear: cross(w, &self.momentum) * T::TWO,
            angular: moment * T::TWO,
        }
    }

    /// Bᵀ m.
    #[inline(always)]
    pub(super) fn coriolis_transposed(&self, m: &Motion<T>) -> Vector3<T> {
        let trace = self.stir.m11 + self.stir.m22 + self.stir.m33;
        let moment = m.angular * trace - self.stir.tr_mul(&m.angular);
        (cross(&self.momentum, &m.linear) + moment) * T::TWO
    }
}
