//! Solves the problem on the whole body.

use crate::answer::Answer;
use crate::file::{FEET, File};
use crate::legs::{DT, N, SrbMotion};
use crate::srb::{Noise, Observe};
use core::ops::ControlFlow;
use nalgebra::Vector3;
use ocp_solver::{Barrier, Progress, SparseStage};
use serde_json::{Value, json};
use std::time::Instant;
use wb_opt::{BASE, EulerOrder, Pose, Sample, State};

/// Controls and rows: 18 accelerations, 12 forces; 98 rows on four feet with 12 clearances.
const NX: usize = 2 * N;
const NU: usize = N + 3 * FEET;
const NI: usize = wb_opt::row_capacity(N, FEET, 4, 12, false);

type Node = SparseStage<f64, State<f64, N>, NX, NU, NI>;

impl File {
    /// Solves the problem of a task on the whole body, with the phases of a solution on the single rigid body and along its motion, as
    /// [`solve_srb`](Self::solve_srb) does.
    ///
    /// # Errors
    /// No such task, a motion of other phases, or what cannot be solved at all.
    pub fn solve_whole_body(
        &self,
        name: &str,
        srb: &SrbMotion,
        barrier: Barrier,
        mut noise: impl FnMut() -> f64,
        mut observe: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
    ) -> Result<Answer, String> {
        self.solve_whole_body_observed(name, srb, barrier, &mut noise, &mut observe)
    }

    /// [`Self::solve_whole_body`], compiled once and here: the solver is large.
    fn solve_whole_body_observed(
        &self,
        name: &str,
        srb: &SrbMotion,
        barrier: Barrier,
        noise: Noise<'_>,
        observe: Observe<'_>,
    ) -> Result<Answer, String> {
        let data = self.whole_body(name, srb)?;
        let problem = data.problem();
        let mut settings = wb_opt::settings();
        settings.barrier = barrier;
        settings.threads = jump_planner::threads();
        let rest = SparseStage::sparse(State::at_rest(Pose::level([0.0; N])));
        let mut stages: Vec<Node> = vec![rest; problem.intervals() + 1];
        let force = |k: usize, foot: usize| Vector3::from_fn(|i, _| data.forces[k][3 * foot + i]);
        let clock = Instant::now();
        problem.write_guess(&mut stages, &data.nodes, force, noise);
        let outcome = problem
            .plan(&settings, &mut stages, observe)
            .map_err(|error| error.to_string())?;
        let wall_ms = clock.elapsed().as_secs_f64() * 1e3;
        let nodes = || stages.iter().map(|stage| (&stage.state, &stage.control));
        let judged = problem.judge(nodes());
        let samples: Vec<Sample<f64, N, FEET>> = nodes()
            .enumerate()
            .take(problem.intervals())
            .map(|(k, (state, control))| problem.sample(k, state, control))
            .collect();
        let durations = data.durations();
        Ok(Answer {
            cost: judged.cost,
            max_violation: judged.max_violation,
            peaks: Some([judged.peak_force, judged.peak_effort]),
            solution: json!({
                "task": name,
                "integ": "mid",
                "dt": DT,
                "T": durations,
                "sol": layout(&samples, data.order),
            }),
            durations,
            ..Answer::new(&outcome, wall_ms)
        })
    }
}

/// The arrays the reference checkers read, at the midpoints of the intervals.
fn layout(samples: &[Sample<f64, N, FEET>], order: EulerOrder) -> Value {
    let filed = |x: &[f64; N]| filed(x, order);
    let rows = |row: &dyn Fn(&Sample<f64, N, FEET>) -> Value| -> Value {
        samples.iter().map(row).collect()
    };
    json!({
        "q": rows(&|s| json!(filed(&s.q))),
        "v": rows(&|s| json!(filed(&s.v))),
        "a": rows(&|s| json!(filed(&s.a))),
        "tau": rows(&|s| json!(s.effort[BASE..])),
        "F": rows(&|s| s.forces_w.iter().map(|f| json!(f.as_slice())).collect()),
    })
}

/// From the order of the chain to x, y, z, roll, pitch, yaw.
fn filed(x: &[f64; N], order: EulerOrder) -> Vec<f64> {
    let mut out = x.to_vec();
    for (value, column) in x.iter().zip(order.columns()) {
        out[column] = *value;
    }
    out
}
