//! Tables by *quantity*, `[[T; N]; K]`: a column is a body or a joint, and neighbours in a row share a vector instruction.

use so3::Scalar;

use super::at;

/// Column `i` of a table by quantity.
#[inline(always)]
pub(super) fn column<T: Scalar, const K: usize, const N: usize>(
    table: &[[T; N]; K],
    i: usize,
) -> [T; K] {
    let mut out = [T::ZERO; K];
    for (x, row) in out.iter_mut().zip(table) {
        *x = at(row, i);
    }
    out
}

/// Writes column `i` of a table by quantity.
#[inline(always)]
pub(super) fn set_column<T: Scalar, const K: usize, const N: usize>(
    table: &mut [[T; N]; K],
    i: usize,
    values: [T; K],
) {
    for (row, x) in table.iter_mut().zip(values) {
        if let Some(slot) = row.get_mut(i) {
            *slot = x;
        }
    }
}

/// Joints of a branch taken together.
pub(super) const LANES: usize = 4;

/// `LANES` entries from j on; zero beyond the end.
#[inline(always)]
pub(super) fn lanes<T: Scalar, const N: usize>(row: &[T; N], j: usize) -> [T; LANES] {
    match row.get(j..) {
        Some(&[a, b, c, d, ..]) => [a, b, c, d],
        _ => [at(row, j), at(row, j + 1), at(row, j + 2), at(row, j + 3)],
    }
}

/// `W` entries from `start` on.
#[inline(always)]
pub(super) fn window<T: Scalar, const W: usize, const N: usize>(
    row: &[T; N],
    start: usize,
) -> [T; W] {
    let window = row.get(start..).and_then(|rest| rest.first_chunk());
    window.copied().unwrap_or([T::ZERO; W])
}

/// Writes `W` entries from `start` on.
#[inline(always)]
pub(super) fn set_window<T: Scalar, const W: usize, const N: usize>(
    row: &mut [T; N],
    start: usize,
    x: &[T; W],
) {
    if let Some(to) = row.get_mut(start..).and_then(|rest| rest.first_chunk_mut()) {
        *to = *x;
    }
}
