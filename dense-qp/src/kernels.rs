//! Loops over slices that can neither panic nor allocate: the arithmetic of the crate.
//!
//! Every access is by iterator or by `get`; out-of-range reads give nothing, out-of-range writes do
//! nothing. The loops that write are calls: only across a call does the compiler know that the two
//! slices do not overlap, and without that it spends more on checking than on computing. Callers keep
//! indices in range, so the fall-backs never run; they exist so that no panic path is linked.

use so3::Scalar;

use crate::access::{at, head, head_mut, put, span, span_mut};

/// aᵀb over the shorter length, in four interleaved partial sums (a fixed order, so that host and
/// target round alike, and one the compiler can vectorise: a sum of their own for the entries beyond whole blocks would make it
/// gather single entries instead).
#[inline(always)]
pub(crate) fn dot<T: Scalar>(a: &[T], b: &[T]) -> T {
    let n = a.len().min(b.len());
    let (a, b) = (head(a, n), head(b, n));
    let (a4, a1) = a.as_chunks::<4>();
    let (b4, b1) = b.as_chunks::<4>();
    let mut s = [T::ZERO; 4];
    for (p, q) in a4.iter().zip(b4) {
        s[0] += p[0] * q[0];
        s[1] += p[1] * q[1];
        s[2] += p[2] * q[2];
        s[3] += p[3] * q[3];
    }
    for (s, (p, q)) in s.iter_mut().zip(a1.iter().zip(b1)) {
        *s += *p * *q;
    }
    (s[0] + s[2]) + (s[1] + s[3])
}

/// Σ aᵢxᵢ over columns `from..to`, few of them: one after the other.
#[inline(always)]
pub(crate) fn dot_few<T: Scalar>(a: &[T], x: &[T], from: usize, to: usize) -> T {
    let mut sum = T::ZERO;
    // By index: two iterators cost more than these few products.
    for j in from..to.min(a.len()).min(x.len()) {
        sum += at(a, j) * at(x, j);
    }
    sum
}

/// Σ (f·aᵢ)², in four partial sums, as [`dot`].
pub(crate) fn square_scaled<T: Scalar>(a: &[T], f: T) -> T {
    let (a4, a1) = a.as_chunks::<4>();
    let mut s = [T::ZERO; 4];
    for v in a4 {
        let v = v.map(|v| v * f);
        s = [
            s[0] + v[0] * v[0],
            s[1] + v[1] * v[1],
            s[2] + v[2] * v[2],
            s[3] + v[3] * v[3],
        ];
    }
    let rest = (s[0] + s[2]) + (s[1] + s[3]);
    a1.iter().fold(rest, |sum, v| sum + (*v * f) * (*v * f))
}

/// Σ |aᵢ|, in four partial sums, as [`dot`].
#[inline(always)]
pub(crate) fn sum_sizes<T: Scalar>(a: &[T]) -> T {
    let (a4, a1) = a.as_chunks::<4>();
    let mut s = [T::ZERO; 4];
    for v in a4 {
        s[0] += so3::math::abs(v[0]);
        s[1] += so3::math::abs(v[1]);
        s[2] += so3::math::abs(v[2]);
        s[3] += so3::math::abs(v[3]);
    }
    let rest = (s[0] + s[2]) + (s[1] + s[3]);
    a1.iter().fold(rest, |sum, v| sum + so3::math::abs(*v))
}

/// Σ |aᵢbᵢ|: with ε the round-off of aᵀb. In four partial sums, as [`dot`].
pub(crate) fn dot_sizes<T: Scalar>(a: &[T], b: &[T]) -> T {
    let n = a.len().min(b.len());
    let (a4, a1) = head(a, n).as_chunks::<4>();
    let (b4, b1) = head(b, n).as_chunks::<4>();
    let mut s = [T::ZERO; 4];
    for (p, q) in a4.iter().zip(b4) {
        s[0] += so3::math::abs(p[0] * q[0]);
        s[1] += so3::math::abs(p[1] * q[1]);
        s[2] += so3::math::abs(p[2] * q[2]);
        s[3] += so3::math::abs(p[3] * q[3]);
    }
    let terms = a1.iter().zip(b1).map(|(p, q)| so3::math::abs(*p * *q));
    terms.fold((s[0] + s[2]) + (s[1] + s[3]), |sum, term| sum + term)
}

/// y ← y − f·x.
#[inline(never)]
pub(crate) fn sub_scaled<T: Scalar>(y: &mut [T], f: T, x: &[T]) {
    let n = y.len().min(x.len());
    let (y, x) = (head_mut(y, n), head(x, n));
    let (y4, y1) = y.as_chunks_mut::<4>();
    let (x4, x1) = x.as_chunks::<4>();
    for (y, x) in y4.iter_mut().zip(x4) {
        *y = [
            y[0] - f * x[0],
            y[1] - f * x[1],
            y[2] - f * x[2],
            y[3] - f * x[3],
        ];
    }
    for (y, x) in y1.iter_mut().zip(x1) {
        *y -= f * *x;
    }
}

/// `i` rounded down to a multiple of the kernels' width. Triangular factors hold zeros there, so that
/// loops over them start at full width.
#[inline(always)]
pub(crate) const fn floor4(i: usize) -> usize {
    i & !3
}

/// `i` rounded up to a multiple of the kernels' width, at most `limit`.
#[inline(always)]
pub(crate) const fn ceil4(i: usize, limit: usize) -> usize {
    let up = (i + 3) & !3;
    if up < limit { up } else { limit }
}

/// `W` columns, those from `from`, of y − Σ fᵢ·aᵢ, y being `s`: they stay in registers while all rows pass.
#[inline(always)]
pub(crate) fn sub_block<T: Scalar, const N: usize, const W: usize>(
    mut s: [T; W],
    factors: &[T],
    rows: &[[T; N]],
    from: usize,
) -> [T; W] {
    for (f, a) in factors.iter().zip(rows) {
        let Some(a) = a.get(from..).and_then(|a| a.first_chunk::<W>()) else {
            break;
        };
        for (s, a) in s.iter_mut().zip(a) {
            *s -= *f * *a;
        }
    }
    s
}

/// The first `W` columns of `y`, which are those from `column` on, of y − Σ fᵢ·aᵢ or, where `SUM`, of Σ fᵢ·aᵢ.
#[inline(always)]
fn sweep_block<T: Scalar, const N: usize, const W: usize, const SUM: bool>(
    y: &mut [T],
    factors: &[T],
    rows: &[[T; N]],
    column: usize,
) -> usize {
    let Some(s) = y.first_chunk_mut::<W>() else {
        return W;
    };
    let known = if SUM { [T::ZERO; W] } else { *s };
    let swept = sub_block(known, factors, rows, column);
    for (s, swept) in s.iter_mut().zip(swept) {
        *s = if SUM { -swept } else { swept };
    }
    W
}

/// Columns `from..to` of y ← y − Σ fᵢ·aᵢ or, where `SUM`, of y ← Σ fᵢ·aᵢ, block by block, without the rows before `first` of a block's
/// column.
#[inline(always)]
fn sweep<T: Scalar, const N: usize, const SUM: bool>(
    y: &mut [T; N],
    factors: &[T],
    rows: &[[T; N]],
    [from, to]: [usize; 2],
    first: impl Fn(usize) -> usize,
) {
    let all = factors.len().min(rows.len());
    let mut column = from;
    while column < to {
        let left = to - column;
        let Some(y) = y.get_mut(column..to) else {
            return;
        };
        let factors = span(factors, first(column), all);
        let rows = span(rows, first(column), all);
        column += match left {
            8.. => sweep_block::<T, N, 8, SUM>(y, factors, rows, column),
            4.. => sweep_block::<T, N, 4, SUM>(y, factors, rows, column),
            3 => sweep_block::<T, N, 3, SUM>(y, factors, rows, column),
            _ => sweep_block::<T, N, 1, SUM>(y, factors, rows, column),
        };
    }
}

#[inline(always)]
fn sweep_whole<T: Scalar, const N: usize, const SUM: bool>(
    y: &mut [T; N],
    factors: &[T],
    rows: &[[T; N]],
    [from, to]: [usize; 2],
) {
    let mut column = from;
    // Chains of that many columns hide how long a product takes.
    while column + 16 <= to {
        let y = span_mut(y, column, to);
        column += if y.len() == 20 && !SUM {
            sweep_block::<T, N, 20, SUM>(y, factors, rows, column)
        } else {
            sweep_block::<T, N, 16, SUM>(y, factors, rows, column)
        };
    }
    sweep::<T, N, SUM>(y, factors, rows, [column, to], |_| 0);
}

/// y ← y − Σ fᵢ·aᵢ on columns `from..to` of whole rows; `from` and `to` are multiples of 4 (or `to` = N).
#[inline(never)]
pub(crate) fn sub_rows<T: Scalar, const N: usize>(
    y: &mut [T; N],
    factors: &[T],
    rows: &[[T; N]],
    from: usize,
    to: usize,
) {
    sweep_whole::<T, N, false>(y, factors, rows, [from, to]);
}

/// y ← Σ fᵢ·aᵢ on the columns up to `to`, as [`sub_rows`].
#[inline(never)]
pub(crate) fn sum_rows<T: Scalar, const N: usize>(
    y: &mut [T; N],
    factors: &[T],
    rows: &[[T; N]],
    to: usize,
) {
    sweep_whole::<T, N, true>(y, factors, rows, [0, to]);
}

/// [`sum_rows`] of the rows of a lower triangle, row i of which is zero after column i.
#[inline(never)]
pub(crate) fn sum_triangle<T: Scalar, const N: usize>(
    y: &mut [T; N],
    factors: &[T],
    rows: &[[T; N]],
) {
    let to = ceil4(rows.len(), N);
    sweep::<T, N, true>(y, factors, rows, [0, to], |column| column);
}

/// (x, y) ← (c·x + s·y, c·y − s·x) on columns `from..to`; these are multiples of 4 (or `to` = N).
#[inline(never)]
pub(crate) fn rotate<T: Scalar, const N: usize>(
    x: &mut [T; N],
    y: &mut [T; N],
    [cos, sin]: [T; 2],
    [from, to]: [usize; 2],
) {
    for (x, y) in span_mut(x, from, to).iter_mut().zip(span_mut(y, from, to)) {
        (*x, *y) = (cos * *x + sin * *y, cos * *y - sin * *x);
    }
}

/// aᵢ ← aᵢ − fᵢ·x for all rows, on columns `from..to`; `from` and `to` are multiples of 4 (or `to` = N).
#[inline(never)]
pub(crate) fn sub_outer<T: Scalar, const N: usize>(
    rows: &mut [[T; N]],
    factors: &[T],
    x: &[T; N],
    from: usize,
    to: usize,
) {
    for (row, f) in rows.iter_mut().zip(factors) {
        let (Some(y), Some(x)) = (row.get_mut(from..to), x.get(from..to)) else {
            return;
        };
        let (y4, y1) = y.as_chunks_mut::<4>();
        let (x4, x1) = x.as_chunks::<4>();
        for (y, x) in y4.iter_mut().zip(x4) {
            *y = [
                y[0] - *f * x[0],
                y[1] - *f * x[1],
                y[2] - *f * x[2],
                y[3] - *f * x[3],
            ];
        }
        for (y, x) in y1.iter_mut().zip(x1) {
            *y -= *f * *x;
        }
    }
}

/// y ← f·y on columns `first..to` of a whole row, and zeros before them up to the kernels' width; `to`
/// is a multiple of 4 (or N).
#[inline(always)]
pub(crate) fn scale_from<T: Scalar, const N: usize>(y: &mut [T; N], f: T, first: usize, to: usize) {
    let (y4, y1) = y.as_chunks_mut::<4>();
    for block in first / 4..to / 4 {
        let Some(y) = y4.get_mut(block) else { break };
        *y = y.map(|y| y * f);
    }
    if to == N {
        for y in y1 {
            *y *= f;
        }
    }
    for column in floor4(first)..first {
        put(y, column, T::ZERO);
    }
}

/// [`dot`] over columns `from..to` of whole rows; `from` and `to` are multiples of 4 (or `to` = N).
#[inline(always)]
pub(crate) fn dot_in<T: Scalar, const N: usize>(
    a: &[T; N],
    b: &[T; N],
    from: usize,
    to: usize,
) -> T {
    let (a4, a1) = a.as_chunks::<4>();
    let (b4, b1) = b.as_chunks::<4>();
    let blocks = from / 4..to / 4;
    let mut s = [T::ZERO; 4];
    if let (Some(a4), Some(b4)) = (a4.get(blocks.clone()), b4.get(blocks)) {
        for (p, q) in a4.iter().zip(b4) {
            s[0] += p[0] * q[0];
            s[1] += p[1] * q[1];
            s[2] += p[2] * q[2];
            s[3] += p[3] * q[3];
        }
    }
    if to == N {
        for (s, (p, q)) in s.iter_mut().zip(a1.iter().zip(b1)) {
            *s += *p * *q;
        }
    }
    (s[0] + s[2]) + (s[1] + s[3])
}

/// Products of x with rows, two at a time, over columns `from..to`; these are multiples of 4 (or `to` = N). As [`dot_in`] of each.
#[inline(never)]
pub(crate) fn dots<T: Scalar, const N: usize>(
    out: &mut [T],
    rows: &[[T; N]],
    x: &[T; N],
    [from, to]: [usize; 2],
) {
    let (pairs, last) = rows.as_chunks::<2>();
    let mut out = out.iter_mut();
    for [a, b] in pairs {
        let (s, t) = dot_pair([a, b], x, from, to);
        if let (Some(first), Some(second)) = (out.next(), out.next()) {
            (*first, *second) = (s, t);
        }
    }
    if let ([a], Some(out)) = (last, out.next()) {
        *out = dot_in(a, x, from, to);
    }
}

/// [`dot_in`] of two rows with x.
#[inline(always)]
fn dot_pair<T: Scalar, const N: usize>(
    [a, b]: [&[T; N]; 2],
    x: &[T; N],
    from: usize,
    to: usize,
) -> (T, T) {
    let blocks = from / 4..to / 4;
    let (mut s, mut t) = ([T::ZERO; 4], [T::ZERO; 4]);
    if let (Some(a), Some(b), Some(x)) = (
        a.as_chunks::<4>().0.get(blocks.clone()),
        b.as_chunks::<4>().0.get(blocks.clone()),
        x.as_chunks::<4>().0.get(blocks),
    ) {
        for ((a, b), x) in a.iter().zip(b).zip(x) {
            for k in 0..4 {
                s[k] += a[k] * x[k];
                t[k] += b[k] * x[k];
            }
        }
    }
    if to == N {
        let rest = a.as_chunks::<4>().1.iter().zip(b.as_chunks::<4>().1);
        let sums = s.iter_mut().zip(&mut t);
        for ((s, t), ((a, b), x)) in sums.zip(rest.zip(x.as_chunks::<4>().1)) {
            *s += *a * *x;
            *t += *b * *x;
        }
    }
    let sum = |s: [T; 4]| (s[0] + s[2]) + (s[1] + s[3]);
    (sum(s), sum(t))
}

/// max |aᵢ| (NaN entries are skipped), in four lanes.
#[inline(always)]
pub(crate) fn max_abs<T: Scalar>(a: &[T]) -> T {
    // A comparison, not a maximum: false for NaN.
    let larger = |high: T, v: T| {
        let size = so3::math::abs(v);
        if size > high { size } else { high }
    };
    let (a4, a1) = a.as_chunks::<4>();
    let mut high = [T::ZERO; 4];
    for v in a4 {
        high = [
            larger(high[0], v[0]),
            larger(high[1], v[1]),
            larger(high[2], v[2]),
            larger(high[3], v[3]),
        ];
    }
    let rest = a1.iter().fold(T::ZERO, |high, v| larger(high, *v));
    high.iter().fold(rest, |high, v| larger(high, *v))
}

/// max aᵢ²fᵢ (NaN entries are skipped), in four lanes, as [`max_abs`].
#[inline(always)]
pub(crate) fn largest_square<T: Scalar>(a: &[T], f: &[T]) -> T {
    let n = a.len().min(f.len());
    let (a4, a1) = head(a, n).as_chunks::<4>();
    let (f4, f1) = head(f, n).as_chunks::<4>();
    let larger = |high: T, v: T| if v > high { v } else { high };
    let mut high = [T::ZERO; 4];
    for (a, f) in a4.iter().zip(f4) {
        for k in 0..4 {
            high[k] = larger(high[k], a[k] * a[k] * f[k]);
        }
    }
    let rest = a1.iter().zip(f1).map(|(a, f)| *a * *a * *f);
    rest.chain(high).fold(T::ZERO, larger)
}

/// Whether every entry is neither NaN nor infinite.
#[inline(always)]
pub(crate) fn all_finite<T: Scalar>(a: &[T]) -> bool {
    // 0·v is 0 for a finite v and NaN otherwise; one addition per entry and no branch.
    let (a4, a1) = a.as_chunks::<4>();
    let mut s = [T::ZERO; 4];
    for v in a4 {
        s[0] += v[0] * T::ZERO;
        s[1] += v[1] * T::ZERO;
        s[2] += v[2] * T::ZERO;
        s[3] += v[3] * T::ZERO;
    }
    for v in a1 {
        s[0] += *v * T::ZERO;
    }
    (s[0] + s[1]) + (s[2] + s[3]) == T::ZERO
}
