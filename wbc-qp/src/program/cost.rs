//! Squares of rows as costs: g and the upper triangle of H, tile by tile.

use so3::Scalar;

/// Most rows that go over H together.
const GROUP: usize = 8;

/// Columns of a tile; with two rows of it and what they are multiplied with, eight sums stay in sixteen registers.
const WIDTH: usize = 4;

/// A row a, b and w of ½ w (aᵀz − b)².
type Cost<'r, T, const V: usize> = (&'r [T; V], T, T);

/// Adds ½ Σ w (aᵀz − b)² to g and the upper triangle of H. What is below the diagonal afterwards means nothing.
pub(super) fn add<'r, T: Scalar + 'r, const V: usize>(
    hessian: &mut [[T; V]; V],
    gradient: &mut [T; V],
    mut costs: impl Iterator<Item = Cost<'r, T, V>>,
) {
    while let Some(first) = costs.next() {
        let mut group = [first; GROUP];
        let mut used = 1;
        for (slot, cost) in group.iter_mut().skip(1).zip(&mut costs) {
            *slot = cost;
            used += 1;
        }
        add_group(hessian, gradient, group.get(..used).unwrap_or(&[]));
    }
}

/// [`add`] of at most [`GROUP`] rows.
fn add_group<T: Scalar, const V: usize>(
    hessian: &mut [[T; V]; V],
    gradient: &mut [T; V],
    costs: &[Cost<'_, T, V>],
) {
    let (pairs, last) = hessian.as_chunks_mut::<2>();
    let mut i = 0;
    for pair in pairs {
        add_rows(pair, gradient, costs, i);
        i += 2;
    }
    if let [row] = last {
        add_rows(core::array::from_mut(row), gradient, costs, i);
    }
}

/// The part of the rows of H from `i`, and of g there.
#[inline(always)]
fn add_rows<T: Scalar, const V: usize, const R: usize>(
    h: &mut [[T; V]; R],
    gradient: &mut [T; V],
    costs: &[Cost<'_, T, V>],
    i: usize,
) {
    let mut scaled = [[T::ZERO; R]; GROUP];
    let Some(g) = gradient.get_mut(i..).and_then(|g| g.first_chunk_mut::<R>()) else {
        return;
    };
    let mut is_used = false;
    for (scaled, (a, b, weight)) in scaled.iter_mut().zip(costs) {
        let Some(a) = a.get(i..).and_then(|a| a.first_chunk::<R>()) else {
            return;
        };
        *scaled = a.map(|a| *weight * a);
        is_used |= *scaled != [T::ZERO; R];
        for (g, f) in g.iter_mut().zip(scaled) {
            *g -= *f * *b;
        }
    }
    if !is_used {
        return;
    }
    // From the right, so that tiles end where the rows do; the last may begin before the diagonal.
    let mut end = V;
    while end > i && end >= WIDTH {
        end -= WIDTH;
        add_tile::<T, V, R, WIDTH>(h, &scaled, costs, end);
    }
    if end > i {
        match const { V % WIDTH } {
            1 => add_tile::<T, V, R, 1>(h, &scaled, costs, 0),
            2 => add_tile::<T, V, R, 2>(h, &scaled, costs, 0),
            _ => add_tile::<T, V, R, 3>(h, &scaled, costs, 0),
        }
    }
}

/// The part of `C` columns, those from `j`.
#[inline(always)]
fn add_tile<T: Scalar, const V: usize, const R: usize, const C: usize>(
    h: &mut [[T; V]; R],
    scaled: &[[T; R]; GROUP],
    costs: &[Cost<'_, T, V>],
    j: usize,
) {
    let mut sums = [[T::ZERO; C]; R];
    for (sums, h) in sums.iter_mut().zip(&*h) {
        let Some(h) = h.get(j..).and_then(|h| h.first_chunk::<C>()) else {
            return;
        };
        *sums = *h;
    }
    for (scaled, (a, ..)) in scaled.iter().zip(costs) {
        let Some(a) = a.get(j..).and_then(|a| a.first_chunk::<C>()) else {
            return;
        };
        for (sums, f) in sums.iter_mut().zip(scaled) {
            for (sum, a) in sums.iter_mut().zip(a) {
                *sum += *f * *a;
            }
        }
    }
    for (sums, h) in sums.iter().zip(h) {
        if let Some(h) = h.get_mut(j..).and_then(|h| h.first_chunk_mut::<C>()) {
            *h = *sums;
        }
    }
}
