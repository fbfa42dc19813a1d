//! The nine tasks, and the shipped file with numbers of its own.

use reference_problems::{Answer, File, SHIPPED};
use serde_json::{Value, json};

/// Largest ratio to the peer's cost, and violation of a row.
const MOST: [f64; 2] = [1.001, 1e-6];

/// The shipped file, changed.
pub(crate) fn changed(change: impl FnOnce(&mut Value)) -> File {
    let mut file: Value = serde_json::from_str(SHIPPED).unwrap();
    change(&mut file);
    File::parse(&file.to_string()).unwrap()
}

/// A file with one task, a spin by less.
pub(crate) fn mine(change: impl FnOnce(&mut Value)) -> File {
    changed(|file| {
        let mut spin = file["tasks"]["spin"].take();
        spin["angle"] = 1.2.into();
        file["tasks"] = json!({ "mine": spin });
        change(file);
    })
}

/// As good as the peer's solution, without violation.
pub(crate) fn assert_reaches(answer: &Answer, cost: f64) {
    let told = format!("{} after {} iterations", answer.cost, answer.iterations);
    assert!(answer.status == ocp_solver::Status::Solved, "{told}");
    assert!(answer.cost <= MOST[0] * cost, "{told}, not {cost}");
    assert!(answer.max_violation <= MOST[1], "{}", answer.max_violation);
}
