//! The whole-body plan of a task as it is to be executed: timings from the single rigid body, or found on the whole body itself.

pub use super::setup::{FRICTION_SMOOTHING, GOAL_TOLERANCE, N, POSED};
use super::setup::{NI, NU, times};
use super::stored::{open, store};
use super::task::{SrbPlan, Task};
use super::{FOOT_COUNT, Observe};
use crate::audit::Audit;
use crate::grid::Grid;
use crate::kept::Kept;
use crate::search::searched;
pub use crate::stronger::Stronger;
pub use crate::tightening::Tightening;
use core::ops::ControlFlow;
use ocp_solver::{Progress, Solution, SparseStage, Status, blocking_rows};
use serde_json::{Value, json};
use std::time::Instant;
use wb_opt::{BASE, Gains, Judgement, Phase, Problem, Row, Sample, State};

/// How often limits are drawn in at most.
const TIGHTENINGS: usize = 3;
/// How often at most where there are links to keep apart: those that pass through each other show one after the other.
const SEPARATIONS: usize = 6;

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
    /// Contact phases with their durations; the length of an interval is the mean one.
    pub phases: Vec<Phase<f64, FOOT_COUNT>>,
    /// All intervals in order.
    pub intervals: Vec<Interval>,
    /// State at the planned touchdown.
    pub end: State<f64, N>,
    /// What blocks, worst first; nothing if the plan was solved.
    pub blocked: Vec<Blocked>,
    /// Share of the torque limits that the plan was allowed.
    pub torque_share: f64,
    /// Where none was found: the weakest joints that have one, if any have.
    pub stronger: Option<Stronger>,
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
    /// How many times as strong and as fast as they are the joints were taken to be.
    pub strength: f64,
    /// Limits that were drawn in after the audit of the attempt before.
    pub drawn: Tightening,
    /// How many pairs of links were kept apart, because they had passed through each other in an attempt before.
    pub apart: usize,
    /// How it ended.
    pub status: Status,
    /// What the audit has against the motion, if there is one and it has.
    pub complaint: Option<String>,
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
    /// For the next plan like this one; nothing where the last solve found none, or where the durations were unknowns.
    pub kept: Option<Kept>,
}

/// Plans the whole body and audits the plan.
///
/// First with the least torque, on intervals as short as they will be. Where that finds no motion, the search goes on on few long ones, with all
/// the torque there is and then with less, in other durations and then in the given ones; beside a slow first try, if there is a second core. Where
/// there is none at all, stronger joints are tried, and weaker ones from there ([`Stronger`]).
///
/// Where the audit finds limits exceeded between nodes, they are drawn in by that much and the plan is made again from where it is
/// ([`Tightening`]); where it finds links that pass through each other, with those kept apart. Where that is no remedy, or the flight is not true
/// to the dynamics, the intervals were too long for this robot: they are halved, once.
///
/// # Errors
/// A problem that cannot be begun with, or a plan that cannot be stored.
pub fn audited(
    task: &Task,
    srb: &SrbPlan,
    timing: Timing,
    mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<Audited, String> {
    audited_observed(task, srb, timing, &mut observer)
}

/// [`audited`], compiled once and here.
pub(crate) fn audited_observed(
    task: &Task,
    srb: &SrbPlan,
    timing: Timing,
    observer: Observe<'_>,
) -> Result<Audited, String> {
    let clock = Instant::now();
    let (grid, plan) = searched(task, srb, timing, observer)?;
    let none = Tightening::default();
    finished(clock, task, grid, (plan, none), observer)
}

/// As [`audited`], beginning with an earlier plan of the same phases in given durations; from the start where that leads nowhere.
pub(crate) fn audited_near(
    task: &Task,
    srb: &SrbPlan,
    kept: &Kept,
    observer: Observe<'_>,
) -> Result<Audited, String> {
    let clock = Instant::now();
    let mut near = Grid::near(task, srb, kept);
    let plan = near.moved(&kept.drawn, observer)?;
    if matches!(plan.outcome.status, Status::Solved | Status::Cancelled) {
        return finished(clock, task, near, (plan, kept.drawn), observer);
    }
    let (grid, plan) = searched(task, srb, Timing::Given, observer)?;
    let none = Tightening::default();
    finished(clock, task, grid.after(near), (plan, none), observer)
}

/// Audits a plan, and makes it again where the audit asks for it.
fn finished<'a>(
    clock: Instant,
    task: &'a Task,
    mut grid: Grid<'a>,
    (plan, mut drawn): (WholeBodyPlan, Tightening),
    observer: Observe<'_>,
) -> Result<Audited, String> {
    let mut told = tightened(task, &mut grid, (plan, &mut drawn), observer)?;
    // Shorter intervals make no link thinner.
    if !told.audit.as_ref().is_none_or(Audit::is_a_motion) {
        grid = grid.split(2);
        drawn = Tightening::default();
        let plan = grid.again(&drawn, observer)?;
        let fine = tightened(task, &mut grid, (plan, &mut drawn), observer)?;
        if fine.audit.is_some() {
            told = fine;
        }
    }
    told.path.clone_from(&grid.path);
    told.kept = grid.kept(drawn);
    told.wall_ms = clock.elapsed().as_secs_f64() * 1e3;
    Ok(told)
}

/// Audits a plan on a grid, and plans again within limits drawn in as long as that is what the audit asks for, a few times.
fn tightened(
    task: &Task,
    grid: &mut Grid<'_>,
    (plan, drawn): (WholeBodyPlan, &mut Tightening),
    observer: Observe<'_>,
) -> Result<Audited, String> {
    let mut told = plan.audited(task)?;
    grid.note(told.audit.as_ref());
    for round in 0..SEPARATIONS {
        let Some(audit) = told.audit.as_ref().filter(|audit| !audit.passes()) else {
            break;
        };
        let (next, parted) = (drawn.after(audit), grid.keep_apart(audit));
        if !parted && (next.is_none() || round >= TIGHTENINGS) {
            break;
        }
        *drawn = next.unwrap_or(*drawn);
        let again = grid.again(drawn, observer)?.audited(task)?;
        grid.note(again.audit.as_ref());
        if again.audit.is_none() {
            break;
        }
        told = again;
    }
    Ok(told)
}

impl WholeBodyPlan {
    /// What the stages hold, in physical units.
    pub(crate) fn of<S: Copy, const X: usize>(
        (problem, phases): (
            &Problem<'_, f64, N, FOOT_COUNT>,
            Vec<Phase<f64, FOOT_COUNT>>,
        ),
        (mut outcome, torque_share): (Solution<f64>, f64),
        stages: &[SparseStage<f64, S, X, NU, NI>],
        state: impl Fn(&S) -> &State<f64, N>,
    ) -> Result<Self, String> {
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
        let end = *state(&stages.last().ok_or("no nodes")?.state);
        let off = so3::log(&(problem.goal.rot_wc.inverse() * end.rot_wc)).norm();
        let blocked = if outcome.status != Status::Solved {
            blocked.collect()
        } else if off > core::f64::consts::FRAC_PI_2 {
            // The goal's rows are sines of the angle from it, which are small half a turn away, too.
            outcome.status = Status::Stalled;
            let turn = Row::Goal { axis: BASE - 1 };
            vec![Blocked {
                row: turn,
                violation: off,
            }]
        } else {
            Vec::new()
        };
        Ok(Self {
            end,
            torque_share,
            stronger: None,
            blocked,
            outcome,
            judged: problem.judge(nodes),
            torque_limit: strongest.fold(0.0, f64::max),
            intervals: intervals.collect(),
            phases,
        })
    }

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
            kept: None,
        })
    }
}

/// Plans the whole body along a single-rigid-body plan, without an audit.
///
/// # Errors
/// A problem that cannot be begun with.
pub fn plan(
    task: &Task,
    srb: &SrbPlan,
    timing: Timing,
    mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<WholeBodyPlan, String> {
    Ok(searched(task, srb, timing, &mut observer)?.1)
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
            "strength": self.strength,
            "drawn_in": {
                "position": drawn.position,
                "speed": drawn.speed,
                "torque": drawn.torque,
                "friction": drawn.friction,
                "height": drawn.height,
            },
            "kept_apart": self.apart,
            "status": format!("{:?}", self.status),
            "audit": self.complaint,
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
        let stronger = if self.strength > 1.0 {
            format!(" of joints {:.2} times as strong", self.strength)
        } else {
            String::new()
        };
        let apart = match self.apart {
            0 => String::new(),
            1 => ", a pair kept apart".to_owned(),
            pairs => format!(", {pairs} pairs kept apart"),
        };
        write!(
            f,
            "{durations}, {} intervals, {:.0} % of the torque{stronger}{}{apart}: {:?} after {} iterations, {:.0} ms",
            self.intervals,
            100.0 * self.torque_share,
            self.drawn,
            self.status,
            self.iterations,
            self.wall_ms
        )?;
        match &self.complaint {
            Some(complaint) => write!(f, "; {complaint}"),
            None => Ok(()),
        }
    }
}
