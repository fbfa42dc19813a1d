//! The active rows, and what they leave free, in coordinates in which H is the identity.
//!
//! With H = UᵀDU and J = U⁻¹D^-½, J Jᵀ = H⁻¹, and d = Jᵀa are the coordinates of a row a. J is kept turned by orthogonal
//! transformations so that the coordinates of the active rows are upper triangular, Jᵀ A_Wᵀ = [R; 0]. Of a new row
//! d = [d₁; d₂] then
//!
//! - r = R⁻¹d₁ is how the active multipliers answer to its own,
//! - z = J₂d₂ is the step that it causes, and aᵀz = |d₂|² (zero for a row that depends on the active ones)
//!
//! (Goldfarb and Idnani 1983). Rows enter by a Householder reflection of J₂ and leave by plane rotations. Neither loses
//! digits, however different the curvatures of H are.

use crate::elimination::Elimination;
use crate::factor::Factor;
use crate::kernels::{at, ceil4, dots, floor4, head, head_mut, put, rotate, span, span_mut};
use crate::kernels::{sub_outer, sub_rows, sub_scaled, sub_triangle};
use crate::settings::dependence_tolerance;
use so3::{Scalar, math};

/// A row in the coordinates of the basis.
#[derive(Clone, Debug)]
pub(crate) struct Candidate<T, const N: usize> {
    pub(crate) d: [T; N],
    /// |d₂|², 0 for a row that depends on the active ones.
    pub(crate) free: T,
}

#[derive(Clone, Debug)]
pub(crate) struct Basis<T, const N: usize> {
    /// J by columns, an entry per free variable. Scratch until [`Basis::prepare`].
    pub(crate) j: [[T; N]; N],
    /// R by rows, zeros outside of its triangle.
    r: [[T; N]; N],
    /// 1 / R_kk.
    r_inverse: [T; N],
    pub(crate) len: usize,
    /// Number of free variables; 0 until J is there.
    dim: usize,
    // Rotations of a removal.
    cos: [T; N],
    sin: [T; N],
}

impl<T: Scalar, const N: usize> Candidate<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            d: [T::ZERO; N],
            free: T::ZERO,
        }
    }

    /// |d₂|², given how many rows are active.
    fn measure(&mut self, len: usize, dim: usize) {
        let (active, free) = (head(&self.d, len), span(&self.d, len, dim));
        let square = |d: &[T]| d.iter().fold(T::ZERO, |sum, x| sum + *x * *x);
        self.free = square(free);
        let whole = self.free + square(active);
        // False for NaN.
        if len >= dim || self.free <= dependence_tolerance::<T>() * whole {
            self.free = T::ZERO;
        }
    }
}

impl<T: Scalar, const N: usize> Basis<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            j: [[T::ZERO; N]; N],
            r: [[T::ZERO; N]; N],
            r_inverse: [T::ZERO; N],
            len: 0,
            dim: 0,
            cos: [T::ZERO; N],
            sin: [T::ZERO; N],
        }
    }

    /// No active rows, and no J.
    pub(crate) fn clear(&mut self) {
        self.len = 0;
        self.dim = 0;
    }

    /// J of a factor, unless it is there already: a problem without a violated row never needs it.
    pub(crate) fn prepare(&mut self, factor: &Factor<T, N>) {
        if self.dim == factor.dim {
            return;
        }
        let n = factor.dim;
        self.dim = n;
        let end = ceil4(n, N);
        // Column c of U⁻¹ is unit vector c less the columns before it, each times what U has in its row.
        let mut shares = [T::ZERO; N];
        for c in 0..n {
            let Some((before, [column, ..])) = self.j.split_at_mut_checked(c) else {
                break;
            };
            for (f, u) in shares.iter_mut().zip(&factor.u).take(c) {
                *f = at(u, c);
            }
            column.fill(T::ZERO);
            sub_triangle(column, &shares, before, end);
            put(column, c, T::ONE);
        }
        for (c, (column, w)) in self.j.iter_mut().zip(&factor.weight).take(n).enumerate() {
            let scale = math::sqrt(*w);
            for x in head_mut(column, c + 1) {
                *x *= scale;
            }
        }
    }

    /// d ← Jᵀa for a row over the free variables, with zeros up to the kernels' width.
    pub(crate) fn coordinates(&self, row: &[T; N], d: &mut [T; N]) {
        let used = |a: &T| *a != T::ZERO;
        let entries = head(row, self.dim);
        let first = entries.iter().position(used).unwrap_or(0);
        let end = entries.iter().rposition(used).map_or(0, |last| last + 1);
        dots(
            d,
            head(&self.j, self.dim),
            row,
            [floor4(first), ceil4(end, N)],
        );
    }

    /// Measures a candidate whose `d` is set.
    pub(crate) fn project(&self, c: &mut Candidate<T, N>) {
        c.measure(self.len, self.dim);
    }

    /// z = J₂d₂, or J d with `from` = 0, into the free variables of `step`.
    #[inline]
    pub(crate) fn direction(
        &self,
        from: usize,
        d: &[T; N],
        free_variables: &[usize],
        step: &mut [T; N],
    ) {
        let mut z = [T::ZERO; N];
        let (d, columns) = (span(d, from, self.dim), span(&self.j, from, self.dim));
        sub_rows(&mut z, d, columns, 0, ceil4(self.dim, N));
        for (z, v) in z.iter().zip(free_variables) {
            put(step, *v, -*z);
        }
    }

    /// Appends an independent candidate whose z is in `step`.
    pub(crate) fn append(
        &mut self,
        c: &mut Candidate<T, N>,
        elimination: &Elimination<T, N>,
        step: &[T; N],
    ) {
        let (k, n) = (self.len, self.dim);
        let first = at(&c.d, k);
        let length = math::sqrt(c.free);
        let signed = if first < T::ZERO { -length } else { length };
        // u = d₂ + signed·e, and I − u uᵀ/(uᵀd₂) turns d₂ into −signed·e.
        put(&mut c.d, k, first + signed);
        let share = T::ONE / (c.free + math::abs(first) * length);
        let columns = self.j.get_mut(k..n).unwrap_or(&mut []);
        let Some(first) = columns.first() else { return };
        let mut shares = *first;
        for (f, v) in shares.iter_mut().zip(elimination.free_variables()) {
            *f = (at(step, *v) + signed * *f) * share;
        }
        sub_outer(columns, span(&c.d, k, n), &shares, 0, ceil4(n, N));
        if let Some((above, [row, ..])) = self.r.split_at_mut_checked(k) {
            for (r, d) in above.iter_mut().zip(&c.d) {
                put(r, k, *d);
            }
            row.fill(T::ZERO);
            put(row, k, -signed);
            put(&mut self.r_inverse, k, -T::ONE / signed);
            self.len += 1;
        }
    }

    /// Removes row `k` and carries `c` over to the smaller basis.
    pub(crate) fn remove(&mut self, k: usize, c: &mut Candidate<T, N>) {
        if k >= self.len {
            return;
        }
        let last = self.len - 1;
        for row in self.r.iter_mut().take(self.len) {
            for i in k..last {
                let next = at(row.as_slice(), i + 1);
                put(row, i, next);
            }
            put(row, last, T::ZERO);
        }
        for i in k..last {
            let Some([row, below]) = self.r.get_mut(i..).and_then(|r| r.first_chunk_mut()) else {
                break;
            };
            // What the next row has before its diagonal is turned away.
            let (x, y) = (at(row.as_slice(), i), at(below.as_slice(), i));
            let length = math::sqrt(x * x + y * y);
            let inverse = T::ONE / length;
            let (cos, sin) = (x * inverse, y * inverse);
            rotate(row, below, [cos, sin], [floor4(i), ceil4(last, N)]);
            put(row, i, length);
            put(below, i, T::ZERO);
            put(&mut self.r_inverse, i, inverse);
            put(&mut self.cos, i, cos);
            put(&mut self.sin, i, sin);
        }
        for i in k..last {
            let (cos, sin) = (at(&self.cos, i), at(&self.sin, i));
            let Some([first, second]) = self.j.get_mut(i..).and_then(|j| j.first_chunk_mut())
            else {
                break;
            };
            rotate(first, second, [cos, sin], [0, ceil4(self.dim, N)]);
            let (x, y) = (at(&c.d, i), at(&c.d, i + 1));
            put(&mut c.d, i, cos * x + sin * y);
            put(&mut c.d, i + 1, cos * y - sin * x);
        }
        self.len = last;
        c.measure(last, self.dim);
    }

    /// v ← R⁻¹v.
    #[inline]
    pub(crate) fn solve(&self, v: &mut [T; N]) {
        let len = self.len;
        let rows = self.r.iter().zip(&self.r_inverse).enumerate();
        for (k, (row, inverse)) in rows.take(len).rev() {
            // From the far end: what was found last is needed last.
            let terms = span(row, k + 1, len).iter().zip(span(v, k + 1, len)).rev();
            let s = terms.fold(T::ZERO, |sum, (r, v)| sum + *r * *v);
            if let Some(e) = v.get_mut(k) {
                *e = (*e - s) * *inverse;
            }
        }
    }

    /// v ← R⁻ᵀv.
    pub(crate) fn solve_transposed(&self, v: &mut [T; N]) {
        let rows = self.r.iter().zip(&self.r_inverse).enumerate();
        for (k, (row, inverse)) in rows.take(self.len) {
            let Some((e, after)) = span_mut(v, k, self.len).split_first_mut() else {
                break;
            };
            *e *= *inverse;
            sub_scaled(after, *e, span(row, k + 1, self.len));
        }
    }
}
