//! Products of matrices in tiles of four rows by four columns, which stay in registers while the sums run.
//!
//! Each entry's sum runs over the rows in their order, so how many entries are summed side by side changes no bit. A tile that sticks out
//! of a matrix is zero there. As in [`crate::kernels`], nothing panics.

use so3::Scalar;

/// Four rows of four columns.
pub(crate) type Tile<T> = [[T; 4]; 4];

/// Whether two rows of a tile are summed at a time: four rows of four numbers and what they are multiplied with take more
/// than the sixteen registers that 32-bit Arm has for `f64`.
const IS_NARROW: bool = cfg!(target_arch = "arm");

/// Four entries of a row, from column `from`.
#[inline(always)]
pub(crate) fn block<T: Scalar, const N: usize>(row: &[T; N], from: usize) -> [T; 4] {
    let open = row.get(from..).unwrap_or(&[]);
    if let Some(block) = open.first_chunk() {
        return *block;
    }
    let mut entries = [T::ZERO; 4];
    match const { N % 4 } {
        1 => copy::<T, 1>(&mut entries, open),
        2 => copy::<T, 2>(&mut entries, open),
        _ => copy::<T, 3>(&mut entries, open),
    }
    entries
}

/// The tile at column `from` of the first four of `rows`.
#[inline(always)]
pub(crate) fn load<T: Scalar, const N: usize>(rows: &[[T; N]], from: usize) -> Tile<T> {
    let mut tile = [[T::ZERO; 4]; 4];
    for (entries, row) in tile.iter_mut().zip(rows) {
        *entries = block(row, from);
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
            continue;
        }
        match const { N % 4 } {
            1 => copy::<T, 1>(open, entries),
            2 => copy::<T, 2>(open, entries),
            _ => copy::<T, 3>(open, entries),
        }
    }
}

/// The first `W` entries of a ← those of b: as many as the compiler knows, so that it calls nothing.
#[inline(always)]
fn copy<T: Scalar, const W: usize>(a: &mut [T], b: &[T]) {
    if let (Some(a), Some(b)) = (a.first_chunk_mut::<W>(), b.first_chunk::<W>()) {
        *a = *b;
    }
}

/// Σ pᵢqᵢᵀ taken from the tile, with four entries of each of the rows pᵢ and qᵢ, from columns `i` and `j`. `P` is `N`, or 4 with `i` 0: what
/// sticks out is as wide as N leaves it.
#[inline(always)]
pub(crate) fn sub_products<T: Scalar, const N: usize, const P: usize>(
    tile: &mut Tile<T>,
    (p, i): (&[[T; P]], usize),
    (q, j): (&[[T; N]], usize),
) {
    if i + 4 <= P && j + 4 <= N {
        return sub_block::<T, N, P, 4, 4>(tile, (p, i), (q, j));
    }
    match const { N % 4 } {
        1 => sub_edge::<T, N, P, 1>(tile, (p, i), (q, j)),
        2 => sub_edge::<T, N, P, 2>(tile, (p, i), (q, j)),
        _ => sub_edge::<T, N, P, 3>(tile, (p, i), (q, j)),
    }
}

/// [`sub_products`] of a tile that sticks out, `W` of whose rows or columns are inside.
#[inline(never)]
fn sub_edge<T: Scalar, const N: usize, const P: usize, const W: usize>(
    tile: &mut Tile<T>,
    (p, i): (&[[T; P]], usize),
    (q, j): (&[[T; N]], usize),
) {
    match (i + 4 <= P, j + 4 <= N) {
        (true, _) => sub_block::<T, N, P, 4, W>(tile, (p, i), (q, j)),
        (_, true) => sub_block::<T, N, P, W, 4>(tile, (p, i), (q, j)),
        _ => sub_block::<T, N, P, W, W>(tile, (p, i), (q, j)),
    }
}

/// [`sub_products`] of the first `R` rows and `C` columns.
#[inline(always)]
fn sub_block<T: Scalar, const N: usize, const P: usize, const R: usize, const C: usize>(
    tile: &mut Tile<T>,
    (p, i): (&[[T; P]], usize),
    q: (&[[T; N]], usize),
) {
    if !IS_NARROW {
        return sub_pass::<T, N, P, R, C>(tile, (p, i), q);
    }
    let (upper, lower) = tile.split_at_mut(2);
    match R {
        1 => sub_pass::<T, N, P, 1, C>(upper, (p, i), q),
        2 => sub_pass::<T, N, P, 2, C>(upper, (p, i), q),
        3 => {
            sub_pass::<T, N, P, 2, C>(upper, (p, i), q);
            sub_pass::<T, N, P, 1, C>(lower, (p, i + 2), q);
        }
        _ => {
            sub_pass::<T, N, P, 2, C>(upper, (p, i), q);
            sub_pass::<T, N, P, 2, C>(lower, (p, i + 2), q);
        }
    }
}

/// [`sub_block`] of rows that are summed side by side.
#[inline(always)]
fn sub_pass<T: Scalar, const N: usize, const P: usize, const R: usize, const C: usize>(
    tile: &mut [[T; 4]],
    (p, i): (&[[T; P]], usize),
    (q, j): (&[[T; N]], usize),
) {
    let mut sums = [[T::ZERO; C]; R];
    for (sums, row) in sums.iter_mut().zip(&*tile) {
        copy::<T, C>(sums, row);
    }
    for (p, q) in p.iter().zip(q) {
        let p = p.get(i..).and_then(|p| p.first_chunk::<R>());
        let q = q.get(j..).and_then(|q| q.first_chunk::<C>());
        let (Some(p), Some(q)) = (p, q) else { break };
        let q = *q;
        for (sums, f) in sums.iter_mut().zip(p) {
            for (sum, q) in sums.iter_mut().zip(q) {
                *sum -= *f * q;
            }
        }
    }
    for (row, sums) in tile.iter_mut().zip(&sums) {
        copy::<T, C>(row, sums);
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
