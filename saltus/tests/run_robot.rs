//! A quadruped from its URDF jumps as the built-in one does: with its own motors, shapes and gains, in both simulators.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("robot-{name}"));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// The text of A1's URDF, which says nothing of motors but effort and speed.
fn urdf() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/a1.urdf");
    fs::read_to_string(path).unwrap()
}

fn run(folder: &Path, task: &str, sim: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["run", task, "--robot", "robot.urdf", "--sim", sim])
        .args(["--json", "--out", &format!("{sim}-out")])
        .current_dir(folder)
        .output()
        .unwrap()
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn a_robot_from_its_urdf_is_on_target() {
    let folder = folder("jumps");
    fs::write(folder.join("robot.urdf"), urdf()).unwrap();
    let sims: &[&str] = if cfg!(feature = "mujoco") {
        &["native", "mujoco"]
    } else {
        &["native"]
    };
    for sim in sims {
        let output = run(&folder, "a1/spin-90", sim);
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        crate::keys::are_all_there(&json);
        assert_eq!(json["on_target"], true, "{sim}: {}", json["verdict"]);
        assert_eq!(json["placeholders"], serde_json::json!([]));
        assert!(folder.join(format!("{sim}-out/report.html")).exists());
    }
}

/// The torque of a plan is told beside the limit of the joint that has it, and friction beside the task's.
#[test]
fn torque_is_told_beside_the_limit_of_its_joint() {
    let folder = folder("torque");
    let mut parts = Vec::new();
    for part in urdf().split("<joint ") {
        let hip = part.contains("_hip_joint\"");
        parts.push(if hip {
            part.replace("effort=\"33.5\"", "effort=\"20\"")
        } else {
            part.to_owned()
        });
    }
    fs::write(folder.join("robot.urdf"), parts.join("<joint ")).unwrap();
    let task = include_str!("../../jump-planner/tasks/a1/lateral.toml");
    fs::write(
        folder.join("t.toml"),
        format!("{task}\n[limits]\nfriction = 0.7\n"),
    )
    .unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["run", "t.toml", "--robot", "robot.urdf", "--out", "out"])
        .current_dir(&folder)
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let line = said
        .lines()
        .find(|line| line.starts_with("leg plan"))
        .unwrap();
    assert!(
        line.contains("of 33.5 N m (") && line.contains("_calf)"),
        "{line}"
    );
    assert!(line.ends_with("of 0.70"), "{line}");
}

/// A plan that `saltus plan` would refuse for what its links pass through is flown, and that is told.
#[test]
fn what_the_audit_refuses_is_told_where_it_is_flown() {
    let folder = folder("audit");
    fs::write(folder.join("robot.urdf"), urdf()).unwrap();
    let thick = "urdf = \"robot.urdf\"\n[limbs]\nthigh_radius_m = 0.19\n";
    fs::write(folder.join("thick.toml"), thick).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(["run", "a1/lateral", "--robot", "thick.toml", "--out", "out"])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stdout).unwrap();
    let line = said
        .lines()
        .find(|line| line.starts_with("audit "))
        .unwrap();
    for word in ["refuses the plan", "_thigh passes through the ground"] {
        assert!(line.contains(word), "{line}");
    }
}

/// A limit of effort that no motor of this size has is told, before anything is planned with it.
#[test]
#[ignore = "long: cargo xtask suites"]
fn a_placeholder_for_a_limit_is_named() {
    let folder = folder("placeholder");
    let strong = urdf().replace("effort=\"33.5\"", "effort=\"1000\"");
    fs::write(folder.join("robot.urdf"), strong).unwrap();
    let output = run(&folder, "a1/lateral", "native");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("1000 N m") && said.contains("placeholders"),
        "{said}"
    );
}
