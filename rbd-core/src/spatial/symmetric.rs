//! Symmetric 3×3 matrices in six numbers.

use core::ops::{Add, Sub};

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;
use so3::math::mul_add;

/// A symmetric 3×3 matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric3<T> {
    /// Row x, column x.
    pub xx: T,
    /// Row y, column y.
    pub yy: T,
    /// Row z, column z.
    pub zz: T,
    /// Row x, column y.
    pub xy: T,
    /// Row x, column z.
    pub xz: T,
    /// Row y, column z.
    pub yz: T,
}

impl<T: Scalar> Symmetric3<T> {
    /// The zero matrix.
    pub const ZERO: Self = Self {
        xx: T::ZERO,
        yy: T::ZERO,
        zz: T::ZERO,
        xy: T::ZERO,
        xz: T::ZERO,
        yz: T::ZERO,
    };

    /// From [xx, yy, zz, xy, xz, yz].
    #[inline(always)]
    #[must_use]
    pub const fn new([xx, yy, zz, xy, xz, yz]: [T; 6]) -> Self {
        Self {
            xx,
            yy,
            zz,
            xy,
            xz,
            yz,
        }
    }

    /// [xx, yy, zz, xy, xz, yz].
    #[inline(always)]
    #[must_use]
    pub const fn to_array(self) -> [T; 6] {
        [self.xx, self.yy, self.zz, self.xy, self.xz, self.yz]
    }

    /// The symmetric part of a matrix: (M + Mᵀ)/2.
    #[inline(always)]
    #[must_use]
    pub fn of(m: &Matrix3<T>) -> Self {
        Self {
            xx: m.m11,
            yy: m.m22,
            zz: m.m33,
            xy: (m.m12 + m.m21) * T::HALF,
            xz: (m.m13 + m.m31) * T::HALF,
            yz: (m.m23 + m.m32) * T::HALF,
        }
    }

    /// factor · 1.
    #[inline(always)]
    #[must_use]
    pub fn diagonal(factor: T) -> Self {
        Self {
            xx: factor,
            yy: factor,
            zz: factor,
            ..Self::ZERO
        }
    }

    /// factor · v vᵀ.
    #[inline(always)]
    #[must_use]
    pub fn outer(v: &Vector3<T>, factor: T) -> Self {
        let w = v * factor;
        Self {
            xx: w.x * v.x,
            yy: w.y * v.y,
            zz: w.z * v.z,
            xy: w.x * v.y,
            xz: w.x * v.z,
            yz: w.y * v.z,
        }
    }

    /// a bᵀ + b aᵀ.
    #[inline(always)]
    #[must_use]
    pub fn outer_pair(a: &Vector3<T>, b: &Vector3<T>) -> Self {
        Self {
            xx: T::TWO * a.x * b.x,
            yy: T::TWO * a.y * b.y,
            zz: T::TWO * a.z * b.z,
            xy: mul_add(a.y, b.x, a.x * b.y),
            xz: mul_add(a.z, b.x, a.x * b.z),
            yz: mul_add(a.z, b.y, a.y * b.z),
        }
    }

    /// Sum of the diagonal.
    #[inline(always)]
    #[must_use]
    pub fn trace(&self) -> T {
        self.xx + self.yy + self.zz
    }

    /// tr(S) 1 − S: from second moments to a rotational inertia.
    #[inline(always)]
    #[must_use]
    pub fn trace_complement(&self) -> Self {
        Self {
            xx: self.yy + self.zz,
            yy: self.xx + self.zz,
            zz: self.xx + self.yy,
            xy: -self.xy,
            xz: -self.xz,
            yz: -self.yz,
        }
    }

    /// S − a bᵀ for parallel a and b.
    #[inline(always)]
    pub(crate) fn less_outer(&self, a: &Vector3<T>, b: &Vector3<T>) -> Self {
        Self {
            xx: mul_add(-a.x, b.x, self.xx),
            yy: mul_add(-a.y, b.y, self.yy),
            zz: mul_add(-a.z, b.z, self.zz),
            xy: mul_add(-a.x, b.y, self.xy),
            xz: mul_add(-a.x, b.z, self.xz),
            yz: mul_add(-a.y, b.z, self.yz),
        }
    }

    /// S v.
    #[inline(always)]
    #[must_use]
    pub fn mul(&self, v: &Vector3<T>) -> Vector3<T> {
        let dot = |x: T, y: T, z: T| mul_add(z, v.z, mul_add(y, v.y, x * v.x));
        Vector3::new(
            dot(self.xx, self.xy, self.xz),
            dot(self.xy, self.yy, self.yz),
            dot(self.xz, self.yz, self.zz),
        )
    }

    /// As a full matrix.
    #[inline(always)]
    #[must_use]
    pub fn to_matrix(&self) -> Matrix3<T> {
        Matrix3::new(
            self.xx, self.xy, self.xz, //
            self.xy, self.yy, self.yz, //
            self.xz, self.yz, self.zz,
        )
    }

    /// R S Rᵀ.
    #[inline(always)]
    #[must_use]
    pub fn rotated(&self, r: &Matrix3<T>) -> Self {
        let m = r * self.to_matrix();
        let row = |i: usize, j: usize| {
            let (a, b) = (m.row(i), r.row(j));
            a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
        };
        Self {
            xx: row(0, 0),
            yy: row(1, 1),
            zz: row(2, 2),
            xy: row(0, 1),
            xz: row(0, 2),
            yz: row(1, 2),
        }
    }
}

impl<T: Scalar> Default for Symmetric3<T> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<T: Scalar> Add for Symmetric3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            xx: self.xx + o.xx,
            yy: self.yy + o.yy,
            zz: self.zz + o.zz,
            xy: self.xy + o.xy,
            xz: self.xz + o.xz,
            yz: self.yz + o.yz,
        }
    }
}

impl<T: Scalar> Sub for Symmetric3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self {
            xx: self.xx - o.xx,
            yy: self.yy - o.yy,
            zz: self.zz - o.zz,
            xy: self.xy - o.xy,
            xz: self.xz - o.xz,
            yz: self.yz - o.yz,
        }
    }
}
