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
//! digits, however different the curvatures of H are. Kept of R is its inverse: −r and the new multiplier's own answer are its next
//! column, r is a product then, in which no entry waits for another, and what a leaving row has in it says how to turn.

use crate::access::{at, copy, head, head_mut, put, span, span_mut};
use crate::elimination::Elimination;
use crate::factor::Factor;
use crate::kernels::{ceil4, dot, dots, rotate};
use crate::kernels::{sub_outer, sum_rows, sum_triangle};
use crate::settings::{cancellation_tolerance, dependence_tolerance};
use crate::tiles::{Shares, load, store, sub_products};
use so3::{Scalar, math};

/// A row in the coordinates of the basis.
#[derive(Clone, Debug)]
pub(crate) struct Candidate<T, const N: usize> {
    pub(crate) d: [T; N],
    /// |d₂|², 0 for a row that depends on the active ones.
    pub(crate) free: T,
    /// |d|².
    whole: T,
}

#[derive(Clone, Debug)]
pub(crate) struct Basis<T, const N: usize> {
    /// J by columns, an entry per variable: what the equalities make of the others is there. Scratch until [`Basis::prepare`].
    pub(crate) j: [[T; N]; N],
    /// Sum of the squares of the entries of J over the free variables, if there are equalities.
    square: T,
    /// R⁻¹ by columns, zeros below its diagonal.
    inverse: [[T; N]; N],
    /// |d|² of each active row, when it entered: turns leave it as it is.
    lengths: [T; N],
    pub(crate) len: usize,
    /// Number of free variables; 0 until J is there.
    dim: usize,
}

impl<T: Scalar, const N: usize> Candidate<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            d: [T::ZERO; N],
            free: T::ZERO,
            whole: T::ZERO,
        }
    }

    /// |d₂|², given how many rows are active; returns |d|².
    fn measure(&mut self, len: usize, dim: usize) -> T {
        let (active, free) = (head(&self.d, len), span(&self.d, len, dim));
        self.free = dot(free, free);
        let whole = self.free + dot(active, active);
        // False for NaN.
        if len >= dim || self.free <= dependence_tolerance::<T>() * whole {
            self.free = T::ZERO;
        }
        self.whole = whole;
        whole
    }
}

impl<T: Scalar, const N: usize> Basis<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            j: [[T::ZERO; N]; N],
            square: T::ZERO,
            inverse: [[T::ZERO; N]; N],
            lengths: [T::ZERO; N],
            len: 0,
            dim: 0,
        }
    }

    /// No active rows, and no J.
    pub(crate) fn clear(&mut self) {
        self.len = 0;
        self.dim = 0;
    }

    /// J of a factor, unless it is there already: a problem without a violated row never needs it.
    pub(crate) fn prepare(&mut self, factor: &Factor<T, N>, elimination: &Elimination<T, N>) {
        if self.dim == factor.dim {
            return;
        }
        let n = factor.dim;
        self.dim = n;
        // Column c of U⁻¹ is unit vector c less the columns before it, each times what U has in its row; four columns at a time.
        let mut first = 0;
        while first < n {
            let Some((before, open)) = self.j.split_at_mut_checked(first) else {
                break;
            };
            let own = head_mut(open, 4.min(n - first));
            if elimination.rank == 0 {
                for column in own.iter_mut() {
                    span_mut(column, first, N).fill(T::ZERO);
                }
            }
            let u = load(span(&factor.u, first, n), first);
            let [a, b, c, _] = u;
            let shares = Shares([a[1]], [a[2], b[2]], [a[3], b[3], c[3]]);
            let mut at_row = 0;
            while at_row <= first {
                let mut tile = [[T::ZERO; 4]; 4];
                if at_row == first {
                    for (k, row) in tile.iter_mut().enumerate() {
                        put(row, k, T::ONE);
                    }
                }
                let shared = (span(&factor.u, at_row, first), first);
                sub_products(&mut tile, shared, (span(before, at_row, first), at_row));
                shares.take(&mut tile);
                store(own, at_row, &tile);
                at_row += 4;
            }
            first += 4;
        }
        self.square = T::ZERO;
        let has_basic = elimination.has_basic();
        if has_basic {
            elimination.transpose(&mut self.inverse);
        }
        let (mut free, mut moved) = ([T::ZERO; N], [T::ZERO; N]);
        for (c, (column, w)) in self.j.iter_mut().zip(&factor.weight).take(n).enumerate() {
            let scale = math::sqrt(*w);
            if elimination.rank == 0 {
                for x in head_mut(column, c + 1) {
                    *x *= scale;
                }
                continue;
            }
            let known = head_mut(&mut free, c + 1);
            for (y, x) in known.iter_mut().zip(&*column) {
                *y = *x * scale;
            }
            self.square += dot(known, known);
            let moves = has_basic.then_some((&self.inverse, &mut moved));
            elimination.expand_by(moves, known, column);
        }
    }

    /// d ← Jᵀa.
    pub(crate) fn coordinates(&self, row: &[T; N], d: &mut [T; N]) {
        let (blocks, rest) = row.as_chunks::<4>();
        let used = |block: &[T; 4]| *block != [T::ZERO; 4];
        let first = blocks.iter().position(used).unwrap_or(blocks.len());
        let end = if rest.iter().any(|a| *a != T::ZERO) {
            N
        } else {
            4 * blocks.iter().rposition(used).map_or(0, |last| last + 1)
        };
        dots(d, head(&self.j, self.dim), row, [4 * first, end]);
    }

    /// [`Basis::coordinates`] of the unit row of a variable.
    pub(crate) fn coordinates_of_unit(&self, variable: usize, d: &mut [T; N]) {
        for (d, column) in d.iter_mut().zip(head(&self.j, self.dim)) {
            *d = at(column, variable);
        }
    }

    /// Measures a candidate whose `d` is set; returns |d|².
    pub(crate) fn project(&self, c: &mut Candidate<T, N>) -> T {
        c.measure(self.len, self.dim)
    }

    /// Whether a candidate may be Σ rₖaₖ of active rows but for the round-off of these terms: where they cancel, |d₂| is no measure of itself. A
    /// row that keeps √ε of its length is in no doubt.
    pub(crate) fn is_in_doubt(&self, c: &Candidate<T, N>, r: &[T; N]) -> bool {
        if c.free > T::EPSILON * c.whole {
            return false;
        }
        let shares = r.iter().zip(&self.lengths).take(self.len);
        let terms = shares.fold(T::ZERO, |sum, (r, length)| sum + *r * *r * *length);
        c.free <= cancellation_tolerance::<T>() * terms
    }

    /// |d₂|² of a candidate whatever its share of |d|², if it is more than round-off of d; returns whether it is.
    pub(crate) fn insist(&self, c: &mut Candidate<T, N>) -> bool {
        let free = span(&c.d, self.len, self.dim);
        c.free = dot(free, free);
        let is_more = c.free > cancellation_tolerance::<T>() * c.whole;
        if !is_more {
            c.free = T::ZERO;
        }
        is_more
    }

    /// Most that |d|² can be of a row whose entries over the free variables are at most 1, once the equalities are taken out of it.
    pub(crate) fn most(&self) -> T {
        self.square * T::of(self.dim as f64)
    }

    /// z = J₂d₂, or J d with `from` = 0.
    #[inline]
    pub(crate) fn direction(&self, from: usize, d: &[T; N], z: &mut [T; N]) {
        let (d, columns) = (span(d, from, self.dim), span(&self.j, from, self.dim));
        sum_rows(z, d, columns, N);
    }

    /// Appends an independent candidate whose z and r are given.
    pub(crate) fn append(&mut self, c: &mut Candidate<T, N>, z: &[T; N], r: &[T; N]) {
        let k = self.len;
        let first = at(&c.d, k);
        let length = math::sqrt(c.free);
        let signed = if first < T::ZERO { -length } else { length };
        // u = d₂ + signed·e, and I − u uᵀ/(uᵀd₂) turns d₂ into −signed·e.
        let share = T::ONE / (c.free + math::abs(first) * length);
        put(&mut c.d, k, first + signed);
        let columns = self.j.get_mut(k..self.dim).unwrap_or(&mut []);
        let Some(first) = columns.first() else { return };
        let mut shares = [T::ZERO; N];
        for (f, (z, first)) in shares.iter_mut().zip(z.iter().zip(first)) {
            *f = (*z + signed * *first) * share;
        }
        sub_outer(columns, span(&c.d, k, self.dim), &shares, 0, N);
        if let Some(column) = self.inverse.get_mut(k) {
            column.fill(T::ZERO);
            let inverse = T::ONE / signed;
            for (e, r) in head_mut(column, k).iter_mut().zip(r) {
                *e = *r * inverse;
            }
            put(column, k, -inverse);
            put(&mut self.lengths, k, c.whole);
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
            let next = at(&self.lengths, i + 1);
            put(&mut self.lengths, i, next);
        }
        // R⁻¹ without row k is the new inverse once its columns are turned so that all of that row is in the last one, which falls away.
        let mut running = T::ZERO;
        for (i, column) in self.inverse.iter_mut().enumerate().take(last + 1).skip(k) {
            // A rotation by one, by hand: that of a slice has a panic, which nothing proves away for some sizes.
            let mut carried = at(column.as_slice(), k);
            for entry in span_mut(column, k, i + 1).iter_mut().rev() {
                core::mem::swap(entry, &mut carried);
            }
        }
        for i in k..last {
            let Some([first, second]) = self.inverse.get_mut(i..).and_then(|t| t.first_chunk_mut())
            else {
                break;
            };
            if i == k {
                running = at(first.as_slice(), i);
                put(first, i, T::ZERO);
            }
            let own = at(second.as_slice(), i + 1);
            put(second, i + 1, T::ZERO);
            let length = math::sqrt(running * running + own * own);
            let inverse = T::ONE / length;
            let turn = [own * inverse, -running * inverse];
            rotate(first, second, turn, [0, ceil4(i + 1, N)]);
            running = length;
            let Some([first, second]) = self.j.get_mut(i..).and_then(|j| j.first_chunk_mut())
            else {
                break;
            };
            rotate(first, second, turn, [0, N]);
            let ([cos, sin], x, y) = (turn, at(&c.d, i), at(&c.d, i + 1));
            put(&mut c.d, i, cos * x + sin * y);
            put(&mut c.d, i + 1, cos * y - sin * x);
        }
        self.len = last;
        c.measure(last, self.dim);
    }

    /// r ← R⁻¹d₁, d₁ being the first entries of d.
    #[inline]
    pub(crate) fn solve(&self, d: &[T; N], r: &mut [T; N]) {
        let columns = head(&self.inverse, self.len);
        sum_triangle(r, head(d, self.len), columns);
    }

    /// v ← R⁻ᵀv.
    pub(crate) fn solve_transposed(&self, v: &mut [T; N]) {
        let len = self.len;
        let mut known = [T::ZERO; N];
        copy(head_mut(&mut known, len), v);
        dots(
            head_mut(v, len),
            head(&self.inverse, len),
            &known,
            [0, ceil4(len, N)],
        );
    }
}

#[cfg(test)]
mod tests {
    use super::{Basis, Candidate};

    /// e₀ and e₀ + `angle`·e₁ are active, and e₁ + `own`·e₂ comes: whether it is in doubt that it depends on them.
    fn is_in_doubt(angle: f64, own: f64) -> bool {
        let mut basis = Basis::<f64, 3>::new();
        basis.dim = 3;
        basis.j = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (mut c, mut r, mut z) = (Candidate::new(), [0.0; 3], [0.0; 3]);
        for row in [[1.0, 0.0, 0.0], [1.0, angle, 0.0], [0.0, 1.0, own]] {
            basis.coordinates(&row, &mut c.d);
            basis.project(&mut c);
            basis.solve(&c.d, &mut r);
            if row[0] != 0.0 {
                basis.direction(basis.len, &c.d, &mut z);
                basis.append(&mut c, &z, &r);
            }
        }
        assert!(c.free > 0.0);
        basis.is_in_doubt(&c, &r)
    }

    /// Rows at an angle of 1e-9 make up another by terms of 1e9, whose round-off hides 1e-8 of its own. 1e-7, more than √ε, is in no doubt
    /// whatever the terms, and 1e-8 is in none where they are small.
    #[test]
    fn a_row_is_in_doubt_that_is_round_off_of_large_terms() {
        assert!(is_in_doubt(1e-9, 1e-8));
        assert!(!is_in_doubt(1e-9, 1e-7));
        assert!(!is_in_doubt(1.0, 1e-8));
    }
}
