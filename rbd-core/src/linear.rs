//! Small dense factorisations on fixed-size arrays.

use so3::Scalar;

/// Factors a symmetric positive definite matrix in place into L D Lᵀ (unit L below the diagonal, D on
/// it); only the lower triangle is read.
///
/// A pivot at or below `EPSILON` times its original diagonal entry, or NaN, is replaced by 0: the
/// direction is treated as infinitely stiff by [`ldl_back_substitute`].
#[inline]
#[allow(
    clippy::needless_range_loop,
    reason = "indices are those of the textbook formula"
)]
pub fn ldl_factor<T: Scalar, const N: usize>(m: &mut [[T; N]; N]) {
    for j in 0..N {
        let original = m[j][j];
        let mut work = [T::ZERO; N];
        for k in 0..j {
            work[k] = m[j][k] * m[k][k];
        }
        let mut pivot = original;
        for k in 0..j {
            pivot -= m[j][k] * work[k];
        }
        let good = pivot > original * T::EPSILON;
        m[j][j] = if good { pivot } else { T::ZERO };
        let inverse = if good { T::ONE / pivot } else { T::ZERO };
        for i in j + 1..N {
            let mut x = m[i][j];
            for k in 0..j {
                x -= m[i][k] * work[k];
            }
            m[i][j] = x * inverse;
        }
    }
}

/// Solves L D Lᵀ x = b with the factors of [`ldl_factor`]; a zero pivot gives a zero component.
#[inline]
#[must_use]
pub fn ldl_back_substitute<T: Scalar, const N: usize>(m: &[[T; N]; N], b: [T; N]) -> [T; N] {
    let mut x = b;
    for i in 0..N {
        for k in 0..i {
            x[i] -= m[i][k] * x[k];
        }
    }
    for i in 0..N {
        x[i] = if m[i][i] > T::ZERO {
            x[i] / m[i][i]
        } else {
            T::ZERO
        };
    }
    for i in (0..N).rev() {
        for k in i + 1..N {
            x[i] -= m[k][i] * x[k];
        }
    }
    x
}

/// Solves M x = b for a symmetric positive definite M, destroying M.
#[inline]
#[must_use]
pub fn ldl_solve<T: Scalar, const N: usize>(m: &mut [[T; N]; N], b: [T; N]) -> [T; N] {
    ldl_factor(m);
    ldl_back_substitute(m, b)
}
