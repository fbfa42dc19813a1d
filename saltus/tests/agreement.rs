//! Both simulators tell the same flight, where they are known to: `saltus verdicts --agreement`.
#![cfg(feature = "mujoco")]
#![allow(clippy::unwrap_used, reason = "tests")]

use serde_json::Value;
use std::process::Command;

/// Tasks that agree within 3 cm and 3° on hard and on firm ground; `contact-sim`'s README has all nine.
const AGREED: [&str; 6] = [
    "a1/lateral",
    "a1/lateral-down",
    "a1/spin-90",
    "a1/diagonal",
    "a1/forward-60",
    "a1/double-barrel-roll",
];

#[test]
#[ignore = "long: cargo xtask suites"]
fn both_simulators_tell_the_same_flights() {
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["verdicts", "--agreement", "--json"])
        .args(AGREED)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let json: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    let lines = json["agreement"].as_array().cloned().unwrap_or_default();
    assert_eq!(lines.len(), 2 * AGREED.len(), "{said}");
    for line in &lines {
        assert_eq!(line["agrees"], true, "{line}");
    }
    assert_eq!(output.status.code(), Some(0), "{said}");
}
