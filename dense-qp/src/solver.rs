//! The dual active-set search.
//!
//! A point that is optimal for the active rows alone (multipliers ≥ 0) moves toward the most violated
//! row p: along −z, z = H⁻¹a_p projected off the active rows, the row's multiplier grows by t, the
//! others change by −t·r. The step ends where the row is met (it enters) or where a multiplier
//! reaches zero (that row leaves). If the row depends on the active ones (z = 0) and no multiplier
//! falls, the rows contradict each other. Each full step raises the dual cost, so no active set
//! repeats (Goldfarb and Idnani 1983; the LDLᵀ form of the same idea is in Arnström et al. 2022).

mod exchange;
mod gauge;
mod lengths;
mod newton;
mod outcome;
mod proof;
mod violated;

use so3::{Scalar, math};

use crate::access::{at, put};
use crate::factor::is_linear;
use crate::kernels::{dot, max_abs, square_scaled};
use crate::{Error, Problem, Settings, Solution, Status, Workspace};
use exchange::Pass;
use gauge::{NOISE, SETTLED};
use proof::{Ray, has_fallen};

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
    Search::new(problem, settings, workspace).conclude(Search::run)
}

/// Goes on where the workspace's last solve ended, for the same problem with other limits of inequalities: rows may have lost
/// their limits or moved them. Nothing is factorised again, so this costs only the rows that change.
///
/// H, g, the rows and the equalities must be those of the last solve; where they are not, the status is at worst
/// [`Status::Numerical`], since it is found from the problem given. Without a last solve this is [`solve_warm`].
///
/// # Errors
/// As [`solve`].
pub fn resume<'w, T: Scalar, const N: usize, const M: usize>(
    problem: &Problem<'_, T, N, M>,
    settings: &Settings<T>,
    workspace: &'w mut Workspace<T, N, M>,
) -> Result<Solution<'w, T, N, M>, Error> {
    let search = Search::new(problem, settings, workspace);
    if search.w.is_factorised {
        search.conclude(Search::resume)
    } else {
        search.conclude(Search::run)
    }
}

struct Search<'a, 'p, 'w, T, const N: usize, const M: usize> {
    p: &'a Problem<'p, T, N, M>,
    s: &'a Settings<T>,
    w: &'w mut Workspace<T, N, M>,
    iterations: u32,
    /// Iterations, and remembered rows that entered or left.
    steps: u32,
    /// Most of them.
    most: u32,
    /// Rows of which it was in doubt whether they depend on the active ones, with none to leave for them.
    doubts: u32,
    /// Whether no correction of the point has confirmed a contradiction, so that the row that seems to be one enters.
    insists: bool,
    /// Σ|xᵢ|(|Hx|ᵢ + |g|ᵢ), the terms of the cost, at the last gradient.
    worth: T,
    /// Σ|λₖeₖ| over the active rows: what their distances eₖ from their limits are worth.
    toll: T,
    /// The largest |λₖeₖ|.
    complementarity: T,
    /// Largest violation of any row in its own units, at the last look and measure of drift.
    primal: T,
}

/// State of a row that is eliminated; ±1 when it is active on a side, 0 otherwise.
const EQUALITY: i8 = 2;

impl<'a, 'p, 'w, T: Scalar, const N: usize, const M: usize> Search<'a, 'p, 'w, T, N, M> {
    fn new(
        problem: &'a Problem<'p, T, N, M>,
        settings: &'a Settings<T>,
        workspace: &'w mut Workspace<T, N, M>,
    ) -> Self {
        Self {
            p: problem,
            s: settings,
            w: workspace,
            iterations: 0,
            steps: 0,
            doubts: 0,
            insists: false,
            most: settings.max_steps.min(Workspace::<T, N, M>::STEPS),
            worth: T::ZERO,
            toll: T::ZERO,
            complementarity: T::ZERO,
            primal: T::ZERO,
        }
    }

    /// Searches, and says what came of it.
    fn conclude(
        mut self,
        search: impl FnOnce(&mut Self) -> Result<Status, Error>,
    ) -> Result<Solution<'w, T, N, M>, Error> {
        // A solved problem has passed through finite arithmetic entry by entry. Only otherwise is it
        // worth asking whether the data can be at fault.
        let status = match search(&mut self) {
            Ok(Status::Solved) => Status::Solved,
            outcome => {
                if let Err(error) = self.p.validate() {
                    self.w.forget();
                    return Err(error);
                }
                outcome.inspect_err(|_| self.w.forget())?
            }
        };
        Ok(self.finish(status))
    }

    fn run(&mut self) -> Result<Status, Error> {
        self.s.validate()?;
        let w = &mut *self.w;
        let seeds = w.basis.len.min(N);
        w.is_factorised = false;
        w.basis.clear();
        w.row_scale_inverse.fill(T::ZERO);
        w.row_length_inverse.fill(T::ZERO);
        w.previous.fill(T::ZERO);
        // Dependent equalities hold when the others do.
        let limits = self.p.row_lower.iter().zip(self.p.row_upper);
        let has_rows = mark_equal(&mut w.row_state, limits);
        let mut has_fixed = false;
        w.bound_state.fill(0);
        if let (Some(lower), Some(upper)) = (self.p.lower, self.p.upper) {
            has_fixed = mark_equal(&mut w.bound_state, lower.iter().zip(upper));
        }
        if let Err(c) = w.elimination.build(
            self.p,
            [has_fixed, has_rows],
            self.s.feasibility,
            &mut w.vec_a,
        ) {
            return Ok(self.contradiction(c.id, c.residual_positive));
        }
        w.factor.dim = w.elimination.free();
        w.elimination.reduce_hessian(
            self.p.hessian,
            &mut w.factor.u,
            &mut w.factor.weight,
            &mut w.basis.j,
        );
        let [least, scale] = w.factor.curvatures(self.p.gradient);
        if is_linear(least, scale) {
            self.weigh_linear(scale);
        }
        let w = &mut *self.w;
        if let Some(k) = w.factor.factorise(scale, &w.vec_b)
            && self.is_concave(k)
        {
            return Err(Error::HessianNotConvex(k));
        }
        let w = &mut *self.w;
        w.is_factorised = true;
        w.elimination.particular(&mut w.x);
        if w.elimination.rank == 0 {
            // x is zero.
            w.gradient = *self.p.gradient;
        } else {
            self.evaluate_gradient();
        }
        self.outer(false, Some(seeds))
    }

    /// [`Search::run`] without the equalities, the factor and the active set: they are there.
    fn resume(&mut self) -> Result<Status, Error> {
        self.s.validate()?;
        self.w.previous.fill(T::ZERO);
        for k in (0..self.w.basis.len).rev() {
            let (l, u) = self.p.limits(at(&self.w.id, k));
            let limit = if at(&self.w.side, k) > 0 { u } else { l };
            if !limit.is_finite_number() {
                self.steps += 1;
                self.leave(k);
            }
        }
        // Multipliers are found anew, as those of remembered rows are.
        self.w.lambda.fill(T::ZERO);
        self.evaluate_gradient();
        let known = self.drop_unfit();
        self.outer(known, None)
    }

    /// Whether the search has taken all the time that it may.
    fn is_at_cap(&self) -> bool {
        self.iterations >= self.s.max_iterations || self.steps >= self.most
    }

    /// Newton corrections of (x, λ) for the active rows, each followed by the search; with a
    /// proximal factor these are the proximal steps.
    fn outer(&mut self, mut known: bool, mut seeds: Option<usize>) -> Result<Status, Error> {
        // Merit when it last fell to half, cost when it last fell by more than round-off, and passes since either.
        let (mut mark, mut cost) = (T::INFINITY, T::INFINITY);
        let mut stalls = 0;
        // After a few passes without progress what is left counts as round-off; proximal steps may make some again.
        let few = 4;
        let patience = if self.w.factor.proximal { 20 } else { few };
        loop {
            if self.is_at_cap() {
                return Ok(Status::Limit);
            }
            self.iterations += 1;
            self.steps += 1;
            self.correct(known);
            known = false;
            if self.has_pulling() {
                return Ok(Status::Limit);
            }
            let pass = match core::mem::take(&mut seeds) {
                Some(seeds) => self.start(seeds),
                None => {
                    self.w.pool_len = 0;
                    self.search()
                }
            };
            match pass {
                Pass::Feasible => {}
                // A contradiction that the data do not confirm comes from round-off in x: correct
                // x and look again.
                Pass::Stop(Status::Numerical) if stalls < 4 || !self.insists => {
                    self.insists = stalls >= 4;
                    stalls += 1;
                    self.evaluate_gradient();
                    continue;
                }
                Pass::Stop(status) => return Ok(status),
            }
            let rest = self.measure();
            if !(rest.scale.is_finite_number() && rest.drift.is_finite_number()) {
                return Ok(Status::Numerical);
            }
            if self.w.factor.proximal {
                match self.ray_step(&mut cost) {
                    Ray::Endless => return Ok(self.come_back()),
                    Ray::Moved => {
                        self.w.previous = self.w.x;
                        continue;
                    }
                    Ray::Stays => self.reduce_gradient(),
                }
            }
            if self.is_tight(&rest) {
                return Ok(Status::Solved);
            }
            let (dual, primal) = (self.s.optimality * rest.scale, self.s.feasibility);
            let merit = math::max(rest.residual * primal, rest.drift * dual);
            if merit < mark * T::HALF {
                (mark, stalls) = (merit, 0);
            } else {
                stalls += 1;
                let noise = if stalls > few { SETTLED } else { NOISE };
                if self.is_within(&rest, noise) {
                    return Ok(Status::Solved);
                }
            }
            if self.w.factor.proximal {
                let now = self.p.cost(&self.w.x);
                if has_fallen(now, cost, self.worth) {
                    (cost, stalls) = (now, 0);
                }
            }
            if stalls > patience {
                return Ok(Status::Numerical);
            }
            self.w.previous = self.w.x;
        }
    }

    /// Amount by which x exceeds the limit of a row on one side.
    fn excess(&self, id: usize, side: i8) -> T {
        let (l, u) = self.p.limits(id);
        let v = self.p.value(id, &self.w.x);
        if side > 0 { v - u } else { l - v }
    }
}

/// The states of rows with equal limits and of others; returns whether there are any.
fn mark_equal<'a, T: Scalar>(
    states: &mut [i8],
    limits: impl Iterator<Item = (&'a T, &'a T)>,
) -> bool {
    let mut any = 0;
    for (state, (l, u)) in states.iter_mut().zip(limits) {
        *state = if l == u { EQUALITY } else { 0 };
        any |= *state;
    }
    any != 0
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

/// 1 / |aᵢ|₂, by which violations of rows are compared.
#[inline]
fn length_inverse<T: Scalar, const N: usize, const M: usize>(
    problem: &Problem<'_, T, N, M>,
    w: &mut Workspace<T, N, M>,
    id: usize,
) -> T {
    let known = at(&w.row_length_inverse, id);
    if known != T::ZERO || id >= M {
        return if id < M { known } else { T::ONE };
    }
    let entries = problem.entries(id).1;
    let square = dot(entries, entries);
    let least = T::EPSILON * T::EPSILON * (T::EPSILON * T::EPSILON);
    let inverse = if square > least && square * least < T::ONE {
        T::ONE / math::sqrt(square)
    } else {
        // Scaled, a row of any units has a square.
        let scale = scale_inverse::<T, N, M>(problem, w, id);
        scale / math::sqrt(math::max(square_scaled(entries, scale), T::ONE))
    };
    put(&mut w.row_length_inverse, id, inverse);
    inverse
}
