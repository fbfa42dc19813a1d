//! The dual active-set search.
//!
//! A point that is optimal for the active rows alone (multipliers ≥ 0) moves toward the most violated
//! row p: along −z, z = H⁻¹a_p projected off the active rows, the row's multiplier grows by t, the
//! others change by −t·r. The step ends where the row is met (it enters) or where a multiplier
//! reaches zero (that row leaves). If the row depends on the active ones (z = 0) and no multiplier
//! falls, the rows contradict each other. Each full step raises the dual cost, so no active set
//! repeats (Goldfarb and Idnani 1983; the LDLᵀ form of the same idea is in Arnström et al. 2022).

use crate::kernels::{at, dot, head, head_mut, max_abs, put};
use crate::residual::{infeasibility, kkt_residual, worse};
use crate::settings::row_tolerance;
use crate::workspace::POOL;
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
        primal: T::ZERO,
    };
    // A solved problem has passed through finite arithmetic entry by entry. Only otherwise is it
    // worth asking whether the data can be at fault.
    let status = match search.run() {
        Ok(Status::Solved) => Status::Solved,
        outcome => {
            if let Err(error) = problem.validate() {
                search.w.forget();
                return Err(error);
            }
            outcome.inspect_err(|_| search.w.forget())?
        }
    };
    Ok(search.finish(status))
}

struct Search<'a, 'p, 'w, T, const N: usize, const M: usize> {
    p: &'a Problem<'p, T, N, M>,
    s: &'a Settings<T>,
    w: &'w mut Workspace<T, N, M>,
    iterations: u32,
    /// Distance outside a row that counts as violated, at the present x.
    tolerance: T,
    /// Largest violation of any row in its own units, at the last look and measure of drift.
    primal: T,
}

/// State of a row that is eliminated; ±1 when it is active on a side, 0 otherwise.
const EQUALITY: i8 = 2;

/// What a look at all rows found.
enum Look {
    Feasible,
    Violated,
    Unsound,
}

/// How the search for a point that satisfies all rows ended.
enum Pass {
    Feasible,
    Stop(Status),
}

impl<'w, T: Scalar, const N: usize, const M: usize> Search<'_, '_, 'w, T, N, M> {
    fn run(&mut self) -> Result<Status, Error> {
        self.s.validate()?;
        let w = &mut *self.w;
        let seeds = w.basis.len.min(N);
        w.basis.clear();
        w.row_scale_inverse.fill(T::ZERO);
        w.row_state.fill(0);
        w.bound_state.fill(0);
        w.previous.fill(T::ZERO);
        if let Err(c) = w
            .elimination
            .build(self.p, self.s.feasibility, &mut w.vec_a)
        {
            return Ok(self.contradiction(c.id, c.residual_positive));
        }
        // Dependent equalities hold when the others do.
        let limits = self.p.row_lower.iter().zip(self.p.row_upper);
        for (state, (l, u)) in w.row_state.iter_mut().zip(limits) {
            if l == u {
                *state = EQUALITY;
            }
        }
        if let (Some(lower), Some(upper)) = (self.p.lower, self.p.upper) {
            for (state, (l, u)) in w.bound_state.iter_mut().zip(lower.iter().zip(upper)) {
                if l == u {
                    *state = EQUALITY;
                }
            }
        }
        w.factor.dim = w.elimination.free();
        w.elimination.reduce_hessian(
            self.p.hessian,
            &mut w.factor.u,
            &mut w.factor.weight,
            &mut w.vec_a,
        );
        w.factor.factorise(max_abs(self.p.gradient))?;
        w.elimination.particular(&mut w.x);
        if w.elimination.rank == 0 {
            // x is zero.
            w.gradient = *self.p.gradient;
        } else {
            self.evaluate_gradient();
        }
        self.seed(seeds);
        self.drop_unfit();
        self.outer()
    }

    /// Re-enters the remembered active set, without multipliers yet.
    fn seed(&mut self, seeds: usize) {
        for k in 0..seeds {
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            let (l, u) = self.p.limits(id);
            let limit = if side > 0 { u } else { l };
            if self.w.state(id) != 0 || !(is_range(l, u) && limit.is_finite_number()) {
                continue;
            }
            self.prepare(id, side);
            if self.w.candidate.free > T::ZERO {
                self.turn();
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
            match self.search() {
                Pass::Feasible => {}
                // A contradiction that the data do not confirm comes from round-off in x: correct
                // x and look again.
                Pass::Stop(Status::Numerical) if stalls < 4 => {
                    stalls += 1;
                    self.evaluate_gradient();
                    continue;
                }
                Pass::Stop(status) => return Ok(status),
            }
            let scale = self.evaluate_gradient();
            let residual = self.reduced_residual();
            let drift = self.drift();
            let (dual, primal) = (self.s.optimality * scale, self.s.feasibility);
            let merit = math::max(residual * primal, drift * dual);
            let progress = merit < last * T::HALF;
            // Well inside the tolerances, or inside and no longer improving.
            let margin = T::of(0.01);
            if !(scale.is_finite_number() && drift.is_finite_number()) {
                return Ok(Status::Numerical);
            }
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
            if !self.w.factor.proximal && stalls > 4 {
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

    /// Largest entry of Zᵀ·gradient (left in `vec_a`).
    fn reduced_residual(&mut self) -> T {
        let w = &mut *self.w;
        w.elimination.reduce(&w.gradient, &mut w.vec_a);
        crate::residual::norm(crate::kernels::head(&w.vec_a, w.factor.dim))
    }

    /// Amount by which x exceeds the limit of a row on one side.
    fn excess(&self, id: usize, side: i8) -> T {
        let (l, u) = self.p.limits(id);
        let v = self.p.value(id, &self.w.x);
        if side > 0 { v - u } else { l - v }
    }

    /// From `gradient` at (x, λ): the point that is stationary with all active rows met. Then drops
    /// rows until no multiplier is negative.
    fn correct(&mut self) {
        let w = &mut *self.w;
        w.elimination.reduce(&w.gradient, &mut w.vec_a);
        if w.basis.len == 0 {
            w.factor.solve_transposed(&mut w.vec_a);
            w.factor.weigh(&mut w.vec_a);
            w.factor.solve(&mut w.vec_a);
            for (v, y) in w.elimination.free_variables().iter().zip(&w.vec_a) {
                put(&mut w.step, *v, *y);
            }
            self.move_along_step();
        } else {
            self.newton();
            let w = &mut *self.w;
            for (l, change) in w.lambda.iter_mut().zip(&w.vec_b).take(w.basis.len) {
                *l += *change;
            }
            let free = w.elimination.free_variables();
            w.basis.direction(0, &w.candidate.d, free, &mut w.step);
            self.move_along_step();
            self.drop_negative();
        }
        // Far excursions (large proximal steps) leave round-off in the equalities.
        self.w.elimination.restore(&mut self.w.x, &mut self.w.vec_a);
    }

    /// The step towards the stationary point with all active rows met, as coordinates y of J in the candidate, and the change of the
    /// multipliers in `vec_b`; from `gradient`, reduced in `vec_a`. y₁ meets the active rows, y₂ is the gradient's own, and the
    /// multipliers take the rest.
    fn newton(&mut self) {
        let w = &mut *self.w;
        w.candidate.d.fill(T::ZERO);
        for (i, g) in w.vec_a.iter().enumerate().take(w.factor.dim) {
            w.basis.add_coordinates(i, *g, &mut w.candidate.d);
        }
        for k in 0..self.w.basis.len {
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            let e = self.excess(id, side);
            put(&mut self.w.vec_b, k, e);
        }
        let w = &mut *self.w;
        w.basis.solve_transposed(&mut w.vec_b);
        let rows = w.candidate.d.iter_mut().zip(&mut w.vec_b);
        for (d, y) in rows.take(w.basis.len) {
            (*d, *y) = (*y, *y - *d);
        }
        w.basis.solve(&mut w.vec_b);
    }

    /// Remembered rows that would pull instead of push leave before the search, all at once: one by one, each would cost a step.
    fn drop_unfit(&mut self) {
        for _ in 0..3 {
            if self.w.basis.len == 0 {
                return;
            }
            let w = &mut *self.w;
            w.elimination.reduce(&w.gradient, &mut w.vec_a);
            self.newton();
            let before = self.w.basis.len;
            for k in (0..before).rev() {
                if at(&self.w.vec_b, k) < T::ZERO {
                    self.leave(k);
                }
            }
            if self.w.basis.len == before {
                return;
            }
        }
    }

    /// x ← x − step, whose free part is set.
    fn move_along_step(&mut self) {
        let w = &mut *self.w;
        w.elimination.complete(&mut w.step, &mut w.vec_a);
        crate::kernels::sub_scaled(&mut w.x, T::ONE, &w.step);
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
            self.answer();
            self.turn();
            self.advance(-value);
        }
    }

    /// Coordinates of a row in the basis.
    fn prepare(&mut self, id: usize, side: i8) {
        let w = &mut *self.w;
        w.basis.prepare(&w.factor);
        head_mut(&mut w.candidate.d, w.factor.dim).fill(T::ZERO);
        // What is left of a row that depends on the equalities is round-off, not a row.
        let least = if w.elimination.rank == 0 {
            T::ZERO
        } else {
            row_tolerance::<T>() / scale_inverse::<T, N, M>(self.p, w, id)
        };
        let sign = signed(side, T::ONE);
        let (basis, d) = (&w.basis, &mut w.candidate.d);
        if w.elimination.has_basic() {
            if id < M {
                w.elimination
                    .reduce(crate::kernels::row(self.p.rows, id), &mut w.vec_a);
            } else {
                w.elimination.reduce_unit(id - M, &mut w.vec_a);
            }
            let reduced = head(&w.vec_a, w.factor.dim);
            if max_abs(reduced) > least {
                for (i, a) in reduced.iter().enumerate() {
                    if *a != T::ZERO {
                        basis.add_coordinates(i, sign * *a, d);
                    }
                }
            }
        } else if id < M {
            let (from, row) = self.p.entries(id);
            let free = |k: usize| w.elimination.free_index(from + k);
            let large = |(k, a): (usize, &T)| math::abs(*a) > least && free(k).is_some();
            if least == T::ZERO || row.iter().enumerate().any(large) {
                for (k, a) in row.iter().enumerate() {
                    if let (true, Some(i)) = (*a != T::ZERO, free(k)) {
                        basis.add_coordinates(i, sign * *a, d);
                    }
                }
            }
        } else if let Some(i) = w.elimination.free_index(id - M) {
            basis.add_coordinates(i, sign, d);
        }
        let w = &mut *self.w;
        w.basis.project(&mut w.candidate);
    }

    /// r (in `vec_b`) of the candidate.
    fn answer(&mut self) {
        let w = &mut *self.w;
        for (r, d) in w.vec_b.iter_mut().zip(&w.candidate.d).take(w.basis.len) {
            *r = *d;
        }
        w.basis.solve(&mut w.vec_b);
    }

    /// z (in `step`) of the candidate.
    fn turn(&mut self) {
        let w = &mut *self.w;
        if w.candidate.free > T::ZERO {
            let free = w.elimination.free_variables();
            w.basis
                .direction(w.basis.len, &w.candidate.d, free, &mut w.step);
            w.elimination.complete(&mut w.step, &mut w.vec_a);
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
        w.basis.append(&mut w.candidate, &w.elimination, &w.step);
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

    /// Looks at every inactive row and bound and collects the most violated ones, relative to their
    /// scale, in the pool.
    fn look(&mut self) -> Look {
        let mut length = T::ZERO;
        for v in &self.w.x {
            length += math::abs(*v);
        }
        let round_off = T::of(32.0) * T::EPSILON * length;
        self.tolerance = math::min(
            math::max(self.s.feasibility, round_off),
            T::of(1000.0) * self.s.feasibility,
        );
        self.primal = T::ZERO;
        self.w.pool_len = 0;
        let mut sound = length.is_finite_number();
        let mut excess = [T::ZERO; POOL];
        // An infinite entry may satisfy a row that has no limit on that side.
        let mut sum = T::ZERO;
        let limits = self.p.row_lower.iter().zip(self.p.row_upper);
        for (i, (a, (l, u))) in self.p.rows.iter().zip(limits).enumerate() {
            if at(&self.w.row_state, i) != 0 {
                continue;
            }
            let v = self.p.row_value(i, a, &self.w.x);
            sum += v;
            // False for a NaN anywhere.
            if v <= *u && v >= *l {
                continue;
            }
            sound &= self.judge(i, v, *l, *u, &mut excess);
        }
        if self.p.lower.is_some() || self.p.upper.is_some() {
            for i in 0..N {
                let ((l, u), v) = (self.p.limits(M + i), at(&self.w.x, i));
                if (v <= u && v >= l) || at(&self.w.bound_state, i) != 0 {
                    continue;
                }
                sound &= self.judge(M + i, v, l, u, &mut excess);
            }
        }
        if !(sound && sum.is_finite_number()) {
            return Look::Unsound;
        }
        if self.w.pool_len > 0 {
            Look::Violated
        } else {
            Look::Feasible
        }
    }

    /// A row that is violated, or has bad numbers (then the answer is false).
    fn judge(&mut self, i: usize, v: T, l: T, u: T, excess: &mut [T; POOL]) -> bool {
        if !(v.is_finite_number() && is_range(l, u)) {
            return false;
        }
        let (e, side) = if v - u > l - v {
            (v - u, 1)
        } else {
            (l - v, -1)
        };
        self.primal = math::max(self.primal, e);
        let scaled = e * scale_inverse::<T, N, M>(self.p, self.w, i);
        if scaled > self.tolerance {
            pool_insert(self.w, excess, scaled, (i, side));
        }
        true
    }

    /// How far x is from the limits of the active rows and the equalities, relative to their scale;
    /// NaN if a number is bad. Completes `primal`.
    fn drift(&mut self) -> T {
        let mut drift = T::ZERO;
        for k in 0..self.w.basis.len {
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            let e = self.excess(id, side);
            self.primal = worse(self.primal, e);
            drift = worse(
                drift,
                math::abs(e) * scale_inverse::<T, N, M>(self.p, self.w, id),
            );
        }
        for i in 0..M {
            if at(&self.w.row_state, i) == EQUALITY {
                let e = math::abs(self.excess(i, 1));
                self.primal = worse(self.primal, e);
                drift = worse(drift, e * scale_inverse::<T, N, M>(self.p, self.w, i));
            }
        }
        drift
    }

    /// The row to enter next: the most violated one of the pool, or of all rows when the pool is
    /// used up.
    fn next(&mut self) -> Result<Option<(usize, i8)>, Status> {
        for refilled in [false, true] {
            let (mut worst, mut found) = (self.tolerance, None);
            for k in 0..self.w.pool_len {
                let (id, side) = at(&self.w.pool, k);
                if self.w.state(id) != 0 {
                    continue;
                }
                let e = self.excess(id, side) * scale_inverse::<T, N, M>(self.p, self.w, id);
                if e > worst {
                    (worst, found) = (e, Some((id, side)));
                }
            }
            if found.is_some() || refilled {
                return Ok(found);
            }
            match self.look() {
                Look::Unsound => return Err(Status::Numerical),
                Look::Feasible => return Ok(None),
                Look::Violated => {}
            }
        }
        Ok(None)
    }

    /// Enters violated rows until none is left.
    fn search(&mut self) -> Pass {
        self.w.pool_len = 0;
        loop {
            let (id, side) = match self.next() {
                Ok(Some(found)) => found,
                Ok(None) => return Pass::Feasible,
                Err(status) => return Pass::Stop(status),
            };
            self.prepare(id, side);
            let mut lambda = T::ZERO;
            loop {
                if self.iterations >= self.s.max_iterations {
                    return Pass::Stop(Status::Limit);
                }
                self.iterations += 1;
                self.answer();
                self.turn();
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
                let d = w.candidate.free;
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
            if self.w.state(i) == EQUALITY {
                continue;
            }
            let (l, u) = self.p.limits(i);
            let rate = self.p.value(i, &self.w.step);
            let scale = T::ONE / scale_inverse::<T, N, M>(self.p, self.w, i);
            let value = self.p.value(i, &self.w.x);
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
    fn finish(mut self, status: Status) -> Solution<'w, T, N, M> {
        if status == Status::Solved {
            self.publish();
            let residual = self.residual();
            return self.solution(status, residual);
        }
        let proof = (self.w.row_multipliers, self.w.bound_multipliers);
        self.evaluate_gradient();
        self.publish();
        let (rows, bounds) = (&self.w.row_multipliers, &self.w.bound_multipliers);
        let residual = kkt_residual(self.p, &self.w.x, rows, bounds);
        if status == Status::Infeasible {
            (self.w.row_multipliers, self.w.bound_multipliers) = proof;
        }
        self.solution(status, residual)
    }

    /// Multipliers of all rows from those of the active ones and the gradient.
    fn publish(&mut self) {
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
            set_multiplier(w, id, signed(side, y));
        }
    }

    /// [`kkt_residual`] from what the last look and the last gradient left behind.
    fn residual(&mut self) -> crate::Residual<T> {
        let mut complementarity = T::ZERO;
        for k in 0..self.w.basis.len {
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            let c = math::abs(at(&self.w.lambda, k) * self.excess(id, side));
            complementarity = worse(complementarity, c);
        }
        let w = &mut *self.w;
        for k in 0..w.elimination.rank {
            let (id, mu) = (at(&w.elimination.id, k), at(&w.vec_a, k));
            let off = self.p.value(id, &w.x) - self.p.limits(id).1;
            complementarity = worse(complementarity, math::abs(mu * off));
            self.p.add_row(id, mu, &mut w.gradient);
        }
        crate::Residual {
            stationarity: crate::residual::norm(&w.gradient),
            primal: self.primal,
            complementarity,
        }
    }

    fn solution(self, status: Status, residual: crate::Residual<T>) -> Solution<'w, T, N, M> {
        let iterations = self.iterations;
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

/// Whether l ≤ x ≤ u is a range that numbers can satisfy; false for a NaN.
fn is_range<T: Scalar>(l: T, u: T) -> bool {
    l <= u && l < T::INFINITY && u > -T::INFINITY
}

/// y at an upper limit, −y at a lower one.
#[inline(always)]
fn signed<T: Scalar>(side: i8, y: T) -> T {
    if side > 0 { y } else { -y }
}

/// 1 / max |aᵢ|, computed for the rows that need it.
#[inline]
fn scale_inverse<T: Scalar, const N: usize, const M: usize>(
    problem: &Problem<'_, T, N, M>,
    w: &mut Workspace<T, N, M>,
    id: usize,
) -> T {
    let Some(known) = w.row_scale_inverse.get_mut(id) else {
        return T::ONE;
    };
    if *known == T::ZERO {
        let size = max_abs(problem.entries(id).1);
        *known = if size > T::ZERO {
            T::ONE / size
        } else {
            T::ONE
        };
    }
    *known
}

/// Inserts into the list sorted by excess, which keeps the worst.
fn pool_insert<T: Scalar, const N: usize, const M: usize>(
    w: &mut Workspace<T, N, M>,
    excess: &mut [T; POOL],
    e: T,
    entry: (usize, i8),
) {
    let (mut e, mut entry) = (e, entry);
    for (known, slot) in excess.iter_mut().zip(&mut w.pool).take(w.pool_len) {
        if e > *known {
            core::mem::swap(known, &mut e);
            core::mem::swap(slot, &mut entry);
        }
    }
    if w.pool_len < POOL {
        put(excess, w.pool_len, e);
        put(&mut w.pool, w.pool_len, entry);
        w.pool_len += 1;
    }
}
