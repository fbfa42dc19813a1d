//! A whole-body plan as JSON, for checkers in other languages (`tests/peers/wb_audit.py`).

use super::whole_body::filed;
use crate::jump::whole_body::{self, Interval, WholeBodyPlan};
use serde_json::{Value, json};
use wb_opt::BASE;

/// States at the starts of the intervals; torques, forces and gains are held over them. Base coordinates are x, y, z,
/// roll, pitch, yaw.
pub(super) fn layout(name: &str, plan: &WholeBodyPlan) -> Value {
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
