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
use crate::kernels::{at, ceil4, copy, dot, dot_in, dots, head, head_mut, put, rotate, span};
use crate::kernels::{sub_outer, sub_rows, sub_scaled_in, sub_triangle};
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
    /// J by columns, an entry per variable: what the equalities make of the others is there. Scratch until [`Basis::prepare`].
    pub(crate) j: [[T; N]; N],
    /// Sum of the squares of the entries of J over the free variables, if there are equalities.
    square: T,
    /// R by columns, zeros on its diagonal and below.
    r: [[T; N]; N],
    /// R_kk.
    diagonal: [T; N],
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

    /// |d₂|², given how many rows are active; returns |d|².
    fn measure(&mut self, len: usize, dim: usize) -> T {
        let (active, free) = (head(&self.d, len), span(&self.d, len, dim));
        self.free = dot(free, free);
        let whole = self.free + dot(active, active);
        // False for NaN.
        if len >= dim || self.free <= dependence_tolerance::<T>() * whole {
            self.free = T::ZERO;
        }
        whole
    }
}

impl<T: Scalar, const N: usize> Basis<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            j: [[T::ZERO; N]; N],
            square: T::ZERO,
            r: [[T::ZERO; N]; N],
            diagonal: [T::ZERO; N],
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
    pub(crate) fn prepare(&mut self, factor: &Factor<T, N>, elimination: &Elimination<T, N>) {
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
        self.square = T::ZERO;
        for (c, (column, w)) in self.j.iter_mut().zip(&factor.weight).take(n).enumerate() {
            let scale = math::sqrt(*w);
            for x in head_mut(column, c + 1) {
                *x *= scale;
            }
            if elimination.rank > 0 {
                let free = *column;
                self.square += dot(&free, &free);
                elimination.expand(&free, c + 1, column);
            }
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

    /// Most that |d|² can be of a row whose entries over the free variables are at most 1, once the equalities are taken out of it.
    pub(crate) fn most(&self) -> T {
        self.square * T::of(self.dim as f64)
    }

    /// z = J₂d₂, or J d with `from` = 0.
    #[inline]
    pub(crate) fn direction(&self, from: usize, d: &[T; N], z: &mut [T; N]) {
        z.fill(T::ZERO);
        let (d, columns) = (span(d, from, self.dim), span(&self.j, from, self.dim));
        sub_rows(z, d, columns, 0, N);
        for z in z {
            *z = -*z;
        }
    }

    /// Appends an independent candidate whose z is given.
    pub(crate) fn append(&mut self, c: &mut Candidate<T, N>, z: &[T; N]) {
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
        for (f, z) in shares.iter_mut().zip(z) {
            *f = (*z + signed * *f) * share;
        }
        sub_outer(columns, span(&c.d, k, n), &shares, 0, N);
        if let Some(column) = self.r.get_mut(k) {
            column.fill(T::ZERO);
            copy(head_mut(column, k), &c.d);
            put(&mut self.diagonal, k, -signed);
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
        if let Some(columns) = self.r.get_mut(k..=last) {
            columns.rotate_left(1);
        }
        for i in k..last {
            let Some([column, later @ ..]) = self.r.get_mut(i..last) else {
                break;
            };
            // What the next row has in this column, once its own diagonal, is turned away.
            let (x, y) = (at(column.as_slice(), i), at(&self.diagonal, i + 1));
            let length = math::sqrt(x * x + y * y);
            let inverse = T::ONE / length;
            let (cos, sin) = (x * inverse, y * inverse);
            put(column, i, T::ZERO);
            for column in later {
                if let Some([x, y]) = column.get_mut(i..).and_then(|c| c.first_chunk_mut()) {
                    (*x, *y) = (cos * *x + sin * *y, cos * *y - sin * *x);
                }
            }
            put(&mut self.diagonal, i, length);
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
            rotate(first, second, [cos, sin], [0, N]);
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
        // What is found is written elsewhere: one entry could not be read back as part of four without waiting.
        let mut rest = *v;
        // By index: over an iterator of the columns, reversed, the same loop takes more instructions.
        for k in (0..self.len.min(N)).rev() {
            let Some(column) = self.r.get(k) else { break };
            let e = at(rest.as_slice(), k) * at(&self.r_inverse, k);
            put(v, k, e);
            sub_scaled_in(&mut rest, e, column, 0, ceil4(k, N));
        }
    }

    /// v ← R⁻ᵀv.
    pub(crate) fn solve_transposed(&self, v: &mut [T; N]) {
        let columns = self.r.iter().zip(&self.r_inverse).enumerate();
        for (k, (column, inverse)) in columns.take(self.len) {
            let s = dot_in(column, v, 0, ceil4(k, N));
            if let Some(e) = v.get_mut(k) {
                *e = (*e - s) * *inverse;
            }
        }
    }
}
