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

/// What a task says of its robot, of where that stands, of the ground and of forces is what is planned, flown and judged.
#[test]
fn a_stored_plan_is_flown_as_its_task_says() {
    let folder = folder("says");
    fs::write(
        folder.join("robot.urdf"),
        urdf().replace("name=\"a1\"", "name=\"own\""),
    )
    .unwrap();
    let task = "robot = \"robot.urdf\"\ngoal_m = [0.0, 0.2, 0.0]\n\
        feet_m = [[0.292, 0.13], [0.292, -0.13], [-0.052, 0.13], [-0.052, -0.13]]\n\
        [[phase]]\nfeet = [\"FL\", \"FR\", \"RL\", \"RR\"]\nguess_s = 0.5\n\
        [[phase]]\nfeet = []\nguess_s = 0.35\n\
        [limits]\nfriction = 0.7\nforce_weights = 0.9\n";
    fs::write(folder.join("own.toml"), task).unwrap();
    let saltus = |args: &[&str]| {
        let command = Command::new(env!("CARGO_BIN_EXE_saltus"))
            .args(args)
            .current_dir(&folder)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&command.stdout).into_owned();
        assert_eq!(command.status.code(), Some(0), "{said}");
        said
    };
    saltus(&["plan", "own.toml", "--out", "plan"]);
    let said = saltus(&["run", "plan/plan.bin", "--json", "--out", "run"]);
    let json: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(json["on_target"], true, "{}", json["verdict"]);
    assert_eq!(json["plant"]["friction"], 0.7);
    let log = fs::read_to_string(folder.join("run/log.csv")).unwrap();
    let mut lines = log.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let is_force = |name: &str| name.starts_with("f_plan_") && name.ends_with("_z");
    let forces: Vec<_> = (0..header.len()).filter(|i| is_force(header[*i])).collect();
    assert_eq!(forces.len(), 4);
    let planned = lines.flat_map(|line| {
        forces
            .iter()
            .map(|i| line[*i].parse().unwrap())
            .collect::<Vec<f64>>()
    });
    let most = planned.fold(0.0, f64::max);
    let limit = 0.9 * 13.741 * 9.81;
    assert!(
        (0.9 * limit..=1.01 * limit).contains(&most),
        "{most} of {limit}"
    );
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

/// Links that are in each other where the robot stands have never touched in any simulator: a trunk of 0.35 m, with the thighs inside it,
/// jumped on target with "nothing but feet touched". They are told; of A1's own, none are.
#[test]
fn links_that_nobody_sees_collide_are_named() {
    let folder = folder("overlap");
    fs::write(folder.join("a1.urdf"), urdf()).unwrap();
    let a1 = include_str!("../../models/a1.toml");
    let size = a1.lines().find(|line| line.starts_with("size_m")).unwrap();
    // A goal that is refused before anything is planned.
    let far =
        include_str!("../../jump-planner/tasks/a1/lateral.toml").replace("0.3, 0.0]", "60.0, 0.0]");
    fs::write(folder.join("far.toml"), far).unwrap();
    for (size_now, are_named) in [(size, false), ("size_m = [0.8, 0.6, 0.35]", true)] {
        fs::write(folder.join("robot.toml"), a1.replace(size, size_now)).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_saltus"))
            .args(["plan", "far.toml", "--robot", "robot.toml"])
            .current_dir(&folder)
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        for word in ["in each other", "FL_thigh and trunk", "correct the sizes"] {
            assert_eq!(said.contains(word), are_named, "{said}");
        }
    }
}
