//! Equality rows and fixed variables, eliminated before the search.
//!
//! With the rows A_E x = b of rank r, and the columns ordered as r basic ones B and the rest F,
//! a row-wise LU factorisation A_B = L U (columns chosen as pivots) gives
//!
//! x_B = p − W x_F,  W = A_B⁻¹ A_F,  p = A_B⁻¹ b,
//!
//! so the free variables y = x_F span the null space and every row a reduces to
//! a_y = a_F − Wᵀ a_B. Fixed variables come first: their rows of U are unit vectors and their rows
//! of W are zero. A row that depends on earlier ones is dropped when it agrees with them.

use crate::kernels::{at, ceil4, dot, head, head_mut, max_abs, put, row, row_mut, span, span_mut};
use crate::kernels::{copy, sub_all, sub_scaled, sub_scaled_pair};
use crate::problem::Problem;
use crate::settings::row_tolerance;
use so3::{Scalar, math};

#[derive(Clone, Debug)]
pub(crate) struct Elimination<T, const N: usize> {
    /// Permuted columns. Row k: multipliers of L before column k, U from k to r, W after.
    lu: [[T; N]; N],
    /// 1 / U_kk.
    inverse: [T; N],
    /// Reduced right-hand side, then p.
    rhs: [T; N],
    /// Variable of each permuted column.
    perm: [usize; N],
    /// Permuted column of each variable, where `rank` is not 0.
    place: [usize; N],
    /// Constraint (row i, or M + variable) behind each row of `lu`.
    pub(crate) id: [usize; N],
    /// Number of fixed variables.
    fixed: usize,
    /// Rank r of the equalities.
    pub(crate) rank: usize,
}

/// A dependent equality whose right-hand side contradicts the earlier ones.
pub(crate) struct Contradiction {
    pub(crate) id: usize,
    /// Amount by which it does: aᵀx − b on the set where the earlier ones hold.
    pub(crate) residual_positive: bool,
}

impl<T: Scalar, const N: usize> Elimination<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            lu: [[T::ZERO; N]; N],
            inverse: [T::ZERO; N],
            rhs: [T::ZERO; N],
            perm: [0; N],
            place: [0; N],
            id: [0; N],
            fixed: 0,
            rank: 0,
        }
    }

    /// Number of free variables.
    pub(crate) fn free(&self) -> usize {
        N - self.rank.min(N)
    }

    /// Variables of the free columns.
    #[inline(always)]
    pub(crate) fn free_variables(&self) -> &[usize] {
        span(&self.perm, self.rank, N)
    }

    /// Whether a free variable moves others: a row that is not merely fixed was eliminated.
    #[inline(always)]
    pub(crate) fn has_basic(&self) -> bool {
        self.rank > self.fixed
    }

    /// Index of `variable` among the free ones.
    #[inline(always)]
    pub(crate) fn free_index(&self, variable: usize) -> Option<usize> {
        if self.rank == 0 {
            return Some(variable);
        }
        at(&self.place, variable).checked_sub(self.rank)
    }

    /// Factorises the equalities of `problem` (rows and bounds with equal limits). `feasibility` is
    /// the distance up to which a dependent row may contradict the others.
    pub(crate) fn build<const M: usize>(
        &mut self,
        problem: &Problem<'_, T, N, M>,
        feasibility: T,
        scratch: &mut [T; N],
    ) -> Result<(), Contradiction> {
        self.rank = 0;
        self.fixed = 0;
        for (i, p) in self.perm.iter_mut().enumerate() {
            *p = i;
        }
        if let (Some(lower), Some(upper)) = (problem.lower, problem.upper) {
            for (i, (l, u)) in lower.iter().zip(upper).enumerate() {
                if l == u && l.is_finite_number() {
                    self.fix(i, M + i, *l);
                }
            }
        }
        self.fixed = self.rank;
        for (i, (l, u)) in problem.row_lower.iter().zip(problem.row_upper).enumerate() {
            if l == u && l.is_finite_number() {
                self.insert(problem, i, *l, feasibility, scratch)?;
            }
        }
        self.finish();
        if self.rank > 0 {
            for (column, variable) in self.perm.iter().enumerate() {
                put(&mut self.place, *variable, column);
            }
        }
        Ok(())
    }

    /// Variables are fixed in increasing order, so column `variable` still holds it.
    fn fix(&mut self, variable: usize, id: usize, value: T) {
        let k = self.rank;
        let r = row_mut(&mut self.lu, k);
        r.fill(T::ZERO);
        put(r, k, T::ONE);
        put(&mut self.rhs, k, value);
        put(&mut self.id, k, id);
        if k < N && variable < N {
            self.perm.swap(k, variable);
        }
        self.rank += 1;
    }

    fn insert<const M: usize>(
        &mut self,
        problem: &Problem<'_, T, N, M>,
        i: usize,
        limit: T,
        feasibility: T,
        work: &mut [T; N],
    ) -> Result<(), Contradiction> {
        let a = row(problem.rows, i);
        for (w, p) in work.iter_mut().zip(&self.perm) {
            *w = at(a, *p);
        }
        let mut rhs = limit;
        let rank = self.rank;
        for (k, (r, c)) in self.lu.iter().zip(&self.rhs).take(rank).enumerate() {
            let f = at(work.as_slice(), k);
            if f == T::ZERO {
                continue;
            }
            let f = if k < self.fixed {
                f
            } else {
                let f = f * at(&self.inverse, k);
                sub_scaled(span_mut(work, k + 1, N), f, span(r, k + 1, N));
                f
            };
            put(work, k, f);
            rhs -= f * *c;
        }
        // The pivot is the entry that is largest for variables measured by their own curvature;
        // w²/c is compared crosswise, without a division.
        let (mut pivot, mut best, mut best_scale) = (rank, T::ZERO, T::ONE);
        for (j, (w, p)) in work.iter().zip(&self.perm).enumerate().skip(rank) {
            let scale = at(row(problem.hessian, *p), *p) + T::ONE;
            let square = *w * *w;
            if square * best_scale > best * scale {
                (pivot, best, best_scale) = (j, square, scale);
            }
        }
        let size = max_abs(a);
        let left = max_abs(span(work, rank, N));
        if rank >= N || left <= row_tolerance::<T>() * size {
            let scale = if size > T::ZERO { size } else { T::ONE };
            let noise = T::of(256.0) * T::EPSILON * (math::abs(limit) + size * max_abs(&self.rhs));
            if math::abs(rhs) > math::max(feasibility * scale, noise) {
                return Err(Contradiction {
                    id: i,
                    residual_positive: rhs < T::ZERO,
                });
            }
            return Ok(());
        }
        copy(row_mut(&mut self.lu, rank), work);
        put(&mut self.rhs, rank, rhs);
        put(&mut self.id, rank, i);
        put(&mut self.inverse, rank, T::ONE / at(work.as_slice(), pivot));
        if pivot != rank && pivot < N {
            self.perm.swap(rank, pivot);
            for r in self.lu.iter_mut().take(rank + 1) {
                if rank < N {
                    r.swap(rank, pivot);
                }
            }
        }
        self.rank += 1;
        Ok(())
    }

    /// U₁₁⁻¹ on the right part and on the right-hand side.
    fn finish(&mut self) {
        let (rank, fixed) = (self.rank, self.fixed);
        for k in (fixed..rank).rev() {
            let Some((upper, lower)) = self.lu.split_at_mut_checked(k + 1) else {
                break;
            };
            let Some(r) = upper.last_mut() else { break };
            let Some((left, right)) = r.split_at_mut_checked(rank) else {
                break;
            };
            let shares = span(left, k + 1, rank);
            let below = shares.iter().zip(lower.iter());
            sub_all(right, below.map(|(f, below)| (*f, span(below, rank, N))));
            let mut p = at(&self.rhs, k);
            for (f, known) in shares.iter().zip(span(&self.rhs, k + 1, rank)) {
                p -= *f * *known;
            }
            let inverse = at(&self.inverse, k);
            for w in right {
                *w *= inverse;
            }
            put(&mut self.rhs, k, p * inverse);
        }
    }

    /// x = (p, 0): the point with all free variables at zero.
    pub(crate) fn particular(&self, x: &mut [T; N]) {
        x.fill(T::ZERO);
        for (p, v) in self.rhs.iter().zip(&self.perm).take(self.rank) {
            put(x, *v, *p);
        }
    }

    /// y ← a_F − Wᵀ a_B.
    #[inline]
    pub(crate) fn reduce(&self, a: &[T], y: &mut [T; N]) {
        if self.rank == 0 {
            for (y, a) in y.iter_mut().zip(a) {
                *y = *a;
            }
            return;
        }
        for (y, v) in y.iter_mut().zip(self.free_variables()) {
            *y = at(a, *v);
        }
        let free = self.free();
        span_mut(y, free, N).fill(T::ZERO);
        for (w, v) in self
            .lu
            .iter()
            .zip(&self.perm)
            .take(self.rank)
            .skip(self.fixed)
        {
            let f = at(a, *v);
            if f != T::ZERO {
                sub_scaled(head_mut(y, free), f, span(w, self.rank, N));
            }
        }
    }

    /// y ← t_F + |W|ᵀ t_B: sizes of the terms of [`Elimination::reduce`] from those of its entries.
    pub(crate) fn reduce_sizes(&self, t: &[T; N], y: &mut [T; N]) {
        if self.rank == 0 {
            *y = *t;
            return;
        }
        for (y, v) in y.iter_mut().zip(self.free_variables()) {
            *y = at(t, *v);
        }
        let basic = self.lu.iter().zip(&self.perm).take(self.rank);
        for (w, v) in basic.skip(self.fixed) {
            let f = at(t, *v);
            let shares = y.iter_mut().zip(span(w, self.rank, N));
            shares.for_each(|(y, w)| *y += math::abs(f * *w));
        }
    }

    /// [`Elimination::reduce`] of the unit row of `variable`.
    pub(crate) fn reduce_unit(&self, variable: usize, y: &mut [T; N]) {
        y.fill(T::ZERO);
        if let Some(i) = self.free_index(variable) {
            put(y, i, T::ONE);
            return;
        }
        let column = at(&self.place, variable);
        if column >= self.fixed {
            sub_scaled(y, T::ONE, span(row(&self.lu, column), self.rank, N));
        }
    }

    /// Completes a displacement whose free part is set: z_B ← −W z_F. `y` is scratch.
    #[inline]
    pub(crate) fn complete(&self, z: &mut [T; N], y: &mut [T; N]) {
        if self.rank == 0 {
            return;
        }
        for v in self.perm.iter().take(self.fixed) {
            put(z, *v, T::ZERO);
        }
        if self.has_basic() {
            for (y, v) in y.iter_mut().zip(self.free_variables()) {
                *y = at(z.as_slice(), *v);
            }
            let y = head(y, self.free());
            let basic = self.lu.iter().zip(&self.perm).take(self.rank);
            for (w, v) in basic.skip(self.fixed) {
                put(z, *v, -dot(span(w, self.rank, N), y));
            }
        }
    }

    /// x_B ← p − W x_F.
    pub(crate) fn restore(&self, x: &mut [T; N], y: &mut [T; N]) {
        if !self.has_basic() {
            return;
        }
        for (y, v) in y.iter_mut().zip(self.free_variables()) {
            *y = at(x.as_slice(), *v);
        }
        let y = head(y, self.free());
        let basic = self
            .lu
            .iter()
            .zip(&self.rhs)
            .zip(&self.perm)
            .take(self.rank);
        for ((w, p), v) in basic.skip(self.fixed) {
            put(x, *v, *p - dot(span(w, self.rank, N), y));
        }
    }

    /// Upper triangle of ZᵀHZ into `out` and the size of the terms of its diagonal into `magnitude`.
    pub(crate) fn reduce_hessian(
        &self,
        h: &[[T; N]; N],
        out: &mut [[T; N]; N],
        magnitude: &mut [T; N],
        scratch: &mut [T; N],
    ) {
        let (rank, free) = (self.rank, self.free());
        if rank == 0 {
            for (i, ((o, h), m)) in out.iter_mut().zip(h).zip(magnitude).enumerate() {
                copy(span_mut(o, i, N), span(h, i, N));
                *m = at(h, i);
            }
            return;
        }
        for (i, (o, v)) in out.iter_mut().zip(self.free_variables()).enumerate() {
            let hv = row(h, *v);
            for (o, w) in o.iter_mut().zip(self.free_variables()).skip(i) {
                *o = at(hv, *w);
            }
            span_mut(o, free, ceil4(free, N)).fill(T::ZERO);
        }
        for (m, v) in magnitude.iter_mut().zip(self.free_variables()) {
            *m = at(row(h, *v), *v);
        }
        // ZᵀHZ = H_FF − WᵀC − CᵀW with C = H_BF − ½ H_BB W, one row of C and W at a time.
        let rows = self.lu.iter().zip(&self.perm).take(rank).skip(self.fixed);
        for (w, v) in rows {
            let hv = row(h, *v);
            for (c, f) in scratch.iter_mut().zip(self.free_variables()) {
                *c = at(hv, *f);
            }
            let others = self.lu.iter().zip(&self.perm).take(rank).skip(self.fixed);
            let others = others.map(|(w2, v2)| (at(hv, *v2) * T::HALF, span(w2, rank, N)));
            sub_all(head_mut(scratch, free), others);
            let w = span(w, rank, N);
            for (i, o) in out.iter_mut().take(free).enumerate() {
                let (wi, ci) = (at(w, i), at(scratch.as_slice(), i));
                if wi != T::ZERO || ci != T::ZERO {
                    sub_scaled_pair(
                        span_mut(o, i, free),
                        wi,
                        span(scratch, i, free),
                        ci,
                        span(w, i, free),
                    );
                    if let Some(m) = magnitude.get_mut(i) {
                        *m += math::abs(wi * ci);
                    }
                }
            }
        }
    }

    /// Multipliers μ of the equalities from A_Bᵀ μ = −s_B, in the order of `id`.
    pub(crate) fn multipliers(&self, s: &[T; N], mu: &mut [T; N]) {
        let rank = self.rank;
        for (m, v) in mu.iter_mut().zip(&self.perm).take(rank) {
            *m = -at(s, *v);
        }
        // Uᵀ v = −s_B
        for (k, r) in self.lu.iter().take(rank).enumerate() {
            let Some((solved, rest)) = mu.split_at_mut_checked(k + 1) else {
                break;
            };
            let Some(e) = solved.last_mut() else { break };
            *e /= at(r, k);
            if k >= self.fixed && *e != T::ZERO {
                sub_scaled(head_mut(rest, rank - k - 1), *e, span(r, k + 1, rank));
            }
        }
        // Lᵀ μ = v
        for (k, r) in self.lu.iter().take(rank).enumerate().rev() {
            let Some((before, rest)) = mu.split_at_mut_checked(k) else {
                break;
            };
            let f = rest.first().copied().unwrap_or(T::ZERO);
            if k >= self.fixed && f != T::ZERO {
                sub_scaled(before, f, head(r, k));
            }
        }
    }
}
