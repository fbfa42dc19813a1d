//! Rows that enter and leave the active set.

use so3::{Scalar, math};

use super::violated::Look;
use super::{Search, is_range, length_inverse, scale_inverse};
use crate::Status;
use crate::access::{at, put};
use crate::kernels::max_abs;
use crate::settings::row_tolerance;

/// How the search for a point that satisfies all rows ended.
pub(super) enum Pass {
    Feasible,
    Stop(Status),
}

impl<T: Scalar, const N: usize, const M: usize> Search<'_, '_, '_, T, N, M> {
    /// [`Search::search`] from the point without active rows, with the `seeds` active rows that the last solve left. Where this start does
    /// not look like its own, rows have moved, as in a receding horizon, and those of old would only have to leave again.
    pub(super) fn start(&mut self, seeds: usize) -> Pass {
        match self.look() {
            Look::Unsound => return Pass::Stop(Status::Numerical),
            Look::Feasible => return Pass::Feasible,
            Look::Violated => {}
        }
        if self.is_like_last() && seeds > 0 {
            self.recall(seeds);
            self.drop_negative();
            if self.has_pulling() {
                return Pass::Stop(Status::Limit);
            }
        }
        self.search()
    }

    /// Whether the most violated rows are those of the last solve, violated by as much, to a tenth. Remembers them for the next.
    fn is_like_last(&mut self) -> bool {
        let now = core::array::from_fn(|k| {
            if k >= self.w.pool_len {
                return (0, 0, T::ZERO);
            }
            let (id, side) = at(&self.w.pool, k);
            (id, side, self.excess(id, side))
        });
        let last = core::mem::replace(&mut self.w.first, now);
        let mut pairs = now.iter().map(|(id, side, excess)| {
            let same = last.iter().find(|row| (row.0, row.1) == (*id, *side));
            same.is_some_and(|row| math::abs(row.2 - *excess) <= T::of(0.1) * *excess)
        });
        pairs.all(|is_same| is_same)
    }

    /// Enters violated rows until none is left.
    pub(super) fn search(&mut self) -> Pass {
        loop {
            match self.next() {
                Ok(Some((id, side, excess))) => {
                    if let Some(status) = self.admit(id, side, excess) {
                        return Pass::Stop(status);
                    }
                }
                Ok(None) => return Pass::Feasible,
                Err(status) => return Pass::Stop(status),
            }
        }
    }

    /// Enters rows of the last active set, `seeds` of them: always the most violated one, and none that is not, so that a wrong guess costs
    /// a look at its row. Multipliers may fall below zero on the way: most rise again with the rows that follow. Those not yet read
    /// stand behind the place of the next active row, since at most one enters per row read.
    fn recall(&mut self, seeds: usize) {
        for first in 0..seeds {
            let (mut worst, mut found) = (self.s.feasibility, None);
            for k in first..seeds {
                let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
                if self.is_seed(id, side)
                    && let Some(scaled) = self.excess_above(worst, id, side)
                {
                    (worst, found) = (scaled, Some(k));
                }
            }
            let Some(k) = found else { return };
            if self.is_at_cap() {
                return;
            }
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            let (passed, its_side) = (at(&self.w.id, first), at(&self.w.side, first));
            put(&mut self.w.id, k, passed);
            put(&mut self.w.side, k, its_side);
            self.steps += 1;
            self.prepare(id, side);
            let t = self.excess(id, side) / self.w.candidate.free;
            if self.w.candidate.free > T::ZERO && t.is_finite_number() {
                self.answer();
                self.turn();
                self.advance(t);
                self.enter(id, side, t);
            }
        }
    }

    /// Whether a remembered row is not active yet and still has its limit.
    fn is_seed(&self, id: usize, side: i8) -> bool {
        let (l, u) = self.p.limits(id);
        let limit = if side > 0 { u } else { l };
        self.w.state(id) == 0 && is_range(l, u) && limit.is_finite_number()
    }

    /// Moves toward the row that x exceeds by `excess` until it is met and enters; rows whose multipliers reach zero on the way leave. Returns why the
    /// search ends, if it does.
    fn admit(&mut self, id: usize, side: i8, mut excess: T) -> Option<Status> {
        self.prepare(id, side);
        let mut lambda = T::ZERO;
        loop {
            if self.is_at_cap() {
                return Some(Status::Limit);
            }
            self.iterations += 1;
            self.steps += 1;
            self.answer();
            if self.is_dependent_after_all() {
                self.w.candidate.free = T::ZERO;
            }
            self.turn();
            let d = self.w.candidate.free;
            let full = if d > T::ZERO { excess / d } else { T::INFINITY };
            let (t, blocking) = self.first_zero(full);
            if full <= t {
                if !full.is_finite_number() {
                    let status = self.refuse(id, side);
                    if status.is_some() {
                        return status;
                    }
                    continue;
                }
                self.advance(full);
                self.enter(id, side, lambda + full);
                return None;
            }
            let Some(k) = blocking else {
                return Some(Status::Numerical);
            };
            self.advance(t);
            lambda += t;
            self.leave(k);
            excess = self.excess(id, side);
        }
    }

    /// Whether a candidate in doubt is taken for one that depends on the active rows. Where none of those can leave for it, that says that
    /// they contradict it: if no proof confirms so, a correction of the point may show that it was never violated. Twice; then it enters.
    fn is_dependent_after_all(&mut self) -> bool {
        let w = &*self.w;
        if w.candidate.free <= T::ZERO || !w.basis.is_in_doubt(&w.candidate, &w.vec_b) {
            return false;
        }
        if self.first_zero(T::INFINITY).1.is_some() {
            return true;
        }
        self.doubts += 1;
        self.doubts <= 2
    }

    /// What comes of a row that depends on the active ones and contradicts them. Though nothing confirms that, the search would end here: where
    /// it would for good, the row enters with what the active ones leave of it, and there is no status.
    #[inline(never)]
    fn refuse(&mut self, id: usize, side: i8) -> Option<Status> {
        let status = self.conflict(id, side);
        let w = &mut *self.w;
        let enters =
            self.insists && w.candidate.free <= T::ZERO && w.basis.insist(&mut w.candidate);
        (status == Status::Infeasible || !enters).then_some(status)
    }

    /// How far the entering multiplier may grow until the first of the others reaches zero, and which, if that is below `full`; from r
    /// in `vec_b`. Changes are told from round-off as forces, |rₖ| max|aₖ|: rows in other units have other multipliers. Most steps
    /// are full, and then it does not matter which changes are round-off.
    fn first_zero(&mut self, full: T) -> (T, Option<usize>) {
        let mut others = self.w.lambda.iter().zip(&self.w.vec_b);
        let stays = |(l, r): (&T, &T)| *r <= T::ZERO || full * *r <= *l;
        if full < T::INFINITY && others.by_ref().take(self.w.basis.len).all(stays) {
            return (T::INFINITY, None);
        }
        let first = self.first_above(T::ZERO);
        if full <= first.0 {
            return first;
        }
        let mut largest = T::ZERO;
        for k in 0..self.w.basis.len {
            let r = at(&self.w.vec_b, k);
            largest = math::max(largest, math::abs(r) / self.active_scale(k));
        }
        self.first_above(T::of(8.0) * T::EPSILON * largest)
    }

    /// The first multiplier to reach zero of those that change by a force of more than `noise`, and when.
    fn first_above(&mut self, noise: T) -> (T, Option<usize>) {
        let (mut t, mut blocking) = (T::INFINITY, None);
        for k in 0..self.w.basis.len {
            let (l, r) = (at(&self.w.lambda, k), at(&self.w.vec_b, k));
            if r > T::ZERO && (noise == T::ZERO || r > noise * self.active_scale(k)) {
                let ratio = math::max(l, T::ZERO) / r;
                if ratio < t {
                    (t, blocking) = (ratio, Some(k));
                }
            }
        }
        (t, blocking)
    }

    /// 1 / max|aₖ| of active row k.
    #[inline(always)]
    pub(super) fn active_scale(&mut self, k: usize) -> T {
        let id = at(&self.w.id, k);
        scale_inverse::<T, N, M>(self.p, self.w, id)
    }

    /// Coordinates of a row in the basis.
    pub(super) fn prepare(&mut self, id: usize, side: i8) {
        let w = &mut *self.w;
        w.basis.prepare(&w.factor, &w.elimination);
        let (basis, d) = (&w.basis, &mut w.candidate.d);
        match self.p.rows.get(id) {
            Some(row) if self.p.spans.is_none() => basis.coordinates(row, d),
            // Outside of its span nothing of a row is read.
            Some(_) => {
                w.vec_a.fill(T::ZERO);
                self.p.add_row(id, T::ONE, &mut w.vec_a);
                basis.coordinates(&w.vec_a, d);
            }
            None => basis.coordinates_of_unit(id - M, d),
        }
        if side < 0 {
            for d in d {
                *d = -*d;
            }
        }
        let square = w.basis.project(&mut w.candidate);
        if w.elimination.rank > 0 && self.depends_on_equalities(id, square) {
            self.w.candidate.d.fill(T::ZERO);
            self.w.candidate.free = T::ZERO;
        }
    }

    /// Whether what the equalities leave of a row is round-off, not a row; |d|² is `square`.
    fn depends_on_equalities(&mut self, id: usize, square: T) -> bool {
        let w = &mut *self.w;
        // Whose coordinates are larger than such a row can have needs no closer look. False for NaN.
        let longest = row_tolerance::<T>() / length_inverse::<T, N, M>(self.p, w, id);
        if square > T::of(4.0) * w.basis.most() * longest * longest {
            return false;
        }
        let least = row_tolerance::<T>() / scale_inverse::<T, N, M>(self.p, w, id);
        w.vec_a.fill(T::ZERO);
        self.p.add_row(id, T::ONE, &mut w.vec_a);
        let row = w.vec_a;
        w.elimination.reduce(&row, &mut w.vec_a);
        max_abs(&w.vec_a) <= least
    }

    /// r (in `vec_b`) of the candidate.
    pub(super) fn answer(&mut self) {
        let w = &mut *self.w;
        w.basis.solve(&w.candidate.d, &mut w.vec_b);
    }

    /// z (in `step`) of the candidate.
    pub(super) fn turn(&mut self) {
        let w = &mut *self.w;
        if w.candidate.free > T::ZERO {
            w.basis.direction(w.basis.len, &w.candidate.d, &mut w.step);
        } else {
            w.step.fill(T::ZERO);
        }
    }

    /// x ← x − t z, λ_W ← λ_W − t r.
    pub(super) fn advance(&mut self, t: T) {
        let w = &mut *self.w;
        crate::kernels::sub_scaled(&mut w.x, t, &w.step);
        crate::kernels::sub_scaled(
            crate::access::head_mut(&mut w.lambda, w.basis.len),
            t,
            &w.vec_b,
        );
    }

    pub(super) fn enter(&mut self, id: usize, side: i8, lambda: T) {
        let w = &mut *self.w;
        let k = w.basis.len;
        w.basis.append(&mut w.candidate, &w.step, &w.vec_b);
        put(&mut w.id, k, id);
        put(&mut w.side, k, side);
        put(&mut w.lambda, k, lambda);
        w.set_state(id, side);
    }

    /// Row `k` of the active set leaves; the candidate is carried over.
    pub(super) fn leave(&mut self, k: usize) {
        let w = &mut *self.w;
        let id = at(&w.id, k);
        w.set_state(id, 0);
        let len = w.basis.len;
        w.basis.remove(k, &mut w.candidate);
        for i in k + 1..len {
            let (id, side, lambda) = (at(&w.id, i), at(&w.side, i), at(&w.lambda, i));
            put(&mut w.id, i - 1, id);
            put(&mut w.side, i - 1, side);
            put(&mut w.lambda, i - 1, lambda);
        }
    }
}
