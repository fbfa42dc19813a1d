//! Four runs that an earlier judge let pass, and what this one says of them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// A task file made of a built-in one, and what `saltus run` says of it.
fn run(name: &str, text: &str) -> Output {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("task.toml"), text).unwrap();
    Command::new(env!("CARGO_BIN_EXE_saltus"))
        // Legs by kinematics alone: what the judge says is tested here, not what a planner finds.
        .args(["run", "task.toml", "--json", "--out", "run"])
        .args(["--planner", "kinematics"])
        .current_dir(folder)
        .output()
        .unwrap()
}

fn failures(output: &Output) -> Vec<String> {
    let json: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    assert_eq!(json["on_target"], output.status.success(), "{json}");
    let list = json["verdict"]["failures"].as_array().unwrap();
    list.iter()
        .map(|x| x["name"].as_str().unwrap().to_owned())
        .collect()
}

/// A goal in the air: the jump ended 13 cm below it, on target.
#[test]
fn a_goal_that_is_not_on_the_ground_is_refused() {
    let text =
        include_str!("../../jump-planner/tasks/a1/lateral.toml").replace("0.3, 0.0]", "0.3, 0.15]");
    let output = run("height", &text);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("goal_m") && said.contains("0.15"), "{said}");
}

/// The double backflip pushed its rear shanks through the edge of its box for a tenth of a second: the audit found nothing.
#[test]
#[ignore = "long: cargo xtask suites"]
fn a_plan_through_the_edge_of_its_box_is_refused() {
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["plan", "a1/double-backflip", "--json"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["status"], "AuditFailed", "{json}");
    let told = json["answer"].to_string();
    for shank in ["RL_shank", "RR_shank"] {
        let through = format!("{shank} passes through the ground");
        assert!(told.contains(&through), "{told}");
    }
}

/// A goal that leans by 20 degrees: the robot stood level, with "0.3 degrees" off.
#[test]
#[ignore = "long: cargo xtask suites"]
fn a_goal_that_the_robot_does_not_stand_in_is_missed() {
    let turn = "[turn]\naxis = [0.0, 1.0, 0.0]\nangle_deg = -20.0\n\n[total]";
    let text = include_str!("../../jump-planner/tasks/a1/lateral.toml").replace("[total]", turn);
    let failures = failures(&run("pitch", &text));
    assert!(
        failures.contains(&"stand.rotation_deg".to_owned()),
        "{failures:?}"
    );
}
