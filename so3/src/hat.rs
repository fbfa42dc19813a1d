//! The isomorphism between ℝ³ and so(3), the skew-symmetric 3×3 matrices.

use crate::math::mul_add;
use crate::{Matrix3, Scalar, Vector3};

/// Skew-symmetric matrix of a vector: hat(w) v = w × v.
///
/// hat(w) = [0, −w₃, w₂; w₃, 0, −w₁; −w₂, w₁, 0]. Exact.
#[inline(always)]
#[must_use]
pub fn hat<T: Scalar>(w: &Vector3<T>) -> Matrix3<T> {
    let o = T::ZERO;
    Matrix3::new(o, -w.z, w.y, w.z, o, -w.x, -w.y, w.x, o)
}

/// d I + p A + q w wᵀ, A = hat(w): the form of every map of this crate, since A² = w wᵀ − θ² I.
///
/// Element by element: sums of whole matrices leave compilers with wide registers shuffling.
#[inline(always)]
pub(crate) fn combination<T: Scalar>(w: &Vector3<T>, d: T, p: T, q: T) -> Matrix3<T> {
    let (a, b) = (w * p, w * q);
    Matrix3::new(
        mul_add(b.x, w.x, d),
        mul_add(b.x, w.y, -a.z),
        mul_add(b.x, w.z, a.y),
        mul_add(b.y, w.x, a.z),
        mul_add(b.y, w.y, d),
        mul_add(b.y, w.z, -a.x),
        mul_add(b.z, w.x, -a.y),
        mul_add(b.z, w.y, a.x),
        mul_add(b.z, w.z, d),
    )
}

/// Vector of the skew-symmetric part of a matrix: vee(hat(w)) = w.
///
/// vee(A) = ½ (A₃₂ − A₂₃, A₁₃ − A₃₁, A₂₁ − A₁₂), so vee(A) = vee(½(A − Aᵀ)) for any 3×3 matrix. For a rotation
/// by the angle θ about the unit axis a, vee(R) = a sin θ.
#[inline(always)]
#[must_use]
pub fn vee<T: Scalar>(m: &Matrix3<T>) -> Vector3<T> {
    Vector3::new(m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12) * T::HALF
}
