//! Solves the problem on the single rigid body.

use crate::answer::Answer;
use crate::file::{FEET, File};
use core::ops::ControlFlow;
use jump_planner::bounds::{Impossible, rigid_body};
use ocp_solver::{Barrier, Progress, Settings, Stage};
use serde_json::{Value, json};
use srb_opt::{Problem, State};
use std::time::Instant;

/// Gives a number to add to the guess.
pub(crate) type Noise<'a> = &'a mut dyn FnMut() -> f64;
/// Who hears every iteration, and stops the solver by `Break`.
pub(crate) type Observe<'a> = &'a mut dyn FnMut(&Progress<f64>) -> ControlFlow<()>;

/// Legs in the file's order.
const LEGS: [&str; FEET] = ["FL", "FR", "RL", "RR"];
/// Controls of four feet, and rows.
const NU: usize = 3 * FEET;
const NI: usize = 40;

type Stages<const PHASES: usize, const NX: usize> = Vec<Stage<f64, State<f64, PHASES>, NX, NU, NI>>;

impl File {
    /// The closed-form bound that shows that a task has no solution on the single rigid body, if there is one.
    ///
    /// # Errors
    /// No such task, or what `srb-opt` says of it.
    pub fn impossible(&self, name: &str) -> Result<Option<Impossible>, String> {
        Ok(match self.task(name)?.phase_count() {
            0..=4 => rigid_body(&self.problem::<4>(name)?, LEGS, 1.0),
            _ => rigid_body(&self.problem::<12>(name)?, LEGS, 1.0),
        })
    }

    /// Solves the problem of a task on the single rigid body from its cold guess. Each number of the guess has a number of `noise` added;
    /// `observe` sees every iteration and may stop there.
    ///
    /// # Errors
    /// No such task, or what cannot be solved at all; a solve that fails is an answer, with its status.
    pub fn solve_srb(
        &self,
        name: &str,
        barrier: Barrier,
        mut noise: impl FnMut() -> f64,
        mut observe: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
    ) -> Result<Answer, String> {
        self.solve_srb_observed(name, barrier, &mut noise, &mut observe)
    }

    /// [`Self::solve_srb`], compiled once and here: the solver is large.
    fn solve_srb_observed(
        &self,
        name: &str,
        barrier: Barrier,
        noise: Noise<'_>,
        observe: Observe<'_>,
    ) -> Result<Answer, String> {
        match self.task(name)?.phase_count() {
            0..=4 => self.sized::<4, 16>(name, barrier, noise, observe),
            _ => self.sized::<12, 24>(name, barrier, noise, observe),
        }
    }

    fn sized<const PHASES: usize, const NX: usize>(
        &self,
        name: &str,
        barrier: Barrier,
        noise: Noise<'_>,
        observe: Observe<'_>,
    ) -> Result<Answer, String> {
        let problem: Problem<f64, FEET, PHASES> = self.problem(name)?;
        let count = problem.intervals() + 1;
        let mut stages: Stages<PHASES, NX> = vec![Stage::new(State::new()); count];
        let mut settings = Settings::new();
        settings.barrier = barrier;
        let clock = Instant::now();
        problem.write_guess(&mut stages, noise);
        let outcome = problem
            .plan(&settings, &mut stages, observe)
            .map_err(|error| error.to_string())?;
        let wall_ms = clock.elapsed().as_secs_f64() * 1e3;
        let judged = problem.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
        Ok(Answer {
            cost: judged.cost,
            max_violation: judged.max_violation,
            durations: stages[0].state.durations[..problem.phase_count].to_vec(),
            solution: json!({ "task": name, "sol": layout(&problem, &stages) }),
            ..Answer::new(&outcome, wall_ms)
        })
    }
}

/// The arrays the reference checkers read.
fn layout<const PHASES: usize, const NX: usize>(
    problem: &Problem<f64, FEET, PHASES>,
    stages: &Stages<PHASES, NX>,
) -> Value {
    let last = problem.intervals();
    let samples: Vec<_> = stages
        .iter()
        .enumerate()
        .take(last)
        .map(|(k, stage)| problem.sample(k, &stage.state, &stage.control))
        .collect();
    let states = || stages.iter().map(|stage| &stage.state);
    json!({
        "T": stages[0].state.durations[..problem.phase_count],
        "p": states().map(|s| s.pos_w.as_slice().to_vec()).collect::<Vec<_>>(),
        "v": states().map(|s| s.vel_w.as_slice().to_vec()).collect::<Vec<_>>(),
        "W": states().map(|s| s.omega_b.as_slice().to_vec()).collect::<Vec<_>>(),
        "R": states().map(|s| s.rot_wb.as_slice().to_vec()).collect::<Vec<_>>(),
        "Wd": samples.iter().map(|s| s.alpha_b.as_slice().to_vec()).collect::<Vec<_>>(),
        "f": samples
            .iter()
            .map(|s| s.forces_w.iter().flat_map(|f| f.as_slice().to_vec()).collect())
            .collect::<Vec<Vec<f64>>>(),
    })
}
