//! Slacks, bound multipliers and barrier terms of the constraint rows of one node.
//!
//! A row `l ≤ c(x, u) ≤ h` becomes `c − s = 0` with a slack `s` strictly between its bounds and the
//! barrier `−µ log(s − l) − µ log(h − s)`. Its Newton step, with `z_l`, `z_h` the bound multipliers and
//! `Σ = z_l/(s−l) + z_h/(h−s)`, is eliminated at once:
//!
//! ```text
//! ds = J d + (c − s),   y⁺ = µ/(h−s) − µ/(s−l) + Σ ds
//! ```
//!
//! so a row adds `JᵀΣJ` to the stage Hessian and `Jᵀ (µ/(h−s) − µ/(s−l) + Σ(c − s))` to its gradient. A
//! row with `l == h` is an equality, see [`crate::eliminate`].
//!
//! In *elastic mode* every row gives way, `c − s = e y`, which adds `½ (c − s)²/e` to the cost: as `e` goes to
//! zero the solution is one of least squared violation among its neighbours. The row above then adds
//! `Σ/(1 + e Σ)` and `(µ/(h−s) − µ/(s−l) + Σ(c − s))/(1 + e Σ)`, and an equality `1/e` and `(c − l)/e`.

use crate::kernel::{dot, larger};
use crate::stage::{Side, Stage};
use so3::Scalar;
use so3::math::{max, min};

/// Parameters of a factorisation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowBarrier<T> {
    /// Barrier parameter µ.
    pub(crate) mu: T,
    /// Entries below this share of their row count as zero in the elimination of equalities.
    pub(crate) rank_tolerance: T,
}

/// Sums over the bounds of a problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Complementarity<T> {
    /// Σ distance × multiplier.
    pub(crate) sum: T,
    /// Smallest product.
    pub(crate) smallest: T,
    /// Largest product.
    pub(crate) largest: T,
    /// Number of bounds.
    pub(crate) count: T,
}

impl<T: Scalar> Complementarity<T> {
    pub(crate) const fn new() -> Self {
        Self {
            sum: T::ZERO,
            smallest: T::INFINITY,
            largest: T::ZERO,
            count: T::ZERO,
        }
    }

    fn add<const NI: usize>(&mut self, side: &Side<T, NI>, rows: usize) {
        for (distance, multiplier) in side.distance.iter().zip(&side.multiplier).take(rows) {
            if *distance < T::INFINITY {
                let product = *distance * *multiplier;
                self.sum += product;
                self.smallest = min(self.smallest, product);
                self.largest = larger(self.largest, product);
                self.count += T::ONE;
            }
        }
    }
}

impl<T: Scalar, const NI: usize> Side<T, NI> {
    /// Newton step of multiplier `i` for a slack step away from the bound.
    fn newton(&self, i: usize, mu: T, slack_step: T) -> T {
        let (d, z) = (self.distance[i], self.multiplier[i]);
        if d < T::INFINITY {
            (mu - z * slack_step) / d - z
        } else {
            T::ZERO
        }
    }
}

impl<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>
    Stage<T, X, NX, NU, NI>
{
    /// Whether row `i` is an equality.
    #[inline(always)]
    pub(crate) fn is_equality(&self, i: usize) -> bool {
        self.bounds.0[i] == self.bounds.1[i]
    }

    /// Rows in use, never more than there is storage.
    #[inline(always)]
    pub(crate) fn row_count(&self) -> usize {
        self.dims.rows().min(NI)
    }

    /// Places slacks strictly inside their bounds and gives every bound a multiplier.
    ///
    /// A slack keeps at least `push` (relative to the bound's magnitude above one, and to the width of the
    /// interval) from its bounds; multipliers start at `multiplier`, or on the central path of `mu` if
    /// that is given.
    pub(crate) fn start_rows(&mut self, push: T, multiplier: T, mu: Option<T>) {
        for i in 0..self.row_count() {
            let (l, h, c) = (self.bounds.0[i], self.bounds.1[i], self.values.rows[i]);
            self.row_multiplier[i] = T::ZERO;
            for side in [&mut self.lower, &mut self.upper] {
                side.distance[i] = T::INFINITY;
                side.multiplier[i] = T::ZERO;
            }
            if l == h {
                self.slack[i] = l;
                continue;
            }
            let margin = min(push, push * (h - l));
            let mut s = c;
            if l.is_finite_number() {
                s = max(s, l + margin);
            }
            if h.is_finite_number() {
                s = min(s, h - margin);
            }
            self.slack[i] = s;
            let start = |d: T| mu.map_or(multiplier, |mu| mu / d);
            if l.is_finite_number() {
                self.lower.distance[i] = s - l;
                self.lower.multiplier[i] = start(s - l);
            }
            if h.is_finite_number() {
                self.upper.distance[i] = h - s;
                self.upper.multiplier[i] = start(h - s);
            }
            self.row_multiplier[i] = self.upper.multiplier[i] - self.lower.multiplier[i];
        }
    }

    /// Places slacks inside bounds that may have moved since the last solve, and keeps its multipliers within
    /// a factor of ten of the central path of `mu`.
    pub(crate) fn resume_rows(&mut self, push: T, mu: T) {
        let kept = (
            self.lower.multiplier,
            self.upper.multiplier,
            self.row_multiplier,
        );
        self.start_rows(min(push, so3::math::sqrt(mu)), T::ONE, Some(mu));
        let ten = T::of(10.0);
        for i in 0..self.row_count() {
            if self.is_equality(i) {
                self.row_multiplier[i] = kept.2[i];
                continue;
            }
            for (side, z) in [(&mut self.lower, kept.0[i]), (&mut self.upper, kept.1[i])] {
                let central = side.multiplier[i];
                side.multiplier[i] = max(min(z, central * ten), central / ten);
            }
            self.row_multiplier[i] = self.upper.multiplier[i] - self.lower.multiplier[i];
        }
    }

    /// Multiplies all multipliers by a factor.
    pub(crate) fn scale_multipliers(&mut self, factor: T) {
        for y in self
            .costate
            .iter_mut()
            .chain(&mut self.row_multiplier)
            .chain(&mut self.lower.multiplier)
            .chain(&mut self.upper.multiplier)
        {
            *y *= factor;
        }
    }

    /// Weights and targets of the condensed rows.
    pub(crate) fn condense_rows(&mut self, mu: T) {
        for i in 0..self.row_count() {
            let residual = self.values.rows[i] - self.slack[i];
            if self.is_equality(i) {
                let weight = if self.elastic > T::ZERO {
                    T::ONE / self.elastic
                } else {
                    T::ZERO
                };
                (self.step.weight[i], self.step.target[i]) = (weight, weight * residual);
            } else {
                let (below, above) = (
                    T::ONE / self.lower.distance[i],
                    T::ONE / self.upper.distance[i],
                );
                let weight = self.lower.multiplier[i] * below + self.upper.multiplier[i] * above;
                let give = if self.elastic > T::ZERO {
                    T::ONE / (T::ONE + self.elastic * weight)
                } else {
                    T::ONE
                };
                self.step.weight[i] = weight * give;
                self.step.target[i] = (mu * (above - below) + weight * residual) * give;
            }
        }
    }

    /// `J d` of row `i` for the state and control steps.
    #[inline(always)]
    fn row_change(&self, i: usize) -> T {
        let (d, x_rows) = (&self.derivatives, self.dims.state_rows);
        let u_rows = x_rows.saturating_add(self.dims.control_rows);
        let mut change = T::ZERO;
        if i < x_rows || i >= u_rows {
            change += dot(&d.rows_x[i], &self.step.state);
        }
        if i >= x_rows {
            change += dot(&d.rows_u[i], &self.step.control);
        }
        change
    }

    /// Slack and multiplier steps from the state and control steps.
    ///
    /// Returns the largest primal and dual step lengths that keep `1 − fraction` of every distance and
    /// multiplier.
    pub(crate) fn step_rows(&mut self, mu: T, fraction: T) -> (T, T) {
        let (mut primal, mut dual) = (T::ONE, T::ONE);
        for i in 0..self.row_count() {
            let change = self.row_change(i);
            let mut ds = self.values.rows[i] - self.slack[i] + change;
            if self.elastic > T::ZERO {
                let multiplier = self.step.target[i] + self.step.weight[i] * change;
                ds -= self.elastic * multiplier;
                if self.is_equality(i) {
                    self.step.target[i] = multiplier;
                }
            }
            self.step.slack[i] = ds;
            if self.is_equality(i) {
                continue;
            }
            for (side, ds) in [(&self.lower, ds), (&self.upper, -ds)] {
                let (z, dz) = (side.multiplier[i], side.newton(i, mu, ds));
                if dz < T::ZERO && dual * dz < -fraction * z {
                    dual = -fraction * z / dz;
                }
            }
            let limit = if ds < T::ZERO {
                self.lower.distance[i]
            } else {
                self.upper.distance[i]
            };
            let reach = so3::math::abs(ds);
            if primal * reach > fraction * limit {
                primal = fraction * limit / reach;
            }
        }
        (primal, dual)
    }

    /// The slack `s` of row `i`, moved toward the row's value where that takes it away from both bounds.
    ///
    /// Such a move lowers the violation and the barrier at once; without it a slack that was pushed
    /// against a bound by a bad step stays there and stops the iteration.
    fn relaxed(&self, i: usize, s: T) -> T {
        let (l, h, c) = (self.bounds.0[i], self.bounds.1[i], self.values.rows[i]);
        let centre = (l + h) * T::HALF;
        if c > s && (h == T::INFINITY || s < centre) {
            if h == T::INFINITY { c } else { min(c, centre) }
        } else if c < s && (l == -T::INFINITY || s > centre) {
            if l == -T::INFINITY { c } else { max(c, centre) }
        } else {
            s
        }
    }

    /// Moves slacks and multipliers of equalities by `primal`, bound multipliers by `dual` of their steps.
    ///
    /// `mu` is that of the step, `floor` bounds how small a multiplier becomes.
    pub(crate) fn accept_rows(&mut self, primal: T, dual: T, mu: T, floor: T) {
        for i in 0..self.row_count() {
            let ds = self.step.slack[i];
            if self.is_equality(i) {
                let full = self.step.target[i];
                self.row_multiplier[i] += primal * (full - self.row_multiplier[i]);
                continue;
            }
            let s = self.relaxed(i, self.slack[i] + primal * ds);
            self.slack[i] = s;
            for (side, bound, sign) in [
                (&mut self.lower, self.bounds.0[i], T::ONE),
                (&mut self.upper, self.bounds.1[i], -T::ONE),
            ] {
                if side.distance[i] == T::INFINITY {
                    continue;
                }
                let step = side.newton(i, mu, sign * ds);
                // The distance is kept positive even where rounding would close it.
                let distance = max(sign * (s - bound), T::EPSILON * side.distance[i]);
                side.distance[i] = distance;
                let z = side.multiplier[i] + dual * step;
                // Kept within 1e10 of the central path, as IPOPT does, so that the Hessian stays exact.
                let far = T::of(1e10);
                side.multiplier[i] = max(min(z, floor * far / distance), floor / (far * distance));
            }
            self.row_multiplier[i] = self.upper.multiplier[i] - self.lower.multiplier[i];
        }
    }

    /// Largest and summed violation of `c − s = e y` (`s = l` in an equality).
    pub(crate) fn row_violation(&self, slack_step: T) -> (T, T) {
        let (mut worst, mut sum) = (T::ZERO, T::ZERO);
        let rows = self
            .values
            .rows
            .iter()
            .zip(&self.slack)
            .zip(&self.step.slack);
        for (i, ((value, slack), step)) in rows.enumerate().take(self.row_count()) {
            let moved = if self.is_equality(i) {
                T::ZERO
            } else {
                slack_step * *step
            };
            let r = *value - *slack - moved - self.elastic * self.row_multiplier[i];
            worst = larger(worst, r);
            sum += so3::math::abs(r);
        }
        (worst, sum)
    }

    /// Adds this node's bounds to the complementarity sums.
    pub(crate) fn add_complementarity(&self, to: &mut Complementarity<T>) {
        to.add(&self.lower, self.row_count());
        to.add(&self.upper, self.row_count());
    }
}
