//! The whole-body stage.

use super::{Args, Planned};
use crate::reference::whole_body::{DT, N, SrbMotion};
use crate::reference::{FEET, File};
use jump_lab::noise::Noise;
use nalgebra::Vector3;
use ocp_solver::Stage;
use serde_json::{Value, json};
use wb_opt::{BASE, EulerOrder, Pose, Sample, State};

/// Controls and rows: 18 accelerations, 12 forces; 98 rows on four feet with 12 clearances.
const NX: usize = 2 * N;
const NU: usize = N + 3 * FEET;
const NI: usize = wb_opt::row_capacity(N, FEET, 4, 12, false);

type Node = Stage<f64, State<f64, N>, NX, NU, NI>;

/// Solves the whole-body problem of a task that follows an SRB solution.
pub(super) fn solve(args: &Args, file: &File, name: &str, srb: &str) -> Result<Planned, String> {
    let data = file.whole_body(name, &SrbMotion::parse(srb)?)?;
    let problem = data.problem();
    let mut settings = wb_opt::settings();
    settings.barrier = args.barrier();
    let mut stages: Vec<Node> =
        vec![Stage::new(State::at_rest(Pose::level([0.0; N]))); problem.intervals() + 1];
    let (outcome, wall_ms) = args.timed(|| {
        let mut noise = Noise::new(args.seed, args.guess_noise);
        let force = |k: usize, foot: usize| Vector3::from_fn(|i, _| data.forces[k][3 * foot + i]);
        problem.write_guess(&mut stages, &data.nodes, force, || noise.sample());
        problem
            .plan(&settings, &mut stages, |progress| args.observe(progress))
            .map_err(|error| error.to_string())
    })?;
    let nodes = || stages.iter().map(|stage| (&stage.state, &stage.control));
    let judged = problem.judge(nodes());
    let samples: Vec<Sample<f64, N, FEET>> = nodes()
        .enumerate()
        .take(problem.intervals())
        .map(|(k, (state, control))| problem.sample(k, state, control))
        .collect();
    let durations = data.durations();
    Ok(Planned {
        status: format!("{:?}", outcome.status),
        report: json!({
            "wall_ms": wall_ms,
            "iterations": outcome.iterations,
            "restarts": outcome.restarts,
            "cost": judged.cost,
            "max_violation": judged.max_violation,
            "peak_force_n": judged.peak_force,
            "peak_torque_nm": judged.peak_effort,
        }),
        solution: json!({
            "task": name,
            "integ": "mid",
            "dt": DT,
            "T": durations,
            "sol": layout(&samples, data.order),
        }),
        durations,
    })
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
