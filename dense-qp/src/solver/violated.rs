//! Looks at the rows that are not active, and how far the active ones are off.

use so3::{Scalar, math};

use super::{EQUALITY, Search, is_range, length_inverse, scale_inverse};
use crate::access::{at, put};
use crate::kernels::sum_sizes;
use crate::residual::worse;
use crate::workspace::POOL;
use crate::{Status, Workspace};

/// What a look at all rows found.
pub(super) enum Look {
    Feasible,
    Violated,
    Unsound,
}

/// What a look at all rows has seen so far.
struct Scan<T> {
    /// Σ|xⱼ|.
    length: T,
    /// By how much the rows of the pool are violated, as distances.
    excess: [T; POOL],
    /// Of all values: finite where they are.
    sum: T,
    is_sound: bool,
}

impl<T: Scalar> Scan<T> {
    fn new(length: T) -> Self {
        Self {
            length,
            excess: [T::ZERO; POOL],
            sum: T::ZERO,
            is_sound: length.is_finite_number(),
        }
    }
}

impl<T: Scalar, const N: usize, const M: usize> Search<'_, '_, '_, T, N, M> {
    /// Looks at every inactive row and bound and collects the most violated ones, by their distance, in the pool.
    pub(super) fn look(&mut self) -> Look {
        let mut scan = Scan::new(sum_sizes(&self.w.x));
        self.primal = T::ZERO;
        self.w.pool_len = 0;
        let p = self.p;
        let limits = p.row_lower.iter().zip(p.row_upper);
        for (i, (a, (l, u))) in p.rows.iter().zip(limits).enumerate() {
            if at(&self.w.row_state, i) != 0 {
                continue;
            }
            let v = p.row_value(i, a, &self.w.x);
            // An infinite entry may satisfy a row that has no limit on that side.
            scan.sum += v;
            // False for a NaN anywhere.
            if !(v <= *u && v >= *l) {
                self.judge(i, v, [*l, *u], &mut scan);
            }
        }
        if p.lower.is_some() || p.upper.is_some() {
            let none = ([-T::INFINITY; N], [T::INFINITY; N]);
            let lower = p.lower.unwrap_or(&none.0);
            let upper = p.upper.unwrap_or(&none.1);
            for (i, (l, u)) in lower.iter().zip(upper).enumerate() {
                let v = at(&self.w.x, i);
                if (v <= *u && v >= *l) || at(&self.w.bound_state, i) != 0 {
                    continue;
                }
                self.judge(M + i, v, [*l, *u], &mut scan);
            }
        }
        if !(scan.is_sound && scan.sum.is_finite_number()) {
            return Look::Unsound;
        }
        if self.w.pool_len > 0 {
            Look::Violated
        } else {
            Look::Feasible
        }
    }

    /// A row that is violated, or has bad numbers.
    #[inline(never)]
    fn judge(&mut self, i: usize, v: T, [l, u]: [T; 2], scan: &mut Scan<T>) {
        if !(v.is_finite_number() && is_range(l, u)) {
            scan.is_sound = false;
            return;
        }
        let (e, side) = if v - u > l - v {
            (v - u, 1)
        } else {
            (l - v, -1)
        };
        self.primal = math::max(self.primal, e);
        // Never larger than the violation relative to the row's scale. Round-off is at most that of a row whose entries are all as
        // large as the largest.
        let distance = e * length_inverse::<T, N, M>(self.p, self.w, i);
        let noise = T::of(64.0) * T::EPSILON * scan.length;
        let is_large = distance > self.s.feasibility && distance > noise;
        let limit = if side > 0 { u } else { l };
        if is_large || self.is_more_than_noise(i, e, limit, noise) {
            pool_insert(self.w, &mut scan.excess, distance, (i, side));
        }
    }

    /// Whether a violation that is small for the row's length is one.
    #[inline(never)]
    fn is_more_than_noise(&mut self, i: usize, e: T, limit: T, noise: T) -> bool {
        let inverse = scale_inverse::<T, N, M>(self.p, self.w, i);
        let scaled = e * inverse;
        scaled > self.s.feasibility
            && (scaled > noise || scaled > self.row_noise(i, limit, inverse))
    }

    /// How far x is outside a row on one side, relative to the row's scale, if that is more than `least` and than round-off.
    #[inline]
    pub(super) fn excess_above(&mut self, least: T, id: usize, side: i8) -> Option<T> {
        let inverse = scale_inverse::<T, N, M>(self.p, self.w, id);
        let scaled = self.excess(id, side) * inverse;
        (scaled > least && self.is_violated(scaled, id, side)).then_some(scaled)
    }

    /// Whether x is outside a row by more than round-off, `scaled` being by how much, relative to the row's scale.
    fn is_violated(&mut self, scaled: T, id: usize, side: i8) -> bool {
        let inverse = scale_inverse::<T, N, M>(self.p, self.w, id);
        let (l, u) = self.p.limits(id);
        let limit = if side > 0 { u } else { l };
        scaled > self.row_noise(id, limit, inverse)
    }

    /// How far x is from the limits of the active rows and the equalities, relative to their scale;
    /// NaN if a number is bad. Completes `primal`, and sets `toll` and `complementarity`.
    pub(super) fn drift(&mut self) -> T {
        let mut drift = T::ZERO;
        self.toll = T::ZERO;
        self.complementarity = T::ZERO;
        for k in 0..self.w.basis.len {
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            let e = self.excess(id, side);
            self.primal = worse(self.primal, e);
            let worth = math::abs(at(&self.w.lambda, k) * e);
            self.toll += worth;
            self.complementarity = worse(self.complementarity, worth);
            drift = worse(
                drift,
                math::abs(e) * scale_inverse::<T, N, M>(self.p, self.w, id),
            );
        }
        let equalities = if self.w.elimination.has_rows { M } else { 0 };
        for i in 0..equalities {
            if at(&self.w.row_state, i) == EQUALITY {
                let e = math::abs(self.excess(i, 1));
                self.primal = worse(self.primal, e);
                drift = worse(drift, e * scale_inverse::<T, N, M>(self.p, self.w, i));
            }
        }
        drift
    }

    /// The row to enter next, on which side, and by how much x exceeds it: the most violated one of the pool, or of all rows when the
    /// pool is used up.
    pub(super) fn next(&mut self) -> Result<Option<(usize, i8, T)>, Status> {
        let (mut worst, mut found) = (T::ZERO, None);
        for k in 0..self.w.pool_len {
            let (id, side) = at(&self.w.pool, k);
            if self.w.state(id) != 0 {
                continue;
            }
            let excess = self.excess(id, side);
            let distance = excess * length_inverse::<T, N, M>(self.p, self.w, id);
            if distance > worst {
                (worst, found) = (distance, Some((id, side, excess)));
            }
        }
        if let Some((id, side, excess)) = found {
            let (l, u) = self.p.limits(id);
            let inverse = length_inverse::<T, N, M>(self.p, self.w, id);
            if worst > self.most_noise(if side > 0 { u } else { l }, inverse) {
                return Ok(found);
            }
            let scaled = excess * scale_inverse::<T, N, M>(self.p, self.w, id);
            if scaled > self.s.feasibility && self.is_violated(scaled, id, side) {
                return Ok(found);
            }
        }
        match self.look() {
            Look::Unsound => Err(Status::Numerical),
            Look::Feasible => Ok(None),
            Look::Violated => {
                let (id, side) = at(&self.w.pool, 0);
                Ok(Some((id, side, self.excess(id, side))))
            }
        }
    }
}

/// Inserts into the list sorted by excess, which keeps the worst.
fn pool_insert<T: Scalar, const N: usize, const M: usize>(
    w: &mut Workspace<T, N, M>,
    excess: &mut [T; POOL],
    e: T,
    entry: (usize, i8),
) {
    let (mut e, mut entry) = (e, entry);
    for (known, slot) in excess.iter_mut().zip(&mut w.pool).take(w.pool_len) {
        if e > *known {
            core::mem::swap(known, &mut e);
            core::mem::swap(slot, &mut entry);
        }
    }
    if w.pool_len < Workspace::<T, N, M>::LISTED {
        put(excess, w.pool_len, e);
        put(&mut w.pool, w.pool_len, entry);
        w.pool_len += 1;
    }
}
