//! One call from a guess to a plan.

use crate::error::Error;
use crate::problem::Problem;
use crate::rows::row_capacity;
use crate::state::{State, TIMES};
use core::ops::ControlFlow;
use ocp_solver::{Keep, Progress, Settings, Solution, Solver, Stage, Status};
use so3::Scalar;
use so3::math::max;

impl<T: Scalar, const FEET: usize, const PHASES: usize> Problem<T, FEET, PHASES> {
    /// Plans from the guess in the stages ([`Problem::write_guess`]) and leaves the plan there.
    ///
    /// Problem (2) has poor local optima in which a contact phase shrinks to its shortest duration.
    /// Where a solve ends in one, or in no solution, and did not start from the plain guess, that is solved too and
    /// the better plan is kept; `iterations` and `factorisations` count everything.
    ///
    /// # Errors
    /// [`Error::Parameter`] for unusable data, [`Error::Capacity`] for const sizes that are too small,
    /// [`Error::Solver`] for what the solver refuses.
    pub fn plan<const NX: usize, const NU: usize, const NI: usize, K: Keep<T, NX, NU, NI>>(
        &self,
        settings: &Settings<T>,
        stages: &mut [Stage<T, State<T, PHASES>, NX, NU, NI, K>],
        mut observer: impl FnMut(&Progress<T>) -> ControlFlow<()>,
    ) -> Result<Solution<T>, Error> {
        self.plan_observed(settings, stages, &mut observer)
    }

    /// [`Self::plan`], compiled once for all observers.
    fn plan_observed<const NX: usize, const NU: usize, const NI: usize, K: Keep<T, NX, NU, NI>>(
        &self,
        settings: &Settings<T>,
        stages: &mut [Stage<T, State<T, PHASES>, NX, NU, NI, K>],
        observer: &mut dyn FnMut(&Progress<T>) -> ControlFlow<()>,
    ) -> Result<Solution<T>, Error> {
        self.check()?;
        let fits = NX >= TIMES.saturating_add(PHASES)
            && NU >= FEET.saturating_mul(3)
            && NI >= row_capacity(FEET, PHASES);
        if !fits {
            return Err(Error::Capacity);
        }
        let first = Solver::new(*settings).solve(self, stages, &mut *observer)?;
        let is_good = match first.status {
            Status::Solved => !self.has_collapsed_phase(stages),
            status => status == Status::Cancelled,
        };
        if is_good {
            return Ok(first);
        }
        stages.iter_mut().for_each(Stage::keep);
        self.write_guess(stages, || T::ZERO);
        if stages.iter().all(Stage::is_at_guess) {
            stages.iter_mut().for_each(Stage::recall);
            return Ok(first);
        }
        let mut cold = *settings;
        cold.warm_start = false;
        cold.initial_mu = max(settings.initial_mu, Settings::new().initial_mu);
        let mut last = Solver::new(cold).solve(self, stages, observer)?;
        let iterations = first.iterations.saturating_add(last.iterations);
        let factorisations = first.factorisations.saturating_add(last.factorisations);
        let is_better = last.status == Status::Solved
            && (first.status != last.status || last.cost < first.cost);
        if !is_better {
            stages.iter_mut().for_each(Stage::recall);
            last = first;
        }
        (last.iterations, last.factorisations) = (iterations, factorisations);
        last.restarts = last.restarts.saturating_add(1);
        Ok(last)
    }

    /// Whether a contact phase ended at its shortest duration although it may be longer.
    fn has_collapsed_phase<const NX: usize, const NU: usize, const NI: usize, K>(
        &self,
        stages: &[Stage<T, State<T, PHASES>, NX, NU, NI, K>],
    ) -> bool {
        let Some(first) = stages.first() else {
            return false;
        };
        self.used_phases()
            .iter()
            .zip(&first.state.durations)
            .any(|(phase, duration)| {
                let width = phase.max_duration - phase.min_duration;
                phase.contacts.contains(&true)
                    && *duration < phase.min_duration + T::of(1e-3) * width
            })
    }
}
