//! Equalities of a node in the recursion: collected backwards, their multipliers recovered forwards.

use crate::eliminate::{Carried, Elimination, Pivots, Row, Source};
use crate::kernel::{add_product, add_scaled, dot, largest};
use crate::linearised::Linearised;
use crate::project::{Work, minimise};
use crate::stage::Node;
use so3::Scalar;
use so3::math::max;

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Node<T, NX, NU, NI> {
    /// Least over the controls under the equalities of this node and those its successor hands back; the
    /// rows that no control meets are left to be handed on.
    ///
    /// Returns false if the quadratic has no minimum under them.
    #[inline(always)]
    #[must_use]
    pub(crate) fn minimise(
        &mut self,
        d: &impl Linearised<T, NX, NU>,
        work: &mut Work<T, NX, NU>,
        next: Option<&Carried<T, NX>>,
        tolerance: T,
    ) -> bool {
        let n = self.dims.controls.min(NU);
        self.riccati.carried.count = 0;
        self.riccati.pivots.clear();
        let with_rows = self.has_equalities(next);
        if n == 0 && !self.has_equalities(None) {
            // Nothing to decide: rows pass through, and those that depend are found further back.
            if let Some(next) = next {
                self.pass_back(d, next);
            }
            return true;
        }
        if with_rows {
            let mut free = [false; NU];
            for free in free.iter_mut().take(n) {
                *free = true;
            }
            work.elimination.start(n, free, tolerance);
            work.whiten(n, &mut self.riccati.pivots.whitening);
            self.insert_rows(d, next, &mut work.elimination);
        }
        let r = &mut self.riccati;
        let left = (&mut r.hessian, &mut r.gradient);
        let law = (&mut r.gain, &mut r.feedforward);
        if with_rows {
            work.elimination.finish(&mut r.carried, &mut r.pivots);
            n == 0 || work.minimise_under(left, &r.pivots.whitening, n, law)
        } else {
            minimise(left, &mut work.q.xu, &mut work.q.uu, &mut work.q.u, n, law)
        }
    }

    /// Whether there are own equalities or rows handed back by `next`.
    #[inline(always)]
    pub(crate) fn has_equalities(&self, next: Option<&Carried<T, NX>>) -> bool {
        let own =
            self.elastic == T::ZERO && (0..self.row_count()).any(|i| self.rows.is_equality(i));
        own || next.is_some_and(|next| next.count > 0)
    }

    /// Puts the rows of the successor through dynamics without controls.
    #[inline(never)]
    fn pass_back(&mut self, d: &impl Linearised<T, NX, NU>, next: &Carried<T, NX>) {
        let rows = self.row_count();
        let carried = &mut self.riccati.carried;
        carried.pass(next, rows, |h, x| {
            d.pull_back_x(h, x);
            dot(h, &self.values.gap)
        });
    }

    #[inline(never)]
    fn insert_rows(
        &mut self,
        d: &impl Linearised<T, NX, NU>,
        next: Option<&Carried<T, NX>>,
        to: &mut Elimination<T, NX, NU>,
    ) {
        let (rows, n) = (self.row_count(), self.dims.controls.min(NU));
        let pivots = &mut self.riccati.pivots;
        for i in 0..rows {
            if !self.rows.is_equality(i) {
                continue;
            }
            let lower = self.rows.lower[i];
            let (x, u) = d.row(i, self.dims.parts(i));
            let scale = max(largest(&x), largest(&u));
            let constant = self.values.rows[i] - lower;
            to.insert(Row::new(x, u, constant, scale, i as Source), pivots);
        }
        let Some(next) = next.filter(|next| next.count > 0) else {
            return;
        };
        let authority = d.authority(n);
        let handed = next.rows.iter().zip(&next.residual).take(next.count);
        for (j, (h, residual)) in handed.enumerate() {
            let (mut x, mut u) = ([T::ZERO; NX], [T::ZERO; NU]);
            d.pull_back_x(h, &mut x);
            d.pull_back_u(h, &mut u);
            let constant = *residual + dot(h, &self.values.gap);
            let source = rows.saturating_add(j) as Source;
            to.insert(
                Row::new(x, u, constant, largest(h) * authority, source),
                pivots,
            );
        }
    }

    /// Multipliers of the equalities after the full step, and those of the rows `next` handed back.
    ///
    /// `costate` is the gradient of the successor's cost-to-go without its rows. Needs the multipliers of
    /// the rows this node handed back, and the steps of this node.
    #[expect(
        clippy::needless_range_loop,
        reason = "so that the compiler sees that the index is below NI"
    )]
    #[inline(never)]
    pub(crate) fn recover_multipliers(
        &mut self,
        d: &impl Linearised<T, NX, NU>,
        costate: &[T; NX],
        next: Option<&mut Carried<T, NX>>,
        shift: T,
        mu: T,
    ) {
        let rows = self.row_count();
        let mut own = [T::ZERO; NI];
        let mut handed = [T::ZERO; NX];
        let mut write = |source: Source, y: T| {
            let i = usize::from(source);
            let slot = if i < rows {
                own.get_mut(i)
            } else {
                handed.get_mut(i.saturating_sub(rows))
            };
            if let Some(slot) = slot {
                *slot = y;
            }
        };
        self.riccati.carried.multipliers(&mut write);
        if !self.riccati.pivots.is_empty() {
            // Gradient in the controls: everything but the pivot rows, whose multipliers are still zero.
            let mut gradient = *d.cost_u();
            add_scaled(&mut gradient, shift, &self.step.control);
            d.add_curvature(&self.step.state, &self.step.control, &mut gradient);
            let mut costate = *costate;
            if let Some(next) = &next {
                for (row, y) in next.rows.iter().zip(&handed).take(next.count) {
                    add_scaled(&mut costate, *y, row);
                }
            }
            d.pull_back_u(&costate, &mut gradient);
            let first = self.dims.state_rows;
            for i in first..rows {
                let y = if self.rows.is_equality(i) {
                    own[i]
                } else {
                    // The condensed multiplier at the full step.
                    let (weight, target) = self.condensed(i, mu);
                    let change = self.step.rows[i] - (self.values.rows[i] - self.rows.slack[i]);
                    target + weight * change
                };
                if y != T::ZERO {
                    d.add_row_u(i, y, &mut gradient);
                }
            }
            let n = self.dims.controls.min(NU);
            self.riccati.pivots.multipliers(gradient, n, |source, y| {
                let i = usize::from(source);
                let slot = if i < rows {
                    own.get_mut(i)
                } else {
                    handed.get_mut(i.saturating_sub(rows))
                };
                if let Some(slot) = slot {
                    *slot = y;
                }
            });
        }
        for i in 0..rows {
            if self.rows.is_equality(i) {
                self.step.rows[i] = own[i];
            }
        }
        if let Some(next) = next {
            next.multiplier = handed;
        }
    }
}

/// Solves for the free coordinates of the first state under the rows that no control could meet.
///
/// `free[i]` marks the coordinates; the multipliers of the rows are left in `carried`. `None` if the
/// cost-to-go is not positive definite in what the rows leave free.
pub(crate) fn solve_start<T: Scalar, const NX: usize>(
    hessian: &[[T; NX]; NX],
    gradient: &[T; NX],
    carried: &mut Carried<T, NX>,
    free: &[bool; NX],
    tolerance: T,
) -> Option<[T; NX]> {
    // The start coordinates are the "controls" of a stage without a state.
    let mut work = Work::<T, 1, NX>::new();
    work.q.uu = *hessian;
    for (i, (column, u)) in work.q.uu.iter_mut().zip(&mut work.q.u).enumerate() {
        u[0] = if free[i] { gradient[i] } else { T::ZERO };
        for (j, value) in column.iter_mut().enumerate() {
            if !(free[i] && free[j]) {
                *value = if i == j { T::ONE } else { T::ZERO };
            }
        }
    }
    let (mut xx, mut x) = ([[T::ZERO]], [T::ZERO]);
    let (mut gain, mut step) = ([[T::ZERO]; NX], [[T::ZERO]; NX]);
    let (left, law) = ((&mut xx, &mut x), (&mut gain, &mut step));
    if carried.count == 0 {
        let found = minimise(left, &mut work.q.xu, &mut work.q.uu, &mut work.q.u, NX, law);
        return found.then(|| step.map(|[value]| value));
    }
    let mut pivots = Pivots::new();
    work.elimination.start(NX, *free, tolerance);
    work.whiten(NX, &mut pivots.whitening);
    let given = carried.rows.iter().zip(&carried.residual);
    for (i, (h, residual)) in given.enumerate().take(carried.count) {
        let mut u = *h;
        for (value, free) in u.iter_mut().zip(free) {
            *value = if *free { *value } else { T::ZERO };
        }
        let row = Row::new([T::ZERO], u, *residual, largest(h), i as Source);
        work.elimination.insert(row, &mut pivots);
    }
    work.elimination.finish(&mut Carried::new(), &mut pivots);
    if !work.minimise_under(left, &pivots.whitening, NX, law) {
        return None;
    }
    let step = step.map(|[value]| value);
    let mut total = *gradient;
    add_product(&mut total, hessian, &step);
    for (value, free) in total.iter_mut().zip(free) {
        *value = if *free { *value } else { T::ZERO };
    }
    carried.multiplier = [T::ZERO; NX];
    pivots.multipliers(total, NX, |source, y| {
        if let Some(slot) = carried.multiplier.get_mut(usize::from(source)) {
            *slot = y;
        }
    });
    Some(step)
}
