//! Plain-loop kernels on padded, column-major matrices.
//!
//! A matrix with `R` rows and `C` columns is `[[T; R]; C]`. Inner loops run over a whole column, whose
//! length is a constant, so the compiler turns them into vector code on any target; outer loops skip
//! zero multipliers, which is how the sparsity of a stage is exploited without describing it.

use so3::Scalar;
use so3::math::{abs, max};

/// `y += factor · x`.
#[inline(always)]
pub(crate) fn add_scaled<T: Scalar, const N: usize>(y: &mut [T; N], factor: T, x: &[T; N]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * *x;
    }
}

/// A sum in eight lanes, so that it vectorises under strict rounding: term `i` goes into lane `i mod 8`.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<T>([T; 8]);

impl<T: Scalar> Lanes<T> {
    #[inline(always)]
    pub(crate) const fn new() -> Self {
        Self([T::ZERO; 8])
    }

    /// Adds term `i`.
    #[inline(always)]
    pub(crate) fn add(&mut self, i: usize, term: T) {
        self.0[i & 7] += term;
    }

    #[inline(always)]
    pub(crate) fn total(self) -> T {
        let [a, b, c, d, e, f, g, h] = self.0;
        ((a + e) + (c + g)) + ((b + f) + (d + h))
    }
}

/// `xᵀ y`.
#[inline(always)]
pub(crate) fn dot<T: Scalar, const N: usize>(x: &[T; N], y: &[T; N]) -> T {
    let mut sum = Lanes::new();
    let (x8, x_rest) = x.as_chunks::<8>();
    let (y8, y_rest) = y.as_chunks::<8>();
    for (x, y) in x8.iter().zip(y8) {
        for ((lane, x), y) in sum.0.iter_mut().zip(x).zip(y) {
            *lane += *x * *y;
        }
    }
    for ((lane, x), y) in sum.0.iter_mut().zip(x_rest).zip(y_rest) {
        *lane += *x * *y;
    }
    sum.total()
}

/// `out += matrix · weights`, skipping zero weights.
#[inline(always)]
pub(crate) fn add_product<T: Scalar, const R: usize, const C: usize>(
    out: &mut [T; R],
    matrix: &[[T; R]; C],
    weights: &[T; C],
) {
    let mut sum = *out;
    for (column, weight) in matrix.iter().zip(weights) {
        if *weight != T::ZERO {
            add_scaled(&mut sum, *weight, column);
        }
    }
    *out = sum;
}

/// The lower triangle of `matrix += Σ_j left_j rowsᵀ_j` over the first `n` rows; the upper one is left
/// partly updated.
#[inline(always)]
pub(crate) fn add_outer_products<T: Scalar, const N: usize, const M: usize>(
    matrix: &mut [[T; N]; N],
    left: &[[T; N]; M],
    rows: &[[T; N]; M],
    n: usize,
) {
    for (c, column) in matrix.iter_mut().enumerate() {
        // Eight rows at a time stay in registers over the whole sum.
        let (eights, rest) = column.as_chunks_mut::<8>();
        for (i, chunk) in eights.iter_mut().enumerate().skip(c / 8) {
            let mut sum = *chunk;
            for (left, row) in left.iter().zip(rows).take(n) {
                if let Some(row) = row.as_chunks::<8>().0.get(i) {
                    add_scaled(&mut sum, left[c], row);
                }
            }
            *chunk = sum;
        }
        for (left, row) in left.iter().zip(rows).take(n) {
            for (value, row) in rest.iter_mut().zip(row.as_chunks::<8>().1) {
                *value += left[c] * *row;
            }
        }
    }
}

/// `out += matrixᵀ · x`.
#[inline(always)]
pub(crate) fn add_transposed_product<T: Scalar, const R: usize, const C: usize>(
    out: &mut [T; C],
    matrix: &[[T; R]; C],
    x: &[T; R],
) {
    for (out, column) in out.iter_mut().zip(matrix) {
        *out += dot(column, x);
    }
}

/// The transpose.
#[inline(always)]
pub(crate) fn transpose<T: Scalar, const R: usize, const C: usize>(
    matrix: &[[T; R]; C],
) -> [[T; C]; R] {
    let mut out = [[T::ZERO; C]; R];
    for (j, column) in matrix.iter().enumerate() {
        set_column(&mut out, j, column);
    }
    out
}

/// Writes column `j` of a matrix that is stored by rows.
#[inline(always)]
pub(crate) fn set_column<T: Scalar, const R: usize, const C: usize>(
    rows: &mut [[T; C]; R],
    j: usize,
    column: &[T; R],
) {
    for (row, value) in rows.iter_mut().zip(column) {
        if let Some(slot) = row.get_mut(j) {
            *slot = *value;
        }
    }
}

/// Copies the lower triangle onto the upper one.
#[inline(always)]
pub(crate) fn mirror_lower<T: Scalar, const N: usize>(matrix: &mut [[T; N]; N]) {
    for i in 1..N {
        let (before, rest) = matrix.split_at_mut(i);
        if let Some(column) = rest.first_mut() {
            for (upper, other) in column.iter_mut().zip(before) {
                *upper = other[i];
            }
        }
    }
}

/// `matrix += weight · row · rowᵀ`, skipping zero entries of `row`.
#[inline(always)]
pub(crate) fn add_outer<T: Scalar, const N: usize>(
    matrix: &mut [[T; N]; N],
    weight: T,
    row: &[T; N],
) {
    for (column, entry) in matrix.iter_mut().zip(row) {
        if *entry != T::ZERO {
            add_scaled(column, weight * *entry, row);
        }
    }
}

/// The largest magnitude, found in eight lanes.
#[inline(always)]
pub(crate) fn largest<T: Scalar, const N: usize>(values: &[T; N]) -> T {
    let mut lanes = [T::ZERO; 8];
    let (eights, rest) = values.as_chunks::<8>();
    for chunk in eights {
        for (lane, x) in lanes.iter_mut().zip(chunk) {
            *lane = max(*lane, abs(*x));
        }
    }
    for (lane, x) in lanes.iter_mut().zip(rest) {
        *lane = max(*lane, abs(*x));
    }
    lanes.iter().fold(T::ZERO, |most, lane| max(most, *lane))
}

/// `max(largest, |x|)` where a NaN wins, so that no broken number passes as small.
#[inline(always)]
pub(crate) fn larger<T: Scalar>(largest: T, x: T) -> T {
    let magnitude = abs(x);
    if magnitude > largest || magnitude.is_nan_number() {
        magnitude
    } else {
        largest
    }
}

/// `L D Lᵀ` of the leading `n` × `n` block of a symmetric matrix, lower triangle, in place.
///
/// Afterwards column `j` holds column `j` of the unit-lower `L` below the diagonal, and `inverse_pivots`
/// the inverses of `D`. Returns false at the first pivot that is not above `floor`: the block is not
/// positive definite.
#[inline(always)]
#[must_use]
pub(crate) fn factor<T: Scalar, const N: usize>(
    matrix: &mut [[T; N]; N],
    inverse_pivots: &mut [T; N],
    n: usize,
    floor: T,
) -> bool {
    for j in 0..N {
        if j >= n {
            break;
        }
        let mut column = matrix[j];
        let pivot = column[j];
        if !(pivot > floor && pivot.is_finite_number()) {
            return false;
        }
        let inverse = T::ONE / pivot;
        for k in (j + 1)..N {
            if k >= n {
                break;
            }
            let weight = column[k] * inverse;
            if weight != T::ZERO {
                add_scaled(&mut matrix[k], -weight, &column);
            }
        }
        for value in &mut column {
            *value *= inverse;
        }
        matrix[j] = column;
        inverse_pivots[j] = inverse;
    }
    true
}

/// Solves `L z = y` in place for several right-hand sides at once: `rows[j]` is row `j` of `y`.
#[inline(always)]
pub(crate) fn solve_lower<T: Scalar, const N: usize, const M: usize>(
    factor: &[[T; N]; N],
    rows: &mut [[T; M]; N],
    n: usize,
) {
    for j in 0..N {
        if j >= n {
            break;
        }
        let row = rows[j];
        for k in (j + 1)..N {
            if k >= n {
                break;
            }
            add_scaled(&mut rows[k], -factor[j][k], &row);
        }
    }
}

/// Solves `Lᵀ z = y` in place for several right-hand sides at once: `rows[j]` is row `j` of `y`.
#[inline(always)]
pub(crate) fn solve_upper<T: Scalar, const N: usize, const M: usize>(
    factor: &[[T; N]; N],
    rows: &mut [[T; M]; N],
    n: usize,
) {
    for j in (0..N).rev() {
        if j >= n {
            continue;
        }
        let row = rows[j];
        for i in 0..j {
            add_scaled(&mut rows[i], -factor[i][j], &row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factor_and_solves_reproduce_the_matrix() {
        // A = Gᵀ G + I of a fixed G; the leading 3 × 3 block is solved against A x = b.
        let a: [[f64; 4]; 4] = [
            [4.0, 1.0, -0.5, 9.0],
            [1.0, 3.0, 0.7, 9.0],
            [-0.5, 0.7, 2.0, 9.0],
            [9.0; 4],
        ];
        let (mut l, mut inverse) = (a, [0.0; 4]);
        assert!(factor(&mut l, &mut inverse, 3, 0.0));
        let mut x = [[1.0], [2.0], [3.0], [0.0]];
        solve_lower(&l, &mut x, 3);
        for (x, d) in x.iter_mut().zip(&inverse) {
            x[0] *= d;
        }
        solve_upper(&l, &mut x, 3);
        // Rows and columns of a symmetric matrix agree.
        for (row, wanted) in a.iter().zip([1.0, 2.0, 3.0]) {
            let b: f64 = row.iter().zip(&x).take(3).map(|(a, x)| a * x[0]).sum();
            assert!((b - wanted).abs() < 1e-12);
        }
    }

    #[test]
    fn a_nan_wins_wherever_it_stands() {
        for values in [
            [f64::NAN, 1.0, -2.0],
            [1.0, f64::NAN, -2.0],
            [1.0, -2.0, f64::NAN],
        ] {
            assert!(values.iter().fold(0.0, |most, x| larger(most, *x)).is_nan());
        }
        assert!(
            [1.0, -2.0, 0.5]
                .iter()
                .fold(0.0, |most, x| larger(most, *x))
                == 2.0
        );
    }

    #[test]
    fn an_indefinite_block_is_refused() {
        let mut a: [[f64; 2]; 2] = [[1.0, 2.0], [2.0, 1.0]];
        assert!(!factor(&mut a, &mut [0.0; 2], 2, 0.0));
        let mut nan: [[f64; 2]; 2] = [[f64::NAN, 0.0], [0.0, 1.0]];
        assert!(!factor(&mut nan, &mut [0.0; 2], 2, 0.0));
    }
}
