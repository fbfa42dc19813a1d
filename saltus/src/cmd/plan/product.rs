//! The plan that is to be executed: single rigid body, then whole body, both with margins.

use super::{Args, Planned, whole_body::filed};
use crate::jump::task::Task;
use crate::jump::whole_body::{self, Interval, WholeBodyPlan};
use serde_json::{Value, json};
use wb_opt::BASE;

/// Plans a shipped task; the report of the single-rigid-body stage, and the whole-body plan.
pub(super) fn solve(args: &Args, name: &str) -> Result<(Value, Planned), String> {
    let task = Task::load(name)?;
    let srb = task.solve()?;
    let mut solved = None;
    let (outcome, wall_ms) = args.timed(|| {
        let plan = whole_body::plan(&task, &srb, |progress| args.observe(progress))?;
        let outcome = plan.outcome;
        solved = Some(plan);
        Ok(outcome)
    })?;
    let plan = solved.ok_or("nothing was solved")?;
    let report = json!({
        "wall_ms": wall_ms,
        "iterations": outcome.iterations,
        "restarts": outcome.restarts,
        "cost": plan.judged.cost,
        "max_violation": plan.judged.max_violation,
        "peak_force_n": plan.judged.peak_force,
        "peak_torque_nm": plan.judged.peak_effort,
        "torque_limit_nm": plan.torque_limit,
    });
    let phases = plan.phases.iter();
    let planned = Planned {
        status: format!("{:?}", outcome.status),
        durations: phases.map(|p| p.dt * p.intervals as f64).collect(),
        report,
        solution: layout(name, &plan),
    };
    let srb = json!({
        "wall_ms": srb.wall_ms,
        "iterations": srb.iterations,
        "max_violation": srb.max_violation,
    });
    Ok((srb, planned))
}

/// States at the starts of the intervals; torques, forces and gains are held over them. Base coordinates are x, y, z,
/// roll, pitch, yaw.
fn layout(name: &str, plan: &WholeBodyPlan) -> Value {
    let rows =
        |row: &dyn Fn(&Interval) -> Value| -> Value { plan.intervals.iter().map(row).collect() };
    let order = plan.order;
    let gain = |by: &[[f64; whole_body::N]; whole_body::N]| -> Value {
        by[BASE..]
            .iter()
            .map(|row| json!(filed(row, order)))
            .collect()
    };
    json!({
        "task": name,
        "euler": format!("{order:?}").to_lowercase(),
        "phases": plan.phases.iter().map(|p| json!({
            "contacts": p.contacts,
            "intervals": p.intervals,
            "dt": p.dt,
        })).collect::<Vec<_>>(),
        "t": rows(&|i| json!(i.start)),
        "dt": rows(&|i| json!(i.dt)),
        "q": rows(&|i| json!(filed(&i.state.q, order))),
        "v": rows(&|i| json!(filed(&i.state.v, order))),
        "a": rows(&|i| json!(filed(&i.sample.a, order))),
        "tau": rows(&|i| json!(i.sample.effort[BASE..])),
        "F": rows(&|i| i.sample.forces_w.iter().map(|f| json!(f.as_slice())).collect()),
        "tau_by_q": rows(&|i| gain(&i.gains.effort_by_q)),
        "tau_by_v": rows(&|i| gain(&i.gains.effort_by_v)),
    })
}
