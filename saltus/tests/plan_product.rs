//! Whole-body plans for execution: margins kept, torques held, gains written.
#![allow(clippy::unwrap_used, reason = "tests")]

use serde_json::Value;
use std::process::Command;

/// Plans a task; the report and the plan's arrays.
fn plan(task: &str) -> (Value, Value) {
    let name = task.replace('/', "-");
    let path = std::env::temp_dir().join(format!("saltus-{name}-{}.json", std::process::id()));
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["plan", "--stage", "product", "--json", "--reference", task])
        .args(["--solution", path.to_str().unwrap()])
        .output()
        .unwrap();
    let report = serde_json::from_slice(&output.stdout).unwrap();
    let solution = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    std::fs::remove_file(&path).unwrap();
    (report, solution)
}

fn numbers(row: &Value) -> Vec<f64> {
    let row = row.as_array().unwrap();
    row.iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn margins_are_kept_and_states_follow_from_one_another() {
    for task in ["a1/lateral", "a1/spin-90", "a1/barrel-roll"] {
        let (report, plan) = plan(task);
        assert_eq!(report["status"], "Solved", "{report}");
        assert!(report["whole_body"]["max_violation"].as_f64().unwrap() <= 1e-6);
        assert_eq!(report["whole_body"]["torque_limit_nm"], 24.0, "{report}");
        let rows = |key: &str| plan[key].as_array().unwrap().iter().map(numbers);
        let dt = numbers(&plan["dt"]);
        let (q, v, a): (Vec<_>, Vec<_>, Vec<_>) = (
            rows("q").collect(),
            rows("v").collect(),
            rows("a").collect(),
        );
        for torques in rows("tau") {
            assert!(torques.iter().all(|t| t.abs() <= 24.0 + 1e-6), "{task}");
        }
        for forces in plan["F"].as_array().unwrap() {
            for f in forces.as_array().unwrap().iter().map(numbers) {
                assert!(f[0].abs().max(f[1].abs()) <= 0.45 * f[2] + 1e-6, "{task}");
            }
        }
        for (k, dt) in dt.iter().enumerate().take(dt.len() - 1) {
            for i in 0..18 {
                let reached = q[k][i] + dt * v[k][i] + 0.5 * dt * dt * a[k][i];
                assert!((reached - q[k + 1][i]).abs() < 1e-7, "{task} {k} {i}");
                assert!(
                    (v[k][i] + dt * a[k][i] - v[k + 1][i]).abs() < 1e-6,
                    "{task} {k} {i}"
                );
            }
        }
        // Two-leg stance is unstable open loop: it is kept short.
        for (phase, report) in plan["phases"]
            .as_array()
            .unwrap()
            .iter()
            .zip(report["phases"].as_array().unwrap())
        {
            let feet = phase["contacts"].as_array().unwrap();
            if feet.iter().filter(|on| on.as_bool().unwrap()).count() == 2 {
                assert!(
                    report["duration_s"].as_f64().unwrap() <= 0.35 + 1e-6,
                    "{task}"
                );
            }
        }
        // Feedback of every joint, finite everywhere.
        for gains in plan["tau_by_q"].as_array().unwrap() {
            let gains = gains.as_array().unwrap();
            assert_eq!(gains.len(), 12);
            assert!(
                gains
                    .iter()
                    .all(|row| numbers(row).iter().all(|x| x.is_finite()))
            );
        }
    }
}

#[test]
fn tasks_of_a_file_are_not_planned_for_execution() {
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args([
            "plan",
            "--stage",
            "product",
            "--reference",
            "spin",
            "--srb",
            "nowhere.json",
        ])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("shipped tasks"));
}
