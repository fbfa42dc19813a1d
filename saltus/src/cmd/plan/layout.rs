//! A whole-body plan as JSON, for checkers in other languages (`tests/peers/wb_audit.py`).

use jump_planner::whole_body::{self, Interval, WholeBodyPlan};
use serde_json::{Value, json};
use wb_opt::BASE;

/// States at the starts of the intervals; torques, forces and gains are held over them. `R` is the rotation from base to
/// world by rows, and in `q` the three entries of the base's turn are zero; its rates and accelerations are those in base
/// axes.
pub(super) fn layout(name: &str, plan: &WholeBodyPlan) -> Value {
    let rows =
        |row: &dyn Fn(&Interval) -> Value| -> Value { plan.intervals.iter().map(row).collect() };
    let gain = |by: &[[f64; whole_body::N]; whole_body::N]| -> Value {
        by[BASE..].iter().map(|row| json!(row.as_slice())).collect()
    };
    json!({
        "task": name,
        "phases": plan.phases.iter().map(|p| json!({
            "contacts": p.contacts,
            "intervals": p.intervals,
            "dt": p.dt,
        })).collect::<Vec<_>>(),
        "t": rows(&|i| json!(i.start)),
        "dt": rows(&|i| json!(i.dt)),
        "R": rows(&|i| i.state.rot_wc.matrix().row_iter().map(|row| json!([row[0], row[1], row[2]])).collect()),
        "q": rows(&|i| json!(i.state.q.as_slice())),
        "v": rows(&|i| json!(i.state.v.as_slice())),
        "a": rows(&|i| json!(i.sample.a.as_slice())),
        "tau": rows(&|i| json!(i.sample.effort[BASE..])),
        "F": rows(&|i| i.sample.forces_w.iter().map(|f| json!(f.as_slice())).collect()),
        "tau_by_q": rows(&|i| gain(&i.gains.effort_by_q)),
        "tau_by_v": rows(&|i| gain(&i.gains.effort_by_v)),
    })
}
