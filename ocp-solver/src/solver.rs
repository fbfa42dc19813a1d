//! The interior-point iteration.

use crate::blocking::largest_violation;
use crate::filter::Filter;
use crate::iterate::{self, Merit};
use crate::keep::Keep;
use crate::problem::Problem;
use crate::rows::Complementarity;
use crate::settings::{Error, Progress, Residual, Settings, Solution, Status};
use crate::stage::Stage;
use core::ops::ControlFlow;
use so3::Scalar;
use so3::math::{max, min};

/// Who hears every iteration, and stops the solver by `Break`.
type Observer<'a, T> = &'a mut dyn FnMut(&Progress<T>) -> ControlFlow<()>;

/// The solver: settings only; all state lives in the stages.
#[derive(Clone, Copy, Debug)]
pub struct Solver<T> {
    /// Options.
    pub settings: Settings<T>,
}

/// State of one attempt that is not per node.
pub(crate) struct Run<T, const NX: usize> {
    pub(crate) free: [bool; NX],
    adaptive: bool,
    pub(crate) mu: T,
    /// Last Hessian shift that was needed.
    pub(crate) shift: T,
    short_steps: usize,
    iterations: usize,
    pub(crate) factorisations: usize,
    attempt: usize,
    /// Iterations at which an attempt has to end.
    limit: usize,
    /// Give of the rows, see [`crate::rows`].
    elastic: T,
    /// The next attempt goes on from the slacks and multipliers of the last.
    warm: bool,
    /// Sums of violations of the last iterates.
    recent: [T; 4],
    pub(crate) filter: Filter<T>,
    /// Steps of this attempt that were taken against the filter.
    pub(crate) leaps: u8,
    best: Residual<T>,
    best_cost: T,
    best_score: T,
}

impl<T: Scalar> Solver<T> {
    /// A solver with the given settings.
    #[must_use]
    pub const fn new(settings: Settings<T>) -> Self {
        Self { settings }
    }

    /// Solves from the guess in the stages and leaves the solution there.
    ///
    /// # Errors
    /// Data that cannot be solved with, see [`Error`]; outcomes of a solve are [`Status`]es.
    pub fn solve<P, K, const NX: usize, const NU: usize, const NI: usize>(
        &self,
        problem: &P,
        stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
        mut observer: impl FnMut(&Progress<T>) -> ControlFlow<()>,
    ) -> Result<Solution<T>, Error>
    where
        P: Problem<T, NX, NU, NI>,
        K: Keep<T, NX, NU, NI>,
    {
        // Of one type: the iteration is compiled once for all observers of a problem.
        let observer: Observer<'_, T> = &mut observer;
        self.settings.check()?;
        prepare(problem, stages, self.settings.workers())?;
        let mut run = Run::new(problem);
        let mut status = Status::IterationLimit;
        let mut restarts = 0;
        // What is left of the limit is for the search of a point of least violation.
        let limit = self.settings.max_iterations;
        let reserve = self.settings.restoration_iterations;
        run.limit = if limit >= reserve.saturating_mul(2) {
            limit.saturating_sub(reserve)
        } else {
            limit
        };
        for (i, (adaptive, mu)) in self.settings.attempts().into_iter().flatten().enumerate() {
            if i > 0 {
                for stage in stages.iter_mut() {
                    (stage.state, stage.control) = stage.guess;
                }
                let _ = iterate::evaluate(problem, stages, self.settings.workers());
            }
            (run.adaptive, run.attempt, restarts) = (adaptive, i, i);
            if i == 0 && self.settings.warm_start {
                for stage in stages.iter_mut() {
                    stage.node.resume_rows(mu);
                }
                run.warm = true;
            }
            status = self.attempt(problem, stages, &mut run, mu, observer);
            run.warm = false;
            if matches!(status, Status::Solved | Status::Cancelled) || run.iterations >= run.limit {
                break;
            }
        }
        run.limit = limit;
        let give_up = matches!(
            status,
            Status::Solved | Status::Cancelled | Status::NotFinite
        );
        if !give_up && run.iterations < limit {
            restarts = restarts.saturating_add(1);
            status = self.restore(problem, stages, &mut run, status, observer);
        }
        if !matches!(status, Status::Solved | Status::LocallyInfeasible) {
            for stage in stages.iter_mut() {
                (stage.state, stage.control) = stage.best;
            }
            let _ = iterate::evaluate(problem, stages, self.settings.workers());
        }
        Ok(Solution {
            status,
            iterations: run.iterations,
            cost: run.best_cost,
            residual: run.best,
            violation: largest_violation(stages),
            mu: run.mu,
            factorisations: run.factorisations,
            restarts,
        })
    }

    /// Looks for a point of least violation from the best iterate, in elastic mode (see [`crate::rows`]).
    ///
    /// Where the violation goes to zero with the give of the rows, solves from there; where it stays, the
    /// problem is locally infeasible. Returns `status` where neither comes out.
    fn restore<P, K, const NX: usize, const NU: usize, const NI: usize>(
        &self,
        problem: &P,
        stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
        run: &mut Run<T, NX>,
        status: Status,
        observer: Observer<'_, T>,
    ) -> Status
    where
        P: Problem<T, NX, NU, NI>,
        K: Keep<T, NX, NU, NI>,
    {
        for stage in stages.iter_mut() {
            (stage.state, stage.control) = stage.best;
        }
        if iterate::evaluate(problem, stages, self.settings.workers()).is_some() {
            return status;
        }
        run.adaptive = false;
        run.attempt = run.attempt.saturating_add(1);
        let settings = &self.settings;
        let far = T::of(100.0) * settings.primal_tolerance;
        let mut before = T::INFINITY;
        for elastic in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8].map(T::of) {
            if run.elastic > T::ZERO {
                // Multipliers grow as the give shrinks.
                let growth = run.elastic / elastic;
                stages
                    .iter_mut()
                    .for_each(|stage| stage.node.scale_multipliers(growth));
                run.warm = true;
            }
            run.elastic = elastic;
            let outcome = self.attempt(problem, stages, run, settings.initial_mu, observer);
            run.warm = false;
            if outcome != Status::Solved {
                run.elastic = T::ZERO;
                return if outcome == Status::Cancelled {
                    outcome
                } else {
                    status
                };
            }
            let violation = largest_violation(stages);
            if violation < run.best.primal {
                // Where nothing better comes out, this is what the answer is about.
                run.answer_with(violation, stages);
                for stage in stages.iter_mut() {
                    stage.best = (stage.state, stage.control);
                }
            }
            if violation <= far {
                break;
            }
            if elastic < T::of(2e-5) && violation > before * T::HALF {
                run.elastic = T::ZERO;
                run.answer_with(violation, stages);
                return Status::LocallyInfeasible;
            }
            before = violation;
        }
        // The point is nearly feasible, and its multipliers are nearly those of a solution.
        let mu = settings.smallest_mu(run.elastic);
        run.elastic = T::ZERO;
        for (warm, mu) in [(true, mu), (false, settings.initial_mu)] {
            run.attempt = run.attempt.saturating_add(1);
            run.warm = warm;
            let outcome = self.attempt(problem, stages, run, mu, observer);
            run.warm = false;
            if matches!(outcome, Status::Solved | Status::Cancelled) {
                return outcome;
            }
        }
        status
    }

    /// One descent under one barrier rule, from evaluated values.
    fn attempt<P, K, const NX: usize, const NU: usize, const NI: usize>(
        &self,
        problem: &P,
        stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
        run: &mut Run<T, NX>,
        initial_mu: T,
        observer: Observer<'_, T>,
    ) -> Status
    where
        P: Problem<T, NX, NU, NI>,
        K: Keep<T, NX, NU, NI>,
    {
        let settings = &self.settings;
        let last_iteration = run.iterations.saturating_add(settings.attempt_iterations);
        let mut point = run.begin(settings, stages, initial_mu);
        let (mut primal_step, mut dual_step, mut used_shift) = (T::ZERO, T::ZERO, T::ZERO);
        loop {
            let workers = settings.workers();
            let (residual, complementarity) =
                iterate::differentiate(problem, stages, &run.free, point.worst, workers);
            if run.elastic == T::ZERO {
                run.remember(settings, stages, &point, &residual);
            }
            let progress = Progress {
                iteration: run.iterations,
                cost: point.cost,
                residual,
                mu: run.mu,
                primal_step,
                dual_step,
                shift: used_shift,
                attempt: run.attempt,
            };
            if observer(&progress).is_break() {
                return Status::Cancelled;
            }
            if settings.is_solved(&residual, run.elastic) {
                if run.elastic == T::ZERO {
                    run.best = residual;
                    run.best_cost = point.cost;
                }
                return Status::Solved;
            }
            if run.iterations >= run.limit.min(last_iteration) {
                return Status::IterationLimit;
            }
            run.iterations = run.iterations.saturating_add(1);
            self.update_mu(run, &residual, &complementarity);

            let found = self
                .newton(problem, stages, run)
                .and_then(|step| self.search(problem, stages, run, &point, step));
            let (trial, step) = match found {
                Ok(found) => found,
                Err(status) => return status,
            };
            (used_shift, primal_step, dual_step) = (step.shift, step.primal, step.dual);
            run.recent = [run.recent[1], run.recent[2], run.recent[3], trial.sum];
            let floor = max(run.mu, settings.smallest_mu(run.elastic));
            iterate::accept(stages, &step, run.mu, floor);
            point = if run.elastic > T::ZERO {
                // The give of the rows has moved with their multipliers.
                iterate::merit(stages)
            } else {
                trial
            };
            if run.stalls(settings, primal_step) {
                return Status::Stalled;
            }
        }
    }

    /// Barrier parameter of the next step.
    fn update_mu<const NX: usize>(
        &self,
        run: &mut Run<T, NX>,
        residual: &Residual<T>,
        complementarity: &Complementarity<T>,
    ) {
        let settings = &self.settings;
        let smallest = settings.smallest_mu(run.elastic);
        let relief = Settings::relief(run.elastic);
        if complementarity.count <= T::ZERO {
            run.mu = smallest;
        } else if run.adaptive {
            // LOQO: the more uneven the products, the more centring.
            let mean = complementarity.sum / complementarity.count;
            let evenness = complementarity.smallest / mean;
            let bend = min(T::of(0.05) * (T::ONE - evenness) / evenness, T::TWO);
            run.mu = max(
                settings.adaptive_factor * bend * bend * bend * mean,
                smallest,
            );
        } else {
            // The barrier problem is solved closely enough: go on to the next.
            for _ in 0..8 {
                let gap = max(
                    complementarity.largest - run.mu,
                    run.mu - complementarity.smallest,
                );
                let error = max(max(residual.primal, residual.dual * relief), gap);
                if error > settings.mu_margin * run.mu || run.mu <= smallest {
                    break;
                }
                let power = so3::math::exp(settings.mu_power * so3::math::log(run.mu));
                let lower = min(settings.mu_factor * run.mu, power);
                // The last step is not worth a stage of its own.
                run.mu = if run.elastic == T::ZERO && lower < smallest * T::of(10.0) {
                    smallest
                } else {
                    max(lower, smallest)
                };
            }
        }
    }
}

impl<T: Scalar, const NX: usize> Run<T, NX> {
    fn new<P: Problem<T, NX, NU, NI>, const NU: usize, const NI: usize>(problem: &P) -> Self {
        let mut free = [false; NX];
        for (i, free) in free.iter_mut().enumerate() {
            *free = problem.is_free_at_start(i);
        }
        let none = Residual {
            primal: T::INFINITY,
            dual: T::INFINITY,
            complementarity: T::INFINITY,
        };
        Self {
            free,
            adaptive: false,
            mu: T::ZERO,
            shift: T::ZERO,
            short_steps: 0,
            iterations: 0,
            factorisations: 0,
            attempt: 0,
            limit: 0,
            elastic: T::ZERO,
            warm: false,
            recent: [T::ZERO; 4],
            filter: Filter::new(T::ZERO),
            leaps: 0,
            best: none,
            best_cost: T::INFINITY,
            best_score: T::INFINITY,
        }
    }

    /// Whether steps pass the filter: µ stays for a while, so that there is a function to descend.
    pub(crate) fn uses_filter(&self) -> bool {
        !self.adaptive && self.elastic == T::ZERO
    }

    /// Whether a step to this sum of violations should be halved: it is far above all recent ones.
    ///
    /// This guards steps that pass no filter; nearly every step to the boundary is a good one there.
    pub(crate) fn explodes(&self, sum: T) -> bool {
        let worst = self
            .recent
            .iter()
            .fold(T::ONE, |worst, sum| max(worst, *sum));
        sum > T::of(2.0) * worst
    }

    /// Sets out from the iterate in the stages: multipliers and slacks, unless those of the last attempt are kept, and the filter.
    fn begin<X: Copy, K, const NU: usize, const NI: usize>(
        &mut self,
        settings: &Settings<T>,
        stages: &mut [Stage<T, X, NX, NU, NI, K>],
        initial_mu: T,
    ) -> Merit<T> {
        self.mu = initial_mu;
        self.shift = T::ZERO;
        self.short_steps = 0;
        for stage in stages.iter_mut() {
            let node = &mut stage.node;
            node.elastic = self.elastic;
            if self.warm {
                continue;
            }
            node.costate = [T::ZERO; NX];
            let mu = (!self.adaptive).then_some(initial_mu);
            node.start_rows(settings.bound_push, settings.initial_multiplier, mu);
        }
        let point = iterate::merit(stages);
        self.recent = [point.sum; 4];
        (self.filter, self.leaps) = (Filter::new(point.sum), 0);
        point
    }

    /// The answer is about the iterate in the stages, which violates its rows by so much.
    fn answer_with<X: Copy, K, const NU: usize, const NI: usize>(
        &mut self,
        violation: T,
        stages: &[Stage<T, X, NX, NU, NI, K>],
    ) {
        self.best.primal = violation;
        self.best_cost = iterate::merit(stages).cost;
    }

    /// Whether so many steps in a row were as short as this one that the attempt is given up.
    fn stalls(&mut self, settings: &Settings<T>, step: T) -> bool {
        if step < settings.stall_step {
            self.short_steps = self.short_steps.saturating_add(1);
        } else {
            self.short_steps = 0;
        }
        let patience = if self.adaptive {
            settings.stall_count
        } else {
            settings.stall_count.saturating_mul(10)
        };
        self.short_steps >= patience
    }

    /// Keeps the iterate if it is the closest to a solution so far.
    fn remember<X: Copy, K, const NU: usize, const NI: usize>(
        &mut self,
        settings: &Settings<T>,
        stages: &mut [Stage<T, X, NX, NU, NI, K>],
        point: &Merit<T>,
        residual: &Residual<T>,
    ) {
        let score = settings.score(residual);
        if score < self.best_score || self.best_cost == T::INFINITY {
            self.best_score = score;
            self.best = *residual;
            self.best_cost = point.cost;
            for stage in stages.iter_mut() {
                stage.best = (stage.state, stage.control);
            }
        }
    }
}

/// Reads sizes and bounds, checks them, and evaluates the guess.
fn prepare<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    K: Keep<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
    workers: usize,
) -> Result<(), Error> {
    let needed = problem.intervals().saturating_add(1);
    if stages.len() != needed {
        return Err(Error::StageCount {
            needed,
            given: stages.len(),
        });
    }
    for (k, stage) in stages.iter_mut().enumerate() {
        let node = &mut stage.node;
        node.dims = problem.dims(k);
        if k.saturating_add(1) == needed {
            node.dims.controls = 0;
        }
        if node.dims.controls > NU || node.dims.rows() > NI {
            return Err(Error::Dims { stage: k });
        }
        (node.rows.lower, node.rows.upper) = ([T::ZERO; NI], [T::ZERO; NI]);
        problem.bounds(k, &mut node.rows.lower, &mut node.rows.upper);
        let bounds = node.rows.lower.iter().zip(&node.rows.upper);
        for (row, (lower, upper)) in bounds.enumerate().take(node.row_count()) {
            if lower.is_nan_number() || upper.is_nan_number() || *lower > *upper {
                return Err(Error::Bounds { stage: k, row });
            }
        }
        node.values = crate::problem::Values::new();
        stage.kept.begin();
        stage.guess = (stage.state, stage.control);
    }
    match iterate::evaluate(problem, stages, workers) {
        Some(stage) => Err(Error::Guess { stage }),
        None => Ok(()),
    }
}
