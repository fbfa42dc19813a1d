//! The active rows, orthogonalised without square roots.
//!
//! With H = UᵀDU every active row a becomes m = U⁻ᵀ a_y, and ⟨m, n⟩ = mᵀD⁻¹n is the product aᵀH⁻¹b.
//! The rows are kept as M = L Q: L unit lower triangular, the rows of Q orthogonal with squared
//! lengths d. This is the LDLᵀ factor of A_W H⁻¹ A_Wᵀ with the orthogonal part kept, so that a new
//! row's distance from the span of the others is computed without squaring the condition number.

use crate::kernels::{at, ceil4, copy, dot_in, head, put, row, span_mut};
use crate::kernels::{sub_scaled_in, weighted_dot};
use crate::settings::dependence_tolerance;
use so3::Scalar;

/// A row relative to the basis: m = Σ lⱼ qⱼ + q with q orthogonal to the basis, d = ⟨q, q⟩.
#[derive(Clone, Debug)]
pub(crate) struct Candidate<T, const N: usize> {
    pub(crate) l: [T; N],
    pub(crate) q: [T; N],
    /// 0 for a row that depends on the basis.
    pub(crate) d: T,
    /// ⟨m, m⟩.
    norm: T,
}

#[derive(Clone, Debug)]
pub(crate) struct Basis<T, const N: usize> {
    q: [[T; N]; N],
    l: [[T; N]; N],
    d: [T; N],
    d_inverse: [T; N],
    pub(crate) len: usize,
    /// Dimension of the rows.
    dim: usize,
    // Rotations of a removal.
    rot_l: [T; N],
    rot_carry: [T; N],
    rot_row: [T; N],
    work: [T; N],
}

impl<T: Scalar, const N: usize> Candidate<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            l: [T::ZERO; N],
            q: [T::ZERO; N],
            d: T::ZERO,
            norm: T::ZERO,
        }
    }

    fn settle(&mut self, full: bool) {
        if full || self.d <= dependence_tolerance::<T>() * self.norm {
            self.d = T::ZERO;
        }
    }
}

impl<T: Scalar, const N: usize> Basis<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            q: [[T::ZERO; N]; N],
            l: [[T::ZERO; N]; N],
            d: [T::ZERO; N],
            d_inverse: [T::ZERO; N],
            len: 0,
            dim: 0,
            rot_l: [T::ZERO; N],
            rot_carry: [T::ZERO; N],
            rot_row: [T::ZERO; N],
            work: [T::ZERO; N],
        }
    }

    pub(crate) fn clear(&mut self, dim: usize) {
        self.len = 0;
        self.dim = dim;
    }

    /// Splits `c.q` (holding m on entry) into its part in the basis and the rest.
    pub(crate) fn project(&mut self, weight: &[T; N], c: &mut Candidate<T, N>) {
        let (n, len) = (self.dim, self.len);
        let end = ceil4(n, N);
        c.norm = weighted_dot(head(weight, n), &c.q, &c.q);
        c.d = c.norm;
        // Twice is enough: after a second pass what is left is orthogonal or is round-off.
        for pass in 0..2 {
            if len == 0 || (pass == 1 && c.d > T::of(0.04) * c.norm) {
                break;
            }
            for ((s, q), w) in self.work.iter_mut().zip(&c.q).zip(weight).take(end) {
                *s = *q * *w;
            }
            for (j, (q, di)) in self.q.iter().zip(&self.d_inverse).take(len).enumerate() {
                let f = dot_in(q, &self.work, 0, end) * *di;
                let before = if pass == 0 { T::ZERO } else { at(&c.l, j) };
                put(&mut c.l, j, before + f);
                put(&mut self.rot_row, j, f);
            }
            for (q, f) in self.q.iter().zip(&self.rot_row).take(len) {
                sub_scaled_in(&mut c.q, *f, q, 0, end);
            }
            c.d = weighted_dot(head(weight, n), &c.q, &c.q);
        }
        c.settle(len >= n);
    }

    /// Appends an independent candidate.
    pub(crate) fn append(&mut self, c: &Candidate<T, N>) {
        let k = self.len;
        if let (Some(q), Some(l)) = (self.q.get_mut(k), self.l.get_mut(k)) {
            copy(q, &c.q);
            copy(l, head(&c.l, k));
            span_mut(l, k, ceil4(k, N)).fill(T::ZERO);
            put(&mut self.d, k, c.d);
            put(&mut self.d_inverse, k, T::ONE / c.d);
            self.len += 1;
        }
    }

    /// Removes row `k` and carries `c` over to the smaller basis.
    ///
    /// The freed direction is passed through the later rows by rotations of two orthogonal vectors,
    /// q' = qᵢ + l·carry and carry' = (dᵢ carry − l d_carry qᵢ)/d', d' = dᵢ + l² d_carry.
    pub(crate) fn remove(&mut self, k: usize, c: &mut Candidate<T, N>) {
        let (n, len) = (self.dim, self.len);
        let end = ceil4(n, N);
        if k >= len {
            return;
        }
        let mut carry_d = at(&self.d, k);
        copy(&mut self.work, head(row(&self.q, k), end));
        for i in k + 1..len {
            let Ok([to, from]) = self.l.get_disjoint_mut([i - 1, i]) else {
                break;
            };
            // Row i of L through the earlier rotations; what is left belongs to the carry.
            let mut a = at(from.as_slice(), k);
            copy(to, head(from, k));
            for j in k + 1..i {
                let (l, fc, fr) = (
                    at(&self.rot_l, j),
                    at(&self.rot_carry, j),
                    at(&self.rot_row, j),
                );
                let b = at(from.as_slice(), j);
                put(to, j - 1, a * fc + b * fr);
                a -= l * b;
            }
            span_mut(to, i - 1, ceil4(i - 1, N)).fill(T::ZERO);
            let di = at(&self.d, i);
            let d = di + a * a * carry_d;
            let inverse = T::ONE / d;
            let (fc, fr) = (a * carry_d * inverse, di * inverse);
            put(&mut self.rot_l, i, a);
            put(&mut self.rot_carry, i, fc);
            put(&mut self.rot_row, i, fr);
            let Ok([to, from]) = self.q.get_disjoint_mut([i - 1, i]) else {
                break;
            };
            for ((to, q), carry) in to.iter_mut().zip(from.iter()).zip(&mut self.work).take(end) {
                let (v, w) = (*q, *carry);
                *to = v + a * w;
                *carry = fr * w - fc * v;
            }
            put(&mut self.d, i - 1, d);
            put(&mut self.d_inverse, i - 1, inverse);
            carry_d *= fr;
        }
        let mut a = at(&c.l, k);
        for j in k + 1..len {
            let (l, fc, fr) = (
                at(&self.rot_l, j),
                at(&self.rot_carry, j),
                at(&self.rot_row, j),
            );
            let b = at(&c.l, j);
            put(&mut c.l, j - 1, a * fc + b * fr);
            a -= l * b;
        }
        if c.d == T::ZERO {
            c.q.fill(T::ZERO);
        }
        sub_scaled_in(&mut c.q, -a, &self.work, 0, end);
        c.d += a * a * carry_d;
        self.len -= 1;
        c.settle(self.len >= n);
    }

    /// v ← L⁻ᵀ v.
    pub(crate) fn solve_transposed(&self, v: &mut [T; N]) {
        for (i, l) in self.l.iter().take(self.len).enumerate().rev() {
            let f = at(v.as_slice(), i);
            let end = ceil4(i, N);
            sub_scaled_in(v, f, l, 0, end);
        }
    }

    /// v ← D⁻¹L⁻¹ v.
    pub(crate) fn solve_scaled(&self, v: &mut [T; N]) {
        for (i, l) in self.l.iter().take(self.len).enumerate() {
            let end = ceil4(i, N);
            let s = dot_in(l, v, 0, end);
            if let Some(e) = v.get_mut(i) {
                *e -= s;
            }
        }
        for (v, d) in v.iter_mut().zip(&self.d_inverse).take(self.len) {
            *v *= *d;
        }
    }

    /// out ← Σ cⱼ qⱼ.
    pub(crate) fn combine(&self, c: &[T; N], out: &mut [T; N]) {
        let end = ceil4(self.dim, N);
        out.fill(T::ZERO);
        for (q, c) in self.q.iter().zip(c).take(self.len) {
            sub_scaled_in(out, -*c, q, 0, end);
        }
    }
}
