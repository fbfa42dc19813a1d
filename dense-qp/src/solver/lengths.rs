//! How far variables go, in their own units: what a proximal step should be where there is no curvature to say.

use so3::{Scalar, math};

use super::Search;
use crate::access::{at, put};

/// Lengths up to this many times the least are like it: they are a guess. Then equal weights keep what is exact of small integers exact, and the
/// way along a ray straight.
const LIKE: f64 = 1000.0;

impl<T: Scalar, const N: usize, const M: usize> Search<'_, '_, '_, T, N, M> {
    /// Into `vec_b`, for free variables without curvature, C/L²: with the lengths L of the variables and the largest curvature C = max H L², or where
    /// H is zero the largest slope C = max |g| L. So steps are the same in any units. Where lengths are alike all get
    /// `unscaled`, and so does a variable of which nobody knows how far it goes. `step` and `vec_a` are scratch.
    pub(super) fn weigh_linear(&mut self, unscaled: T) {
        let w = &mut *self.w;
        let free = w.elimination.free();
        w.elimination.reduce(self.p.gradient, &mut w.vec_a);
        let (mut curvature, mut slope) = (T::ZERO, T::ZERO);
        let (mut least, mut most) = (T::INFINITY, T::ZERO);
        for k in 0..free {
            let (g, h) = (at(&self.w.vec_a, k), at(&self.w.factor.weight, k));
            let variable = at(self.w.elimination.free_variables(), k);
            let length = self.length(variable, [math::abs(g), h]);
            put(&mut self.w.step, k, length);
            if length > T::ZERO {
                (least, most) = (math::min(least, length), math::max(most, length));
            }
            curvature = math::max(curvature, h * length * length);
            slope = math::max(slope, math::abs(g) * length);
        }
        let w = &mut *self.w;
        w.vec_b.fill(unscaled);
        if most <= least * T::of(LIKE) {
            return;
        }
        let cost = if curvature > T::ZERO {
            curvature
        } else {
            slope
        };
        for (own, length) in w.vec_b.iter_mut().zip(&w.step) {
            let weight = cost / (*length * *length);
            if is_length(weight) {
                *own = weight;
            }
        }
    }

    /// How far a variable goes: the range between its bounds, or the distance of its one bound from the origin, or those of its rows. The geometric mean of
    /// the least and the largest that a number can have digits of beside the least. With a curvature of its own the least, and no more than the way to
    /// where its slope `[g, h]` ends. Zero where nothing says.
    fn length(&self, variable: usize, [g, h]: [T; 2]) -> T {
        let (l, u) = self.p.limits(M + variable);
        let range = u - l;
        let of_bounds = if range.is_finite_number() {
            [range; 2]
        } else {
            [math::abs(l), math::abs(u)]
        };
        let of_rows = || (0..M).map(|i| self.distance(i, variable));
        let lengths = || {
            of_bounds
                .into_iter()
                .chain(of_rows())
                .filter(|x| is_length(*x))
        };
        let to_rest = Some(g / h).filter(|x| is_length(*x));
        let least = lengths().chain(to_rest).reduce(math::min);
        let Some(least) = least else { return T::ZERO };
        if h > T::ZERO {
            return least;
        }
        let near = lengths().filter(|length| *length * T::EPSILON <= least);
        math::sqrt(least) * math::sqrt(near.fold(least, math::max))
    }

    /// How far from the origin a variable alone meets the farther limit of row `i`.
    fn distance(&self, i: usize, variable: usize) -> T {
        let (l, u) = self.p.limits(i);
        let (from, entries) = self.p.entries(i);
        let entry = variable
            .checked_sub(from)
            .map_or(T::ZERO, |j| at(entries, j));
        let finite = [l, u].into_iter().filter(|limit| limit.is_finite_number());
        let limit = finite.fold(T::ZERO, |largest, limit| {
            math::max(largest, math::abs(limit))
        });
        limit / math::abs(entry)
    }
}

/// Whether it is above zero and finite.
fn is_length<T: Scalar>(x: T) -> bool {
    x > T::ZERO && x.is_finite_number()
}
