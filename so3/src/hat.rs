//! The isomorphism between ℝ³ and so(3), the skew-symmetric 3×3 matrices.

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

/// Vector of the skew-symmetric part of a matrix: vee(hat(w)) = w.
///
/// vee(A) = ½ (A₃₂ − A₂₃, A₁₃ − A₃₁, A₂₁ − A₁₂), so vee(A) = vee(½(A − Aᵀ)) for any 3×3 matrix. For a rotation
/// by the angle θ about the unit axis a, vee(R) = a sin θ.
#[inline(always)]
#[must_use]
pub fn vee<T: Scalar>(m: &Matrix3<T>) -> Vector3<T> {
    Vector3::new(m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12) * T::HALF
}
