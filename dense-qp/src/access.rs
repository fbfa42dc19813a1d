//! Entries, spans and rows by index that cannot panic: outside there is nothing, and nothing is written.

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
