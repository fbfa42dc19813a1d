//! A task's whole-body problem on a grid of intervals, and the ways in which it is solved there.

use super::FOOT_COUNT;
use super::Observe;
use super::kept::Kept;
use super::pace::Pace;
use super::setup::{N, NI, NU, NX, Setup};
use super::task::{PHASES, SrbPlan, Task};
use crate::apart::Separation;
use crate::audit::Audit;
use crate::lengths::Lengths;
use crate::stronger::Stronger;
use crate::tightening::Tightening;
use crate::whole_body::{Attempt, Timing, WholeBodyPlan};
use core::ops::ControlFlow;
use ocp_solver::{Progress, Settings, SparseStage, Status};
use std::time::Instant;
use wb_opt::{BASE, FreeTiming, Problem, State, TimedState};

/// Most iterations; what is solved takes 10 to 60.
const PATIENCE: usize = 150;
/// Iterations in which a descent from the rigid body's motion has to arrive: others find what it does not in as many.
const FIRST_PATIENCE: usize = 100;
/// Iterations in which a motion on the parts of long intervals has to arrive: those that do take half to all of them.
const PARTS_PATIENCE: usize = 60;
/// Iterations in which a motion with less torque has to arrive from one with more. Where that takes longer, it is another motion, and one that
/// only long intervals have: between their middles it does as it likes.
const LESS_PATIENCE: usize = 40;
/// How strong and fast joints are, over what they are, of which weaker ones are sought.
const STRONGEST: f64 = 3.0;
/// Strengths by less than this factor apart are the same.
const CLOSE: f64 = 1.05;
/// Barrier to begin with where a plan is made again, or on parts of its intervals. With less the first steps go from bound to bound.
const WARM_MU: f64 = 1e-2;
/// The same where the task is another one.
const NEAR_MU: f64 = 1e-4;
/// Iterations in which a plan has to arrive that begins with that of another task; a plan from the start takes 10 to 25.
const NEAR_PATIENCE: usize = 25;

/// Coordinates of a state with durations.
const TIMED: usize = NX + PHASES;

/// A task's problem on its intervals, and the solver's storage: of the two kinds of stages the one that the timing asks for is solved.
pub(crate) struct Grid<'a> {
    task: &'a Task,
    timing: Timing,
    setup: Setup<'a>,
    stages: Vec<SparseStage<f64, State<f64, N>, NX, NU, NI>>,
    timed: Vec<SparseStage<f64, TimedState<f64, N, PHASES>, TIMED, NU, NI>>,
    /// Share of the torque limits of the last solve.
    torque_share: f64,
    /// How many times as strong and as fast as they are the joints were in the last solve.
    strength: f64,
    /// Links that keep apart.
    apart: Separation,
    /// All solves, in order.
    pub(crate) path: Vec<Attempt>,
}

impl<'a> Grid<'a> {
    /// On intervals of these lengths, with the motion of the rigid body as the guess.
    pub(crate) fn new(task: &'a Task, srb: &'a SrbPlan, timing: Timing, lengths: Lengths) -> Self {
        let mut grid = Self::of(task, timing, Setup::new(task, srb, lengths));
        grid.guess();
        grid
    }

    fn of(task: &'a Task, timing: Timing, setup: Setup<'a>) -> Self {
        let problem = setup.problem(&Tightening::default());
        let start = State::at_rest(problem.start);
        let nodes = problem.intervals() + 1;
        let timed = TimedState {
            state: start,
            durations: [0.0; PHASES],
        };
        Self {
            task,
            timing,
            stages: vec![SparseStage::sparse(start); nodes],
            timed: match timing {
                Timing::Given => Vec::new(),
                Timing::Free => vec![SparseStage::sparse(timed); nodes],
            },
            torque_share: 0.0,
            strength: 1.0,
            apart: Separation::default(),
            path: Vec::new(),
            setup,
        }
    }

    /// On the intervals of an earlier plan, from its motion and multipliers.
    pub(crate) fn near(task: &'a Task, srb: &'a SrbPlan, kept: &Kept) -> Self {
        let setup = Setup::on(task, srb, kept.lengths, &kept.intervals);
        let mut grid = Self::of(task, Timing::Given, setup);
        grid.stages.clone_from(&kept.stages);
        grid.torque_share = kept.torque_share;
        grid.apart.clone_from(&kept.apart);
        grid
    }

    /// What the last solve leaves for a task like this one, within these limits; nothing where there was no motion, or where the durations
    /// were unknowns.
    pub(crate) fn kept(self, drawn: Tightening) -> Option<Kept> {
        let solved = self.path.last()?.status == Status::Solved;
        let phases = self.task.problem.used_phases().iter();
        (solved && self.timing == Timing::Given).then(|| Kept {
            body: self.setup.srb.stages.clone(),
            contacts: phases.map(|phase| phase.contacts).collect(),
            lengths: self.setup.lengths,
            intervals: self.setup.phases.iter().map(|p| p.intervals).collect(),
            stages: self.stages,
            torque_share: self.torque_share,
            apart: self.apart,
            drawn,
        })
    }

    /// Keeps links apart from now on that an audit found to pass through each other; whether there were any, and room for them.
    pub(crate) fn keep_apart(&mut self, audit: &Audit) -> bool {
        let kept = audit.overlaps.iter().map(|pair| self.apart.keep(pair));
        kept.fold(false, |any, kept| any | kept)
    }

    /// What an audit has against the last solve.
    pub(crate) fn note(&mut self, audit: Option<&Audit>) {
        if let (Some(last), Some(audit)) = (self.path.last_mut(), audit) {
            last.complaint = (!audit.passes()).then(|| audit.complaint());
        }
    }

    /// The motion of the rigid body.
    fn guess(&mut self) {
        let setup = &self.setup;
        let problem = setup.problem(&Tightening::default());
        let force = |k, foot| setup.force(k, foot);
        problem.write_guess(&mut self.stages, &setup.nodes, force, || 0.0);
        free_timing(self.task, problem).write_guess(&self.stages, &mut self.timed);
    }

    /// The grid with each interval split into equal parts, from the motion that was found on this one.
    pub(crate) fn split(self, parts: usize) -> Self {
        let motion: Vec<_> = match self.timing {
            Timing::Given => self.stages.iter().map(|s| (s.state, s.control)).collect(),
            Timing::Free => (self.timed.iter().map(|s| (s.state.state, s.control))).collect(),
        };
        let setup = self.setup.split(parts, &self.durations());
        let mut fine = Self::of(self.task, self.timing, setup);
        (fine.torque_share, fine.path) = (self.torque_share, self.path);
        fine.apart = self.apart;
        let problem = fine.setup.problem(&Tightening::default());
        problem.write_split(&mut fine.stages, &motion, parts);
        free_timing(self.task, problem).write_guess(&fine.stages, &mut fine.timed);
        take_over(&mut fine.stages, &self.stages, parts);
        take_over(&mut fine.timed, &self.timed, parts);
        fine
    }

    /// This grid, whose solves were made after those of another one.
    pub(crate) fn after(mut self, mut before: Self) -> Self {
        before.path.append(&mut self.path);
        self.path = before.path;
        self
    }

    /// Durations of the phases in the last solve, s.
    fn durations(&self) -> Vec<f64> {
        match self.timed.first() {
            Some(stage) => stage.state.durations.to_vec(),
            None => (self.setup.phases.iter())
                .map(|phase| phase.dt * phase.intervals as f64)
                .collect(),
        }
    }

    /// Plans with the least torque, from the guess.
    pub(crate) fn with_least_torque(
        &mut self,
        observer: Observe<'_>,
    ) -> Result<WholeBodyPlan, String> {
        self.torque_share = self.task.limits.torque_shares[0];
        self.descend(observer)
    }

    /// Plans with the most torque, from the guess, and then with as much less as still has a motion.
    pub(crate) fn with_most_torque(
        &mut self,
        observer: Observe<'_>,
    ) -> Result<WholeBodyPlan, String> {
        let [least, middle, most] = self.task.limits.torque_shares;
        self.torque_share = most;
        let mut plan = self.descend(observer)?;
        for share in [middle, least] {
            if plan.outcome.status != Status::Solved || share >= self.torque_share {
                break;
            }
            let before = self.torque_share;
            self.torque_share = share;
            let less = self.harder(observer)?;
            match less.outcome.status {
                // Nothing is to be done with what there was before, either.
                Status::Solved | Status::Cancelled => plan = less,
                _ => {
                    self.torque_share = before;
                    break;
                }
            }
        }
        Ok(plan)
    }

    /// Plans with the most torque of joints that are stronger and faster than they are, and then of ever weaker ones from there, halving what is
    /// between those that have a motion and those that have none. The last plan, which is solved where a motion of the robot as it is was
    /// found so; if it is not, the weakest joints that have one, or none where those [`STRONGEST`] times as strong have none either.
    pub(crate) fn with_weakest_joints(
        &mut self,
        observer: Observe<'_>,
    ) -> Result<(WholeBodyPlan, Option<Stronger>), String> {
        self.torque_share = self.task.limits.torque_shares[2];
        self.strength = STRONGEST;
        let mut plan = self.descend(observer)?;
        if plan.outcome.status != Status::Solved {
            return Ok((plan, None));
        }
        let (mut low, mut weakest) = (1.0, Stronger::of(STRONGEST, &plan));
        loop {
            self.strength = if weakest.times > CLOSE * low {
                so3::math::sqrt(weakest.times * low)
            } else if low == 1.0 {
                low
            } else {
                break;
            };
            plan = self.harder(observer)?;
            match plan.outcome.status {
                Status::Solved if self.strength == 1.0 => return Ok((plan, None)),
                Status::Solved => weakest = Stronger::of(self.strength, &plan),
                Status::Cancelled => break,
                _ if self.strength == 1.0 => break,
                _ => low = self.strength,
            }
        }
        Ok((plan, Some(weakest)))
    }

    /// Solves a somewhat harder problem from the motion of the last one, which the stages keep where there is none for it.
    fn harder(&mut self, observer: Observe<'_>) -> Result<WholeBodyPlan, String> {
        // Of the two kinds the one that is solved.
        let stages = (self.timing == Timing::Given).then(|| self.stages.clone());
        let timed = self.timed.clone();
        let plan = self.solve(&warm(), &Tightening::default(), observer, &mut |progress| {
            progress.iteration <= LESS_PATIENCE
        })?;
        if !matches!(plan.outcome.status, Status::Solved | Status::Cancelled) {
            self.stages = stages.unwrap_or_else(|| core::mem::take(&mut self.stages));
            self.timed = timed;
        }
        Ok(plan)
    }

    /// Solves from the guess, as long as the solver keeps up: where its first descent does not arrive, others from there take longer than a
    /// search elsewhere.
    fn descend(&mut self, observer: Observe<'_>) -> Result<WholeBodyPlan, String> {
        let (mut pace, timing) = (Pace::default(), self.timing);
        let mut goes_on = |progress: &Progress<f64>| {
            let violation = progress.residual.primal;
            match timing {
                Timing::Given => progress.attempt == 0 && pace.keeps_up(violation, FIRST_PATIENCE),
                // The violation falls late where durations have to move first.
                Timing::Free => true,
            }
        };
        let none = Tightening::default();
        self.solve(&settings(), &none, observer, &mut goes_on)
    }

    /// Allows the most torque from now on; whether that is more than before.
    pub(crate) fn allow_most_torque(&mut self) -> bool {
        let [.., most] = self.task.limits.torque_shares;
        let is_more = most > self.torque_share;
        self.torque_share = most;
        is_more
    }

    /// Plans from the motion of the long intervals that these are parts of, with its torque.
    pub(crate) fn resume(&mut self, observer: Observe<'_>) -> Result<WholeBodyPlan, String> {
        self.solve(&warm(), &Tightening::default(), observer, &mut |progress| {
            progress.iteration <= PARTS_PATIENCE
        })
    }

    /// Plans from the motion of a plan of another task.
    pub(crate) fn moved(
        &mut self,
        drawn: &Tightening,
        observer: Observe<'_>,
    ) -> Result<WholeBodyPlan, String> {
        let mut settings = warm();
        settings.initial_mu = NEAR_MU;
        self.solve(&settings, drawn, observer, &mut |progress| {
            progress.iteration <= NEAR_PATIENCE
        })
    }

    /// Plans again from what the stages hold, with the torque of the last solve.
    pub(crate) fn again(
        &mut self,
        drawn: &Tightening,
        observer: Observe<'_>,
    ) -> Result<WholeBodyPlan, String> {
        self.solve(&warm(), drawn, observer, &mut |_| true)
    }

    /// Solves from what the stages hold, and keeps a note of it. A solve that the observer ends is cancelled, one that does not go on by
    /// `goes_on` has stalled.
    fn solve(
        &mut self,
        settings: &Settings<f64>,
        drawn: &Tightening,
        observer: Observe<'_>,
        goes_on: &mut dyn FnMut(&Progress<f64>) -> bool,
    ) -> Result<WholeBodyPlan, String> {
        let (clock, mut cancelled) = (Instant::now(), false);
        let mut plan = self.solved(drawn, settings, &mut |progress| {
            cancelled = observer(progress).is_break();
            if !cancelled && goes_on(progress) {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        })?;
        if plan.outcome.status == Status::Cancelled && !cancelled {
            plan.outcome.status = Status::Stalled;
        }
        self.path.push(Attempt {
            timing: self.timing,
            intervals: plan.intervals.len(),
            torque_share: self.torque_share,
            strength: self.strength,
            drawn: *drawn,
            apart: self.apart.count(),
            status: plan.outcome.status,
            complaint: None,
            iterations: plan.outcome.iterations,
            wall_ms: clock.elapsed().as_secs_f64() * 1e3,
        });
        Ok(plan)
    }

    fn solved(
        &mut self,
        drawn: &Tightening,
        settings: &Settings<f64>,
        watch: Observe<'_>,
    ) -> Result<WholeBodyPlan, String> {
        let clearances = self.setup.clearances(drawn);
        let apart = self.apart.rows(&self.task.robot, self.setup.given());
        let mut problem = Problem {
            clearances: &clearances,
            apart: &apart,
            ..self.setup.problem(drawn)
        };
        let robot = &mut problem.robot;
        for (limit, motor) in robot.limits.iter_mut().zip(&mut robot.motors).skip(BASE) {
            limit.effort *= self.torque_share * self.strength;
            limit.speed *= self.strength;
            if let Some(motor) = motor {
                motor.torque *= self.strength;
                motor.corner_speed *= self.strength;
                motor.no_load_speed *= self.strength;
            }
        }
        let told = |error| format!("task {}: {error}", self.task.name);
        let whole = |phases: &[_]| self.setup.lengths.whole(self.task, phases);
        if self.timing == Timing::Given {
            let outcome = problem.plan(settings, &mut self.stages, watch);
            let outcome = (outcome.map_err(told)?, self.torque_share);
            let found = (&problem, whole(problem.phases));
            return WholeBodyPlan::of(found, outcome, &self.stages, |state| state);
        }
        let free = free_timing(self.task, problem);
        let outcome = free.plan(settings, &mut self.timed, watch);
        let outcome = (outcome.map_err(told)?, self.torque_share);
        let mut phases = self.setup.phases.clone();
        for (phase, duration) in phases.iter_mut().zip(self.durations()) {
            phase.dt = duration / phase.intervals as f64;
        }
        let problem = Problem {
            phases: &phases,
            ..problem
        };
        let found = (&problem, whole(&phases));
        WholeBodyPlan::of(found, outcome, &self.timed, |state| &state.state)
    }
}

/// Takes over the multipliers of stages whose intervals are `parts` times as long.
fn take_over<S: Copy, const X: usize>(
    fine: &mut [SparseStage<f64, S, X, NU, NI>],
    long: &[SparseStage<f64, S, X, NU, NI>],
    parts: usize,
) {
    for (k, stage) in fine.iter_mut().enumerate() {
        if let Some(from) = long.get(k / parts) {
            stage.resume_part(from, long.get(k / parts + 1), k % parts, parts);
        }
    }
}

/// Ends with a cost within 1e-4 of the least: the last digits of a plan take iterations, and no robot has them.
fn settings() -> Settings<f64> {
    let mut settings = wb_opt::settings();
    (settings.max_iterations, settings.attempt_iterations) = (PATIENCE, PATIENCE);
    settings.dual_tolerance = 1e-3;
    settings.complementarity_tolerance = 1e-5;
    settings.threads = crate::threads();
    settings
}

/// As [`settings`], from the multipliers that are there.
fn warm() -> Settings<f64> {
    let mut settings = settings();
    (settings.warm_start, settings.initial_mu) = (true, WARM_MU);
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
