//! What an earlier judge (commit 7769727) let pass, and what this one says of it: height, pitch, and shanks in the box. The fourth
//! kindness, the lean towards the goal, is `a_lean_towards_the_goal_does_not_count` in `src/jump/judge.rs`.
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

/// A goal in the air: the jump ended 13 cm below it, on target, since `position_error` was the distance along x and y.
#[test]
fn a_goal_that_is_not_on_the_ground_is_refused() {
    let text =
        include_str!("../../jump-planner/tasks/a1/lateral.toml").replace("0.3, 0.0]", "0.3, 0.15]");
    let output = run("height", &text);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("goal_m") && said.contains("0.15"), "{said}");
}

/// The double backflip pushed its rear shanks through the edge of its box for a tenth of a second: the audit looked at torques, speeds
/// and forces only, and no shank had a shape.
#[test]
#[ignore = "long: cargo xtask suites"]
fn a_plan_through_the_edge_of_its_box_is_refused() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("edge");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    // The reference of that plan; along the paper's the shanks keep clear.
    let mut text = include_str!("../../jump-planner/tasks/a1/double-backflip.toml").to_owned();
    for (guess, turn) in [("0.5", 0), ("0.3", 60), ("0.4", 720)] {
        let phase = format!("guess_s = {guess}");
        text = text.replace(&phase, &format!("{phase}\nturn_deg = {turn}.0"));
    }
    std::fs::write(folder.join("task.toml"), text).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["plan", "task.toml", "--json"])
        // The rigid body's: in others the planner finds a way past the edge.
        .args(["--timing", "0.204,0.35,0.996"])
        .current_dir(folder)
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

/// A goal that leans by 20 degrees: the robot stood level, with "0.3 degrees" off, since `orientation_error` was the angle from the heading
/// alone.
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

/// The gate on verdicts names the task whose goal was changed: a leaning goal where a level one was on target.
#[test]
#[ignore = "long: cargo xtask suites"]
fn a_changed_goal_fails_the_gate_with_the_name_of_its_task() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("guard");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let lateral = include_str!("../../jump-planner/tasks/a1/lateral.toml");
    let turn = "[turn]\naxis = [0.0, 1.0, 0.0]\nangle_deg = -20.0\n\n[total]";
    let expected = "[verdicts]\n\"kept.toml\" = { native = \"target\" }\n\"broken.toml\" = { native = \"target\" }\n\n[papers]\n";
    for (name, text) in [
        ("kept.toml", lateral),
        ("broken.toml", &lateral.replace("[total]", turn)),
        ("expected.toml", expected),
    ] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["verdicts", "--sim", "native", "--expect", "expected.toml"])
        .current_dir(folder)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("broken.toml in native: target is expected, found NO: "),
        "{said}"
    );
    assert!(!said.contains("kept.toml"), "{said}");
}
