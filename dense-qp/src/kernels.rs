//! Loops over slices that can neither panic nor allocate: the arithmetic of the crate.
//!
//! Every access is by iterator or by `get`; out-of-range reads give nothing, out-of-range writes do
//! nothing. The loops that write are calls: only across a call does the compiler know that the two
//! slices do not overlap, and without that it spends more on checking than on computing. Callers keep
//! indices in range, so the fall-backs never run; they exist so that no panic path is linked.

use so3::Scalar;

/// aᵀb over the shorter length, in four interleaved partial sums (a fixed order, so that host and
/// target round alike, and one the compiler can vectorise).
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
    let mut rest = T::ZERO;
    for (p, q) in a1.iter().zip(b1) {
        rest += *p * *q;
    }
    ((s[0] + s[2]) + (s[1] + s[3])) + rest
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

/// Σ |aᵢbᵢ|: with ε the round-off of aᵀb.
pub(crate) fn dot_sizes<T: Scalar>(a: &[T], b: &[T]) -> T {
    let terms = a.iter().zip(b).map(|(a, b)| so3::math::abs(*a * *b));
    terms.fold(T::ZERO, |sum, term| sum + term)
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

/// [`sub_scaled`] on columns `from..to` of whole rows; `from` and `to` are multiples of 4 (or `to` = N).
#[inline(never)]
pub(crate) fn sub_scaled_in<T: Scalar, const N: usize>(
    y: &mut [T; N],
    f: T,
    x: &[T; N],
    from: usize,
    to: usize,
) {
    let (y4, y1) = y.as_chunks_mut::<4>();
    let (x4, x1) = x.as_chunks::<4>();
    let blocks = from / 4..to / 4;
    if let (Some(y4), Some(x4)) = (y4.get_mut(blocks.clone()), x4.get(blocks)) {
        for (y, x) in y4.iter_mut().zip(x4) {
            *y = [
                y[0] - f * x[0],
                y[1] - f * x[1],
                y[2] - f * x[2],
                y[3] - f * x[3],
            ];
        }
    }
    if to == N {
        for (y, x) in y1.iter_mut().zip(x1) {
            *y -= f * *x;
        }
    }
}

/// row ← row − Σ fⱼ·aⱼ over the pivot rows aⱼ above it, fⱼ = aⱼₖ times the inverse of its pivot, on
/// columns k, rounded down, up to `to`, a multiple of 4 (or N). Blocks of columns stay in registers
/// while all rows pass.
#[inline(never)]
pub(crate) fn eliminate<T: Scalar, const N: usize>(
    row: &mut [T; N],
    above: &[[T; N]],
    inverses: &[T; N],
    k: usize,
    to: usize,
) {
    let mut shares = [T::ZERO; N];
    for ((f, a), w) in shares.iter_mut().zip(above).zip(inverses) {
        *f = at(a, k) * *w;
    }
    let (y4, y1) = row.as_chunks_mut::<4>();
    for block in k / 4..to / 4 {
        let Some(y) = y4.get_mut(block) else { break };
        let mut s = *y;
        for (f, a) in shares.iter().zip(above) {
            let Some(a) = a.as_chunks::<4>().0.get(block) else {
                break;
            };
            s = [
                s[0] - *f * a[0],
                s[1] - *f * a[1],
                s[2] - *f * a[2],
                s[3] - *f * a[3],
            ];
        }
        *y = s;
    }
    if to == N {
        for (f, a) in shares.iter().zip(above) {
            for (y, a) in y1.iter_mut().zip(a.as_chunks::<4>().1) {
                *y -= *f * *a;
            }
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
    let mut rest = T::ZERO;
    if to == N {
        for (p, q) in a1.iter().zip(b1) {
            rest += *p * *q;
        }
    }
    ((s[0] + s[2]) + (s[1] + s[3])) + rest
}

/// y ← y − f·a − g·b.
#[inline(never)]
pub(crate) fn sub_scaled_pair<T: Scalar>(y: &mut [T], f: T, a: &[T], g: T, b: &[T]) {
    let n = y.len().min(a.len()).min(b.len());
    let (y, a, b) = (head_mut(y, n), head(a, n), head(b, n));
    let (y4, y1) = y.as_chunks_mut::<4>();
    let (a4, a1) = a.as_chunks::<4>();
    let (b4, b1) = b.as_chunks::<4>();
    for ((y, a), b) in y4.iter_mut().zip(a4).zip(b4) {
        *y = [
            y[0] - (f * a[0] + g * b[0]),
            y[1] - (f * a[1] + g * b[1]),
            y[2] - (f * a[2] + g * b[2]),
            y[3] - (f * a[3] + g * b[3]),
        ];
    }
    for ((y, a), b) in y1.iter_mut().zip(a1).zip(b1) {
        *y -= f * *a + g * *b;
    }
}

/// y ← y − Σ f·a, two rows at a time: half as often through y. Rows with f = 0 cost nothing.
#[inline(always)]
pub(crate) fn sub_all<'a, T: Scalar>(y: &mut [T], rows: impl Iterator<Item = (T, &'a [T])>) {
    let mut rows = rows.filter(|(f, _)| *f != T::ZERO);
    while let Some((f, a)) = rows.next() {
        match rows.next() {
            Some((g, b)) => sub_scaled_pair(y, f, a, g, b),
            None => sub_scaled(y, f, a),
        }
    }
}

/// max |aᵢ| (NaN entries are skipped).
#[inline(always)]
pub(crate) fn max_abs<T: Scalar>(a: &[T]) -> T {
    let (mut high, mut low) = (T::ZERO, T::ZERO);
    for v in a {
        if *v > high {
            high = *v;
        }
        if *v < low {
            low = *v;
        }
    }
    if high > -low { high } else { -low }
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

/// The first `n` entries.
#[inline(always)]
pub(crate) fn head<T>(a: &[T], n: usize) -> &[T] {
    a.get(..n).unwrap_or(&[])
}

/// The first `n` entries.
#[inline(always)]
pub(crate) fn head_mut<T>(a: &mut [T], n: usize) -> &mut [T] {
    a.get_mut(..n).unwrap_or(&mut [])
}

/// Entries `from..to`.
#[inline(always)]
pub(crate) fn span<T>(a: &[T], from: usize, to: usize) -> &[T] {
    a.get(from..to).unwrap_or(&[])
}

/// Entries `from..to`.
#[inline(always)]
pub(crate) fn span_mut<T>(a: &mut [T], from: usize, to: usize) -> &mut [T] {
    a.get_mut(from..to).unwrap_or(&mut [])
}

/// Entry `i`.
#[inline(always)]
pub(crate) fn at<V: Copy + Default>(a: &[V], i: usize) -> V {
    a.get(i).copied().unwrap_or_default()
}

/// Entry `i` ← `v`.
#[inline(always)]
pub(crate) fn put<V>(a: &mut [V], i: usize, v: V) {
    if let Some(e) = a.get_mut(i) {
        *e = v;
    }
}

/// Row `i` of a matrix.
#[inline(always)]
pub(crate) fn row<T, const C: usize>(m: &[[T; C]], i: usize) -> &[T] {
    m.get(i).map_or(&[], |r| r.as_slice())
}

/// Row `i` of a matrix.
#[inline(always)]
pub(crate) fn row_mut<T, const C: usize>(m: &mut [[T; C]], i: usize) -> &mut [T] {
    m.get_mut(i).map_or(&mut [], |r| r.as_mut_slice())
}

/// a ← b over the shorter length.
#[inline(always)]
pub(crate) fn copy<T: Copy>(a: &mut [T], b: &[T]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = *b;
    }
}
