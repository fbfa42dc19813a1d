//! Why there is no solution: rows that contradict each other, and rays along which the cost falls without end.

use so3::{Scalar, math};

use super::exchange::Pass;
use super::outcome::set_multiplier;
use super::{EQUALITY, Search, scale_inverse, signed};
use crate::Status;
use crate::access::{at, put};
use crate::kernels::{dot, dot_sizes, max_abs, sub_scaled};
use crate::residual::{infeasibility, worse};
use crate::settings::{proximal_weight, row_tolerance};

impl<T: Scalar, const N: usize, const M: usize> Search<'_, '_, '_, T, N, M> {
    /// The entering row depends on the active ones and nothing blocks: y = 1 on it, −r on them.
    pub(super) fn conflict(&mut self, id: usize, side: i8) -> Status {
        let w = &mut *self.w;
        w.row_multipliers.fill(T::ZERO);
        w.bound_multipliers.fill(T::ZERO);
        for k in 0..w.basis.len {
            let y = math::max(-at(&w.vec_b, k), T::ZERO);
            let (row, side) = (at(&w.id, k), at(&w.side, k));
            set_multiplier(w, row, if side > 0 { y } else { -y });
        }
        set_multiplier(w, id, if side > 0 { T::ONE } else { -T::ONE });
        if self.prove() == Status::Infeasible {
            return Status::Infeasible;
        }
        self.refine();
        self.prove()
    }

    /// Takes out of the sum of a proof that was not confirmed what round-off of r has left there, as far as the active rows span it: far out,
    /// in f32, it is enough to leave room for a feasible point.
    fn refine(&mut self) {
        let w = &mut *self.w;
        for k in 0..w.elimination.rank {
            let id = at(&w.elimination.id, k);
            set_multiplier(w, id, T::ZERO);
        }
        w.gradient = w.bound_multipliers;
        for (i, y) in w.row_multipliers.iter().enumerate() {
            if *y != T::ZERO {
                self.p.add_row(i, *y, &mut w.gradient);
            }
        }
        let candidate = w.candidate.d;
        w.gradient_coordinates();
        self.answer();
        self.w.candidate.d = candidate;
        for k in 0..self.w.basis.len {
            let (id, side, r) = (at(&self.w.id, k), at(&self.w.side, k), at(&self.w.vec_b, k));
            let y = math::max(signed(side, self.multiplier(id)) - r, T::ZERO);
            set_multiplier(self.w, id, signed(side, y));
        }
    }

    /// The multiplier of a row or bound in a proof.
    fn multiplier(&self, id: usize) -> T {
        if id < M {
            at(&self.w.row_multipliers, id)
        } else {
            at(&self.w.bound_multipliers, id - M)
        }
    }

    /// A dependent equality that the earlier ones contradict.
    pub(super) fn contradiction(&mut self, id: usize, positive: bool) -> Status {
        let w = &mut *self.w;
        w.row_multipliers.fill(T::ZERO);
        w.bound_multipliers.fill(T::ZERO);
        w.x.fill(T::ZERO);
        w.factor.dim = 0;
        w.basis.clear();
        set_multiplier(w, id, if positive { T::ONE } else { -T::ONE });
        self.prove()
    }

    /// Completes a proof with the equalities, scales it to max 1, and believes it only if the
    /// numbers of the problem themselves confirm it.
    fn prove(&mut self) -> Status {
        let w = &mut *self.w;
        let mut sum = w.bound_multipliers;
        for (i, y) in w.row_multipliers.iter().enumerate() {
            if *y != T::ZERO {
                self.p.add_row(i, *y, &mut sum);
            }
        }
        w.elimination.multipliers(&sum, &mut w.vec_a);
        for k in 0..w.elimination.rank {
            let (id, mu) = (at(&w.elimination.id, k), at(&w.vec_a, k));
            set_multiplier(w, id, mu);
        }
        // What is round-off is told by forces, |y| max|a|: rows in other units have other multipliers.
        let mut strongest = T::ZERO;
        for i in 0..M + N {
            strongest = math::max(strongest, self.force_of(i));
        }
        let noise = T::of(4.0) * T::EPSILON * strongest;
        for i in 0..M + N {
            if self.force_of(i) <= noise {
                set_multiplier(self.w, i, T::ZERO);
            }
        }
        let w = &mut *self.w;
        let largest = math::max(max_abs(&w.row_multipliers), max_abs(&w.bound_multipliers));
        let inverse = T::ONE / largest;
        for y in w.row_multipliers.iter_mut().chain(&mut w.bound_multipliers) {
            *y *= inverse;
        }
        if self.is_contradiction() {
            Status::Infeasible
        } else {
            Status::Numerical
        }
    }

    /// |y| max|a| of a row's multiplier.
    fn force_of(&mut self, i: usize) -> T {
        math::abs(self.multiplier(i)) / scale_inverse::<T, N, M>(self.p, self.w, i)
    }

    /// Whether the caller's own numbers confirm the multipliers as a proof: with c = Aᵀy + μ, every feasible x has cᵀx ≤ support, so
    /// that its least value over the bounds must exceed `support`, by more than the round-off of both. An entry of c that is round-off
    /// of its terms counts as zero. One that is more and has no bound to multiply leaves a proof that no feasible point is within ten
    /// times the reach of the present one.
    fn is_contradiction(&self) -> bool {
        let (rows, bounds) = (&self.w.row_multipliers, &self.w.bound_multipliers);
        let noise = T::of(32.0) * T::EPSILON;
        let proof = infeasibility(self.p, rows, bounds);
        let (mut least, mut terms, mut open) = (T::ZERO, T::ZERO, T::ZERO);
        for (i, y) in rows.iter().chain(bounds).enumerate() {
            let (l, u) = self.p.limits(i);
            if *y != T::ZERO {
                terms += math::abs(*y * if *y > T::ZERO { u } else { l });
            }
        }
        for (i, mu) in bounds.iter().enumerate() {
            let (mut c, mut size) = (*mu, math::abs(*mu));
            for (a, y) in self.p.rows.iter().zip(rows) {
                if *y != T::ZERO {
                    let term = at(a, i) * *y;
                    c += term;
                    size += math::abs(term);
                }
            }
            if math::abs(c) <= noise * size {
                continue;
            }
            let (l, u) = self.p.limits(M + i);
            let value = c * if c > T::ZERO { l } else { u };
            if value.is_finite_number() {
                least += value;
                terms += math::abs(value);
            } else {
                open = worse(open, math::abs(c));
            }
        }
        let gap = least - proof.support;
        let reach = math::max(T::ONE, max_abs(&self.w.x)) * T::of(10.0);
        gap > noise * terms && open * reach <= gap
    }

    /// Whether the caller's own numbers have negative curvature along the direction in which pivot `k` of the factor found some.
    pub(super) fn is_concave(&mut self, k: usize) -> bool {
        let w = &mut *self.w;
        w.factor.concave(k, &mut w.vec_b);
        let free = w.elimination.free();
        w.elimination.expand(&w.vec_b, free, &mut w.step);
        let (mut curvature, mut terms) = (T::ZERO, T::ZERO);
        for (d, h) in w.step.iter().zip(self.p.hessian) {
            curvature += *d * dot(h, &w.step);
            terms += math::abs(*d) * dot_sizes(h, &w.step);
        }
        curvature < -(T::of(32.0) * T::EPSILON * terms)
    }

    /// Along the last proximal step: goes on to where the cost is least or the first limit stops it, which is far where the curvature
    /// is small beside the proximal weight. Without curvature and limits the cost has no minimum.
    /// `cost` is that of the last step by which it fell by more than round-off.
    pub(super) fn ray_step(&mut self, cost: &mut T) -> Ray {
        let w = &mut *self.w;
        let mut length = T::ZERO;
        for (before, x) in w.previous.iter_mut().zip(&w.x) {
            *before = *x - *before;
            length = worse(length, math::abs(*before));
        }
        if !(length > T::ZERO && length.is_finite_number()) {
            return Ray::Stays;
        }
        scale_direction(&mut w.previous, length);
        // A correction of a variable that the equalities hold is no rate: they would take it back after every step.
        if w.elimination.rank > 0 {
            w.elimination.complete(&mut w.previous, &mut w.vec_a);
        }
        let mut course = self.course();
        if course.is_ascent() {
            return self.follow_fall(&course, length, cost);
        }
        // The next proximal step gets there as well.
        if course.minimum() <= length {
            return Ray::Stays;
        }
        // A step also corrects what the last one left across the ray: curvature and limits of such a share are not the ray's.
        let is_bent = course.minimum() < T::INFINITY && course.minimum() > length + length;
        let is_open = course.is_nearly_straight() && self.first_limit(length) == T::INFINITY;
        let is_refined = (is_bent || is_open) && self.is_descent();
        if is_refined {
            // Each round takes all but a share of what is left of curvature in the direction, the proximal weight's.
            for _ in 0..ROUNDS {
                let before = course.minimum();
                if !self.purify() {
                    self.evaluate_gradient();
                    return Ray::Stays;
                }
                if self.is_ray() {
                    return Ray::Endless;
                }
                course = self.course();
                if course.minimum() < T::INFINITY && course.minimum() <= T::of(4.0) * before {
                    break;
                }
            }
        }
        let limit = self.first_limit(T::INFINITY);
        let reach = math::min(course.minimum(), limit);
        // A limit that only seems to come nearer is no place to go to: x would lose its digits on the way.
        let is_seeming = reach == limit && limit < self.first_limit(length);
        if reach == T::INFINITY && !is_refined {
            return self.follow_fall(&course, length, cost);
        }
        if course.is_ascent() || is_seeming || !(reach > T::ZERO && reach < T::INFINITY) {
            if is_refined {
                // It has lent its place to the direction's.
                self.evaluate_gradient();
            }
            return Ray::Stays;
        }
        self.go(reach)
    }

    /// Along a last proximal step whose slope or curvature is lost in round-off, if the cost has fallen all the same: as far as it falls at
    /// the least, whatever curvature round-off may hide. Steps alone would creep there, in f32 by dozens.
    fn follow_fall(&mut self, course: &Course<T>, length: T, cost: &mut T) -> Ray {
        let reach = -course.slope / math::max(course.curvature, course.curvature_noise);
        if !(reach > length && reach < T::INFINITY) {
            return Ray::Stays;
        }
        let now = self.p.cost(&self.w.x);
        if !has_fallen(now, *cost, self.worth) {
            return Ray::Stays;
        }
        *cost = now;
        let limit = self.first_limit(length);
        self.go(math::min(reach, limit))
    }

    /// Moves x along the direction in `previous`.
    fn go(&mut self, reach: T) -> Ray {
        let w = &mut *self.w;
        sub_scaled(&mut w.x, -reach, &w.previous);
        self.evaluate_gradient();
        Ray::Moved
    }

    /// Slope and curvature of the cost at x along `previous`.
    fn course(&self) -> Course<T> {
        let (x, d) = (&self.w.x, &self.w.previous);
        let mut course = Course {
            slope: T::ZERO,
            slope_noise: T::ZERO,
            curvature: T::ZERO,
            curvature_noise: T::ZERO,
        };
        for (i, (h, g)) in self.p.hessian.iter().zip(self.p.gradient).enumerate() {
            let (di, hd, size) = (at(d, i), dot(h, d), dot_sizes(h, d));
            course.curvature += di * hd;
            course.curvature_noise += math::abs(di) * size;
            course.slope += *g * di + hd * at(x, i);
            course.slope_noise += math::abs(*g * di) + size * math::abs(at(x, i));
        }
        let noise = T::of(32.0) * T::EPSILON;
        course.curvature_noise *= noise;
        course.slope_noise *= noise;
        course
    }

    /// How far x can go along `previous`. An active row stops it only by more than the round-off that holding the row leaves; others only if
    /// a step of this `length` comes nearer to them by more than x may miss a row by: a step corrects such misses, which is no course.
    fn first_limit(&mut self, length: T) -> T {
        let mut far = T::INFINITY;
        for i in 0..M + N {
            let state = self.w.state(i);
            if state == EQUALITY {
                continue;
            }
            let (l, u) = self.p.limits(i);
            let rate = self.p.value(i, &self.w.previous);
            let limit = if rate > T::ZERO { u } else { l };
            let inverse = scale_inverse::<T, N, M>(self.p, self.w, i);
            let least = if state == 0 {
                let noise = T::of(32.0) * T::EPSILON * self.p.size_at(i, &self.w.previous);
                math::max(noise, self.s.feasibility / (length * inverse))
            } else {
                row_tolerance::<T>() / inverse
            };
            if limit.is_finite_number() && math::abs(rate) > least {
                let room = (limit - self.p.value(i, &self.w.x)) / rate;
                far = math::min(far, math::max(room, T::ZERO));
            }
        }
        far
    }

    /// Ends at a ray in `previous`, far out on which x is. Brings x back along it, as near to the origin as limits let it, and into the rows
    /// again: far away their round-off is a violation, and hides others. The ray is one of every point that meets all rows.
    pub(super) fn come_back(&mut self) -> Status {
        let w = &mut *self.w;
        let beyond = dot(&w.x, &w.previous) / dot(&w.previous, &w.previous);
        if beyond > T::ZERO {
            w.previous = w.previous.map(|d| -d);
            let back = math::min(beyond, self.first_limit(T::INFINITY));
            let w = &mut *self.w;
            sub_scaled(&mut w.x, -back, &w.previous);
            w.previous = w.previous.map(|d| -d);
        }
        for _ in 0..ROUNDS {
            self.meet_active();
            self.w.pool_len = 0;
            match self.search() {
                Pass::Feasible => {}
                Pass::Stop(status) => return status,
            }
            if self.is_on_active() {
                return Status::Unbounded;
            }
        }
        Status::Numerical
    }

    /// Takes out of the direction in `previous` what the equalities, the active rows and H do not allow and round-off of x has left in
    /// it: one proximal step from it without a gradient. Returns whether half the digits of a direction are left: where the last step was a
    /// correction across the active rows, what is left is round-off.
    fn purify(&mut self) -> bool {
        let w = &mut *self.w;
        w.elimination.complete(&mut w.previous, &mut w.vec_a);
        w.basis.prepare(&w.factor, &w.elimination);
        for (out, h) in w.gradient.iter_mut().zip(self.p.hessian) {
            *out = dot(h, &w.previous);
        }
        w.gradient_coordinates();
        for k in 0..w.basis.len {
            let (id, side) = (at(&w.id, k), at(&w.side, k));
            let rate = self.p.value(id, &w.previous);
            put(&mut w.vec_b, k, signed(side, rate));
        }
        self.aim();
        let w = &mut *self.w;
        w.basis.direction(0, &w.candidate.d, &mut w.step);
        sub_scaled(&mut w.previous, T::ONE, &w.step);
        let length = max_abs(&w.previous);
        scale_direction(&mut w.previous, length);
        length * length > T::EPSILON
    }

    /// Whether the gradient alone falls along `previous`, by a share of its terms that round-off leaves no doubt about.
    fn is_descent(&self) -> bool {
        let (g, d) = (self.p.gradient, &self.w.previous);
        dot(g, d) < -(T::of(1024.0) * T::EPSILON * dot_sizes(g, d))
    }

    /// Whether the caller's own numbers confirm the direction in `previous` as one along which the cost falls without end: no
    /// curvature, no finite limit ahead, a slope below zero, each up to round-off of its own terms.
    fn is_ray(&self) -> bool {
        let d = &self.w.previous;
        let noise = T::of(64.0) * T::EPSILON;
        let straight = |h: &[T; N]| math::abs(dot(h, d)) <= noise * dot_sizes(h, d);
        let clear = |i: usize| {
            let (l, u) = self.p.limits(i);
            let (rate, least) = (self.p.value(i, d), noise * self.p.size_at(i, d));
            (rate <= least || u == T::INFINITY) && (rate >= -least || l == -T::INFINITY)
        };
        self.is_descent() && self.p.hessian.iter().all(straight) && (0..M + N).all(clear)
    }
}

/// Whether the cost has fallen by more than round-off of its terms.
pub(super) fn has_fallen<T: Scalar>(now: T, before: T, terms: T) -> bool {
    now < before - T::of(8.0) * T::EPSILON * terms
}

/// d ← d/length, without entries that are only what round-off leaves where bounds and rows hold x: each would look like a rate.
fn scale_direction<T: Scalar>(d: &mut [T], length: T) {
    for d in d {
        *d /= length;
        if math::abs(*d) <= T::of(16.0) * T::EPSILON {
            *d = T::ZERO;
        }
    }
}

/// Most corrections of a direction that may be a ray.
const ROUNDS: u32 = 4;

/// What came of following a proximal step.
#[derive(PartialEq)]
pub(super) enum Ray {
    Stays,
    Moved,
    Endless,
}

/// The cost along a direction.
struct Course<T> {
    slope: T,
    slope_noise: T,
    curvature: T,
    curvature_noise: T,
}

impl<T: Scalar> Course<T> {
    /// Whether the cost does not fall by more than round-off.
    fn is_ascent(&self) -> bool {
        self.slope >= -self.slope_noise
    }

    /// Whether the curvature may be what proximal steps have left of a direction without any.
    fn is_nearly_straight(&self) -> bool {
        let terms = self.curvature_noise / (T::of(32.0) * T::EPSILON);
        self.curvature <= T::of(0.01) * proximal_weight::<T>() * terms
    }

    /// How far away the cost is least.
    fn minimum(&self) -> T {
        if self.curvature <= self.curvature_noise {
            T::INFINITY
        } else {
            -self.slope / self.curvature
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Course, Search, has_fallen};
    use crate::{Problem, Settings, Workspace};

    /// The course at x along d of the cost ½(x₀ − x₁)² − (x₀ − x₁), times a unit: no curvature along (1, 1), least where x₀ = x₁ + 1.
    fn course(unit: f64, x: [f64; 2], d: [f64; 2]) -> Course<f64> {
        let (h, g) = ([[unit, -unit], [-unit, unit]], [-unit, unit]);
        let (a, l, u): ([[f64; 2]; 0], [f64; 0], [f64; 0]) = ([], [], []);
        let p = Problem::new(&h, &g, &a, &l, &u);
        let (settings, mut w) = (Settings::default(), Workspace::new());
        (w.x, w.previous) = (x, d);
        Search::new(&p, &settings, &mut w).course()
    }

    /// Of terms of 1e6 a fall by 1e-10 is round-off, one by 1e-7 is not; a cost that stays or rises has not fallen.
    #[test]
    fn a_cost_has_fallen_by_more_than_round_off() {
        for (fall, has) in [(-1.0, false), (0.0, false), (1e-10, false), (1e-7, true)] {
            assert_eq!(has_fallen(1.0 - fall, 1.0, 1e6), has, "{fall}");
        }
    }

    const UNITS: [f64; 3] = [1e-12, 1.0, 1e12];

    /// A proximal step leaves 1e-6 of a direction across one without curvature, of which the share of the curvature is the square. A thousandth
    /// across is another direction.
    #[test]
    fn what_a_proximal_step_leaves_across_is_nearly_straight() {
        for unit in UNITS {
            for (across, is_straight) in [(1e-6, true), (1e-3, false)] {
                let course = course(unit, [0.0; 2], [1.0, 1.0 - across]);
                assert!(course.curvature > course.curvature_noise);
                assert_eq!(course.is_nearly_straight(), is_straight, "{unit} {across}");
            }
        }
    }

    /// A million away from the origin, 1e-9 before the least point the slope is round-off, but not 1e-6 before it.
    #[test]
    fn a_slope_that_is_round_off_is_no_descent() {
        for unit in UNITS {
            for (before, is_ascent) in [(-1e-6, true), (0.0, true), (1e-9, true), (1e-6, false)] {
                let course = course(unit, [1e6 + 1.0 - before, 1e6], [1.0, -1.0]);
                assert_eq!(course.is_ascent(), is_ascent, "{unit} {before}");
            }
        }
    }
}
