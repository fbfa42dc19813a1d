//! Back to SO(3): for matrices that products, integration or files have moved off it.
//!
//! # Derivation
//! Let M = R S with R orthonormal, S = (MᵀM)^½ symmetric positive definite: R is the polar factor, the orthonormal
//! matrix nearest to M in the Frobenius norm (Higham 2008, Functions of Matrices, ch. 8). Both methods change only
//! the singular values σ of M, towards 1.
//!
//! - One step R (3I − MᵀM)/2 maps σ to σ(3 − σ²)/2. With δ = σ² − 1: σ'² − 1 = −¾δ² + ¼δ³, so the defect is
//!   squared. It needs |δ| < 1, no division and no root: for drift, once per control step.
//! - Newton's iteration X ← ½(γX + X⁻ᵀ/γ) maps σ to ½(γσ + 1/(γσ)) and converges quadratically from any nonsingular M;
//!   γ² = ‖X⁻¹‖/‖X‖ brings the σ together first. For data from outside.

use crate::{Error, Matrix3, Rotation3, Scalar, math};

/// Most Newton steps of [`nearest_rotation`]; nine suffice for condition numbers up to 1e12 in f64.
const STEPS: usize = 16;

/// ‖MᵀM − I‖ in the Frobenius norm: zero for rotations (and reflections).
#[must_use]
pub fn orthogonality_defect<T: Scalar>(m: &Matrix3<T>) -> T {
    math::sqrt((m.tr_mul(m) - Matrix3::identity()).norm_squared())
}

/// One Newton–Schulz step ½ M (3I − MᵀM): squares the distance to SO(3). 45 multiplications.
///
/// The axis and angle stay what they are up to the square of the defect.
///
/// # Accuracy
/// A defect d = ‖MᵀM − I‖₂ < 1 becomes at most ¾d² + ¼d³ + 8 ε (test `one_step_squares_the_defect`).
#[inline]
#[must_use]
pub fn orthonormalize_step<T: Scalar>(rot: &Rotation3<T>) -> Rotation3<T> {
    let m = rot.matrix();
    let correction = Matrix3::from_diagonal_element(T::of(1.5)) - m.tr_mul(m) * T::HALF;
    Rotation3::from_matrix_unchecked(m * correction)
}

/// The rotation nearest to a matrix in the Frobenius norm: its polar factor M (MᵀM)^−½.
///
/// # Errors
/// [`Error::NotFinite`] for NaN or infinities; [`Error::NotNearRotation`] where the determinant is negative, or
/// so small beside the largest element that its sign is noise (below 16 ε).
///
/// # Accuracy
/// Defect at most 8 ε. RᵀM is symmetric and positive definite, which characterises the nearest rotation, within
/// 32 ε ‖M‖ (tests `nearest_rotation_*`). At most 16 steps.
pub fn nearest_rotation<T: Scalar>(m: &Matrix3<T>) -> Result<Rotation3<T>, Error> {
    if !m.iter().all(|x| x.is_finite_number()) {
        return Err(Error::NotFinite {
            parameter: "matrix",
        });
    }
    let largest = m
        .iter()
        .fold(T::ZERO, |largest, &x| math::max(largest, math::abs(x)));
    // Not a division by zero: a zero matrix gives NaN, whose determinant fails the test below.
    let mut x = m / largest;
    for _ in 0..STEPS {
        let cofactors = cofactors(&x);
        let det = x.column(0).dot(&cofactors.column(0));
        let determined = det > T::of(16.0) * T::EPSILON;
        if !determined {
            return Err(Error::NotNearRotation);
        }
        let inverse_transposed = cofactors / det;
        let gamma = math::sqrt(math::sqrt(
            inverse_transposed.norm_squared() / x.norm_squared(),
        ));
        let next = (x * gamma + inverse_transposed / gamma) * T::HALF;
        let change = (next - x).norm_squared();
        x = next;
        // Quadratic convergence: the next change would be about this one squared.
        if change <= T::EPSILON {
            return Ok(orthonormalize_step(&Rotation3::from_matrix_unchecked(x)));
        }
    }
    Err(Error::NotNearRotation)
}

/// The matrix of cofactors, det(X) X⁻ᵀ: its columns are the cross products of X's.
fn cofactors<T: Scalar>(x: &Matrix3<T>) -> Matrix3<T> {
    let (a, b, c) = (x.column(0), x.column(1), x.column(2));
    Matrix3::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)])
}
