//! The whole-body plan of a task as it is to be executed: timings from the single rigid body, or found on the whole body itself.

use super::FOOT_COUNT;
use super::pace::Pace;
pub use super::setup::{FRICTION_SMOOTHING, GOAL_TOLERANCE, N, POSED};
use super::setup::{NI, NU, NX, Setup, times};
use super::stored::{open, store};
use super::task::{PHASES, SrbPlan, Task};
use crate::audit::Audit;
pub use crate::tightening::Tightening;
use core::ops::ControlFlow;
use ocp_solver::{Progress, Settings, Solution, SparseStage, Status, blocking_rows};
use serde_json::{Value, json};
use std::time::Instant;
use wb_opt::{BASE, FreeTiming, Gains, Judgement, Phase, Problem, Row, Sample, State, TimedState};

/// Most iterations; tasks that are solved take 15 to 130.
const PATIENCE: usize = 150;
/// How often limits are drawn in at most.
const TIGHTENINGS: usize = 3;
/// Barrier to begin with where a plan is made again.
const WARM_MU: f64 = 1e-3;

/// Where the durations of the phases come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Timing {
    /// From the rigid body's plan: the two-stage way of paper A.
    #[default]
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

/// One solve on the way to a plan.
#[derive(Clone, Debug)]
pub struct Attempt {
    /// Where the durations of the phases came from.
    pub timing: Timing,
    /// Number of intervals.
    pub intervals: usize,
    /// Share of the torque limits.
    pub torque_share: f64,
    /// Limits that were drawn in after the audit of the attempt before.
    pub drawn: Tightening,
    /// How it ended.
    pub status: Status,
    /// Iterations.
    pub iterations: usize,
    /// Time, ms.
    pub wall_ms: f64,
}

/// A plan and what its audit found.
pub struct Audited {
    /// All solves, in order; the plan is that of the last, unless that found none and one before did.
    pub path: Vec<Attempt>,
    /// The plan, or how far the solver came.
    pub plan: WholeBodyPlan,
    /// The plan as it is stored; nothing of a plan that was not solved.
    pub bytes: Vec<u8>,
    /// None of a plan that was not solved.
    pub audit: Option<Audit>,
    /// Time of planning and auditing, ms.
    pub wall_ms: f64,
}

impl Audited {
    /// Whether the solver ended without a plan, and was not told to.
    fn is_missing(&self) -> bool {
        self.audit.is_none() && self.plan.outcome.status != Status::Cancelled
    }

    /// Takes over what was found in another way. A plan that fails its audit says more than none.
    fn replace_with(&mut self, other: Self) {
        let path = core::mem::take(&mut self.path);
        let wall_ms = self.wall_ms + other.wall_ms;
        let more = other.path.clone();
        if other.audit.is_some() {
            *self = other;
        }
        self.wall_ms = wall_ms;
        self.path = path.into_iter().chain(more).collect();
    }
}

/// Plans the whole body and audits the plan.
///
/// Where the audit finds limits exceeded between nodes, they are drawn in by that much and the plan is made again from where it is
/// ([`Tightening`]). Where that is no remedy, or the flight is not true to the dynamics, the intervals were too long for this robot: they are
/// halved, once. Where legs have no motion in the given durations, they are found on the whole body: what a rigid body can do in a time,
/// legs with motors may not.
///
/// # Errors
/// A problem that cannot be begun with, or a plan that cannot be stored.
pub fn audited(
    task: &Task,
    srb: &SrbPlan,
    timing: Timing,
    mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<Audited, String> {
    let mut told = on_grids(task, srb, timing, &mut observer)?;
    let may_differ = timing == Timing::Given && !task.has_given_durations();
    if may_differ && told.is_missing() {
        told.replace_with(on_grids(task, srb, Timing::Free, &mut observer)?);
    }
    Ok(told)
}

/// On the usual intervals, then on halves.
fn on_grids(
    task: &Task,
    srb: &SrbPlan,
    timing: Timing,
    observer: &mut impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<Audited, String> {
    let mut told = tightened(task, Grid::new(task, srb, timing, 1.0)?, observer)?;
    // Shorter intervals make no link thinner.
    if !told.audit.as_ref().is_none_or(Audit::is_a_motion) {
        let fine = tightened(task, Grid::new(task, srb, timing, 0.5)?, observer)?;
        told.replace_with(fine);
    }
    Ok(told)
}

/// Plans on a grid, and again within limits drawn in as long as that is what the audit asks for, a few times.
fn tightened(
    task: &Task,
    mut grid: Grid<'_>,
    observer: &mut impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<Audited, String> {
    let clock = Instant::now();
    let mut told = grid.search(observer)?.audited(task)?;
    let mut drawn = Tightening::default();
    for _ in 0..TIGHTENINGS {
        let Some(next) = told.audit.as_ref().and_then(|audit| drawn.after(audit)) else {
            break;
        };
        drawn = next;
        let again = grid.again(&drawn, observer)?.audited(task)?;
        if again.audit.is_none() {
            break;
        }
        told = again;
    }
    told.path = grid.path;
    told.wall_ms = clock.elapsed().as_secs_f64() * 1e3;
    Ok(told)
}

impl WholeBodyPlan {
    /// Stores and audits the plan, if it was solved.
    fn audited(self, task: &Task) -> Result<Audited, String> {
        let (mut bytes, mut audit) = (Vec::new(), None);
        if self.outcome.status == Status::Solved {
            bytes = store(task, &self)?;
            let stored = open(&bytes, &task.robot).map_err(|error| error.to_string())?;
            audit = Some(Audit::of(&task.robot, &stored)?);
        }
        Ok(Audited {
            path: Vec::new(),
            plan: self,
            bytes,
            audit,
            wall_ms: 0.0,
        })
    }
}

/// Plans the whole body along a single-rigid-body plan.
///
/// # Errors
/// A problem that cannot be begun with.
pub fn plan(
    task: &Task,
    srb: &SrbPlan,
    timing: Timing,
    mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<WholeBodyPlan, String> {
    Grid::new(task, srb, timing, 1.0)?.search(&mut observer)
}

/// Coordinates of a state with durations.
const TIMED: usize = NX + PHASES;

/// A task's problem on its intervals, and the solver's storage: of the two kinds of stages the one that the timing asks for is solved.
struct Grid<'a> {
    task: &'a Task,
    timing: Timing,
    setup: Setup<'a>,
    stages: Vec<SparseStage<f64, State<f64, N>, NX, NU, NI>>,
    timed: Vec<SparseStage<f64, TimedState<f64, N, PHASES>, TIMED, NU, NI>>,
    /// Share of the torque limits of the last solve.
    torque_share: f64,
    path: Vec<Attempt>,
}

impl<'a> Grid<'a> {
    /// With intervals of a share of their usual length.
    fn new(
        task: &'a Task,
        srb: &'a SrbPlan,
        timing: Timing,
        length_share: f64,
    ) -> Result<Self, String> {
        let setup = Setup::new(task, srb, length_share)?;
        let problem = setup.problem(&Tightening::default());
        let start = State::at_rest(problem.start);
        let nodes = problem.intervals() + 1;
        let timed = TimedState {
            state: start,
            durations: [0.0; PHASES],
        };
        Ok(Self {
            task,
            timing,
            stages: vec![SparseStage::sparse(start); nodes],
            timed: match timing {
                Timing::Given => Vec::new(),
                Timing::Free => vec![SparseStage::sparse(timed); nodes],
            },
            torque_share: 0.0,
            path: Vec::new(),
            setup,
        })
    }

    /// Plans from the rigid body's motion, with as little torque as it takes.
    fn search(
        &mut self,
        observer: &mut impl FnMut(&Progress<f64>) -> ControlFlow<()>,
    ) -> Result<WholeBodyPlan, String> {
        let shares = self.task.limits.torque_shares;
        let mut found = None;
        for (i, share) in shares.into_iter().enumerate() {
            self.torque_share = share;
            let setup = &self.setup;
            setup.problem(&Tightening::default()).write_guess(
                &mut self.stages,
                &setup.nodes,
                |k, foot| setup.force(k, foot),
                || 0.0,
            );
            let (mut pace, mut cancelled) = (Pace::default(), false);
            // With the most torque there is nothing to save time for.
            let last = i + 1 == shares.len();
            let watch = |progress: &Progress<f64>| {
                cancelled = observer(progress).is_break();
                let violation = progress.residual.primal;
                if !cancelled && (last || pace.keeps_up(progress.attempt, violation, PATIENCE)) {
                    ControlFlow::Continue(())
                } else {
                    ControlFlow::Break(())
                }
            };
            let plan = self.solve(&Tightening::default(), &settings(), watch)?;
            let solved = plan.outcome.status == Status::Solved;
            found = Some(plan);
            if cancelled || solved {
                break;
            }
        }
        found.ok_or_else(|| "no torque to plan with".to_owned())
    }

    /// Plans again from where the last solve ended, with its torque.
    fn again(
        &mut self,
        drawn: &Tightening,
        observer: &mut impl FnMut(&Progress<f64>) -> ControlFlow<()>,
    ) -> Result<WholeBodyPlan, String> {
        let mut settings = settings();
        (settings.warm_start, settings.initial_mu) = (true, WARM_MU);
        self.solve(drawn, &settings, observer)
    }

    /// Solves from what the stages hold, and keeps a note of it.
    fn solve(
        &mut self,
        drawn: &Tightening,
        settings: &Settings<f64>,
        watch: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
    ) -> Result<WholeBodyPlan, String> {
        let clock = Instant::now();
        let plan = self.solved(drawn, settings, watch)?;
        self.path.push(Attempt {
            timing: self.timing,
            intervals: plan.intervals.len(),
            torque_share: self.torque_share,
            drawn: *drawn,
            status: plan.outcome.status,
            iterations: plan.outcome.iterations,
            wall_ms: clock.elapsed().as_secs_f64() * 1e3,
        });
        Ok(plan)
    }

    fn solved(
        &mut self,
        drawn: &Tightening,
        settings: &Settings<f64>,
        watch: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
    ) -> Result<WholeBodyPlan, String> {
        let mut problem = self.setup.problem(drawn);
        for limit in problem.robot.limits.iter_mut().skip(BASE) {
            limit.effort *= self.torque_share;
        }
        let told = |error| format!("task {}: {error}", self.task.name);
        if self.timing == Timing::Given {
            let outcome = problem.plan(settings, &mut self.stages, watch);
            let outcome = (outcome.map_err(told)?, self.torque_share);
            return finish(&problem, outcome, &self.stages, |state| state);
        }
        let free = free_timing(self.task, problem);
        if !settings.warm_start {
            free.write_guess(&self.stages, &mut self.timed);
        }
        let outcome = free.plan(settings, &mut self.timed, watch);
        let outcome = (outcome.map_err(told)?, self.torque_share);
        let found = self.timed.first();
        let found = found.map_or([0.0; PHASES], |stage| stage.state.durations);
        let mut phases = self.setup.phases.clone();
        for (phase, duration) in phases.iter_mut().zip(found) {
            phase.dt = duration / phase.intervals as f64;
        }
        let problem = Problem {
            phases: &phases,
            ..problem
        };
        finish(&problem, outcome, &self.timed, |state| &state.state)
    }
}

/// Ends with a cost within 1e-4 of the least: the last digits of a plan take iterations, and no robot has them.
fn settings() -> Settings<f64> {
    let mut settings = wb_opt::settings();
    (settings.max_iterations, settings.attempt_iterations) = (PATIENCE, PATIENCE);
    settings.dual_tolerance = 1e-3;
    settings.complementarity_tolerance = 1e-5;
    settings
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
    stages: &[SparseStage<f64, S, X, NU, NI>],
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

impl Attempt {
    /// The entry of `path` in `--json`.
    #[must_use]
    pub fn json(&self) -> Value {
        let drawn = &self.drawn;
        json!({
            "durations": match self.timing {
                Timing::Given => "rigid body",
                Timing::Free => "whole body",
            },
            "intervals": self.intervals,
            "torque_share": self.torque_share,
            "drawn_in": {
                "position": drawn.position,
                "speed": drawn.speed,
                "torque": drawn.torque,
                "friction": drawn.friction,
            },
            "status": format!("{:?}", self.status),
            "iterations": self.iterations,
            "wall_ms": self.wall_ms,
        })
    }
}

impl core::fmt::Display for Attempt {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let durations = match self.timing {
            Timing::Given => "the rigid body's durations",
            Timing::Free => "durations of its own",
        };
        write!(
            f,
            "{durations}, {} intervals, {:.0} % of the torque{}: {:?} after {} iterations, {:.0} ms",
            self.intervals,
            100.0 * self.torque_share,
            self.drawn,
            self.status,
            self.iterations,
            self.wall_ms
        )
    }
}
