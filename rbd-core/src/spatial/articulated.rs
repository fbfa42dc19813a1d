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

    /// The resistance together with that of a body in the same frame.
    #[inline(always)]
    #[must_use]
    pub(crate) fn with(&self, body: &Inertia<T>) -> Self {
        let (m, h, i) = (body.mass, &body.first, body.rotational());
        let (l, c) = (&self.linear, &self.cross);
        Self {
            linear: Symmetric3 {
                xx: l.xx + m,
                yy: l.yy + m,
                zz: l.zz + m,
                ..*l
            },
            // ω × h = −hat(h) ω
            cross: Matrix3::new(
                c.m11,
                c.m12 + h.z,
                c.m13 - h.y,
                c.m21 - h.z,
                c.m22,
                c.m23 + h.x,
                c.m31 + h.y,
                c.m32 - h.x,
                c.m33,
            ),
            angular: self.angular + i,
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
        let less = |start: T, a: T, b: T, c: T, d: T| mul_add(c, d, mul_add(-a, b, start));
        let (m, g) = (&self.linear, &self.cross);
        // M P, column by column: column j of P is p × e_j.
        let h = Matrix3::new(
            less(g.m11, m.xy, p.z, m.xz, p.y),
            less(g.m12, m.xz, p.x, m.xx, p.z),
            less(g.m13, m.xx, p.y, m.xy, p.x),
            less(g.m21, m.yy, p.z, m.yz, p.y),
            less(g.m22, m.yz, p.x, m.xy, p.z),
            less(g.m23, m.xy, p.y, m.yy, p.x),
            less(g.m31, m.yz, p.z, m.zz, p.y),
            less(g.m32, m.zz, p.x, m.xz, p.z),
            less(g.m33, m.xz, p.y, m.yz, p.x),
        );
        // I' = I − Hᵀ P + P H'  =  I + (P H)ᵀ + P H'. Both halves are needed; only the
        // symmetric entries are computed.
        // (P G)_{0j} = p_y G_{2j} − p_z G_{1j}, (P G)_{1j} = p_z G_{0j} − p_x G_{2j},
        // (P G)_{2j} = p_x G_{1j} − p_y G_{0j}
        let i = &self.angular;
        let twice = |start: T, [a, b, c, d]: [T; 4], [e, f, g, h]: [T; 4]| {
            less(less(start, c, d, a, b), g, h, e, f)
        };
        Self {
            linear: self.linear,
            cross: h,
            angular: Symmetric3 {
                xx: twice(i.xx, [p.y, g.m31, p.z, g.m21], [p.y, h.m31, p.z, h.m21]),
                yy: twice(i.yy, [p.z, g.m12, p.x, g.m32], [p.z, h.m12, p.x, h.m32]),
                zz: twice(i.zz, [p.x, g.m23, p.y, g.m13], [p.x, h.m23, p.y, h.m13]),
                xy: twice(i.xy, [p.z, g.m11, p.x, g.m31], [p.y, h.m32, p.z, h.m22]),
                xz: twice(i.xz, [p.x, g.m21, p.y, g.m11], [p.y, h.m33, p.z, h.m23]),
                yz: twice(i.yz, [p.x, g.m22, p.y, g.m12], [p.z, h.m13, p.x, h.m33]),
            },
        }
    }

    /// Acceleration under a force: the inverse of the 6×6 matrix by its blocks, whose pivots wait for each other least, times
    /// the force.
    ///
    /// A pivot that is not positive (no mass) yields zero acceleration in its direction.
    #[inline]
    #[must_use]
    pub fn solve(&self, force: &Force<T>) -> Motion<T> {
        let inverse = crate::linear::spd_inverse_6(&self.to_rows());
        let mut acceleration = [T::ZERO; 6];
        for (row, x) in inverse.iter().zip(force.to_array()) {
            crate::algo::blocks::add_scaled(&mut acceleration, x, row);
        }
        Motion::from_array(acceleration)
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
