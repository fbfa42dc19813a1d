//! From a Newton step to the next iterate.

use crate::equalities::solve_start;
use crate::iterate::{self, Merit};
use crate::keep::Keep;
use crate::problem::Problem;
use crate::riccati::{Direction, factorise, substitute};
use crate::rows::RowBarrier;
use crate::settings::Status;
use crate::solver::{Run, Solver};
use crate::stage::{Pass, Stage};
use so3::Scalar;
use so3::math::max;

/// Share of its distance to a bound that a slack may use up in a step of its own, and of itself a multiplier.
const OWN_SHARE: f64 = 0.9;
/// Halvings of a step before the filter is given up for it.
const HALVINGS: u8 = 6;
/// Steps of one attempt that may be taken against the filter.
const LEAPS: u8 = 10;

impl<T: Scalar> Solver<T> {
    /// Factorises with the least shift that makes the Hessian positive definite and computes the step.
    pub(crate) fn newton<P, K, const NX: usize, const NU: usize, const NI: usize>(
        &self,
        problem: &P,
        stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
        run: &mut Run<T, NX>,
    ) -> Result<Direction<T>, Status>
    where
        P: Problem<T, NX, NU, NI>,
        K: Keep<T, NX, NU, NI>,
    {
        let mut shift = T::ZERO;
        for _ in 0..40 {
            if let Some(step) = self.direction(problem, stages, run, shift, Pass::Same) {
                if shift > T::ZERO {
                    run.shift = shift;
                }
                return Ok(step);
            }
            shift = if shift > T::ZERO {
                shift * T::of(if run.shift > T::ZERO { 8.0 } else { 100.0 })
            } else if run.shift > T::ZERO {
                max(run.shift / T::of(3.0), T::of(1e-12))
            } else {
                T::of(1e-4)
            };
            if shift > T::of(1e12) {
                break;
            }
        }
        Err(Status::Indefinite)
    }

    /// The step for one shift; `None` if the Hessian is not positive definite with it.
    fn direction<P, K, const NX: usize, const NU: usize, const NI: usize>(
        &self,
        problem: &P,
        stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
        run: &mut Run<T, NX>,
        shift: T,
        pass: Pass,
    ) -> Option<Direction<T>>
    where
        P: Problem<T, NX, NU, NI>,
        K: Keep<T, NX, NU, NI>,
    {
        let barrier = RowBarrier {
            mu: run.mu,
            fraction: max(T::of(0.99), T::ONE - run.mu),
            reach: if self.settings.individual_steps && run.uses_filter() {
                T::of(OWN_SHARE)
            } else {
                T::INFINITY
            },
            rank_tolerance: self.settings.rank_tolerance,
        };
        run.factorisations = run.factorisations.saturating_add(1);
        let workers = self.settings.workers();
        if !factorise(problem, stages, barrier, shift, pass, workers) {
            return None;
        }
        let riccati = &mut stages.first_mut()?.node.riccati;
        let start = solve_start(
            &riccati.hessian,
            &riccati.gradient,
            &mut riccati.carried,
            &run.free,
            barrier.rank_tolerance,
        )?;
        let with = (barrier, shift);
        Some(substitute(problem, stages, start, with, pass, workers))
    }

    /// Moves the trial point along the step until it is good enough.
    ///
    /// Returns the merit there and the step that led there; the stages' values are those of the trial point.
    pub(crate) fn search<P, K, const NX: usize, const NU: usize, const NI: usize>(
        &self,
        problem: &P,
        stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
        run: &mut Run<T, NX>,
        from: &Merit<T>,
        step: Direction<T>,
    ) -> Result<(Merit<T>, Direction<T>), Status>
    where
        P: Problem<T, NX, NU, NI>,
        K: Keep<T, NX, NU, NI>,
    {
        let (mut step, common) = (step, step.primal);
        let workers = self.settings.workers();
        step.primal = step.longest();
        let mut trial = iterate::try_step(problem, stages, &step, workers);
        if run.uses_filter() {
            if let Some(found) = self.filtered(problem, stages, run, from, step, trial) {
                return Ok(found);
            }
            // No part of the step is acceptable: the filter may cut off the way around a bend. Leap over it.
            run.filter.clear();
            run.leaps = run.leaps.saturating_add(1);
            if run.leaps > LEAPS {
                return Err(Status::Stalled);
            }
            step.primal = common;
            trial = iterate::try_step(problem, stages, &step, workers);
        }
        let mut halvings = 0u8;
        while !trial.is_finite() || (halvings < 4 && run.explodes(trial.sum)) {
            halvings = halvings.wrapping_add(1);
            if halvings > 20 {
                return Err(Status::NotFinite);
            }
            step.primal *= T::HALF;
            trial = iterate::try_step(problem, stages, &step, workers);
        }
        Ok((trial, step))
    }

    /// The longest of a few halvings that the filter takes. Where the whole step is refused because it raises the
    /// violation, a *second-order correction* is tried first: the step to where the rows curve to (IPOPT's, Wächter
    /// and Biegler 2006, section 2.4).
    fn filtered<P, K, const NX: usize, const NU: usize, const NI: usize>(
        &self,
        problem: &P,
        stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
        run: &mut Run<T, NX>,
        from: &Merit<T>,
        step: Direction<T>,
        trial: Merit<T>,
    ) -> Option<(Merit<T>, Direction<T>)>
    where
        P: Problem<T, NX, NU, NI>,
        K: Keep<T, NX, NU, NI>,
    {
        run.filter.turn_to(run.mu);
        let workers = self.settings.workers();
        let here = from.point(run.mu);
        let (mut step, mut trial) = (step, trial);
        for halvings in 0..=HALVINGS {
            let there = trial.point(run.mu);
            if trial.is_finite() && run.filter.accepts(here, there, step.primal, step.slope) {
                run.filter.remember(here, step.primal, step.slope);
                return Some((trial, step));
            }
            let worse = trial.is_finite() && trial.sum >= from.sum;
            if halvings == 0 && worse && run.filter.may_be_bent(here, there) {
                iterate::correct(problem, stages, &step, workers);
                if let Some(mut bent) =
                    self.direction(problem, stages, run, step.shift, Pass::Corrected)
                {
                    bent.primal = bent.longest();
                    trial = iterate::try_step(problem, stages, &bent, workers);
                    let there = trial.point(run.mu);
                    if trial.is_finite() && run.filter.accepts(here, there, step.primal, step.slope)
                    {
                        run.filter.remember(here, step.primal, step.slope);
                        return Some((trial, bent));
                    }
                }
                // Back to the Newton step.
                let _ = iterate::evaluate(problem, stages, workers);
                let primal = step.primal;
                step = self.direction(problem, stages, run, step.shift, Pass::Same)?;
                step.primal = primal;
            }
            step.primal *= T::HALF;
            trial = iterate::try_step(problem, stages, &step, workers);
        }
        None
    }
}
