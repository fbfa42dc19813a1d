//! A planned jump of a quadruped, from the bytes of its plan to a run and its verdict.

use super::execute::{Run, Trial, run_watched};
use super::judge::Judged;
use core::fmt::Display;
use jump_planner::audit::check_values;
use jump_planner::reference::Reference;
use jump_planner::robot::Quadruped;
use jump_planner::stored;
use jump_planner::task::Task;

/// A task with its plan.
#[derive(Clone)]
pub struct Planned {
    /// What is wanted, by which runs are judged.
    pub task: Task,
    /// What the machine follows.
    pub reference: Reference,
}

impl Planned {
    /// Opens the bytes of a plan for a robot. `task` finds the task by the name in the plan: [`Task::load`] for the built-in ones.
    ///
    /// # Errors
    /// A sentence: the bytes are no plan, or one for another robot or task, or a value is out of its range; or what `task` says.
    pub fn open<E: Display>(
        robot: &Quadruped,
        bytes: &[u8],
        task: impl FnOnce(&str) -> Result<Task, E>,
    ) -> Result<Self, String> {
        let plan = stored::open_for(bytes, robot)?;
        check_values(robot, &plan).map_err(|error| error.to_string())?;
        let task = task(plan.header().task).map_err(|error| error.to_string())?;
        let reference = stored::reference(&plan, &task)?;
        Ok(Self { task, reference })
    }

    /// Flies it in a simulator.
    ///
    /// # Errors
    /// A sentence: the machine refuses the plan, this build lacks the simulator, or that fails.
    pub fn run(&self, trial: Trial<'_>) -> Result<Run, String> {
        let (task, reference) = (&self.task, &self.reference);
        run_watched(task, reference, trial, |_, _| {}, |_, _| {}, |_| {})
    }

    /// Judges a run.
    #[must_use]
    pub fn judge(&self, run: &Run) -> Judged {
        Judged::of(&self.task, &self.reference, run)
    }
}
