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

use crate::iterate::Merit;
use crate::kernel::larger;
use crate::linearised::Linearised;
use crate::riccati::Direction;
use crate::stage::{Node, Rows};
use so3::Scalar;
use so3::math::{abs, max, min};

/// Parameters of a Newton step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowBarrier<T> {
    /// Barrier parameter µ.
    pub(crate) mu: T,
    /// Share of a distance to a bound, or of a multiplier, that a step may use up.
    pub(crate) fraction: T,
    /// Share of its distance to a bound at which a slack stops for itself, and of itself at which a multiplier does; infinite where steps
    /// are common.
    pub(crate) reach: T,
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

    fn add(&mut self, product: T) {
        self.sum += product;
        self.smallest = min(self.smallest, product);
        self.largest = larger(self.largest, product);
        self.count += T::ONE;
    }
}

impl<T: Scalar, const NI: usize> Rows<T, NI> {
    /// Whether row `i` is an equality.
    #[inline(always)]
    pub(crate) fn is_equality(&self, i: usize) -> bool {
        self.lower[i] == self.upper[i]
    }

    /// Multipliers of all rows: upper minus lower side, or that of an equality.
    #[inline(always)]
    pub(crate) fn multipliers(&self) -> [T; NI] {
        let mut y = self.above;
        for (y, below) in y.iter_mut().zip(&self.below) {
            *y -= *below;
        }
        y
    }

    /// Distances of slack `i` from its bounds, positive; +∞ where there is no bound.
    #[inline(always)]
    pub(crate) fn distances(&self, i: usize) -> (T, T) {
        (self.slack[i] - self.lower[i], self.upper[i] - self.slack[i])
    }

    /// The slack `s` of row `i`, moved toward the row's value `c` where that takes it away from both bounds.
    ///
    /// Such a move lowers the violation and the barrier at once; without it a slack that was pushed
    /// against a bound by a bad step stays there and stops the iteration.
    fn relaxed(&self, i: usize, s: T, c: T) -> T {
        let (l, h) = (self.lower[i], self.upper[i]);
        let centre = (l + h) * T::HALF;
        if c > s && (h == T::INFINITY || s < centre) {
            if h == T::INFINITY { c } else { min(c, centre) }
        } else if c < s && (l == -T::INFINITY || s > centre) {
            if l == -T::INFINITY { c } else { max(c, centre) }
        } else {
            s
        }
    }

    /// `s`, kept off the bounds of row `i` even where rounding would close the distance.
    fn inside(&self, i: usize, s: T) -> T {
        let (l, h) = (self.lower[i], self.upper[i]);
        let last = |bound: T| max(T::EPSILON * abs(bound), T::EPSILON * T::EPSILON);
        let mut s = s;
        if h < T::INFINITY && s >= h {
            s = h - last(h);
        }
        if l > -T::INFINITY && s <= l {
            s = l + last(l);
        }
        s
    }
}

/// Newton step of the multiplier `z` of a bound at distance `d`, for a slack step away from the bound.
#[inline(always)]
fn newton<T: Scalar>(d: T, z: T, mu: T, slack_step: T) -> T {
    if d < T::INFINITY {
        (mu - z * slack_step) / d - z
    } else {
        T::ZERO
    }
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Node<T, NX, NU, NI> {
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
            let rows = &mut self.rows;
            let (l, h, c) = (rows.lower[i], rows.upper[i], self.values.rows[i]);
            (rows.below[i], rows.above[i]) = (T::ZERO, T::ZERO);
            if l == h {
                rows.slack[i] = l;
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
            rows.slack[i] = rows.inside(i, s);
            let start = |d: T| mu.map_or(multiplier, |mu| mu / d);
            let (below, above) = rows.distances(i);
            if l.is_finite_number() {
                rows.below[i] = start(below);
            }
            if h.is_finite_number() {
                rows.above[i] = start(above);
            }
        }
    }

    /// Puts every row on the central path of `mu` where it is nearest to the row's value, whose bounds may have moved since the last solve, and
    /// to its multiplier: of a distance d to the bound and a multiplier z there, s z⁺ = µ with s − z⁺ = d − z,
    ///
    /// s = ½ (d − z + √((d − z)² + 4 µ)).
    ///
    /// A row that was active keeps its multiplier, one that was not its distance. Of two bounds the one that pushed counts.
    pub(crate) fn resume_rows(&mut self, mu: T) {
        for i in 0..self.row_count() {
            let rows = &mut self.rows;
            let (l, h, c) = (rows.lower[i], rows.upper[i], self.values.rows[i]);
            if l == h {
                rows.slack[i] = l;
                continue;
            }
            let on_path = |distance: T, multiplier: T| {
                let both = distance - multiplier;
                let root = so3::math::sqrt(both * both + T::of(4.0) * mu);
                // The sum of what cancels least.
                if both > T::ZERO {
                    (both + root) * T::HALF
                } else {
                    T::of(2.0) * mu / (root - both)
                }
            };
            let (below, above) = (rows.below[i], rows.above[i]);
            let is_above = h.is_finite_number() && (above > below || !l.is_finite_number());
            let s = if is_above {
                h - min(on_path(h - c, above), T::of(0.9) * (h - l))
            } else if l.is_finite_number() {
                l + min(on_path(c - l, below), T::of(0.9) * (h - l))
            } else {
                c
            };
            rows.slack[i] = rows.inside(i, s);
            let (below, above) = rows.distances(i);
            // Nothing where there is no bound: its distance is infinite.
            (rows.below[i], rows.above[i]) = (mu / below, mu / above);
        }
    }

    /// Multiplies all multipliers by a factor.
    pub(crate) fn scale_multipliers(&mut self, factor: T) {
        for y in self
            .costate
            .iter_mut()
            .chain(&mut self.rows.below)
            .chain(&mut self.rows.above)
        {
            *y *= factor;
        }
    }

    /// What row `i`, condensed, adds to the stage: its weight, and its multiplier before the step.
    #[inline(always)]
    pub(crate) fn condensed(&self, i: usize, mu: T) -> (T, T) {
        let rows = &self.rows;
        let residual = self.values.rows[i] - rows.slack[i];
        if rows.is_equality(i) {
            let weight = if self.elastic > T::ZERO {
                T::ONE / self.elastic
            } else {
                T::ZERO
            };
            return (weight, weight * residual);
        }
        let (below, above) = rows.distances(i);
        let (below, above) = (T::ONE / below, T::ONE / above);
        let weight = rows.below[i] * below + rows.above[i] * above;
        let give = if self.elastic > T::ZERO {
            T::ONE / (T::ONE + self.elastic * weight)
        } else {
            T::ONE
        };
        (
            weight * give,
            (mu * (above - below) + weight * residual) * give,
        )
    }

    /// `J d` of row `i` for the state and control steps.
    #[inline(always)]
    fn row_change(&self, d: &impl Linearised<T, NX, NU>, i: usize) -> T {
        let parts = self.dims.parts(i);
        d.row_change(i, parts, &self.step.state, &self.step.control)
    }

    /// Slack steps, and in elastic mode multipliers of equalities, from the state and control steps.
    ///
    /// Cuts the step lengths so that they keep `1 − fraction` of every distance and multiplier, and adds the
    /// derivative of the barrier to the slope.
    pub(crate) fn step_rows(
        &mut self,
        d: &impl Linearised<T, NX, NU>,
        barrier: RowBarrier<T>,
        to: &mut Direction<T>,
    ) {
        let RowBarrier { mu, fraction, .. } = barrier;
        let (mut primal, mut dual, mut slope) = (to.primal, to.dual, T::ZERO);
        for i in 0..self.row_count() {
            let change = self.row_change(d, i);
            let mut ds = self.values.rows[i] - self.rows.slack[i] + change;
            if self.elastic > T::ZERO {
                let (weight, target) = self.condensed(i, mu);
                let multiplier = target + weight * change;
                ds -= self.elastic * multiplier;
                if self.rows.is_equality(i) {
                    ds = multiplier;
                }
            }
            self.step.rows[i] = ds;
            if self.rows.is_equality(i) {
                continue;
            }
            let (below, above) = self.rows.distances(i);
            slope += ds / above - ds / below;
            for (d, z, ds) in [
                (below, self.rows.below[i], ds),
                (above, self.rows.above[i], -ds),
            ] {
                let dz = newton(d, z, mu, ds);
                if dz < T::ZERO && dual * dz < -fraction * z {
                    dual = -fraction * z / dz;
                }
            }
            let limit = if ds < T::ZERO { below } else { above };
            let reach = abs(ds);
            if primal * reach > fraction * limit {
                primal = fraction * limit / reach;
            }
        }
        (to.primal, to.dual) = (primal, dual);
        to.slope += mu * slope;
    }

    /// Slack of row `i` after a step.
    #[inline(always)]
    fn moved_slack(&self, i: usize, step: &Direction<T>) -> T {
        let rows = &self.rows;
        let (below, above) = rows.distances(i);
        let ds = min(step.primal * self.step.rows[i], step.reach * above);
        let s = rows.slack[i] + max(ds, -step.reach * below);
        rows.inside(i, rows.relaxed(i, s, self.values.rows[i]))
    }

    /// Moves slacks and multipliers of equalities by the primal part of a step, bound multipliers by its dual part.
    ///
    /// Where rows stop for themselves, a multiplier that falls goes as far as it may. One that grows does not: where its slack stopped early its
    /// Newton step is that for a slack far beyond the bound.
    ///
    /// `mu` is that of the step, `floor` bounds how small a multiplier becomes.
    pub(crate) fn accept_rows(&mut self, step: &Direction<T>, mu: T, floor: T) {
        for i in 0..self.row_count() {
            let ds = self.step.rows[i];
            if self.rows.is_equality(i) {
                self.rows.above[i] += step.primal * (ds - self.rows.above[i]);
                continue;
            }
            let moved = self.moved_slack(i, step);
            let rows = &mut self.rows;
            let before = rows.distances(i);
            rows.slack[i] = moved;
            let now = rows.distances(i);
            for (z, before, now, ds) in [
                (&mut rows.below[i], before.0, now.0, ds),
                (&mut rows.above[i], before.1, now.1, -ds),
            ] {
                if now == T::INFINITY {
                    continue;
                }
                let dz = newton(before, *z, mu, ds);
                let moved = if step.reach < T::INFINITY && dz < T::ZERO {
                    max(*z + dz, (T::ONE - step.reach) * *z)
                } else {
                    *z + step.dual * dz
                };
                // Kept within 1e10 of the central path, as IPOPT does, so that the Hessian stays exact.
                let far = T::of(1e10);
                *z = max(min(moved, floor * far / now), floor / (far * now));
            }
        }
    }

    /// Adds the violation of `c − s = e y` (`s = l` in an equality) and the distances of `s` to its bounds, after
    /// a step if one is given.
    #[inline(always)]
    pub(crate) fn add_merit(&self, step: Option<&Direction<T>>, to: &mut Merit<T>) {
        for i in 0..self.row_count() {
            let rows = &self.rows;
            let mut s = rows.slack[i];
            if !rows.is_equality(i) {
                s = step.map_or(s, |step| self.moved_slack(i, step));
                to.logs.add(s - rows.lower[i]);
                to.logs.add(rows.upper[i] - s);
            }
            let give = self.elastic * (rows.above[i] - rows.below[i]);
            let r = self.values.rows[i] - s - give;
            to.worst = larger(to.worst, r);
            to.sum += abs(r);
        }
    }

    /// See [`crate::iterate::correct`]; `before` are the rows at the iterate.
    pub(crate) fn correct_rows(&mut self, before: &[T; NI], step: &Direction<T>) {
        for (i, before) in before.iter().enumerate().take(self.row_count()) {
            let s = self.rows.slack[i];
            let moved = if self.rows.is_equality(i) {
                s
            } else {
                self.moved_slack(i, step)
            };
            self.values.rows[i] += s - moved + step.primal * (*before - s);
        }
    }

    /// Adds this node's bounds to the complementarity sums.
    pub(crate) fn add_complementarity(&self, to: &mut Complementarity<T>) {
        for i in 0..self.row_count() {
            if self.rows.is_equality(i) {
                continue;
            }
            let (below, above) = self.rows.distances(i);
            for (d, z) in [(below, self.rows.below[i]), (above, self.rows.above[i])] {
                if d < T::INFINITY {
                    to.add(d * z);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Dims;

    /// A row 0 ≤ c with slack 1 and multiplier 2, after a step of its slack.
    fn moved(slack_step: f64, reach: f64) -> (f64, f64) {
        let mut node = crate::stage::Stage::<f64, (), 1, 1, 1>::new(()).node;
        node.dims = Dims {
            control_rows: 1,
            ..Dims::default()
        };
        (node.rows.lower, node.rows.upper) = ([0.0], [f64::INFINITY]);
        (node.rows.slack, node.rows.below) = ([1.0], [2.0]);
        // Where the row already is no slack is moved towards it.
        node.values.rows = [-9.0];
        node.step.rows = [slack_step];
        let step = Direction {
            shift: 0.0,
            primal: 1.0,
            dual: 0.25,
            slope: 0.0,
            reach,
        };
        node.accept_rows(&step, 1e-3, 1e-3);
        (node.rows.slack[0], node.rows.below[0])
    }

    /// Slack and both multipliers of a row with value `c` and kept multipliers, on the path of `mu`.
    fn resumed([l, h]: [f64; 2], c: f64, [below, above]: [f64; 2], mu: f64) -> (f64, f64, f64) {
        let mut node = crate::stage::Stage::<f64, (), 1, 1, 1>::new(()).node;
        node.dims = Dims {
            control_rows: 1,
            ..Dims::default()
        };
        (node.rows.lower, node.rows.upper) = ([l], [h]);
        (node.rows.below, node.rows.above) = ([below], [above]);
        node.values.rows = [c];
        node.resume_rows(mu);
        (node.rows.slack[0], node.rows.below[0], node.rows.above[0])
    }

    #[test]
    fn a_row_resumes_on_the_path_nearest_to_what_it_was() {
        const MU: f64 = 1e-6;
        // Active, inactive, violated, neither, far apart, and exact at the bound.
        for (c, z) in [
            (0.0, 2.0),
            (3.0, 0.0),
            (-0.5, 1.0),
            (1e-3, 1e-3),
            (1e6, 0.0),
            (0.0, 0.0),
        ] {
            let bounds = [5.0, f64::INFINITY];
            let (s, below, above) = resumed(bounds, 5.0 + c, [z, 0.0], MU);
            let d = s - 5.0;
            assert!(d > 0.0 && above == 0.0, "{c} {z}: {s}");
            assert!((d * below / MU - 1.0).abs() < 1e-12, "{c} {z}: {d} {below}");
            // To what ten digits of a slack five away from zero leave.
            let apart = (d - below) - (c - z);
            assert!(apart.abs() < 1e-8 * (1.0 + c.abs()), "{c} {z}: {apart}");
            // The same from above.
            let (low, none, mirrored) = resumed([-f64::INFINITY, -5.0], -5.0 - c, [0.0, z], MU);
            assert_eq!((low, none, mirrored), (-s, 0.0, below));
        }
        // Of two bounds the one that pushed counts, and the other has what is left.
        let (s, below, above) = resumed([0.0, 1.0], 0.999, [0.0, 4.0], MU);
        assert!((above - 4.0).abs() < 0.01 && s < 1.0, "{s} {above}");
        assert!((below - MU / s).abs() < 1e-12);
        // However far the value is, the slack stays between both.
        let (s, ..) = resumed([0.0, 1.0], 7.0, [1e-3, 0.0], MU);
        assert_eq!(s, 0.9);
        // An equality is where it is, a row without bounds has no multipliers.
        assert_eq!(resumed([2.0, 2.0], 9.0, [0.0, 3.0], MU), (2.0, 0.0, 3.0));
        let free = [-f64::INFINITY, f64::INFINITY];
        assert_eq!(resumed(free, 9.0, [0.0, 0.0], MU), (9.0, 0.0, 0.0));
    }

    #[test]
    fn rows_that_stop_for_themselves_keep_a_tenth() {
        let near = |(s, z): (f64, f64), (slack, multiplier): (f64, f64)| {
            assert!((s - slack).abs() < 1e-12 && (z - multiplier).abs() < 1e-12);
        };
        // The slack is to go far beyond the bound, where the multiplier would be (µ − z ds)/d = 6.001: it grows by a quarter of the way there.
        near(moved(-3.0, 0.9), (0.1, 2.0 + 0.25 * 4.001));
        // Away from the bound the multiplier falls, as far as it may whatever the dual step is.
        near(moved(3.0, 0.9), (4.0, 0.2));
        // A step that has room is taken whole.
        near(moved(-0.5, 0.9), (0.5, 1.001));
        // With common steps by the dual step alone.
        near(moved(-0.5, f64::INFINITY), (0.5, 2.0 - 0.25 * 0.999));
    }
}
