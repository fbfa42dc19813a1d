//! The dual active-set search.
//!
//! A point that is optimal for the active rows alone (multipliers ≥ 0) moves toward the most violated
//! row p: along −z, z = H⁻¹a_p projected off the active rows, the row's multiplier grows by t, the
//! others change by −t·r. The step ends where the row is met (it enters) or where a multiplier
//! reaches zero (that row leaves). If the row depends on the active ones (z = 0) and no multiplier
//! falls, the rows contradict each other. Each full step raises the dual cost, so no active set
//! repeats (Goldfarb and Idnani 1983; the LDLᵀ form of the same idea is in Arnström et al. 2022).

use crate::kernels::{all_finite, at, dot, max_abs, put, span};
use crate::residual::{infeasibility, kkt_residual, worse};
use crate::settings::row_tolerance;
use crate::{Error, Problem, Settings, Solution, Status, Workspace};
use so3::{Scalar, math};

/// Solves from scratch.
///
/// # Errors
/// Data that no solver could use: see [`Error`]. Every other outcome is a [`Status`].
pub fn solve<'w, T: Scalar, const N: usize, const M: usize>(
    problem: &Problem<'_, T, N, M>,
    settings: &Settings<T>,
    workspace: &'w mut Workspace<T, N, M>,
) -> Result<Solution<'w, T, N, M>, Error> {
    workspace.forget();
    solve_warm(problem, settings, workspace)
}

/// Solves starting from the active set that the workspace remembers from its last solve. The
/// problem may differ in every number; rows of the set that no longer fit are dropped.
///
/// # Errors
/// As [`solve`].
pub fn solve_warm<'w, T: Scalar, const N: usize, const M: usize>(
    problem: &Problem<'_, T, N, M>,
    settings: &Settings<T>,
    workspace: &'w mut Workspace<T, N, M>,
) -> Result<Solution<'w, T, N, M>, Error> {
    let mut search = Search {
        p: problem,
        s: settings,
        w: workspace,
        iterations: 0,
        tolerance: T::ZERO,
    };
    let status = match search.run() {
        Ok(status) => status,
        Err(error) => {
            search.w.forget();
            return Err(error);
        }
    };
    let iterations = search.iterations;
    Ok(search.finish(status, iterations))
}

struct Search<'a, 'p, 'w, T, const N: usize, const M: usize> {
    p: &'a Problem<'p, T, N, M>,
    s: &'a Settings<T>,
    w: &'w mut Workspace<T, N, M>,
    iterations: u32,
    /// Distance outside a row that counts as violated, at the present x.
    tolerance: T,
}

/// How the search for a point that satisfies all rows ended.
enum Pass {
    Feasible,
    Stop(Status),
}

impl<'w, T: Scalar, const N: usize, const M: usize> Search<'_, '_, 'w, T, N, M> {
    fn run(&mut self) -> Result<Status, Error> {
        self.s.validate()?;
        self.p.validate()?;
        self.scan_rows()?;
        let w = &mut *self.w;
        let seeds = w.basis.len.min(N);
        w.basis.clear(0);
        w.row_state.fill(0);
        w.bound_state.fill(0);
        w.previous.fill(T::ZERO);
        if let Err(c) = w
            .elimination
            .build(self.p, self.s.feasibility, &mut w.vec_a)
        {
            return Ok(self.contradiction(c.id, c.residual_positive));
        }
        let rank = w.elimination.rank;
        for k in 0..rank {
            let id = at(&w.elimination.id, k);
            w.set_state(id, 2);
        }
        w.factor.dim = w.elimination.free();
        w.elimination.reduce_hessian(
            self.p.hessian,
            &mut w.factor.u,
            &mut w.factor.weight,
            &mut w.vec_a,
        );
        w.factor.factorise(max_abs(self.p.gradient))?;
        w.basis.clear(w.factor.dim);
        w.elimination.particular(&mut w.x);
        self.seed(seeds);
        self.evaluate_gradient();
        self.outer()
    }

    /// Scale and extent of every row; dense rows cost one pass, sparse ones save work later.
    fn scan_rows(&mut self) -> Result<(), Error> {
        let w = &mut *self.w;
        let out = w
            .row_scale
            .iter_mut()
            .zip(&mut w.row_scale_inverse)
            .zip(&mut w.row_span);
        for (i, (a, ((scale, inverse), extent))) in self.p.rows.iter().zip(out).enumerate() {
            if !all_finite(a) {
                return Err(Error::RowNotFinite(i));
            }
            let m = max_abs(a);
            *scale = if m > T::ZERO { m } else { T::ONE };
            *inverse = T::ONE / *scale;
            let first = a.iter().position(|v| *v != T::ZERO).unwrap_or(0);
            let last = a.iter().rposition(|v| *v != T::ZERO).map_or(0, |k| k + 1);
            *extent = (first as u16, last as u16);
        }
        Ok(())
    }

    /// Re-enters the remembered active set, without multipliers yet.
    fn seed(&mut self, seeds: usize) {
        for k in 0..seeds {
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            let (l, u) = self.p.limits(id);
            let limit = if side > 0 { u } else { l };
            if self.w.state(id) != 0 || !limit.is_finite_number() {
                continue;
            }
            self.prepare(id, side);
            if self.w.candidate.d > T::ZERO {
                self.enter(id, side, T::ZERO);
            }
        }
    }

    /// Newton corrections of (x, λ) for the active rows, each followed by the search; with a
    /// proximal factor these are the proximal steps.
    fn outer(&mut self) -> Result<Status, Error> {
        let mut last = T::INFINITY;
        let mut stalls = 0;
        loop {
            if self.iterations >= self.s.max_iterations {
                return Ok(Status::Limit);
            }
            self.iterations += 1;
            self.correct();
            if let Pass::Stop(status) = self.search() {
                return Ok(status);
            }
            // Far excursions (large proximal steps) leave round-off in the equalities.
            self.w.elimination.restore(&mut self.w.x, &mut self.w.vec_a);
            let scale = self.evaluate_gradient();
            let residual = self.reduced_residual();
            let drift = self.active_drift();
            let (dual, primal) = (self.s.optimality * scale, self.s.feasibility);
            let merit = math::max(residual * primal, drift * dual);
            let progress = merit < last * T::HALF;
            // Well inside the tolerances, or inside and no longer improving.
            let margin = T::of(0.01);
            if (residual <= margin * dual && drift <= margin * primal)
                || (residual <= dual && drift <= self.tolerance && !progress)
            {
                return Ok(Status::Solved);
            }
            if !progress {
                stalls += 1;
            }
            if self.w.factor.proximal
                && let Some(status) = self.ray_step()
            {
                return Ok(status);
            }
            if (!self.w.factor.proximal && stalls > 4) || merit.is_nan_number() {
                return Ok(Status::Numerical);
            }
            last = math::min(last, merit);
            self.w.previous = self.w.x;
        }
    }

    /// gradient ← Hx + g + N_Wᵀλ; returns the size of its largest term.
    fn evaluate_gradient(&mut self) -> T {
        let w = &mut *self.w;
        let mut scale = T::ZERO;
        for ((out, h), g) in w
            .gradient
            .iter_mut()
            .zip(self.p.hessian)
            .zip(self.p.gradient)
        {
            let hx = dot(h, &w.x);
            scale = worse(scale, worse(math::abs(hx), math::abs(*g)));
            *out = hx + *g;
        }
        for ((id, side), lambda) in w.id.iter().zip(&w.side).zip(&w.lambda).take(w.basis.len) {
            let f = if *side > 0 { *lambda } else { -*lambda };
            let size = if *id < M {
                at(&w.row_scale, *id)
            } else {
                T::ONE
            };
            scale = worse(scale, math::abs(f) * size);
            self.p.add_row(*id, f, &mut w.gradient);
        }
        scale
    }

    /// Largest entry of Zᵀ·gradient (left in `vec_a`).
    fn reduced_residual(&mut self) -> T {
        let w = &mut *self.w;
        w.elimination.reduce(&w.gradient, &mut w.vec_a);
        crate::residual::norm(crate::kernels::head(&w.vec_a, w.factor.dim))
    }

    /// Largest distance of x from the limits of the active rows.
    fn active_drift(&mut self) -> T {
        let mut worst = T::ZERO;
        for k in 0..self.w.basis.len {
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            worst = worse(
                worst,
                math::abs(self.excess(id, side)) * self.scale_inverse(id),
            );
        }
        worst
    }

    fn scale_inverse(&self, id: usize) -> T {
        if id < M {
            at(&self.w.row_scale_inverse, id)
        } else {
            T::ONE
        }
    }

    /// Amount by which x exceeds the limit of a row on one side.
    fn excess(&self, id: usize, side: i8) -> T {
        let (l, u) = self.p.limits(id);
        let v = self.row_value(id);
        if side > 0 { v - u } else { l - v }
    }

    fn row_value(&self, id: usize) -> T {
        if id < M {
            let (from, to) = at(&self.w.row_span, id);
            let (from, to) = (from as usize, to as usize);
            dot(
                span(crate::kernels::row(self.p.rows, id), from, to),
                span(&self.w.x, from, to),
            )
        } else {
            at(&self.w.x, id - M)
        }
    }

    /// From `gradient` at (x, λ): the point that is stationary with all active rows met. Then drops
    /// rows until no multiplier is negative.
    fn correct(&mut self) {
        let w = &mut *self.w;
        w.elimination.reduce(&w.gradient, &mut w.vec_a);
        w.factor.solve_transposed(&mut w.vec_a);
        w.factor.weigh(&mut w.vec_a);
        w.factor.solve(&mut w.vec_a);
        self.move_along(T::ONE);
        if self.w.basis.len > 0 {
            for k in 0..self.w.basis.len {
                let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
                let e = self.excess(id, side);
                put(&mut self.w.vec_b, k, e);
            }
            let w = &mut *self.w;
            w.basis.solve_scaled(&mut w.vec_b);
            w.basis.combine(&w.vec_b, &mut w.vec_a);
            w.basis.solve_transposed(&mut w.vec_b);
            for (l, d) in w.lambda.iter_mut().zip(&w.vec_b).take(w.basis.len) {
                *l += *d;
            }
            w.factor.weigh(&mut w.vec_a);
            w.factor.solve(&mut w.vec_a);
            self.move_along(T::ONE);
            self.drop_negative();
        }
    }

    /// x ← x − t·Z·vec_a.
    fn move_along(&mut self, t: T) {
        let w = &mut *self.w;
        w.elimination.expand(&w.vec_a, &mut w.step);
        crate::kernels::sub_scaled(&mut w.x, t, &w.step);
    }

    fn drop_negative(&mut self) {
        for _ in 0..N {
            let mut worst = None;
            let mut value = T::ZERO;
            for (k, l) in self.w.lambda.iter().take(self.w.basis.len).enumerate() {
                if *l < value {
                    (worst, value) = (Some(k), *l);
                }
            }
            let Some(k) = worst else { break };
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            self.leave(k);
            // The multiplier returns to zero along the direction that leaves the other rows met.
            self.prepare(id, side);
            self.directions();
            self.advance(-value);
        }
    }

    /// Transforms a row and splits it into its part along the active rows and the rest.
    fn prepare(&mut self, id: usize, side: i8) {
        let w = &mut *self.w;
        let q = &mut w.candidate.q;
        if id < M {
            w.elimination
                .reduce(crate::kernels::row(self.p.rows, id), q);
        } else {
            w.elimination.reduce_unit(id - M, q);
        }
        // What is left of a row that depends on the equalities is round-off, not a row.
        if w.elimination.rank > 0 {
            let size = if id < M { at(&w.row_scale, id) } else { T::ONE };
            if max_abs(q) <= row_tolerance::<T>() * size {
                q.fill(T::ZERO);
            }
        }
        if side < 0 {
            for v in q.iter_mut() {
                *v = -*v;
            }
        }
        w.factor.solve_transposed(q);
        w.basis.project(&w.factor.weight, &mut w.candidate);
    }

    /// r (in `vec_b`) and z (in `step`) of the candidate.
    fn directions(&mut self) {
        let w = &mut *self.w;
        w.vec_b = w.candidate.l;
        w.basis.solve_transposed(&mut w.vec_b);
        if w.candidate.d > T::ZERO {
            w.vec_a = w.candidate.q;
            w.factor.weigh(&mut w.vec_a);
            w.factor.solve(&mut w.vec_a);
            w.elimination.expand(&w.vec_a, &mut w.step);
        } else {
            w.step.fill(T::ZERO);
        }
    }

    /// x ← x − t z, λ_W ← λ_W − t r.
    fn advance(&mut self, t: T) {
        let w = &mut *self.w;
        crate::kernels::sub_scaled(&mut w.x, t, &w.step);
        crate::kernels::sub_scaled(
            crate::kernels::head_mut(&mut w.lambda, w.basis.len),
            t,
            &w.vec_b,
        );
    }

    fn enter(&mut self, id: usize, side: i8, lambda: T) {
        let w = &mut *self.w;
        let k = w.basis.len;
        w.basis.append(&w.candidate);
        put(&mut w.id, k, id);
        put(&mut w.side, k, side);
        put(&mut w.lambda, k, lambda);
        w.set_state(id, side);
    }

    /// Row `k` of the active set leaves; the candidate is carried over.
    fn leave(&mut self, k: usize) {
        let w = &mut *self.w;
        let id = at(&w.id, k);
        w.set_state(id, 0);
        let len = w.basis.len;
        w.basis.remove(k, &mut w.candidate);
        for i in k + 1..len {
            let (id, side, lambda) = (at(&w.id, i), at(&w.side, i), at(&w.lambda, i));
            put(&mut w.id, i - 1, id);
            put(&mut w.side, i - 1, side);
            put(&mut w.lambda, i - 1, lambda);
        }
    }

    /// The inactive row that x violates most, relative to its scale.
    fn most_violated(&mut self) -> Option<(usize, i8)> {
        let mut length = T::ZERO;
        for v in &self.w.x {
            length += math::abs(*v);
        }
        let round_off = T::of(32.0) * T::EPSILON * length;
        self.tolerance = math::min(
            math::max(self.s.feasibility, round_off),
            T::of(1000.0) * self.s.feasibility,
        );
        let mut worst = self.tolerance;
        let mut found = None;
        for i in 0..M {
            if at(&self.w.row_state, i) != 0 {
                continue;
            }
            let (l, u) = (at(self.p.row_lower, i), at(self.p.row_upper, i));
            let v = self.row_value(i);
            let (e, side) = if v > u { (v - u, 1) } else { (l - v, -1) };
            let e = e * at(&self.w.row_scale_inverse, i);
            if e > worst {
                (worst, found) = (e, Some((i, side)));
            }
        }
        if self.p.lower.is_some() || self.p.upper.is_some() {
            for i in 0..N {
                if at(&self.w.bound_state, i) != 0 {
                    continue;
                }
                let (l, u) = self.p.limits(M + i);
                let v = at(&self.w.x, i);
                let (e, side) = if v > u { (v - u, 1) } else { (l - v, -1) };
                if e > worst {
                    (worst, found) = (e, Some((M + i, side)));
                }
            }
        }
        found
    }

    /// Enters violated rows until none is left.
    fn search(&mut self) -> Pass {
        while let Some((id, side)) = self.most_violated() {
            self.prepare(id, side);
            let mut lambda = T::ZERO;
            loop {
                if self.iterations >= self.s.max_iterations {
                    return Pass::Stop(Status::Limit);
                }
                self.iterations += 1;
                self.directions();
                // The first multiplier to reach zero.
                let mut blocking = None;
                let mut t = T::INFINITY;
                let w = &*self.w;
                let largest = max_abs(crate::kernels::head(&w.vec_b, w.basis.len));
                let noise = T::of(8.0) * T::EPSILON * largest;
                for (k, (l, r)) in w.lambda.iter().zip(&w.vec_b).take(w.basis.len).enumerate() {
                    if *r > noise {
                        let ratio = math::max(*l, T::ZERO) / *r;
                        if ratio < t {
                            (t, blocking) = (ratio, Some(k));
                        }
                    }
                }
                let d = w.candidate.d;
                let full = if d > T::ZERO {
                    self.excess(id, side) / d
                } else {
                    T::INFINITY
                };
                if full <= t {
                    if !full.is_finite_number() {
                        return Pass::Stop(self.conflict(id, side));
                    }
                    self.advance(full);
                    self.enter(id, side, lambda + full);
                    break;
                }
                let Some(k) = blocking else {
                    return Pass::Stop(Status::Numerical);
                };
                self.advance(t);
                lambda += t;
                self.leave(k);
            }
        }
        Pass::Feasible
    }

    /// The entering row depends on the active ones and nothing blocks: y = 1 on it, −r on them.
    fn conflict(&mut self, id: usize, side: i8) -> Status {
        let w = &mut *self.w;
        w.row_multipliers.fill(T::ZERO);
        w.bound_multipliers.fill(T::ZERO);
        for k in 0..w.basis.len {
            let y = math::max(-at(&w.vec_b, k), T::ZERO);
            let (row, side) = (at(&w.id, k), at(&w.side, k));
            set_multiplier(w, row, if side > 0 { y } else { -y });
        }
        set_multiplier(w, id, if side > 0 { T::ONE } else { -T::ONE });
        self.prove()
    }

    /// A dependent equality that the earlier ones contradict.
    fn contradiction(&mut self, id: usize, positive: bool) -> Status {
        let w = &mut *self.w;
        w.row_multipliers.fill(T::ZERO);
        w.bound_multipliers.fill(T::ZERO);
        w.x.fill(T::ZERO);
        w.factor.dim = 0;
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
        let largest = math::max(max_abs(&w.row_multipliers), max_abs(&w.bound_multipliers));
        let noise = T::of(4.0) * T::EPSILON * largest;
        let inverse = T::ONE / largest;
        for y in w.row_multipliers.iter_mut().chain(&mut w.bound_multipliers) {
            *y = if math::abs(*y) <= noise {
                T::ZERO
            } else {
                *y * inverse
            };
        }
        let proof = infeasibility(self.p, &w.row_multipliers, &w.bound_multipliers);
        let reach = math::max(T::ONE, max_abs(&w.x)) * T::of(10.0);
        if proof.support < T::ZERO && proof.combination * reach <= -proof.support {
            Status::Infeasible
        } else {
            Status::Numerical
        }
    }

    /// Without curvature along the last proximal step, goes on to the first limit; if there is none
    /// the cost has no minimum.
    fn ray_step(&mut self) -> Option<Status> {
        let w = &mut *self.w;
        for ((s, x), before) in w.step.iter_mut().zip(&w.x).zip(&w.previous) {
            *s = *x - *before;
        }
        let length = max_abs(&w.step);
        if !(length > T::ZERO && length.is_finite_number()) {
            return None;
        }
        let mut slope = T::ZERO;
        let (mut curvature, mut size) = (T::ZERO, T::ZERO);
        for s in &mut w.step {
            *s /= length;
        }
        for (h, (g, s)) in self
            .p
            .hessian
            .iter()
            .zip(self.p.gradient.iter().zip(&w.step))
        {
            curvature = worse(curvature, math::abs(dot(h, &w.step)));
            size = worse(size, max_abs(h));
            slope += *g * *s;
        }
        let small = T::of(1e5) * T::EPSILON;
        if !(curvature <= small * size && slope < -(small * max_abs(self.p.gradient))) {
            return None;
        }
        let mut reach = T::INFINITY;
        for i in 0..M + N {
            if self.w.state(i) == 2 {
                continue;
            }
            let (l, u) = self.p.limits(i);
            let rate = self.p.value(i, &self.w.step);
            let scale = if i < M {
                at(&self.w.row_scale, i)
            } else {
                T::ONE
            };
            let value = self.row_value(i);
            let room = if rate > small * scale {
                (u - value) / rate
            } else if rate < -(small * scale) {
                (l - value) / rate
            } else {
                continue;
            };
            reach = math::min(reach, math::max(room, T::ZERO));
        }
        if reach == T::INFINITY {
            self.w.previous = self.w.step;
            return Some(Status::Unbounded);
        }
        let w = &mut *self.w;
        crate::kernels::sub_scaled(&mut w.x, -reach, &w.step);
        self.evaluate_gradient();
        None
    }

    /// Multipliers of all rows, residual, and the solution.
    fn finish(mut self, status: Status, iterations: u32) -> Solution<'w, T, N, M> {
        if status == Status::Infeasible {
            let (rows, bounds) = (self.w.row_multipliers, self.w.bound_multipliers);
            self.publish();
            let residual = kkt_residual(
                self.p,
                &self.w.x,
                &self.w.row_multipliers,
                &self.w.bound_multipliers,
            );
            self.w.row_multipliers = rows;
            self.w.bound_multipliers = bounds;
            return self.solution(status, iterations, residual);
        }
        self.publish();
        let residual = kkt_residual(
            self.p,
            &self.w.x,
            &self.w.row_multipliers,
            &self.w.bound_multipliers,
        );
        self.solution(status, iterations, residual)
    }

    fn publish(&mut self) {
        self.evaluate_gradient();
        let w = &mut *self.w;
        w.row_multipliers.fill(T::ZERO);
        w.bound_multipliers.fill(T::ZERO);
        w.elimination.multipliers(&w.gradient, &mut w.vec_a);
        for k in 0..w.elimination.rank {
            let (id, mu) = (at(&w.elimination.id, k), at(&w.vec_a, k));
            set_multiplier(w, id, mu);
        }
        for k in 0..w.basis.len {
            let (id, side, y) = (at(&w.id, k), at(&w.side, k), at(&w.lambda, k));
            set_multiplier(w, id, if side > 0 { y } else { -y });
        }
    }

    fn solution(
        self,
        status: Status,
        iterations: u32,
        residual: crate::Residual<T>,
    ) -> Solution<'w, T, N, M> {
        let w: &'w Workspace<T, N, M> = self.w;
        Solution {
            status,
            x: &w.x,
            row_multipliers: &w.row_multipliers,
            bound_multipliers: &w.bound_multipliers,
            iterations,
            residual,
            ray: &w.previous,
        }
    }
}

fn set_multiplier<T: Scalar, const N: usize, const M: usize>(
    w: &mut Workspace<T, N, M>,
    id: usize,
    y: T,
) {
    if id < M {
        put(&mut w.row_multipliers, id, y);
    } else {
        put(&mut w.bound_multipliers, id - M, y);
    }
}
