//! How far the present point is from optimal, and whether what is left is round-off.

use so3::{Scalar, math};

use super::{EQUALITY, Search, scale_inverse, signed};
use crate::access::{at, head};
use crate::kernels::{dot_sizes, dots, max_abs};
use crate::residual::{norm, worse};

/// Round-off of evaluating a gradient, in ε of its terms.
pub(super) const NOISE: f64 = 32.0;
/// What corrections that no longer help may leave of a gradient, in ε of its terms: with no gradient at the optimum there is nothing else
/// to measure it by, and there the cost is round-off as well, of which every few steps seem to lower it. Below the default tolerances.
pub(super) const SETTLED: f64 = 1024.0;

/// What is left at a point that meets all rows.
pub(super) struct Rest<T> {
    /// Largest reduced entry of Hx + g + Aᵀλ, and of its terms.
    pub(super) residual: T,
    pub(super) scale: T,
    /// Largest distance of an active row from its limit.
    pub(super) drift: T,
}

impl<T: Scalar, const N: usize, const M: usize> Search<'_, '_, '_, T, N, M> {
    /// gradient ← Hx + g + N_Wᵀλ; returns the size of its largest term.
    pub(super) fn evaluate_gradient(&mut self) -> T {
        let w = &mut *self.w;
        dots(&mut w.gradient, self.p.hessian, &w.x, [0, N]);
        let larger = |high: T, size: T| if size > high { size } else { high };
        let (mut scale, mut worth, mut unsound) = (T::ZERO, T::ZERO, T::ZERO);
        for ((out, g), x) in w.gradient.iter_mut().zip(self.p.gradient).zip(&w.x) {
            let (share, push) = (math::abs(*out), math::abs(*g));
            scale = larger(scale, larger(share, push));
            worth += math::abs(*x) * (share + push);
            *out += *g;
            // 0·v is 0 for a finite v and NaN otherwise.
            unsound += *out * T::ZERO;
        }
        scale += unsound;
        self.worth = worth;
        for k in 0..w.basis.len {
            let (id, f) = (at(&w.id, k), signed(at(&w.side, k), at(&w.lambda, k)));
            scale = worse(
                scale,
                math::abs(f) / scale_inverse::<T, N, M>(self.p, w, id),
            );
            self.p.add_row(id, f, &mut w.gradient);
        }
        scale
    }

    /// Measures the present point; leaves Zᵀ·gradient in `vec_a`.
    pub(super) fn measure(&mut self) -> Rest<T> {
        let scale = self.evaluate_gradient();
        self.reduce_gradient();
        let residual = norm(head(&self.w.vec_a, self.w.factor.dim));
        let drift = self.drift();
        Rest {
            residual,
            scale,
            drift,
        }
    }

    /// Zᵀ·gradient into `vec_a`.
    pub(super) fn reduce_gradient(&mut self) {
        let w = &mut *self.w;
        w.elimination.reduce(&w.gradient, &mut w.vec_a);
    }

    /// Far inside all tolerances. `vec_a` as [`Search::measure`] left it.
    pub(super) fn is_tight(&self, rest: &Rest<T>) -> bool {
        let margin = T::of(0.01);
        let least = margin * self.s.optimality;
        if !(rest.residual <= least * rest.scale && rest.drift <= margin * self.s.feasibility) {
            return false;
        }
        // rᵀH⁻¹r with D for H: the margin stands for what U would add.
        self.gain(rest.scale) + self.toll <= least * self.worth_beside(rest)
    }

    /// What is left to gain of the cost, from the reduced gradient r in `vec_a` or from U⁻ᵀr, which is r where there is no curvature: rᵀD⁻¹r, and
    /// all the way to the bound where nothing but the bound ends the gain. There an entry that is round-off of multipliers, beside terms of this `scale`,
    /// goes nowhere.
    fn gain(&self, scale: T) -> T {
        let noise = T::of(8.0) * T::EPSILON * scale;
        let w = &*self.w;
        let entries = w.vec_a.iter().zip(&w.factor.weight).take(w.factor.dim);
        if !w.factor.proximal {
            return entries.fold(T::ZERO, |sum, (r, w)| sum + *r * *r * *w);
        }
        let of = |(k, (r, weight)): (usize, (&T, &T))| {
            if math::abs(*r) <= noise || !at(&w.factor.linear, k) {
                return *r * *r * *weight;
            }
            let i = at(w.elimination.free_variables(), k);
            let (l, u) = self.p.limits(M + i);
            let x = at(&w.x, i);
            let room = if *r > T::ZERO { x - l } else { u - x };
            math::abs(*r) * math::max(room, T::ZERO)
        };
        entries.enumerate().map(of).fold(T::ZERO, |sum, x| sum + x)
    }

    /// The terms of the cost; at the origin there are none, and lengths count from the distance by which rows may be missed.
    fn worth_beside(&self, rest: &Rest<T>) -> T {
        math::max(self.worth, self.s.feasibility * rest.scale)
    }

    /// Inside the tolerances, or as near as round-off lets a point come, up to `noise`·ε of its terms. `vec_a` as [`Search::measure`]
    /// left it.
    pub(super) fn is_within(&mut self, rest: &Rest<T>, noise: f64) -> bool {
        if rest.drift > self.s.feasibility && !self.is_drift_round_off() {
            return false;
        }
        let reduced = self.w.vec_a;
        if rest.residual <= self.s.optimality * rest.scale {
            let w = &mut *self.w;
            w.factor.solve_transposed(&mut w.vec_a);
            // A proximal step is no measure of those that would follow.
            let margin = T::of(if w.factor.proximal { 0.01 } else { 1.0 });
            if self.gain(rest.scale) + self.toll
                <= margin * self.s.optimality * self.worth_beside(rest)
            {
                return true;
            }
        }
        self.is_gradient_round_off(&reduced, T::of(noise) * T::EPSILON)
    }

    /// Round-off of evaluating row `i` at the present x, as a distance; `inverse` is the row's scale, `limit` its limit. What it hides
    /// where x has run away has a bound.
    #[inline]
    pub(super) fn row_noise(&self, i: usize, limit: T, inverse: T) -> T {
        let noise = T::of(32.0) * T::EPSILON * self.p.size_at(i, &self.w.x) * inverse;
        math::min(noise, self.most_noise(limit, inverse))
    }

    /// The most that [`Search::row_noise`] can be.
    #[inline]
    pub(super) fn most_noise(&self, limit: T, inverse: T) -> T {
        let most = T::of(1000.0) * self.s.feasibility;
        most * math::max(T::ONE, math::abs(limit) * inverse)
    }

    /// Whether x is on the active rows and the equalities, as near as the tolerance or round-off says.
    pub(super) fn is_on_active(&mut self) -> bool {
        self.drift() <= self.s.feasibility || self.is_drift_round_off()
    }

    fn is_drift_round_off(&mut self) -> bool {
        for i in 0..M + N {
            let state = self.w.state(i);
            if state == 0 || (state == EQUALITY && i >= M) {
                continue;
            }
            let (l, u) = self.p.limits(i);
            let (e, limit) = if state > 0 {
                (self.excess(i, 1), u)
            } else {
                (self.excess(i, -1), l)
            };
            let inverse = scale_inverse::<T, N, M>(self.p, self.w, i);
            let far = math::abs(e) * inverse;
            if far > self.s.feasibility && far > self.row_noise(i, limit, inverse) {
                return false;
            }
        }
        true
    }

    /// Whether every entry of the reduced gradient is at most a share `noise` of its own terms. Leaves these in `step` and `vec_a`.
    fn is_gradient_round_off(&mut self, reduced: &[T; N], noise: T) -> bool {
        let w = &mut *self.w;
        let rows = self.p.hessian.iter().zip(self.p.gradient);
        for (out, (h, g)) in w.step.iter_mut().zip(rows) {
            // At the origin as well lengths count from the distance by which rows may be missed.
            *out = dot_sizes(h, &w.x) + math::abs(*g) + self.s.feasibility * max_abs(h);
        }
        for k in 0..w.basis.len {
            let (id, f) = (at(&w.id, k), math::abs(at(&w.lambda, k)));
            if id < M {
                let (from, a) = self.p.entries(id);
                let terms = w.step.iter_mut().skip(from);
                terms.zip(a).for_each(|(t, a)| *t += math::abs(f * *a));
            } else if let Some(t) = w.step.get_mut(id - M) {
                *t += f;
            }
        }
        w.elimination.reduce_sizes(&w.step, &mut w.vec_a);
        let mut entries = reduced.iter().zip(&w.vec_a).take(w.factor.dim);
        if !entries.all(|(r, terms)| math::abs(*r) <= noise * *terms) {
            return false;
        }
        // Where x has run away so far that limits drown in round-off, terms hide a gradient that is none.
        let largest = noise * max_abs(head(&w.vec_a, w.factor.dim));
        largest <= self.s.optimality * T::of(1000.0) * max_abs(self.p.gradient)
            || max_abs(&self.w.x) * T::EPSILON <= T::of(1e-4) * self.reach()
    }

    /// The largest distance of a limit from the origin.
    pub(super) fn reach(&mut self) -> T {
        let mut reach = T::ZERO;
        for i in 0..M + N {
            let (l, u) = self.p.limits(i);
            let inverse = scale_inverse::<T, N, M>(self.p, self.w, i);
            for limit in [l, u] {
                if limit.is_finite_number() {
                    reach = math::max(reach, math::abs(limit) * inverse);
                }
            }
        }
        reach
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::{NOISE, Search};
    use crate::{Problem, Settings, Workspace, solve};

    const INF: f64 = f64::INFINITY;

    /// Active bound x₀ ≤ 1, active row x₁ ≥ 1, equality x₂ = 1: a point that has left one of them by more than round-off is not on them.
    #[test]
    fn a_point_off_a_bound_a_row_or_an_equality_is_not_on_them() {
        let h = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (a, l, u) = ([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [1.0; 2], [INF, 1.0]);
        let (lower, upper) = ([-INF; 3], [1.0, INF, INF]);
        let p = Problem::new(&h, &[-4.0, 0.0, 0.0], &a, &l, &u).with_bounds(&lower, &upper);
        let (settings, mut w) = (Settings::default(), Workspace::new());
        let x = *solve(&p, &settings, &mut w).unwrap().x;
        assert!(Search::new(&p, &settings, &mut w).is_on_active());
        for i in 0..3 {
            for by in [1e-3, -1e-3, 1e-8, -1e-8] {
                w.x = x;
                w.x[i] += by;
                assert!(!Search::new(&p, &settings, &mut w).is_on_active(), "{i}");
            }
        }
    }

    /// min ½x₀² − x₀ + ½ 1e-14 x₁²: at (1, 50) the gradient is 5e-13 beside terms of 1, but the cost can fall by a share of 1e-11.
    #[test]
    fn a_small_gradient_along_a_flat_direction_is_not_the_end() {
        let (h, g) = ([[1.0, 0.0], [0.0, 1e-14]], [-1.0, 0.0]);
        let (a, l, u): ([[f64; 2]; 0], [f64; 0], [f64; 0]) = ([], [], []);
        let p = Problem::new(&h, &g, &a, &l, &u);
        let (settings, mut w) = (Settings::default(), Workspace::new());
        solve(&p, &settings, &mut w).unwrap();
        for (x, is_end) in [(0.0, true), (50.0, false)] {
            w.x[1] = x;
            let mut search = Search::new(&p, &settings, &mut w);
            let rest = search.measure();
            assert!(rest.residual <= 0.01 * settings.optimality * rest.scale);
            assert_eq!(search.is_tight(&rest), is_end, "{x}");
        }
    }

    /// Beside a multiplier of 1e6 a distance of 9e-10 from the limit is worth more of the cost than the tolerance, one of 1e-11 is not;
    /// though both are small as distances, and the gradient is small as well, but not round-off.
    #[test]
    fn what_distances_are_worth_counts() {
        let p = Problem::new(&[[1.0]], &[-1e6], &[[1.0]], &[-INF], &[1.0]);
        let (settings, mut w) = (Settings::default(), Workspace::new());
        solve(&p, &settings, &mut w).unwrap();
        w.lambda[0] *= 1.0 + 1e-12;
        for (distance, is_within) in [(1e-11, true), (9e-10, false)] {
            w.x[0] = 1.0 + distance;
            let mut search = Search::new(&p, &settings, &mut w);
            let rest = search.measure();
            assert!(rest.drift <= settings.feasibility);
            assert_eq!(search.is_within(&rest, NOISE), is_within, "{distance}");
        }
    }

    /// 1e14 along a direction without curvature, the terms of Hx hide a gradient of ½. That is round-off where limits are as far, and none
    /// where they are near the origin: x has run away.
    #[test]
    fn a_gradient_does_not_hide_where_x_has_run_away() {
        let (h, g) = ([[1.0, -1.0], [-1.0, 1.0]], [-0.5; 2]);
        for (far, is_round_off) in [(1e14, true), (1.0, false)] {
            let (a, l, u) = ([[1.0, 0.0]], [-INF], [far]);
            let p = Problem::new(&h, &g, &a, &l, &u);
            let (settings, mut w) = (Settings::default(), Workspace::new());
            w.x = [1e14; 2];
            w.factor.dim = 2;
            let mut search = Search::new(&p, &settings, &mut w);
            let noise = NOISE * f64::EPSILON;
            assert_eq!(
                search.is_gradient_round_off(&g, noise),
                is_round_off,
                "{far}"
            );
        }
    }
}
