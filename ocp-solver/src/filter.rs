//! Which steps the line search takes: a filter.
//!
//! A step must lower the violation `θ` or the barrier function `φ = cost − µ Σ log distances`, and must not lead
//! back to where both are as bad as at an earlier iterate of the same `µ`. Where the violation is small and the
//! step promises to lower `φ` by more, it must lower `φ` (Wächter and Biegler, "On the implementation of an
//! interior-point filter line-search algorithm for large-scale nonlinear programming", 2006, section 2.3).

use so3::Scalar;
use so3::math::{abs, exp, log, max};

/// Pairs kept; the oldest makes room.
const CAPACITY: usize = 32;

/// Violation and barrier function of a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<T> {
    pub(crate) theta: T,
    pub(crate) phi: T,
}

/// Growth of the violation beyond which a second-order correction is not worth its factorisation, where the violation is large.
const BENT: f64 = 3.0;
/// A large violation, in those at the start.
const LARGE: f64 = 0.1;

/// Earlier iterates that a step must not fall back to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Filter<T> {
    entries: [Point<T>; CAPACITY],
    count: usize,
    /// The barrier parameter of all entries.
    mu: T,
    /// Violation below which a step that promises descent must descend, and the largest allowed.
    small: T,
    largest: T,
    /// Violation from which on one that grew is not the mere bend of a step.
    large: T,
}

impl<T: Scalar> Filter<T> {
    /// No entries; `theta` is the violation at the start.
    pub(crate) fn new(theta: T) -> Self {
        let scale = max(theta, T::ONE);
        let none = Point {
            theta: T::INFINITY,
            phi: T::INFINITY,
        };
        Self {
            entries: [none; CAPACITY],
            count: 0,
            mu: T::ZERO,
            small: T::of(1e-4) * scale,
            largest: T::of(1e4) * scale,
            large: T::of(LARGE) * scale,
        }
    }

    /// Forgets the entries of another barrier parameter: their `φ` was another function.
    pub(crate) fn turn_to(&mut self, mu: T) {
        if mu != self.mu {
            (self.mu, self.count) = (mu, 0);
        }
    }

    /// Forgets all entries.
    pub(crate) const fn clear(&mut self) {
        self.count = 0;
    }

    /// Whether a step of length `alpha` from `from` to `to` is taken; `slope` is the derivative of `φ` along it.
    pub(crate) fn accepts(&self, from: Point<T>, to: Point<T>, alpha: T, slope: T) -> bool {
        if to.theta.is_nan_number() || to.theta > self.largest {
            return false;
        }
        let rounding = T::of(10.0) * T::EPSILON * abs(from.phi);
        let allowed = self
            .entries
            .iter()
            .take(self.count)
            .all(|entry| to.theta <= entry.theta || to.phi <= entry.phi + rounding);
        let share = T::of(1e-5);
        allowed
            && if self.asks_descent(from, alpha, slope) {
                to.phi <= from.phi + T::of(1e-4) * alpha * slope + rounding
            } else {
                to.theta <= (T::ONE - share) * from.theta
                    || to.phi <= from.phi - share * from.theta + rounding
            }
    }

    /// Whether a whole step from `from` to `to`, which is refused, may only lack a second-order correction. Far from the rows steps
    /// miss by more than their curvature, and a correction is refused as well.
    pub(crate) fn may_be_bent(&self, from: Point<T>, to: Point<T>) -> bool {
        to.theta <= self.large || to.theta <= T::of(BENT) * from.theta
    }

    /// Remembers where an accepted step left from, unless it was taken for its descent.
    pub(crate) fn remember(&mut self, from: Point<T>, alpha: T, slope: T) {
        if self.asks_descent(from, alpha, slope) {
            return;
        }
        let share = T::of(1e-5);
        let entry = Point {
            theta: (T::ONE - share) * from.theta,
            phi: from.phi - share * from.theta,
        };
        let place = self.count.min(CAPACITY);
        if place == CAPACITY {
            self.entries.rotate_left(1);
        }
        if let Some(slot) = self.entries.get_mut(place.min(CAPACITY - 1)) {
            *slot = entry;
        }
        self.count = place.saturating_add(1).min(CAPACITY);
    }

    /// The switching condition: `α (−slope)^2.3 > θ^1.1` at a small violation.
    fn asks_descent(&self, from: Point<T>, alpha: T, slope: T) -> bool {
        let power = |base: T, exponent: f64| exp(T::of(exponent) * log(base));
        slope < T::ZERO
            && from.theta <= self.small
            && (from.theta <= T::ZERO || alpha * power(-slope, 2.3) > power(from.theta, 1.1))
    }
}

/// A sum of logarithms that takes few of them: factors are multiplied as long as their product stays in range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogSum<T> {
    sum: T,
    product: T,
}

impl<T: Scalar> LogSum<T> {
    pub(crate) const fn new() -> Self {
        Self {
            sum: T::ZERO,
            product: T::ONE,
        }
    }

    /// Adds `log x` of a positive `x`; infinities count as nothing.
    #[inline(always)]
    pub(crate) fn add(&mut self, x: T) {
        if x < T::INFINITY {
            self.product *= x;
            if !(self.product > T::of(1e-12) && self.product < T::of(1e12)) {
                self.sum += log(self.product);
                self.product = T::ONE;
            }
        }
    }

    pub(crate) fn total(&self) -> T {
        self.sum + log(self.product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(theta: f64, phi: f64) -> Point<f64> {
        Point { theta, phi }
    }

    #[test]
    fn steps_must_lower_one_of_the_two_and_not_fall_back() {
        let mut filter = Filter::new(1.0);
        filter.turn_to(0.1);
        let from = at(1.0, 5.0);
        assert!(filter.accepts(from, at(0.5, 9.0), 1.0, 1.0));
        assert!(filter.accepts(from, at(2.0, 4.0), 1.0, 1.0));
        assert!(!filter.accepts(from, at(1.0, 5.0), 1.0, 1.0));
        assert!(!filter.accepts(from, at(f64::NAN, 4.0), 1.0, 1.0));
        filter.remember(from, 1.0, 1.0);
        // From elsewhere, but back to what the first point was.
        assert!(!filter.accepts(at(3.0, 7.0), at(1.5, 6.0), 1.0, 1.0));
        assert!(filter.accepts(at(3.0, 7.0), at(0.9, 6.0), 1.0, 1.0));
        filter.turn_to(0.01);
        assert!(filter.accepts(at(3.0, 7.0), at(1.5, 6.0), 1.0, 1.0));
    }

    #[test]
    fn a_violation_that_grows_far_from_the_rows_is_no_bend() {
        let filter = Filter::new(100.0);
        let bent = |from, to| filter.may_be_bent(at(from, 0.0), at(to, 0.0));
        assert!(bent(20.0, 60.0) && !bent(20.0, 60.1));
        // Near the rows a whole step may make much of a little.
        assert!(bent(1e-9, 10.0) && !bent(1e-9, 10.1));
    }

    #[test]
    fn descent_is_asked_for_where_the_violation_is_small() {
        let mut filter = Filter::new(1.0);
        filter.turn_to(0.1);
        let from = at(1e-6, 5.0);
        // θ falls, but φ was promised to fall by one.
        assert!(!filter.accepts(from, at(0.0, 5.0), 1.0, -1.0));
        assert!(filter.accepts(from, at(1e-5, 4.9), 1.0, -1.0));
        // Such steps leave no entry, so the way back stays open.
        filter.remember(from, 1.0, -1.0);
        assert!(filter.accepts(at(1.0, 9.0), from, 1.0, 0.0));
    }

    #[test]
    fn the_filter_forgets_the_oldest() {
        let mut filter = Filter::new(1.0);
        for i in 0..40 {
            let i = f64::from(i);
            filter.remember(at(100.0 - i, i), 1.0, 1.0);
        }
        assert_eq!(filter.count, CAPACITY);
        assert!((filter.entries[0].phi - 8.0).abs() < 1e-2);
    }

    #[test]
    fn log_sums_are_logarithms() {
        let mut sum = LogSum::new();
        let mut exact = 0.0;
        for i in 1..100 {
            let x = exp(-2.3 * f64::from(i % 23)) * f64::from(i);
            sum.add(x);
            exact += log(x);
        }
        sum.add(f64::INFINITY);
        assert!((sum.total() - exact).abs() < 1e-10 * exact.abs());
    }
}
