//! Planning, with the interpreter free meanwhile.

use core::ops::ControlFlow;
use core::time::Duration;

use jump_planner::{Options, Step, Timing};
use ocp_solver::Progress;
use pyo3::{FromPyObject, Py, PyAny, PyErr, PyResult, Python, pyfunction};

use crate::errors::{bad, failed, no_plan};
use crate::plan::Plan;
use crate::robot::Robot;
use crate::task::Task;

/// A task, or its name.
#[derive(FromPyObject)]
pub(crate) enum Asked {
    /// As it was made.
    Task(Py<Task>),
    /// As `Task.load` takes it.
    Name(String),
}

impl Asked {
    /// The task, for another robot where one is given.
    fn task(&self, robot: Option<&Py<Robot>>) -> PyResult<jump_planner::task::Task> {
        match self {
            Self::Task(task) => task.get().for_robot(robot),
            Self::Name(name) => Ok(Task::named(name, robot)?.task),
        }
    }
}

/// What a step is called.
const fn name(step: Step) -> &'static str {
    match step {
        Step::Body => "body",
        Step::WholeBody => "whole body",
        Step::Relaxations => "relaxations",
    }
}

/// Timings by their name.
fn timing(name: &str) -> PyResult<Timing> {
    match name {
        "given" => Ok(Timing::Given),
        "free" => Ok(Timing::Free),
        _ => Err(bad(format!(
            "timing: must be \"given\" or \"free\", not {name:?}"
        ))),
    }
}

/// Plans a task: bounds, rigid body, whole body, audit. Takes one to ten seconds; other threads of Python run meanwhile, and Ctrl-C stops it.
///
/// `task` is a Task, or what Task.load takes; `robot` jumps in the place of its own. `progress(step, iteration, violation)` is called
/// after every iteration of a solver; whatever it raises stops the planner and is raised here. `timing` is "given", from the rigid
/// body's plan, or "free", unknowns of the whole body's problem. `within` is the time there is, s, which ends an iteration or an audit
/// late; None: as much as it takes. `near` is a plan of a task that differs little, in its goal, friction or robot: planning begins with what it
/// found, where phases are the same and timings given. A plan that was loaded keeps nothing to begin with.
///
/// Raises Infeasible with the proof, NotFound or AuditFailed with the reason, OutOfTime with what stood in the way, and BadInput.
#[pyfunction]
#[pyo3(signature = (task, robot = None, progress = None, *, timing = "given", within = None, near = None), name = "plan")]
pub(crate) fn plan(
    py: Python<'_>,
    task: Asked,
    robot: Option<Py<Robot>>,
    progress: Option<Py<PyAny>>,
    timing: &str,
    within: Option<f64>,
    near: Option<Py<Plan>>,
) -> PyResult<Plan> {
    let task = task.task(robot.as_ref())?;
    let within = within.map(Duration::try_from_secs_f64).transpose();
    let options = Options {
        timing: self::timing(timing)?,
        within: within.map_err(|error| bad(format!("within: {error}")))?,
    };
    let mut stopped: Option<PyErr> = None;
    let found = py.detach(|| {
        let watch = |step, at: Option<&Progress<f64>>| {
            let told = Python::attach(|py| {
                py.check_signals()?;
                if let (Some(progress), Some(at)) = (&progress, at) {
                    progress.call1(py, (name(step), at.iteration, at.residual.primal))?;
                }
                Ok(())
            });
            match told {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    stopped.get_or_insert(error);
                    ControlFlow::Break(())
                }
            }
        };
        match near.as_ref().and_then(|near| near.get().1.as_ref()) {
            Some(kept) => jump_planner::replan(&task, kept, &options, watch),
            None => jump_planner::plan(&task, &options, watch),
        }
    });
    if let Some(error) = stopped {
        return Err(error);
    }
    let found = found.map_err(failed)?;
    match found.answer {
        Some(answer) => Err(no_plan(&answer)),
        None => Plan::of(task, &found.bytes, found.kept),
    }
}
