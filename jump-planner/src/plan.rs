//! The whole way: bounds, rigid body, whole body, bytes, audit.

use crate::Observe;
use crate::answer::Answer;
use crate::audit::Audit;
use crate::bounds::impossible;
use crate::kept::Kept;
use crate::task::{SrbPlan, Task};
use crate::whole_body::{Attempt, Timing, WholeBodyPlan, audited_near, audited_observed};
use core::cell::Cell;
use core::ops::ControlFlow;
use core::time::Duration;
use ocp_solver::{Progress, Settings, Status};
use std::time::Instant;

/// Barrier with which the rigid body's plan begins near another one.
const NEAR_MU: f64 = 1e-5;
/// Iterations in which it has to arrive; from the guess easy jumps take 13 to 25, others to 190.
const NEAR_ITERATIONS: usize = 40;

/// As [`Observe`], of the whole way.
type ObserveSteps<'a> = &'a mut dyn FnMut(Step, Option<&Progress<f64>>) -> ControlFlow<()>;

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
    /// Where [`replan`] can begin for a task like this one.
    pub kept: Option<Kept>,
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
    planned(task, None, options, &mut observe)
}

/// As [`plan`], for a task that differs little from the one that `kept` is of: in its goal, friction, masses or posture. Both stages begin
/// with the motions and multipliers that are kept, on the same intervals, and take about half of the iterations.
///
/// Where that leads nowhere the task is planned from the start; so it is where its phases are others or its durations free.
///
/// # Errors
/// As [`plan`].
pub fn replan(
    task: &Task,
    kept: &Kept,
    options: &Options,
    mut observe: impl FnMut(Step, Option<&Progress<f64>>) -> ControlFlow<()>,
) -> Result<Outcome, String> {
    let same = options.timing == Timing::Given && kept.is_of_phases(task);
    planned(task, same.then_some(kept), options, &mut observe)
}

fn planned(
    task: &Task,
    kept: Option<&Kept>,
    options: &Options,
    observe: ObserveSteps<'_>,
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
            let found = body(task, kept, &mut |p| observe(Step::Body, Some(p)))?;
            let srb = &*out.srb.insert(found);
            if srb.status != Status::Solved {
                let blocked = Answer::no_body_plan(task, srb);
                let end = End::of(srb.status, &late);
                let unwanted = matches!(end, End::Itself)
                    && observe(Step::Relaxations, None).is_break()
                    && late.get().is_none();
                out.answer = Some(match end {
                    End::Itself if unwanted => Answer::cancelled(),
                    End::Itself => {
                        let watch = |p: &_| observe(Step::Relaxations, Some(p));
                        blocked.with_easier_tasks(task, watch)
                    }
                    End::Cancelled => Answer::cancelled(),
                    End::Late(within) => blocked.out_of_time(within),
                });
                return Ok(out);
            }
            srb
        }
    };
    let watch: Observe<'_> = &mut |p| observe(Step::WholeBody, Some(p));
    let whole = match kept {
        Some(kept) => audited_near(task, srb, kept, watch)?,
        None => audited_observed(task, srb, options.timing, watch)?,
    };
    out.answer = match &whole.audit {
        Some(audit) if audit.passes() => None,
        Some(audit) => Some(Answer::failed(audit)),
        None => {
            let blocked = Answer::no_whole_body_plan(task, &whole.plan);
            Some(match End::of(whole.plan.outcome.status, &late) {
                End::Itself => blocked,
                End::Cancelled => Answer::cancelled(),
                End::Late(within) => blocked.out_of_time(within),
            })
        }
    };
    (out.wall_ms, out.bytes, out.audit) = (whole.wall_ms, whole.bytes, whole.audit);
    (out.whole_body, out.path) = (Some(whole.plan), whole.path);
    out.kept = whole.kept;
    Ok(out)
}

/// The motion of the rigid body, from the one that is kept, or from the guess.
fn body(task: &Task, kept: Option<&Kept>, observer: Observe<'_>) -> Result<SrbPlan, String> {
    if let Some(kept) = kept {
        let mut settings = Settings::new();
        (settings.warm_start, settings.initial_mu) = (true, NEAR_MU);
        settings.max_iterations = NEAR_ITERATIONS;
        let found = task.attempt_from(kept.body.clone(), &settings, &mut *observer)?;
        if matches!(found.status, Status::Solved | Status::Cancelled) {
            return Ok(found);
        }
    }
    task.attempt(&Settings::new(), observer)
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
    /// After a solve that ended so.
    fn of(status: Status, late: &Cell<Option<Duration>>) -> Self {
        if status == Status::Cancelled {
            late.get().map_or(Self::Cancelled, Self::Late)
        } else {
            Self::Itself
        }
    }
}
