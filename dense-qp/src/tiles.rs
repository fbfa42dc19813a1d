//! Products of matrices in tiles of four rows by four columns, which stay in registers while the sums run.
//!
//! A tile that sticks out of a matrix is zero there. As in [`crate::kernels`], nothing panics.

use crate::kernels::copy;
use so3::Scalar;

/// Four rows of four columns.
pub(crate) type Tile<T> = [[T; 4]; 4];

/// The tile at column `from` of the first four of `rows`.
#[inline(always)]
pub(crate) fn load<T: Scalar, const N: usize>(rows: &[[T; N]], from: usize) -> Tile<T> {
    let mut tile = [[T::ZERO; 4]; 4];
    for (entries, row) in tile.iter_mut().zip(rows) {
        let open = row.get(from..).unwrap_or(&[]);
        if let Some(block) = open.first_chunk() {
            *entries = *block;
        } else {
            copy(entries, open);
        }
    }
    tile
}

/// Writes the tile at column `from` of the first four of `rows`.
#[inline(always)]
pub(crate) fn store<T: Scalar, const N: usize>(rows: &mut [[T; N]], from: usize, tile: &Tile<T>) {
    for (row, entries) in rows.iter_mut().zip(tile) {
        let open = row.get_mut(from..).unwrap_or(&mut []);
        if let Some(block) = open.first_chunk_mut() {
            *block = *entries;
        } else {
            copy(open, entries);
        }
    }
}

/// Σ pᵢqᵢᵀ taken from the tile, with four entries of each of the rows pᵢ and qᵢ, from columns `i` and `j`; `weigh` changes those of pᵢ,
/// row by row.
#[inline(always)]
pub(crate) fn sub_products<T: Scalar, const N: usize>(
    tile: &mut Tile<T>,
    [p, q]: [&[[T; N]]; 2],
    [i, j]: [usize; 2],
    weigh: impl Fn(usize, [T; 4]) -> [T; 4],
) {
    if i.max(j) + 4 > N {
        return sub_open_products(tile, [p, q], [i, j], weigh);
    }
    let mut sums = *tile;
    for (k, (p, q)) in p.iter().zip(q).enumerate() {
        let p = p.get(i..).and_then(|p| p.first_chunk::<4>());
        let q = q.get(j..).and_then(|q| q.first_chunk::<4>());
        let (Some(p), Some(q)) = (p, q) else { break };
        sub_product(&mut sums, weigh(k, *p), *q);
    }
    *tile = sums;
}

/// [`sub_products`] of a tile that sticks out.
#[cold]
#[inline(never)]
fn sub_open_products<T: Scalar, const N: usize>(
    tile: &mut Tile<T>,
    [p, q]: [&[[T; N]]; 2],
    [i, j]: [usize; 2],
    weigh: impl Fn(usize, [T; 4]) -> [T; 4],
) {
    for (k, (p, q)) in p.iter().zip(q).enumerate() {
        let [mut own, mut other] = [[T::ZERO; 4]; 2];
        copy(&mut own, p.get(i..).unwrap_or(&[]));
        copy(&mut other, q.get(j..).unwrap_or(&[]));
        sub_product(tile, weigh(k, own), other);
    }
}

/// tile − p qᵀ.
#[inline(always)]
fn sub_product<T: Scalar>(tile: &mut Tile<T>, p: [T; 4], q: [T; 4]) {
    for (row, p) in tile.iter_mut().zip(p) {
        *row = less(*row, p, q);
    }
}

/// row − f·other.
#[inline(always)]
pub(crate) fn less<T: Scalar>(row: [T; 4], f: T, other: [T; 4]) -> [T; 4] {
    [
        row[0] - f * other[0],
        row[1] - f * other[1],
        row[2] - f * other[2],
        row[3] - f * other[3],
    ]
}

/// What each row of a tile takes from those before it: of row 1 from row 0, of row 2 from 0 and 1, of row 3 from 0, 1 and 2.
#[derive(Clone, Copy)]
pub(crate) struct Shares<T>(pub(crate) [T; 1], pub(crate) [T; 2], pub(crate) [T; 3]);

impl<T: Scalar> Shares<T> {
    /// Takes from each row of the tile its shares of the rows before it, row by row. Written out: only so do the rows stay in registers.
    #[inline(always)]
    pub(crate) fn take(&self, tile: &mut Tile<T>) {
        let [first, mut second, mut third, mut fourth] = *tile;
        let Self([a], [b, c], [d, e, f]) = *self;
        second = less(second, a, first);
        third = less(less(third, b, first), c, second);
        fourth = less(less(less(fourth, d, first), e, second), f, third);
        *tile = [first, second, third, fourth];
    }
}
