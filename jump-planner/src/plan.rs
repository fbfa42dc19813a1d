//! The whole way: bounds, rigid body, whole body, bytes, audit.

use crate::answer::Answer;
use crate::audit::Audit;
use crate::bounds::impossible;
use crate::task::{SrbPlan, Task};
use crate::whole_body::{Attempt, Timing, WholeBodyPlan, audited};
use core::cell::Cell;
use core::ops::ControlFlow;
use core::time::Duration;
use ocp_solver::{Progress, Settings, Status};
use std::time::Instant;

/// How to plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Where the durations of the phases come from.
    pub timing: Timing,
    /// The time there is, from the call on: it ends an iteration or an audit late, a few tenths of a second on long jumps. None: as
    /// much as it takes.
    pub within: Option<Duration>,
}

/// What the planner is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The motion of the rigid body.
    Body,
    /// The motion of all joints.
    WholeBody,
    /// There is no plan: tasks that ask for less.
    Relaxations,
}

/// How far planning came. Without an [`answer`](Self::answer) the [`bytes`](Self::bytes) are a plan that passed its audit.
#[derive(Default)]
pub struct Outcome {
    /// The rigid body's plan, solved or not; none where a bound proves that there is none, or where timings are free.
    pub srb: Option<SrbPlan>,
    /// The whole body's plan, solved or not.
    pub whole_body: Option<WholeBodyPlan>,
    /// Time that the whole body took, audits included, ms.
    pub wall_ms: f64,
    /// Every solve of the whole body, in order.
    pub path: Vec<Attempt>,
    /// The plan as it is stored, audited and executed; empty if the whole body was not solved.
    pub bytes: Vec<u8>,
    /// What the audit of the bytes found.
    pub audit: Option<Audit>,
    /// Why there is no plan.
    pub answer: Option<Answer>,
}

/// Plans a task. `observe` hears every iteration of the solvers, and stops them by `Break`: what was found until then is handed back.
///
/// # Errors
/// A sentence, for a task that no solver can begin with.
pub fn plan(
    task: &Task,
    options: &Options,
    mut observe: impl FnMut(Step, Option<&Progress<f64>>) -> ControlFlow<()>,
) -> Result<Outcome, String> {
    let clock = Instant::now();
    let mut out = Outcome::default();
    if let Some(proof) = impossible(task) {
        out.answer = Some(Answer::proven(proof));
        return Ok(out);
    }
    let late = Cell::new(None);
    let mut observe = |step, progress: Option<&Progress<f64>>| {
        late.set(options.within.filter(|within| clock.elapsed() >= *within));
        if late.get().is_some() {
            ControlFlow::Break(())
        } else {
            observe(step, progress)
        }
    };
    let guess;
    let srb = match options.timing {
        Timing::Free => {
            guess = task.guess()?;
            &guess
        }
        Timing::Given => {
            let found = task.attempt(&Settings::new(), |p| observe(Step::Body, Some(p)))?;
            let srb = &*out.srb.insert(found);
            if srb.status != Status::Solved {
                let blocked = Answer::no_body_plan(task, srb);
                out.answer = Some(match End::of(srb.status, &late, &mut observe) {
                    End::Itself => {
                        blocked.with_easier_tasks(task, |p| observe(Step::Relaxations, Some(p)))
                    }
                    End::Cancelled => Answer::cancelled(),
                    End::Late(within) => blocked.out_of_time(within),
                });
                return Ok(out);
            }
            srb
        }
    };
    let whole = audited(task, srb, options.timing, |p| {
        observe(Step::WholeBody, Some(p))
    })?;
    out.answer = match &whole.audit {
        Some(audit) if audit.passes() => None,
        Some(audit) => Some(Answer::failed(audit)),
        None => {
            let blocked = Answer::no_whole_body_plan(task, &whole.plan);
            Some(
                match End::of(whole.plan.outcome.status, &late, &mut observe) {
                    End::Itself => blocked
                        .with_stronger_joints(task, srb, |p| observe(Step::Relaxations, Some(p))),
                    End::Cancelled => Answer::cancelled(),
                    End::Late(within) => blocked.out_of_time(within),
                },
            )
        }
    };
    (out.wall_ms, out.bytes, out.audit) = (whole.wall_ms, whole.bytes, whole.audit);
    (out.whole_body, out.path) = (Some(whole.plan), whole.path);
    Ok(out)
}

/// Why a solver ended without a plan.
enum End {
    /// It found none.
    Itself,
    /// The observer wants no more.
    Cancelled,
    /// The time ended.
    Late(Duration),
}

impl End {
    /// After a solve that ended so. A solver that found nothing is asked for easier tasks, unless the observer wants no more.
    fn of(
        status: Status,
        late: &Cell<Option<Duration>>,
        observe: &mut impl FnMut(Step, Option<&Progress<f64>>) -> ControlFlow<()>,
    ) -> Self {
        if status == Status::Cancelled {
            return late.get().map_or(Self::Cancelled, Self::Late);
        }
        if observe(Step::Relaxations, None).is_break() && late.get().is_none() {
            Self::Cancelled
        } else {
            Self::Itself
        }
    }
}
