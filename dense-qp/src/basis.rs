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
use crate::kernels::{at, ceil4, dot, dot_in, floor4, head, put, span, span_mut};
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
    /// J, a row per free variable.
    j: [[T; N]; N],
    /// R by columns.
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
        let d = head(&self.d, dim);
        let square = |d: &[T]| d.iter().fold(T::ZERO, |sum, x| sum + *x * *x);
        self.free = square(span(d, len, dim));
        let whole = self.free + square(head(d, len));
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
        for (i, u) in factor.u.iter().enumerate().take(n).rev() {
            let Some((upper, lower)) = self.j.split_at_mut_checked(i + 1) else {
                break;
            };
            let Some(row) = upper.last_mut() else { break };
            row.fill(T::ZERO);
            put(row, i, T::ONE);
            sub_triangle(row, span(u, i + 1, n), lower, i + 1, end);
        }
        for (k, w) in factor.weight.iter().take(n).enumerate() {
            put(&mut self.cos, k, math::sqrt(*w));
        }
        for (i, row) in self.j.iter_mut().take(n).enumerate() {
            for (x, s) in span_mut(row, i, n).iter_mut().zip(span(&self.cos, i, n)) {
                *x *= *s;
            }
        }
    }

    /// d ← −Jᵀa, a being `entries` on the free variables from `first`, and zero on the others.
    pub(crate) fn coordinates(&self, first: usize, entries: &[T], d: &mut [T; N]) {
        d.fill(T::ZERO);
        let used = |a: &T| *a != T::ZERO;
        if let (Some(from), Some(last)) = (entries.iter().position(used), entries.iter().rposition(used)) {
            let rows = span(&self.j, first + from, self.dim);
            sub_rows(d, span(entries, from, last + 1), rows, 0, ceil4(self.dim, N));
        }
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
        let (d, end) = (tail(d, from), ceil4(self.dim, N));
        for (row, v) in self.j.iter().zip(free_variables) {
            put(step, *v, dot_in(row, &d, floor4(from), end));
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
        let rows = self.j.iter().zip(elimination.free_variables());
        let mut shares = [T::ZERO; N];
        for (f, (row, v)) in shares.iter_mut().zip(rows) {
            *f = (at(step, *v) + signed * at(row, k)) * share;
        }
        let rows = self.j.get_mut(..n).unwrap_or(&mut []);
        sub_outer(rows, &shares, &tail(&c.d, k), floor4(k), ceil4(n, N));
        if let Some(column) = self.r.get_mut(k) {
            for (r, d) in column.iter_mut().zip(&c.d).take(k) {
                *r = *d;
            }
            put(column, k, -signed);
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
        for i in k..last {
            let Some((before, after)) = self.r.split_at_mut_checked(i + 1) else {
                break;
            };
            // Column i + 1 becomes column i; what it has below the diagonal is turned away.
            let (Some(to), Some(from)) = (before.last_mut(), after.first()) else {
                break;
            };
            let (x, y) = (at(from, i), at(from, i + 1));
            let length = math::sqrt(x * x + y * y);
            let inverse = T::ONE / length;
            let (cos, sin) = (x * inverse, y * inverse);
            for (to, from) in to.iter_mut().zip(from).take(i) {
                *to = *from;
            }
            put(to, i, length);
            put(&mut self.r_inverse, i, inverse);
            put(&mut self.cos, i, cos);
            put(&mut self.sin, i, sin);
            for column in after.iter_mut().take(last - i).skip(1) {
                let (x, y) = (at(column.as_slice(), i), at(column.as_slice(), i + 1));
                put(column, i, cos * x + sin * y);
                put(column, i + 1, cos * y - sin * x);
            }
        }
        let turns = || {
            let cos = span(&self.cos, k, last);
            cos.iter().zip(span(&self.sin, k, last))
        };
        let turn = |row: &mut [T; N]| {
            let row = span_mut(row, k, last + 1);
            let mut carried = at(row, 0);
            for (i, (cos, sin)) in turns().enumerate() {
                let next = at(row, i + 1);
                put(row, i, *cos * carried + *sin * next);
                carried = *cos * next - *sin * carried;
            }
            put(row, last - k, carried);
        };
        for row in self.j.iter_mut().take(self.dim) {
            turn(row);
        }
        turn(&mut c.d);
        self.len = last;
        c.measure(last, self.dim);
    }

    /// v ← R⁻¹v.
    #[inline]
    pub(crate) fn solve(&self, v: &mut [T; N]) {
        for (k, (column, inverse)) in self
            .r
            .iter()
            .zip(&self.r_inverse)
            .enumerate()
            .take(self.len)
            .rev()
        {
            let Some((before, rest)) = v.split_at_mut_checked(k) else {
                break;
            };
            if let Some(e) = rest.first_mut() {
                *e *= *inverse;
                sub_scaled(before, *e, column);
            }
        }
    }

    /// v ← R⁻ᵀv.
    #[inline]
    pub(crate) fn solve_transposed(&self, v: &mut [T; N]) {
        let columns = self.r.iter().zip(&self.r_inverse).enumerate();
        for (k, (column, inverse)) in columns.take(self.len) {
            let s = dot(head(column, k), head(v, k));
            if let Some(e) = v.get_mut(k) {
                *e = (*e - s) * *inverse;
            }
        }
    }
}

/// d with zeros before entry `from`, as far as kernels look that start at full width.
#[inline(always)]
fn tail<T: Scalar, const N: usize>(d: &[T; N], from: usize) -> [T; N] {
    let mut tail = *d;
    for i in floor4(from)..from {
        put(&mut tail, i, T::ZERO);
    }
    tail
}
