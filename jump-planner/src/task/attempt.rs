//! Solving a task's problem on the single rigid body.

use super::{SrbPlan, SrbStage, Task};
use crate::Observe;
use core::ops::ControlFlow;
use ocp_solver::{Progress, Settings, Solver, Status};
use std::time::Instant;

impl Task {
    /// Tries to solve the single-rigid-body problem.
    ///
    /// # Errors
    /// As [`Task::guess`].
    pub fn attempt(
        &self,
        settings: &Settings<f64>,
        mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
    ) -> Result<SrbPlan, String> {
        self.attempt_observed(self.guess()?.stages, settings, &mut observer)
    }

    /// As [`Task::attempt`], from these nodes instead of the guess.
    ///
    /// # Errors
    /// What the solver cannot begin with.
    pub fn attempt_from(
        &self,
        stages: Vec<SrbStage>,
        settings: &Settings<f64>,
        mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
    ) -> Result<SrbPlan, String> {
        self.attempt_observed(stages, settings, &mut observer)
    }

    fn attempt_observed(
        &self,
        mut stages: Vec<SrbStage>,
        settings: &Settings<f64>,
        observer: Observe<'_>,
    ) -> Result<SrbPlan, String> {
        let problem = &self.problem;
        let clock = Instant::now();
        let solution = Solver::new(*settings)
            .solve(problem, &mut stages, observer)
            .map_err(|error| error.to_string())?;
        let wall_ms = clock.elapsed().as_secs_f64() * 1e3;
        let judged = problem.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
        Ok(SrbPlan {
            stages,
            status: solution.status,
            iterations: solution.iterations as u32,
            wall_ms,
            cost: judged.cost,
            max_violation: judged.max_violation,
        })
    }

    /// Solves the single-rigid-body problem; anything but a solved problem is an error.
    ///
    /// # Errors
    /// As [`Task::attempt`], or that it was not solved.
    pub fn solve(&self) -> Result<SrbPlan, String> {
        let plan = self.attempt(&Settings::new(), |_| ControlFlow::Continue(()))?;
        if plan.status != Status::Solved {
            return Err(format!(
                "task {}: the planner ended with {:?} after {} iterations, violation {:.1e}",
                self.name, plan.status, plan.iterations, plan.max_violation
            ));
        }
        Ok(plan)
    }
}
