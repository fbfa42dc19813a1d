//! Equality rows and fixed variables, eliminated before the search.
//!
//! With the rows A_E x = b of rank r, and the columns ordered as the free ones F and r basic ones B,
//! a row-wise LU factorisation A_B = L U (columns chosen as pivots) gives
//!
//! x_B = p − W x_F,  W = A_B⁻¹ A_F,  p = A_B⁻¹ b,
//!
//! so the free variables y = x_F span the null space and every row a reduces to
//! a_y = a_F − Wᵀ a_B. Fixed variables come first: their rows of U are unit vectors and their rows
//! of W are zero. A row that depends on earlier ones is dropped when it agrees with them.

use crate::access::{at, copy, head, put, row};
use crate::access::{row_mut, span, span_mut};
use crate::kernels::{ceil4, dots, floor4, largest_square, max_abs};
use crate::kernels::{sub_rows, sub_scaled, sum_rows};
use crate::problem::Problem;
use crate::settings::row_tolerance;
use so3::{Scalar, math};

mod hessian;

#[derive(Clone, Debug)]
pub(crate) struct Elimination<T, const N: usize> {
    /// Permuted columns: the free ones, then the basic ones from the last to the first. Row k: W, then U down to column N−1−k of its
    /// own pivot, then multipliers of L.
    lu: [[T; N]; N],
    /// 1 / U_kk.
    inverse: [T; N],
    /// Reduced right-hand side, then p.
    rhs: [T; N],
    /// Variable of each permuted column.
    perm: [usize; N],
    /// Constraint (row i, or M + variable) behind each row of `lu`.
    pub(crate) id: [usize; N],
    /// Number of fixed variables.
    fixed: usize,
    /// Rank r of the equalities.
    pub(crate) rank: usize,
    /// Whether a row is an equality.
    pub(crate) has_rows: bool,
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
            id: [0; N],
            fixed: 0,
            rank: 0,
            has_rows: false,
        }
    }

    /// Number of free variables.
    pub(crate) fn free(&self) -> usize {
        N - self.rank.min(N)
    }

    /// Variables of the free columns.
    #[inline(always)]
    pub(crate) fn free_variables(&self) -> &[usize] {
        head(&self.perm, self.free())
    }

    /// Whether a free variable moves others: a row that is not merely fixed was eliminated.
    #[inline(always)]
    pub(crate) fn has_basic(&self) -> bool {
        self.rank > self.fixed
    }

    /// Factorises the equalities of `problem` (rows and bounds with equal limits). `feasibility` is
    /// the distance up to which a dependent row may contradict the others; the flags say whether there are any such bounds and rows.
    pub(crate) fn build<const M: usize>(
        &mut self,
        problem: &Problem<'_, T, N, M>,
        [has_fixed, has_rows]: [bool; 2],
        feasibility: T,
        scratch: &mut [T; N],
    ) -> Result<(), Contradiction> {
        self.rank = 0;
        self.fixed = 0;
        self.has_rows = has_rows;
        for (i, p) in self.perm.iter_mut().enumerate() {
            *p = i;
        }
        if let (true, Some(lower), Some(upper)) = (has_fixed, problem.lower, problem.upper) {
            for (i, (l, u)) in lower.iter().zip(upper).enumerate() {
                if l == u && l.is_finite_number() {
                    self.fix(i, M + i, *l);
                }
            }
        }
        self.fixed = self.rank;
        let (mut scales, mut shares) = ([T::ZERO; N], [T::ZERO; N]);
        if has_rows {
            for (scale, p) in scales.iter_mut().zip(self.free_variables()) {
                *scale = T::ONE / (T::ONE + at(row(problem.hessian, *p), *p));
            }
        }
        let limits = problem.row_lower.iter().zip(problem.row_upper);
        for (i, (l, u)) in limits.enumerate().take(if has_rows { M } else { 0 }) {
            if l == u && l.is_finite_number() {
                let scratch = [&mut *scratch, &mut scales, &mut shares];
                self.insert(problem, i, *l, feasibility, scratch)?;
            }
        }
        if self.rank > 0 {
            self.finish(scratch);
        }
        Ok(())
    }

    /// Row k and basic variable k of those that are not merely fixed.
    fn basic(&self) -> impl Iterator<Item = (&[T; N], usize)> {
        let rows = self.lu.iter().zip(self.perm.iter().rev());
        rows.map(|(row, v)| (row, *v))
            .take(self.rank)
            .skip(self.fixed)
    }

    /// Their variables.
    fn basic_variables(&self) -> impl Iterator<Item = &usize> {
        span(&self.perm, self.free(), N - self.fixed.min(N))
            .iter()
            .rev()
    }

    /// Their rows.
    fn basic_rows(&self) -> &[[T; N]] {
        span(&self.lu, self.fixed, self.rank)
    }

    fn fix(&mut self, variable: usize, id: usize, value: T) {
        let k = self.rank;
        let column = if at(&self.perm, variable) == variable {
            Some(variable)
        } else {
            self.perm.iter().position(|v| *v == variable)
        };
        let (Some(column), Some(last)) = (column, self.free().checked_sub(1)) else {
            return;
        };
        let r = row_mut(&mut self.lu, k);
        r.fill(T::ZERO);
        put(r, last, T::ONE);
        put(&mut self.rhs, k, value);
        put(&mut self.id, k, id);
        if column < N && last < N {
            self.perm.swap(column, last);
        }
        self.rank += 1;
    }

    fn insert<const M: usize>(
        &mut self,
        problem: &Problem<'_, T, N, M>,
        i: usize,
        limit: T,
        feasibility: T,
        [work, scales, shares]: [&mut [T; N]; 3],
    ) -> Result<(), Contradiction> {
        let a = row(problem.rows, i);
        for (w, p) in work.iter_mut().zip(&self.perm) {
            *w = at(a, *p);
        }
        let (rank, free) = (self.rank, self.free());
        let rhs = self.eliminate(work, shares, limit);
        // The pivot is the entry that is largest for variables measured by their own curvature; those that are taken have no scale.
        let open = head(work, free);
        let best = largest_square(open, head(scales, free));
        let mut squares = open.iter().zip(&*scales).map(|(w, scale)| *w * *w * *scale);
        let pivot = squares.position(|square| square == best).unwrap_or(0);
        let size = max_abs(a);
        let least = row_tolerance::<T>() * size;
        let is_left = |w: T| w > least;
        let is_new =
            is_left(math::abs(at(work.as_slice(), pivot))) || is_left(max_abs(head(work, free)));
        if rank >= N || !is_new {
            let scale = if size > T::ZERO { size } else { T::ONE };
            let noise = self.noise(shares, size, limit);
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
        let last = N - 1 - rank;
        if pivot < last {
            self.perm.swap(last, pivot);
            scales.swap(last, pivot);
            for r in self.lu.iter_mut().take(rank + 1) {
                r.swap(last, pivot);
            }
        }
        put(scales, last, T::ZERO);
        self.rank += 1;
        Ok(())
    }

    /// Round-off of what [`Elimination::eliminate`] leaves of a limit: a share that cancels keeps that of the row's size. No units of earlier rows matter.
    #[cold]
    fn noise(&self, shares: &[T; N], size: T, limit: T) -> T {
        let mut largest = math::abs(limit);
        for (k, (share, rhs)) in shares.iter().zip(&self.rhs).take(self.rank).enumerate() {
            let of_pivot = if k < self.fixed {
                T::ZERO
            } else {
                size * math::abs(at(&self.inverse, k))
            };
            largest += math::max(math::abs(*share), of_pivot) * math::abs(*rhs);
        }
        T::of(256.0) * T::EPSILON * largest
    }

    /// Takes the earlier rows out of `work`, whose right-hand side is `limit`; returns what is left of that. Their shares stand in the
    /// columns of their pivots then.
    fn eliminate(&self, work: &mut [T; N], shares: &mut [T; N], limit: T) -> T {
        let (mut rhs, free) = (limit, self.free());
        // Columns that a sweep over whole blocks would have to share with pivots go with these.
        let swept = floor4(free);
        let rows = head(&self.lu, self.rank).iter().zip(&self.rhs);
        for ((k, (r, c)), share) in rows.enumerate().zip(&mut *shares) {
            let Some((open, [at_pivot, ..])) = work.split_at_mut_checked(N - 1 - k) else {
                break;
            };
            if k >= self.fixed && *at_pivot != T::ZERO {
                *at_pivot *= at(&self.inverse, k);
                let columns = N - 1 - k;
                let open = span_mut(open, swept, columns).iter_mut();
                for (w, r) in open.zip(span(r, swept, columns)) {
                    *w -= *at_pivot * *r;
                }
            }
            *share = *at_pivot;
            rhs -= *at_pivot * *c;
        }
        let rows = span(&self.lu, self.fixed, self.rank);
        sub_rows(work, span(shares, self.fixed, self.rank), rows, 0, swept);
        rhs
    }

    /// U₁₁⁻¹ on the part of the free columns and on the right-hand side.
    fn finish(&mut self, work: &mut [T; N]) {
        let (rank, free) = (self.rank, self.free());
        let mut shares = [T::ZERO; N];
        for k in (self.fixed..rank).rev() {
            let Some((upper, lower)) = self.lu.split_at_mut_checked(k + 1) else {
                break;
            };
            let Some(r) = upper.last_mut() else { break };
            let (mut p, inverse) = (at(&self.rhs, k), at(&self.inverse, k));
            let of_row = span(r, free, N - 1 - k).iter().rev();
            for ((share, u), known) in
                shares
                    .iter_mut()
                    .zip(of_row)
                    .zip(span(&self.rhs, k + 1, rank))
            {
                *share = *u;
                p -= *u * *known;
            }
            // Beside the free columns stand those of U.
            *work = *r;
            sub_rows(work, head(&shares, rank - k - 1), lower, 0, ceil4(free, N));
            for (w, x) in r.iter_mut().zip(work.iter()).take(free) {
                *w = *x * inverse;
            }
            put(&mut self.rhs, k, p * inverse);
        }
    }

    /// x = (p, 0): the point with all free variables at zero.
    pub(crate) fn particular(&self, x: &mut [T; N]) {
        x.fill(T::ZERO);
        let basic = self.rhs.iter().zip(self.perm.iter().rev());
        for (p, v) in basic.take(self.rank) {
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
        let free = self.free();
        for (y, v) in y.iter_mut().zip(self.free_variables()) {
            *y = at(a, *v);
        }
        span_mut(y, free, N).fill(T::ZERO);
        if self.has_basic() {
            let mut shares = [T::ZERO; N];
            for (f, v) in shares.iter_mut().zip(self.basic_variables()) {
                *f = at(a, *v);
            }
            let used = |f: &T| *f != T::ZERO;
            let first = shares.iter().position(used).unwrap_or(0);
            let end = shares.iter().rposition(used).map_or(0, |last| last + 1);
            let rows = span(self.basic_rows(), first, end);
            sub_rows(y, span(&shares, first, end), rows, 0, ceil4(free, N));
            span_mut(y, free, ceil4(free, N)).fill(T::ZERO);
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
        for (w, v) in self.basic() {
            let f = at(t, v);
            let shares = y.iter_mut().zip(head(w, self.free()));
            shares.for_each(|(y, w)| *y += math::abs(f * *w));
        }
    }

    /// The displacement z of all variables whose free part is y, `used` entries and zeros beside them: z_F = y, z_B = −W y.
    #[inline]
    pub(crate) fn expand(&self, y: &[T; N], used: usize, z: &mut [T; N]) {
        if self.rank == 0 {
            *z = *y;
            return;
        }
        for (y, v) in y.iter().zip(self.free_variables()) {
            put(z, *v, *y);
        }
        for v in span(&self.perm, N - self.fixed.min(N), N) {
            put(z, *v, T::ZERO);
        }
        if self.has_basic() {
            let mut moved = [T::ZERO; N];
            dots(&mut moved, self.basic_rows(), y, [0, ceil4(used, N)]);
            for (d, v) in moved.iter().zip(self.basic_variables()) {
                put(z, *v, -*d);
            }
        }
    }

    /// Wᵀ into the first rows of `out`.
    pub(crate) fn transpose(&self, out: &mut [[T; N]; N]) {
        let end = ceil4(self.rank - self.fixed, N);
        for (i, out) in out.iter_mut().enumerate().take(self.free()) {
            span_mut(out, self.rank - self.fixed, end).fill(T::ZERO);
            for (e, row) in out.iter_mut().zip(self.basic_rows()) {
                *e = at(row, i);
            }
        }
    }

    /// [`Elimination::expand`] of the first entries y by Wᵀ as [`Elimination::transpose`] leaves it, with room for what it moves: for many y.
    #[inline]
    pub(crate) fn expand_by(
        &self,
        moves: Option<(&[[T; N]; N], &mut [T; N])>,
        y: &[T],
        z: &mut [T; N],
    ) {
        let (moving, others) = self
            .free_variables()
            .split_at_checked(y.len())
            .unwrap_or((&[], &[]));
        for (y, v) in y.iter().zip(moving) {
            put(z, *v, *y);
        }
        for v in others
            .iter()
            .chain(span(&self.perm, N - self.fixed.min(N), N))
        {
            put(z, *v, T::ZERO);
        }
        if let Some((transposed, moved)) = moves {
            sum_rows(moved, y, transposed, ceil4(self.rank - self.fixed, N));
            for (d, v) in moved.iter().zip(self.basic_variables()) {
                put(z, *v, -*d);
            }
        }
    }

    /// x_F ← y, x_B ← 0.
    pub(crate) fn scatter(&self, y: &[T; N], x: &mut [T; N]) {
        x.fill(T::ZERO);
        for (y, v) in y.iter().zip(self.free_variables()) {
            put(x, *v, *y);
        }
    }

    /// Completes a displacement whose free part is set: z_B ← −W z_F. `y` is scratch.
    pub(crate) fn complete(&self, z: &mut [T; N], y: &mut [T; N]) {
        self.gather(z, y);
        self.expand(y, self.free(), z);
    }

    /// y ← x_F, with zeros beside it.
    fn gather(&self, x: &[T; N], y: &mut [T; N]) {
        y.fill(T::ZERO);
        for (y, v) in y.iter_mut().zip(self.free_variables()) {
            *y = at(x, *v);
        }
    }

    /// x_B ← p − W x_F.
    pub(crate) fn restore(&self, x: &mut [T; N], y: &mut [T; N]) {
        if !self.has_basic() {
            return;
        }
        self.gather(x, y);
        let mut moved = [T::ZERO; N];
        dots(&mut moved, self.basic_rows(), y, [0, ceil4(self.free(), N)]);
        let known = span(&self.rhs, self.fixed, self.rank);
        for ((d, p), v) in moved.iter().zip(known).zip(self.basic_variables()) {
            put(x, *v, *p - *d);
        }
    }

    /// Multipliers μ of the equalities from A_Bᵀ μ = −s_B, in the order of `id`.
    pub(crate) fn multipliers(&self, s: &[T; N], mu: &mut [T; N]) {
        let free = self.free();
        // In the order of the columns first.
        for (m, v) in mu.iter_mut().zip(&self.perm).skip(free) {
            *m = -at(s, *v);
        }
        // Uᵀ v = −s_B
        for (k, r) in self.lu.iter().take(self.rank).enumerate() {
            let Some((rest, solved)) = mu.split_at_mut_checked(N - 1 - k) else {
                break;
            };
            let Some(e) = solved.first_mut() else { break };
            *e /= at(r, N - 1 - k);
            if k >= self.fixed && *e != T::ZERO {
                sub_scaled(
                    span_mut(rest, free, N - 1 - k),
                    *e,
                    span(r, free, N - 1 - k),
                );
            }
        }
        // Lᵀ μ = v
        for (k, r) in self.lu.iter().take(self.rank).enumerate().rev() {
            let Some((before, after)) = mu.split_at_mut_checked(N - k) else {
                break;
            };
            let f = before.last().copied().unwrap_or(T::ZERO);
            if k >= self.fixed && f != T::ZERO {
                sub_scaled(after, f, span(r, N - k, N));
            }
        }
        mu.reverse();
    }
}

#[cfg(test)]
mod tests {
    use super::Elimination;
    use crate::Problem;

    /// Of a single entry nothing cancels: the terms of what the equalities make of it are that, without signs.
    #[test]
    fn terms_of_a_single_entry_are_what_it_reduces_to() {
        const INF: f64 = f64::INFINITY;
        let a = [[3.0, 1.0, 0.0, -2.0, 1.0], [0.5, 0.0, 4.0, 1.0, -3.0]];
        let (lower, upper) = ([-INF, 1.0, -INF, -INF, -INF], [INF, 1.0, INF, INF, INF]);
        let p = Problem::new(&[[1.0; 5]; 5], &[0.0; 5], &a, &[1.0; 2], &[1.0; 2])
            .with_bounds(&lower, &upper);
        let (mut e, mut y, mut sizes) = (Elimination::new(), [0.0; 5], [0.0; 5]);
        assert!(e.build(&p, [true; 2], 1e-9, &mut y).is_ok());
        assert_eq!((e.fixed, e.rank), (1, 3));
        for i in 0..5 {
            let mut t = [0.0; 5];
            t[i] = 2.0;
            e.reduce(&t, &mut y);
            e.reduce_sizes(&t, &mut sizes);
            assert_eq!(sizes[..2], y.map(f64::abs)[..2], "{i}");
        }
    }
}
