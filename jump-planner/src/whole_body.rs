//! The whole-body plan of a task as it is to be executed: timings from the single rigid body, or found on the whole body itself.

use super::FOOT_COUNT;
use super::pace::Pace;
pub use super::setup::{FRICTION_SMOOTHING, GOAL_TOLERANCE, N, POSED};
use super::setup::{NI, NU, NX, Setup, times};
use super::stored::{open, store};
use super::task::{PHASES, SrbPlan, Task};
use crate::audit::Audit;
use core::ops::ControlFlow;
use ocp_solver::{Progress, Solution, Stage, Status, blocking_rows};
use std::time::Instant;
use wb_opt::{BASE, FreeTiming, Gains, Judgement, Phase, Problem, Row, Sample, State, TimedState};

/// Most iterations; tasks that are solved take 15 to 130.
const PATIENCE: usize = 150;

/// Where the durations of the phases come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Timing {
    /// From the rigid body's plan: the two-stage way of paper A.
    Given,
    /// They are unknowns of the whole body's problem, and start from the given ones.
    Free,
}

/// A solved whole-body plan.
pub struct WholeBodyPlan {
    /// How the solver ended.
    pub outcome: Solution<f64>,
    /// Cost and violations in physical units.
    pub judged: Judgement<f64>,
    /// Torque that the plan was allowed of the strongest joint, N m.
    pub torque_limit: f64,
    /// Contact phases with their durations.
    pub phases: Vec<Phase<f64, FOOT_COUNT>>,
    /// All intervals in order.
    pub intervals: Vec<Interval>,
    /// State at the planned touchdown.
    pub end: State<f64, N>,
    /// What blocks, worst first; nothing if the plan was solved.
    pub blocked: Vec<Blocked>,
    /// Share of the torque limits that the plan was allowed.
    pub torque_share: f64,
}

/// A row that is violated where the solver stopped.
pub struct Blocked {
    /// Which row.
    pub row: Row,
    /// By how much, in the row's own unit.
    pub violation: f64,
}

/// One interval of a plan; torques and forces are held over it.
pub struct Interval {
    /// Start, s.
    pub start: f64,
    /// Length, s.
    pub dt: f64,
    /// State at the start.
    pub state: State<f64, N>,
    /// The middle.
    pub sample: Sample<f64, N, FOOT_COUNT>,
    /// Feedback gains of the solver's last recursion.
    pub gains: Gains<f64, N, FOOT_COUNT>,
}

/// A plan and what its audit found.
pub struct Audited {
    /// The plan, or how far the solver came.
    pub plan: WholeBodyPlan,
    /// The plan as it is stored; nothing of a plan that was not solved.
    pub bytes: Vec<u8>,
    /// None of a plan that was not solved.
    pub audit: Option<Audit>,
    /// Time of planning, without the audit, ms.
    pub wall_ms: f64,
}

/// Plans the whole body and audits the plan. Where the audit finds limits exceeded between nodes or a flight that is not
/// true to the dynamics, the intervals were too long for this robot: they are halved, once.
///
/// # Errors
/// A problem that cannot be begun with, or a plan that cannot be stored.
pub fn audited(
    task: &Task,
    srb: &SrbPlan,
    timing: Timing,
    mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<Audited, String> {
    let mut wall_ms = 0.0;
    let mut on_intervals = |share: f64| {
        let clock = Instant::now();
        let plan = plan_on(task, srb, timing, share, &mut observer)?;
        wall_ms += clock.elapsed().as_secs_f64() * 1e3;
        let (mut bytes, mut audit) = (Vec::new(), None);
        if plan.outcome.status == Status::Solved {
            bytes = store(task, &plan)?;
            let stored = open(&bytes, &task.robot).map_err(|error| error.to_string())?;
            audit = Some(Audit::of(&task.robot, &stored)?);
        }
        Ok::<_, String>(Audited {
            plan,
            bytes,
            audit,
            wall_ms,
        })
    };
    let coarse = on_intervals(1.0)?;
    // Shorter intervals make no link thinner.
    if coarse.audit.as_ref().is_none_or(Audit::is_a_motion) {
        return Ok(coarse);
    }
    let fine = on_intervals(0.5)?;
    // A plan that fails its audit says more than none.
    let wall_ms = fine.wall_ms;
    let told = if fine.audit.is_some() { fine } else { coarse };
    Ok(Audited { wall_ms, ..told })
}

/// Plans the whole body along a single-rigid-body plan.
///
/// # Errors
/// A problem that cannot be begun with.
pub fn plan(
    task: &Task,
    srb: &SrbPlan,
    timing: Timing,
    observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<WholeBodyPlan, String> {
    plan_on(task, srb, timing, 1.0, observer)
}

/// Plans on intervals of a share of their usual length.
fn plan_on(
    task: &Task,
    srb: &SrbPlan,
    timing: Timing,
    share: f64,
    mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<WholeBodyPlan, String> {
    let setup = Setup::new(task, srb, share)?;
    let mut problem = setup.problem();
    let mut stages: Vec<Stage<f64, State<f64, N>, NX, NU, NI>> =
        vec![Stage::new(State::at_rest(problem.start)); problem.intervals() + 1];
    let mut timed = match timing {
        Timing::Given => Vec::new(),
        Timing::Free => timed_stages(&problem),
    };
    let mut settings = wb_opt::settings();
    (settings.max_iterations, settings.attempt_iterations) = (PATIENCE, PATIENCE);
    let mut solved = None;
    let given = problem.robot.limits;
    let shares = task.limits.torque_shares;
    for (i, share) in shares.into_iter().enumerate() {
        for (limit, given) in problem.robot.limits.iter_mut().zip(&given).skip(BASE) {
            limit.effort = share * given.effort;
        }
        problem.write_guess(
            &mut stages,
            &setup.nodes,
            |k, foot| setup.force(k, foot),
            || 0.0,
        );
        let (mut pace, mut cancelled) = (Pace::default(), false);
        let watch = |progress: &Progress<f64>| {
            cancelled = observer(progress).is_break();
            // With the most torque there is nothing to save time for.
            let last = i + 1 == shares.len();
            let violation = progress.residual.primal;
            if !cancelled && (last || pace.keeps_up(progress.attempt, violation, PATIENCE)) {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        };
        let outcome = match timing {
            Timing::Given => problem.plan(&settings, &mut stages, watch),
            Timing::Free => {
                let free = free_timing(task, problem);
                free.write_guess(&stages, &mut timed);
                free.plan(&settings, &mut timed, watch)
            }
        };
        let outcome = outcome.map_err(|error| format!("task {}: {error}", task.name))?;
        solved = Some((outcome, share));
        if cancelled || outcome.status == Status::Solved {
            break;
        }
    }
    let outcome = solved.ok_or("no torque to plan with")?;
    match timing {
        Timing::Given => finish(&problem, outcome, &stages, |state| state),
        Timing::Free => {
            let found = timed
                .first()
                .map_or([0.0; PHASES], |stage| stage.state.durations);
            let mut phases = setup.phases.clone();
            for (phase, duration) in phases.iter_mut().zip(found) {
                phase.dt = duration / phase.intervals as f64;
            }
            let problem = Problem {
                phases: &phases,
                ..problem
            };
            finish(&problem, outcome, &timed, |state| &state.state)
        }
    }
}

/// Coordinates of a state with durations.
const TIMED: usize = NX + PHASES;

type TimedStages = Vec<Stage<f64, TimedState<f64, N, PHASES>, TIMED, NU, NI>>;

fn timed_stages(problem: &Problem<'_, f64, N, FOOT_COUNT>) -> TimedStages {
    let start = TimedState {
        state: State::at_rest(problem.start),
        durations: [0.0; PHASES],
    };
    vec![Stage::new(start); problem.intervals() + 1]
}

/// The problem with the task's bounds on its durations.
fn free_timing<'a>(
    task: &Task,
    problem: Problem<'a, f64, N, FOOT_COUNT>,
) -> FreeTiming<'a, f64, N, FOOT_COUNT, PHASES> {
    let rigid = &task.problem;
    FreeTiming {
        problem,
        durations: rigid
            .phases
            .map(|phase| [phase.min_duration, phase.max_duration]),
        total: [rigid.min_total, rigid.max_total],
    }
}

/// What the stages hold, in physical units.
fn finish<S: Copy, const X: usize>(
    problem: &Problem<'_, f64, N, FOOT_COUNT>,
    (outcome, torque_share): (Solution<f64>, f64),
    stages: &[Stage<f64, S, X, NU, NI>],
    state: impl Fn(&S) -> &State<f64, N>,
) -> Result<WholeBodyPlan, String> {
    let strongest = problem
        .robot
        .limits
        .iter()
        .skip(BASE)
        .map(|limit| limit.effort);
    let nodes = stages
        .iter()
        .map(|stage| (state(&stage.state), &stage.control));
    let starts = times(problem.phases);
    let intervals = stages[..problem.intervals()]
        .iter()
        .zip(&starts)
        .enumerate();
    let intervals = intervals.map(|(k, (stage, start))| {
        let at = state(&stage.state);
        Interval {
            start: *start,
            dt: problem.dt(k),
            state: *at,
            sample: problem.sample(k, at, &stage.control),
            gains: problem.gains(k, at, &stage.control, stage.gain()),
        }
    });
    let blocking = blocking_rows::<4, _, _, _, _, _, _>(stages);
    let blocked = blocking.iter().flatten().filter_map(|found| {
        let (row, unit) = problem.row(found.stage, found.row)?;
        let violation = (found.violation * unit).abs();
        Some(Blocked { row, violation })
    });
    Ok(WholeBodyPlan {
        end: *state(&stages.last().ok_or("no nodes")?.state),
        torque_share,
        blocked: match outcome.status {
            Status::Solved => Vec::new(),
            _ => blocked.collect(),
        },
        outcome,
        judged: problem.judge(nodes),
        torque_limit: strongest.fold(0.0, f64::max),
        intervals: intervals.collect(),
        phases: problem.phases.to_vec(),
    })
}
