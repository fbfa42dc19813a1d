//! Articulated-body inertia: what a subtree with free joints resists with.

use core::ops::Add;

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;
use so3::math::mul_add;

use super::{Force, Inertia, Motion, Symmetric3};

/// A symmetric 6×6 map from acceleration to force that need not be a rigid body's.
///
/// f = M a + H α, n = Hᵀ a + I α, with a, α the linear and angular acceleration of the origin.
/// (Featherstone 2008, chapter 7; linear first.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArticulatedInertia<T> {
    /// M, force per linear acceleration, kg.
    pub linear: Symmetric3<T>,
    /// H, force per angular acceleration, kg m.
    pub cross: Matrix3<T>,
    /// I, moment per angular acceleration, kg m².
    pub angular: Symmetric3<T>,
}

impl<T: Scalar> ArticulatedInertia<T> {
    /// No resistance.
    pub const ZERO: Self = Self {
        linear: Symmetric3::ZERO,
        cross: Matrix3::new(
            T::ZERO,
            T::ZERO,
            T::ZERO,
            T::ZERO,
            T::ZERO,
            T::ZERO,
            T::ZERO,
            T::ZERO,
            T::ZERO,
        ),
        angular: Symmetric3::ZERO,
    };

    /// M a, with the moment: (M a + H α, Hᵀ a + I α).
    #[inline(always)]
    #[must_use]
    pub fn mul(&self, acceleration: &Motion<T>) -> Force<T> {
        let (a, alpha) = (&acceleration.linear, &acceleration.angular);
        Force {
            linear: self.linear.mul(a) + self.cross * alpha,
            angular: self.cross.tr_mul(a) + self.angular.mul(alpha),
        }
    }

    /// A − f fᵀ · factor: what is left when the joint that feels `f` moves freely.
    #[inline(always)]
    #[must_use]
    pub fn without(&self, f: &Force<T>, factor: T) -> Self {
        let (fl, fa) = (f.linear, f.angular);
        let (gl, ga) = (fl * factor, fa * factor);
        let c = &self.cross;
        Self {
            linear: self.linear.less_outer(&gl, &fl),
            cross: Matrix3::new(
                mul_add(-gl.x, fa.x, c.m11),
                mul_add(-gl.x, fa.y, c.m12),
                mul_add(-gl.x, fa.z, c.m13),
                mul_add(-gl.y, fa.x, c.m21),
                mul_add(-gl.y, fa.y, c.m22),
                mul_add(-gl.y, fa.z, c.m23),
                mul_add(-gl.z, fa.x, c.m31),
                mul_add(-gl.z, fa.y, c.m32),
                mul_add(-gl.z, fa.z, c.m33),
            ),
            angular: self.angular.less_outer(&ga, &fa),
        }
    }

    /// The same resistance felt at a point displaced by −`p`, axes unchanged: with P = hat(p),
    /// H' = H − M P, I' = I + P H − (P H)ᵀ… written out, so that symmetry is kept.
    #[inline(always)]
    #[must_use]
    pub fn shifted(&self, p: &Vector3<T>) -> Self {
        // Motion of the old origin: a_old = a + α × p = a − P α. Hence
        // f = M a + (H − M P) α,  n_new = n_old + p × f.
        let row = |a: T, b: T, c: T, d: T| mul_add(a, b, -(c * d));
        let m = &self.linear;
        // M P, column by column: column j of P is p × e_j.
        let mp = Matrix3::new(
            row(m.xy, p.z, m.xz, p.y),
            row(m.xz, p.x, m.xx, p.z),
            row(m.xx, p.y, m.xy, p.x),
            row(m.yy, p.z, m.yz, p.y),
            row(m.yz, p.x, m.xy, p.z),
            row(m.xy, p.y, m.yy, p.x),
            row(m.yz, p.z, m.zz, p.y),
            row(m.zz, p.x, m.xz, p.z),
            row(m.xz, p.y, m.yz, p.x),
        );
        let h = self.cross - mp;
        // I' = I − Hᵀ P + P H'  =  I + (P H)ᵀ + P H'. Both halves are needed; only the
        // symmetric entries are computed.
        let g = &self.cross;
        // (P G)_{0j} = p_y G_{2j} − p_z G_{1j}, (P G)_{1j} = p_z G_{0j} − p_x G_{2j},
        // (P G)_{2j} = p_x G_{1j} − p_y G_{0j}
        let i = &self.angular;
        Self {
            linear: self.linear,
            cross: h,
            angular: Symmetric3 {
                xx: i.xx + row(p.y, g.m31, p.z, g.m21) + row(p.y, h.m31, p.z, h.m21),
                yy: i.yy + row(p.z, g.m12, p.x, g.m32) + row(p.z, h.m12, p.x, h.m32),
                zz: i.zz + row(p.x, g.m23, p.y, g.m13) + row(p.x, h.m23, p.y, h.m13),
                xy: i.xy + row(p.z, g.m11, p.x, g.m31) + row(p.y, h.m32, p.z, h.m22),
                xz: i.xz + row(p.x, g.m21, p.y, g.m11) + row(p.y, h.m33, p.z, h.m23),
                yz: i.yz + row(p.x, g.m22, p.y, g.m12) + row(p.z, h.m13, p.x, h.m33),
            },
        }
    }

    /// Acceleration under a force: solves the 6×6 system by L D Lᵀ.
    ///
    /// A pivot that is not positive (no mass) yields zero acceleration in its direction.
    #[must_use]
    pub fn solve(&self, force: &Force<T>) -> Motion<T> {
        let (l, c, a) = (&self.linear, &self.cross, &self.angular);
        let mut m = [
            [l.xx, l.xy, l.xz, c.m11, c.m12, c.m13],
            [l.xy, l.yy, l.yz, c.m21, c.m22, c.m23],
            [l.xz, l.yz, l.zz, c.m31, c.m32, c.m33],
            [c.m11, c.m21, c.m31, a.xx, a.xy, a.xz],
            [c.m12, c.m22, c.m32, a.xy, a.yy, a.yz],
            [c.m13, c.m23, c.m33, a.xz, a.yz, a.zz],
        ];
        Motion::from_array(crate::linear::ldl_solve(&mut m, force.to_array()))
    }
}

impl<T: Scalar> From<Inertia<T>> for ArticulatedInertia<T> {
    #[inline(always)]
    fn from(i: Inertia<T>) -> Self {
        let h = i.first;
        Self {
            linear: Symmetric3::diagonal(i.mass),
            // ω × h = −hat(h) ω
            cross: Matrix3::new(T::ZERO, h.z, -h.y, -h.z, T::ZERO, h.x, h.y, -h.x, T::ZERO),
            angular: i.rotational(),
        }
    }
}

impl<T: Scalar> Default for ArticulatedInertia<T> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<T: Scalar> Add for ArticulatedInertia<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            linear: self.linear + o.linear,
            cross: self.cross + o.cross,
            angular: self.angular + o.angular,
        }
    }
}
