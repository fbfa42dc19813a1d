//! Small dense factorisations on fixed-size arrays.

use nalgebra::Matrix3;
use so3::Scalar;

/// Factors a symmetric positive definite matrix in place into L D Lᵀ: D on the diagonal, row j of Lᵀ to the right
/// of entry (j, j). Only the upper triangle is read; what lies below the diagonal is overwritten.
///
/// A pivot at or below `EPSILON` times its original diagonal entry, or NaN, is replaced by 0: the
/// direction is treated as infinitely stiff by [`ldl_back_substitute`].
#[inline]
#[allow(
    clippy::needless_range_loop,
    reason = "indices are those of the textbook formula"
)]
pub fn ldl_factor<T: Scalar, const N: usize>(m: &mut [[T; N]; N]) {
    let mut original = [T::ZERO; N];
    for j in 0..N {
        original[j] = m[j][j];
    }
    for j in 0..N {
        // Row by row, whole rows: the sum stays in registers, and its length is a constant. Left of the diagonal it
        // is not used.
        let mut row = m[j];
        for k in 0..j {
            let x = m[k][j] * m[k][k];
            for (y, &z) in row.iter_mut().zip(&m[k]) {
                *y -= x * z;
            }
        }
        let (pivot, inverse) = sound_pivot(row[j], original[j]);
        for x in &mut row {
            *x *= inverse;
        }
        row[j] = pivot;
        m[j] = row;
    }
}

/// A pivot and its inverse, both 0 where rounding has eaten it up.
#[inline(always)]
fn sound_pivot<T: Scalar>(pivot: T, original: T) -> (T, T) {
    if pivot > original * T::EPSILON {
        (pivot, T::ONE / pivot)
    } else {
        (T::ZERO, T::ZERO)
    }
}

/// Solves L D Lᵀ x = b with the factors of [`ldl_factor`]; a zero pivot gives a zero component.
#[inline]
#[must_use]
pub fn ldl_back_substitute<T: Scalar, const N: usize>(m: &[[T; N]; N], b: [T; N]) -> [T; N] {
    let mut x = b;
    for k in 0..N {
        for i in k + 1..N {
            x[i] -= m[k][i] * x[k];
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
        // The newest component last, so that the sum does not wait for it.
        for k in (i + 1..N).rev() {
            x[i] -= m[i][k] * x[k];
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

/// Inverse of a symmetric positive definite 6 × 6 matrix by its 3 × 3 blocks.
///
/// With the blocks [P Q; Qᵀ S], G = P⁻¹ Q and the Schur complement C = S − Qᵀ G:
/// M⁻¹ = [P⁻¹ + G C⁻¹ Gᵀ, −G C⁻¹; −C⁻¹ Gᵀ, C⁻¹]. Two chains of three divisions instead of one of six. A pivot that
/// is lost to rounding counts as infinitely stiff, as in [`ldl_factor`]. Only the upper triangle is read.
#[inline]
#[must_use]
pub fn spd_inverse_6<T: Scalar>(m: &[[T; 6]; 6]) -> [[T; 6]; 6] {
    let block = |r: usize, c: usize| Matrix3::from_fn(|i, j| m[r + i][c + j]);
    let (p, q, s) = (block(0, 0), block(0, 3), block(3, 3));
    let p_inverse = spd_inverse_3(&p, &p);
    let g = p_inverse * q;
    let c_inverse = spd_inverse_3(&(s - q.tr_mul(&g)), &s);
    let cross = g * c_inverse;
    let top = p_inverse + cross * g.transpose();
    core::array::from_fn(|i| {
        core::array::from_fn(|j| match (i < 3, j < 3) {
            (true, true) => top[(i.min(j), i.max(j))],
            (true, false) => -cross[(i, j - 3)],
            (false, true) => -cross[(j, i - 3)],
            (false, false) => c_inverse[(i - 3, j - 3)],
        })
    })
}

/// Inverse of a symmetric positive definite 3 × 3 matrix, W D⁻¹ Wᵀ with W = L⁻ᵀ; `original` has the diagonal that
/// the pivots are judged by.
#[inline(always)]
fn spd_inverse_3<T: Scalar>(m: &Matrix3<T>, original: &Matrix3<T>) -> Matrix3<T> {
    let (_, a) = sound_pivot(m.m11, original.m11);
    let (l21, l31) = (m.m12 * a, m.m13 * a);
    let (_, b) = sound_pivot(m.m22 - m.m12 * l21, original.m22);
    let rest = m.m23 - m.m13 * l21;
    let l32 = rest * b;
    let (_, c) = sound_pivot((m.m33 - m.m13 * l31) - rest * l32, original.m33);
    // Rows of L⁻¹: (1, 0, 0), (−l21, 1, 0), (w, −l32, 1).
    let w = l21 * l32 - l31;
    let (wc, lc) = (w * c, l32 * c);
    let (xy, xz, yz) = (-(l21 * b) - wc * l32, wc, -lc);
    Matrix3::new(
        (a + l21 * l21 * b) + w * wc,
        xy,
        xz,
        xy,
        b + l32 * lc,
        yz,
        xz,
        yz,
        c,
    )
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;

    use super::*;

    /// G Gᵀ + 1 of a full G; the directions in `stiff` have no inertia.
    fn matrix(stiff: &[usize]) -> SMatrix<f64, 6, 6> {
        let g: SMatrix<f64, 6, 6> =
            SMatrix::from_fn(|i, j| so3::math::sin((3 * i + 5 * j + 1) as f64));
        let mut m = g * g.transpose() + SMatrix::identity();
        for &k in stiff {
            m.fill_row(k, 0.0);
            m.fill_column(k, 0.0);
        }
        m
    }

    fn rows(m: &SMatrix<f64, 6, 6>) -> [[f64; 6]; 6] {
        core::array::from_fn(|i| core::array::from_fn(|j| m[(i, j)]))
    }

    #[test]
    fn the_inverse_of_six_by_blocks_and_the_factors_agree() {
        for stiff in [&[][..], &[0], &[2, 4], &[3, 4, 5], &[0, 1, 2, 3, 4, 5]] {
            let m = matrix(stiff);
            let inverse = spd_inverse_6(&rows(&m));
            let inverse: SMatrix<f64, 6, 6> = SMatrix::from_fn(|i, j| inverse[i][j]);
            let mut wanted = SMatrix::<f64, 6, 6>::identity();
            for &k in stiff {
                wanted[(k, k)] = 0.0;
            }
            assert!((m * inverse - wanted).norm() < 1e-13, "{stiff:?}");
            for k in 0..6 {
                let b = core::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
                let x = ldl_solve(&mut rows(&m), b);
                for (i, x) in x.iter().enumerate() {
                    assert!((x - inverse[(i, k)]).abs() < 1e-13, "{stiff:?}: {i}, {k}");
                }
            }
        }
    }
}
