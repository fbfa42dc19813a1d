//! What differs from the plan, as JSON.

use jump_lab::lab::Disturbance;
use jump_lab::lab::keys::ROWS;
use serde_json::{Map, Value, json};

/// Every key with its value, `null` where that is the robot's own.
pub(crate) fn json(disturbance: &Disturbance) -> Value {
    let all: Map<String, Value> = ROWS
        .iter()
        .map(|row| {
            let value = disturbance.set_to(row.key).or(row.nominal);
            (row.name.to_owned(), json!(value))
        })
        .collect();
    Value::Object(all)
}
