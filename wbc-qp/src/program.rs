//! The arrays of one quadratic program, filled term by term.

mod cost;

use so3::Scalar;

use crate::Error;

/// A program with V variables and room for M rows:
/// minimise Σ w (aᵀz − b)² / 2 subject to l ≤ A z ≤ u and lb ≤ z ≤ ub.
#[derive(Clone, Debug)]
pub(crate) struct Program<T, const V: usize, const M: usize> {
    pub(crate) hessian: [[T; V]; V],
    pub(crate) gradient: [T; V],
    pub(crate) rows: [[T; V]; M],
    pub(crate) row_lower: [T; M],
    pub(crate) row_upper: [T; M],
    pub(crate) lower: [T; V],
    pub(crate) upper: [T; V],
    used: usize,
    /// Rows from `used` up to this one are left from an earlier tick, without limits.
    stale: usize,
}

impl<T: Scalar, const V: usize, const M: usize> Program<T, V, M> {
    /// No cost, no row, no bound.
    pub(crate) const fn new() -> Self {
        Self {
            hessian: [[T::ZERO; V]; V],
            gradient: [T::ZERO; V],
            rows: [[T::ZERO; V]; M],
            row_lower: [T::NEG_INFINITY; M],
            row_upper: [T::INFINITY; M],
            lower: [T::NEG_INFINITY; V],
            upper: [T::INFINITY; V],
            used: 0,
            stale: 0,
        }
    }

    /// No cost, no bound, and rows without limits: most are written anew, and [`Program::finish`] clears those that are not.
    pub(crate) fn clear(&mut self) {
        self.clear_costs();
        self.stale = self.stale.max(self.used);
        self.row_lower = [T::NEG_INFINITY; M];
        self.row_upper = [T::INFINITY; M];
        self.lower = [T::NEG_INFINITY; V];
        self.upper = [T::INFINITY; V];
        self.used = 0;
    }

    /// Clears what earlier ticks left in rows that this one has not written.
    pub(crate) fn finish(&mut self) {
        let stale = self.rows.iter_mut().take(self.stale).skip(self.used);
        for row in stale {
            *row = [T::ZERO; V];
        }
        self.stale = self.used;
    }

    /// No cost; rows and bounds stay.
    pub(crate) fn clear_costs(&mut self) {
        self.hessian = [[T::ZERO; V]; V];
        self.gradient = [T::ZERO; V];
    }

    /// Adds ½ w (aᵀz − b)² to the cost.
    pub(crate) fn minimise(&mut self, a: &[T; V], b: T, weight: T) {
        self.minimise_rows([(a, b, weight)].into_iter());
    }

    /// Adds ½ Σ w (aᵀz − b)² over many rows to the cost.
    pub(crate) fn minimise_rows<'r>(&mut self, rows: impl Iterator<Item = (&'r [T; V], T, T)>)
    where
        T: 'r,
    {
        cost::add(&mut self.hessian, &mut self.gradient, rows);
        self.mirror();
    }

    /// [`Program::minimise_rows`] of rows of this program: of each its index, b and w.
    pub(crate) fn minimise_own(&mut self, costs: impl Iterator<Item = (usize, T, T)>) {
        let rows = &self.rows;
        let costs = costs.filter_map(|(i, b, weight)| Some((rows.get(i)?, b, weight)));
        cost::add(&mut self.hessian, &mut self.gradient, costs);
        self.mirror();
    }

    /// Completes H below its diagonal.
    fn mirror(&mut self) {
        for i in 0..V {
            let Some((upper, lower)) = self.hessian.split_at_mut_checked(i + 1) else {
                return;
            };
            let Some(row) = upper.last() else { return };
            let row = row.get(i + 1..).unwrap_or(&[]);
            for (below, x) in lower.iter_mut().zip(row) {
                if let Some(slot) = below.get_mut(i) {
                    *slot = *x;
                }
            }
        }
    }

    /// Adds ½ w (zᵢ − b)² to the cost.
    pub(crate) fn minimise_variable(&mut self, i: usize, b: T, weight: T) {
        if let (Some(g), Some(h)) = (
            self.gradient.get_mut(i),
            self.hessian.get_mut(i).and_then(|row| row.get_mut(i)),
        ) {
            *h += weight;
            *g -= weight * b;
        }
    }

    /// Number of rows so far.
    pub(crate) const fn used(&self) -> usize {
        self.used
    }

    /// Adds l ≤ aᵀz ≤ u; the row's index.
    pub(crate) fn constrain(&mut self, a: &[T; V], lower: T, upper: T) -> Result<usize, Error> {
        let index = self.used;
        let limits = self.row_lower.iter_mut().zip(&mut self.row_upper);
        let Some((row, (l, u))) = self.rows.iter_mut().zip(limits).nth(index) else {
            return Err(Error::NoRoomForRows);
        };
        *row = *a;
        (*l, *u) = (lower, upper);
        self.used = index + 1;
        Ok(index)
    }

    /// Moves the value towards which a cost on row `i` pulls: subtracts `amount`, weight times shift, times the row from g.
    pub(crate) fn pull(&mut self, i: usize, amount: T) {
        let row = self.row(i);
        for (g, a) in self.gradient.iter_mut().zip(&row) {
            *g -= amount * *a;
        }
    }

    /// Sets the limits of a row.
    pub(crate) fn limit_row(&mut self, i: usize, lower: T, upper: T) {
        if let (Some(l), Some(u)) = (self.row_lower.get_mut(i), self.row_upper.get_mut(i)) {
            (*l, *u) = (lower, upper);
        }
    }

    /// Sets the bounds of a variable.
    pub(crate) fn bound(&mut self, i: usize, lower: T, upper: T) {
        if let (Some(l), Some(u)) = (self.lower.get_mut(i), self.upper.get_mut(i)) {
            (*l, *u) = (lower, upper);
        }
    }

    /// Limits of row `i`; none beyond the end.
    pub(crate) fn row_limits(&self, i: usize) -> (T, T) {
        let lower = self.row_lower.get(i).copied();
        let upper = self.row_upper.get(i).copied();
        (
            lower.unwrap_or(T::NEG_INFINITY),
            upper.unwrap_or(T::INFINITY),
        )
    }

    /// Row `i`; zero beyond the end.
    pub(crate) fn row(&self, i: usize) -> [T; V] {
        self.rows.get(i).copied().unwrap_or([T::ZERO; V])
    }

    /// The program as the solver takes it.
    pub(crate) fn problem(&self) -> dense_qp::Problem<'_, T, V, M> {
        dense_qp::Problem::new(
            &self.hessian,
            &self.gradient,
            &self.rows,
            &self.row_lower,
            &self.row_upper,
        )
        .with_bounds(&self.lower, &self.upper)
    }
}

/// aᵀb.
pub(crate) fn dot<T: Scalar, const V: usize>(a: &[T; V], b: &[T; V]) -> T {
    a.iter().zip(b).fold(T::ZERO, |sum, (x, y)| sum + *x * *y)
}
