//! The whole way: bounds, rigid body, whole body, bytes, audit.

use crate::answer::Answer;
use crate::audit::Audit;
use crate::bounds::impossible;
use crate::task::{SrbPlan, Task};
use crate::whole_body::{Attempt, Timing, WholeBodyPlan, audited};
use core::ops::ControlFlow;
use ocp_solver::{Progress, Settings, Status};

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
    timing: Timing,
    mut observe: impl FnMut(Step, Option<&Progress<f64>>) -> ControlFlow<()>,
) -> Result<Outcome, String> {
    let mut out = Outcome::default();
    if let Some(proof) = impossible(task) {
        out.answer = Some(Answer::proven(proof));
        return Ok(out);
    }
    let guess;
    let srb = match timing {
        Timing::Free => {
            guess = task.guess()?;
            &guess
        }
        Timing::Given => {
            let found = task.attempt(&Settings::new(), |p| observe(Step::Body, Some(p)))?;
            let srb = &*out.srb.insert(found);
            if srb.status != Status::Solved {
                let cancelled =
                    srb.status == Status::Cancelled || observe(Step::Relaxations, None).is_break();
                out.answer = Some(if cancelled {
                    Answer::cancelled()
                } else {
                    Answer::no_body_plan(task, srb, |p| observe(Step::Relaxations, Some(p)))
                });
                return Ok(out);
            }
            srb
        }
    };
    let whole = audited(task, srb, timing, |p| observe(Step::WholeBody, Some(p)))?;
    out.answer = match &whole.audit {
        Some(audit) if audit.passes() => None,
        Some(audit) => Some(Answer::failed(audit)),
        None if whole.plan.outcome.status == Status::Cancelled
            || observe(Step::Relaxations, None).is_break() =>
        {
            Some(Answer::cancelled())
        }
        None => Some(Answer::no_whole_body_plan(task, srb, &whole.plan, |p| {
            observe(Step::Relaxations, Some(p))
        })),
    };
    (out.wall_ms, out.bytes, out.audit) = (whole.wall_ms, whole.bytes, whole.audit);
    (out.whole_body, out.path) = (Some(whole.plan), whole.path);
    Ok(out)
}
