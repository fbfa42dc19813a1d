//! Equality rows of a stage, eliminated exactly.
//!
//! The linearised equalities of node `k` are its own rows with equal bounds, and the rows its successor
//! hands back, put through the dynamics `dx⁺ = A dx + B du + gap`:
//!
//! ```text
//! C dx + D du + c = 0              own rows
//! H A dx + H B du + (H gap + h) = 0    for every row  H dx⁺ + h = 0  of node k + 1
//! ```
//!
//! Gaussian elimination takes the rows one by one (Laine and Tomlin, "Efficient computation of feedback
//! control for equality-constrained LQR", 2019; fatrop, Vanroye et al. 2023, eq. (11) to (17)):
//!
//! - A row in which a control is left after the other *pivots* are subtracted becomes a pivot: its
//!   largest control entry is the dependent control `du_p = −(K dx + Z du_free + k)`. Rows with most left
//!   go first.
//! - A row in which none is left binds the state alone and is handed back to node `k − 1`, unless it
//!   depends on the rows that already are: then it is dropped. If it contradicts them as well, no step
//!   can meet it; its residual stays, and so the solve does not end as solved.
//!
//! The rows are eliminated in coordinates of the controls in which the cost is whitened (see
//! [`crate::project`]), so the largest entry is the control that meets the row at least cost.
//!
//! "None is left" means: no entry above `tolerance` times the largest entry that took part. With `S` the
//! rows that became pivots, `D_S = L U` on the dependent controls, and the rows handed back are
//! `row − Σ f · pivot`; so the multipliers of the latter are those of the rows they came from, and
//! the others solve `Uᵀ Lᵀ y_S = −∂/∂u_dep (everything else)` (see [`Pivots::multipliers`]).

use crate::kernel::{add_scaled, largest};
use crate::project::Whitening;
use so3::Scalar;
use so3::math::{abs, max};

/// Where a row came from: an own row below the node's row count, a row of the successor from there on.
pub(crate) type Source = u16;

/// Rows over the state alone that a node hands back: `rows[i] · dx + residual[i] = 0`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carried<T, const NX: usize> {
    pub(crate) count: usize,
    pub(crate) rows: [[T; NX]; NX],
    pub(crate) residual: [T; NX],
    source: [Source; NX],
    /// Multipliers of the rows after the Newton step.
    pub(crate) multiplier: [T; NX],
}

/// The pivot rows of a node, as far as their multipliers need them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pivots<T, const NU: usize> {
    count: usize,
    /// Dependent control of each pivot.
    column: [u16; NU],
    source: [Source; NU],
    /// Row `i`: `L` up to the diagonal, behind it the unit-upper `U`.
    factors: [[T; NU]; NU],
    /// The coordinates the rows were eliminated in.
    pub(crate) whitening: Whitening<T, NU>,
}

/// One row on its way through the elimination: `x · dx + u · du + constant = 0`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<T, const NX: usize, const NU: usize> {
    pub(crate) x: [T; NX],
    pub(crate) u: [T; NU],
    pub(crate) constant: T,
    /// Magnitude against which an entry of `u` counts as zero, in the units of the controls themselves.
    pub(crate) scale: T,
    pub(crate) source: Source,
    /// Largest entry of `u` at first.
    size: T,
    /// Largest multiple of a pivot row that was subtracted, and what that made of `x`.
    subtracted: T,
    in_state: T,
    /// Multiples of the pivot rows subtracted: the row of `L`.
    factors: [T; NU],
}

/// How many rows are whitened together: enough to fill the vectors of a processor.
const BATCH: usize = 8;

/// The pivot rows while a node is being eliminated: `du_p = −(x · dx + u · du + constant)` each, `u` without `p`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Elimination<T, const NX: usize, const NU: usize> {
    count: usize,
    column: [u16; NU],
    pub(crate) x: [[T; NX]; NU],
    pub(crate) u: [[T; NU]; NU],
    pub(crate) constant: [T; NU],
    /// Largest entry of each row of `x`.
    size: [T; NU],
    /// Controls that may become dependent.
    free: [bool; NU],
    tolerance: T,
    /// Number of controls.
    n: usize,
    /// Rows that came last, in the controls themselves.
    new: [Row<T, NX, NU>; BATCH],
    new_count: usize,
    /// Rows that wait: little or nothing was left of their controls when they came.
    waiting: [Row<T, NX, NU>; NX],
    waiting_count: usize,
}

impl<T: Scalar, const NX: usize> Carried<T, NX> {
    pub(crate) const fn new() -> Self {
        Self {
            count: 0,
            rows: [[T::ZERO; NX]; NX],
            residual: [T::ZERO; NX],
            source: [0; NX],
            multiplier: [T::ZERO; NX],
        }
    }
}

impl<T: Scalar, const NU: usize> Pivots<T, NU> {
    pub(crate) const fn new() -> Self {
        Self {
            count: 0,
            column: [0; NU],
            source: [0; NU],
            factors: [[T::ZERO; NU]; NU],
            whitening: Whitening::new(),
        }
    }

    pub(crate) const fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub(crate) const fn clear(&mut self) {
        self.count = 0;
    }

    /// Multipliers of the pivot rows: solves `(L U)ᵀ y = −gradient_dep` and hands each to `write`.
    ///
    /// `gradient` is that of the stage in its `n` controls, with every term but those of the pivot rows.
    pub(crate) fn multipliers(
        &self,
        mut gradient: [T; NU],
        n: usize,
        mut write: impl FnMut(Source, T),
    ) {
        self.whitening
            .gradients(core::array::from_mut(&mut gradient), n);
        let mut y = [T::ZERO; NU];
        for (i, column) in self.column.iter().enumerate().take(self.count) {
            let mut value = -entry(&gradient, *column);
            for (row, earlier) in self.factors.iter().zip(&y).take(i) {
                value -= entry(row, i as u16) * *earlier;
            }
            if let Some(y) = y.get_mut(i) {
                *y = value;
            }
        }
        for i in (0..self.count.min(NU)).rev() {
            let mut value = y[i];
            let later = self.factors.iter().zip(&y).take(self.count);
            for (row, later) in later.skip(i.saturating_add(1)) {
                value -= row[i] * *later;
            }
            y[i] = value / self.factors[i][i];
            write(self.source[i], y[i]);
        }
    }
}

impl<T: Scalar, const NX: usize> Carried<T, NX> {
    /// The rows of `next`, each put through the dynamics by `map`, which returns what it adds to the
    /// residual; `first` is the source of the first one.
    #[inline(always)]
    pub(crate) fn pass(
        &mut self,
        next: &Self,
        first: usize,
        map: impl Fn(&[T; NX], &mut [T; NX]) -> T,
    ) {
        self.count = next.count;
        let from = next.rows.iter().zip(&next.residual);
        let to = self.rows.iter_mut().zip(&mut self.residual);
        let places = to.zip(&mut self.source).zip(from);
        for (j, (((row, residual), source), (h, before))) in places.enumerate().take(next.count) {
            *row = [T::ZERO; NX];
            *residual = *before + map(h, row);
            *source = first.saturating_add(j) as Source;
        }
    }

    /// Hands the multiplier of every row to `write`, with the place the row came from.
    pub(crate) fn multipliers(&self, mut write: impl FnMut(Source, T)) {
        for (source, y) in self.source.iter().zip(&self.multiplier).take(self.count) {
            write(*source, *y);
        }
    }
}

impl<T: Scalar, const NX: usize, const NU: usize> Row<T, NX, NU> {
    const NONE: Self = Self {
        x: [T::ZERO; NX],
        u: [T::ZERO; NU],
        constant: T::ZERO,
        scale: T::ZERO,
        source: 0,
        size: T::ZERO,
        subtracted: T::ZERO,
        in_state: T::ZERO,
        factors: [T::ZERO; NU],
    };

    #[inline(always)]
    pub(crate) fn new(x: [T; NX], u: [T; NU], constant: T, scale: T, source: Source) -> Self {
        Self {
            x,
            u,
            constant,
            scale,
            source,
            in_state: largest(&x),
            ..Self::NONE
        }
    }
}

impl<T: Scalar, const NX: usize, const NU: usize> Elimination<T, NX, NU> {
    pub(crate) const fn new() -> Self {
        Self {
            count: 0,
            column: [0; NU],
            x: [[T::ZERO; NX]; NU],
            u: [[T::ZERO; NU]; NU],
            constant: [T::ZERO; NU],
            size: [T::ZERO; NU],
            free: [false; NU],
            tolerance: T::ZERO,
            n: 0,
            new: [Row::NONE; BATCH],
            new_count: 0,
            waiting: [Row::NONE; NX],
            waiting_count: 0,
        }
    }

    /// No rows; of `n` controls those with `free[j]` may become dependent.
    pub(crate) const fn start(&mut self, n: usize, free: [bool; NU], tolerance: T) {
        self.n = n;
        (self.count, self.new_count, self.waiting_count) = (0, 0, 0);
        (self.free, self.tolerance) = (free, tolerance);
    }

    /// Pivot rows: dependent control and the number of the row.
    pub(crate) fn pivots(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let columns = self.column.iter().take(self.count);
        columns
            .enumerate()
            .map(|(i, column)| (usize::from(*column), i))
    }

    /// Whether control `j` is free and not dependent.
    pub(crate) fn remains(&self, j: usize) -> bool {
        self.free.get(j).copied().unwrap_or(false)
    }

    /// Takes a row in the controls themselves in.
    #[inline(always)]
    pub(crate) fn insert(&mut self, row: Row<T, NX, NU>, pivots: &mut Pivots<T, NU>) {
        if self.new_count >= BATCH {
            self.whiten(pivots);
        }
        if let Some(slot) = self.new.get_mut(self.new_count) {
            *slot = row;
            self.new_count = self.new_count.saturating_add(1);
        }
    }

    /// Turns the rows that came last to whitened coordinates, all at once, and eliminates them.
    #[inline(never)]
    fn whiten(&mut self, pivots: &mut Pivots<T, NU>) {
        let mut gradients = [[T::ZERO; NU]; BATCH];
        for (gradient, row) in gradients.iter_mut().zip(&self.new).take(self.new_count) {
            *gradient = row.u;
        }
        pivots.whitening.gradients(&mut gradients, self.n);
        for (k, gradient) in gradients.iter().enumerate().take(self.new_count) {
            let mut row = self.new[k];
            row.u = *gradient;
            row.size = largest(gradient);
            self.eliminate(row, pivots);
        }
        self.new_count = 0;
    }

    /// Eliminates a row. It becomes a pivot at once if much of its controls is left; otherwise it waits for
    /// [`Self::finish`], because what is left may be what later pivots take away.
    #[inline(always)]
    fn eliminate(&mut self, mut row: Row<T, NX, NU>, pivots: &mut Pivots<T, NU>) {
        for i in 0..self.count.min(NU) {
            self.subtract(&mut row, i);
        }
        let best = self.best(&row, &pivots.whitening);
        match best {
            Some((j, share)) if share > T::of(0.1) => self.pivot(&row, j, pivots),
            _ => {
                if self.waiting_count >= NX {
                    self.settle(pivots);
                }
                if let Some(slot) = self.waiting.get_mut(self.waiting_count) {
                    *slot = row;
                    self.waiting_count = self.waiting_count.saturating_add(1);
                } else if let Some((j, _)) = best {
                    self.pivot(&row, j, pivots);
                }
                // Otherwise the row depends on the full set of rows over the state that waits.
            }
        }
    }

    /// Subtracts pivot row `i`.
    #[inline(always)]
    fn subtract(&self, row: &mut Row<T, NX, NU>, i: usize) {
        let column = entry(&self.column, i as u16);
        let factor = entry(&row.u, column);
        if factor == T::ZERO {
            return;
        }
        add_scaled(&mut row.u, -factor, &self.u[i]);
        add_scaled(&mut row.x, -factor, &self.x[i]);
        row.constant -= factor * self.constant[i];
        row.subtracted = max(row.subtracted, abs(factor));
        row.in_state = max(row.in_state, abs(factor) * self.size[i]);
        for (values, value) in [
            (&mut row.u, (column, T::ZERO)),
            (&mut row.factors, (i as u16, factor)),
        ] {
            if let Some(slot) = values.get_mut(usize::from(value.0)) {
                *slot = value.1;
            }
        }
    }

    /// The largest control entry that is left of a row, as its column and its share of the row at first.
    #[inline(always)]
    fn best(&self, row: &Row<T, NX, NU>, whitening: &Whitening<T, NU>) -> Option<(usize, T)> {
        let mut best = (T::ZERO, None);
        let entries = row.u.iter().zip(&self.free).zip(&whitening.scale);
        for (j, ((value, free), scale)) in entries.enumerate() {
            let value = abs(*value);
            // Pivot rows have no control entry above one.
            let noise = self.tolerance * max(row.scale * *scale, row.subtracted);
            if *free && value > noise && value > best.0 {
                best = (value, Some(j));
            }
        }
        best.1.map(|j| (j, best.0 / row.size))
    }

    #[inline(always)]
    fn pivot(&mut self, row: &Row<T, NX, NU>, j: usize, pivots: &mut Pivots<T, NU>) {
        let i = self.count;
        let column = j as u16;
        let pivot = entry(&row.u, column);
        let inverse = T::ONE / pivot;
        let (Some(x), Some(u), Some(constant), Some(size)) = (
            self.x.get_mut(i),
            self.u.get_mut(i),
            self.constant.get_mut(i),
            self.size.get_mut(i),
        ) else {
            return;
        };
        *x = row.x.map(|v| v * inverse);
        *u = row.u.map(|v| v * inverse);
        (*constant, *size) = (row.constant * inverse, largest(x));
        if let (Some(slot), Some(free)) = (self.column.get_mut(i), self.free.get_mut(j)) {
            (*slot, *free) = (column, false);
        }
        if let (Some(slot), Some(source)) = (pivots.factors.get_mut(i), pivots.source.get_mut(i)) {
            (*slot, *source) = (row.factors, row.source);
            if let Some(value) = slot.get_mut(i) {
                *value = pivot;
            }
        }
        self.count = i.saturating_add(1);
        for k in 0..self.waiting_count.min(NX) {
            let mut row = self.waiting[k];
            self.subtract(&mut row, i.min(NU.saturating_sub(1)));
            self.waiting[k] = row;
        }
    }

    /// Makes pivots of waiting rows, the one with the largest share first, and drops those of the rest
    /// that depend on others.
    #[inline(never)]
    fn settle(&mut self, pivots: &mut Pivots<T, NU>) {
        for _ in 0..NX {
            let mut chosen = (T::ZERO, None);
            for (k, row) in self.waiting.iter().enumerate().take(self.waiting_count) {
                if let Some((j, share)) = self.best(row, &pivots.whitening)
                    && share > chosen.0
                {
                    chosen = (share, Some((k, j)));
                }
            }
            let Some((k, j)) = chosen.1 else { break };
            self.waiting_count = self.waiting_count.saturating_sub(1);
            let (Some(row), Some(last)) = (
                self.waiting.get(k).copied(),
                self.waiting.get(self.waiting_count).copied(),
            ) else {
                break;
            };
            if let Some(slot) = self.waiting.get_mut(k) {
                *slot = last;
            }
            self.pivot(&row, j, pivots);
        }
        // Echelon form of the rows over the state.
        let (mut echelon, mut column) = ([[T::ZERO; NX]; NX], [0u16; NX]);
        let mut kept = 0usize;
        for k in 0..self.waiting_count.min(NX) {
            let row = self.waiting[k];
            let (mut reduced, mut scale) = (row.x, row.in_state);
            for (row, column) in echelon.iter().zip(&column).take(kept) {
                let factor = entry(&reduced, *column);
                add_scaled(&mut reduced, -factor, row);
                scale = max(scale, abs(factor));
                if let Some(value) = reduced.get_mut(usize::from(*column)) {
                    *value = T::ZERO;
                }
            }
            let mut best = (self.tolerance * scale, None);
            for (j, value) in reduced.iter().enumerate() {
                if abs(*value) > best.0 {
                    best = (abs(*value), Some(j as u16));
                }
            }
            let Some(j) = best.1 else { continue };
            let inverse = T::ONE / entry(&reduced, j);
            if let (Some(slot), Some(place), Some(to)) = (
                echelon.get_mut(kept),
                column.get_mut(kept),
                self.waiting.get_mut(kept),
            ) {
                (*slot, *place, *to) = (reduced.map(|v| v * inverse), j, row);
                kept = kept.saturating_add(1);
            }
        }
        self.waiting_count = kept;
    }

    /// Decides on the rows that wait, frees every pivot row of the other dependent controls, and leaves the
    /// rows to hand back in `carried` and what the multipliers of the others need in `pivots`.
    #[inline(always)]
    pub(crate) fn finish(&mut self, carried: &mut Carried<T, NX>, pivots: &mut Pivots<T, NU>) {
        self.whiten(pivots);
        self.settle(pivots);
        carried.count = self.waiting_count;
        let places = carried.rows.iter_mut().zip(&mut carried.residual);
        for (((x, residual), source), row) in places.zip(&mut carried.source).zip(&self.waiting) {
            (*x, *residual, *source) = (row.x, row.constant, row.source);
        }
        (pivots.count, pivots.column) = (self.count, self.column);
        let columns = self.column;
        for (i, (slot, u)) in pivots.factors.iter_mut().zip(&self.u).enumerate() {
            let later = slot.iter_mut().zip(&columns).take(self.count);
            for (value, column) in later.skip(i.saturating_add(1)) {
                *value = entry(u, *column);
            }
        }
        for i in (1..NU).rev() {
            if i >= self.count {
                continue;
            }
            let (x, u, constant) = (self.x[i], self.u[i], self.constant[i]);
            let earlier = self.x.iter_mut().zip(&mut self.u);
            for ((to_x, to_u), to_constant) in earlier.zip(&mut self.constant).take(i) {
                let factor = entry(to_u, columns[i]);
                if factor != T::ZERO {
                    add_scaled(to_x, -factor, &x);
                    add_scaled(to_u, -factor, &u);
                    *to_constant -= factor * constant;
                }
            }
        }
        // What is left of the unit diagonal and of rounding in the dependent columns.
        for u in self.u.iter_mut().take(self.count) {
            for column in columns.iter().take(self.count) {
                if let Some(value) = u.get_mut(usize::from(*column)) {
                    *value = T::ZERO;
                }
            }
        }
    }
}

/// Entry `i`, zero beyond the end.
#[inline(always)]
pub(crate) fn entry<V: Copy + Default, const N: usize>(values: &[V; N], i: u16) -> V {
    values.get(usize::from(i)).copied().unwrap_or_default()
}
