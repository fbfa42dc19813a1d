//! A stored plan is executed like one that was just made.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn folder() -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("stored");
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn saltus(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
    command
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn result(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn a_stored_plan_jumps_as_the_one_that_was_just_made() {
    let folder = folder();
    let lateral = include_str!("../../jump-planner/tasks/a1/lateral.toml");
    std::fs::write(folder.join("mine.toml"), lateral).unwrap();
    let run = |arguments: &[&str]| saltus(&folder, arguments);
    assert!(
        run(&["plan", "mine.toml", "--out", "plan"])
            .status
            .success()
    );
    let fresh = result(&run(&["run", "mine.toml", "--json", "--out", "fresh"]));
    let stored = result(&run(&["run", "plan/plan.bin", "--json", "--out", "stored"]));
    assert_eq!(stored["plan"]["reference"], "stored");
    assert_eq!(stored["plan"]["durations_s"].as_array().unwrap().len(), 2);
    // The container rounds to single precision, nothing else differs.
    for key in ["final_position_error_m", "apex_height_m", "first_contact_s"] {
        let [a, b] = [&fresh, &stored].map(|result| result[key].as_f64().unwrap());
        assert!((a - b).abs() < 2e-3, "{key}: {a} and {b}");
    }
    for name in [
        "report.html",
        "log.csv",
        "log.mcap",
        "result.json",
        "strip.svg",
    ] {
        assert!(folder.join("stored").join(name).exists(), "{name}");
    }

    // Its task is looked for under the name in the plan, and can be given.
    std::fs::rename(folder.join("mine.toml"), folder.join("moved.toml")).unwrap();
    let lost = run(&["run", "plan/plan.bin"]);
    assert_eq!(lost.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&lost.stderr).contains("give it with --task"));
    result(&run(&[
        "run",
        "plan/plan.bin",
        "--task",
        "moved.toml",
        "--json",
        "--out",
        "found",
    ]));

    // Another task's ground is not the plan's.
    let other = run(&["run", "plan/plan.bin", "--task", "a1/lateral-down"]);
    assert_eq!(other.status.code(), Some(2));
    let said = String::from_utf8_lossy(&other.stderr);
    assert!(said.contains("plan again"), "{said}");

    // Nor is another task's goal.
    let nearer = lateral.replace("goal_m = [0.0, 0.3, 0.0]", "goal_m = [0.0, 0.25, 0.0]");
    assert_ne!(nearer, lateral);
    std::fs::write(folder.join("nearer.toml"), nearer).unwrap();
    let other = run(&["run", "plan/plan.bin", "--task", "nearer.toml"]);
    assert_eq!(other.status.code(), Some(2));
    let said = String::from_utf8_lossy(&other.stderr);
    assert!(said.contains("another goal"), "{said}");
}
