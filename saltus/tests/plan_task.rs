//! `saltus plan TASK`: margins kept, torques held, audited, stored; and what happens to tasks that cannot be.

use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of this test's own.
fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("saltus-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn saltus(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_saltus"))
        .args(args)
        .output()
        .unwrap()
}

fn numbers(row: &Value) -> Vec<f64> {
    let row = row.as_array().unwrap();
    row.iter().map(|x| x.as_f64().unwrap()).collect()
}

/// The text of a built-in task.
fn built_in(name: &str) -> String {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../jump-planner/tasks/{name}.toml"));
    std::fs::read_to_string(path).unwrap()
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn plans_keep_margins_pass_the_audit_and_are_stored() {
    let folder = folder("plans");
    for task in ["a1/lateral", "a1/barrel-roll"] {
        let out = folder.join(task.replace('/', "-"));
        let solution = folder.join("solution.json");
        let (out, solution) = (out.to_str().unwrap(), solution.to_str().unwrap());
        let output = saltus(&["plan", task, "--json", "--out", out, "--solution", solution]);
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["status"], "Solved", "{report}");
        assert_eq!(output.status.code(), Some(0));
        let keys: Vec<_> = report.as_object().unwrap().keys().cloned().collect();
        assert_eq!(
            keys,
            [
                "audit",
                "path",
                "phases",
                "srb",
                "status",
                "task",
                "whole_body"
            ]
        );
        for stage in ["srb", "whole_body"] {
            let keys: Vec<_> = report[stage].as_object().unwrap().keys().cloned().collect();
            assert_eq!(keys, ["cost", "iterations", "max_violation", "wall_ms"]);
            assert!(report[stage]["max_violation"].as_f64().unwrap() <= 1e-6);
        }
        let audit = &report["audit"];
        assert!(audit["flight_orientation_error_deg"].as_f64().unwrap() <= 2.0);
        assert!(audit["flight_position_error_m"].as_f64().unwrap() <= 0.01);
        assert!(audit["worst_margin"]["value"].as_f64().unwrap() >= -0.01);
        let plan = serde_json::from_str(&std::fs::read_to_string(solution).unwrap()).unwrap();
        margins_are_kept(task, &plan);
        refused_when_damaged(&Path::new(out).join("plan.bin"));
        // Nothing is overwritten.
        let again = saltus(&["plan", task, "--out", out]);
        assert_eq!(again.status.code(), Some(2));
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Turns whose Euler angles meet their singularity, in one order or in both: on SO(3) they are as good as any. The legs of the diagonal flip pass
/// through each other in its first plan, so that it is made again with those kept apart.
#[test]
#[ignore = "long: cargo xtask suites"]
fn turns_about_mixed_axes_are_planned() {
    let folder = folder("mixed");
    let roll = built_in("a1/barrel-roll");
    let turn = |goal: &str, axis: &str| {
        let text = roll.replace("goal_m = [0.0, -0.3, 0.0]", &format!("goal_m = {goal}"));
        text.replace("axis = [1.0, 0.0, 0.0]", &format!("axis = {axis}"))
    };
    for (name, text, parted) in [
        (
            "diagonal-flip",
            turn("[0.2, -0.2, 0.0]", "[1.0, 1.0, 0.0]"),
            true,
        ),
        (
            "tilted-roll",
            turn("[0.0, -0.3, 0.0]", "[1.0, 0.0, 0.25]"),
            false,
        ),
    ] {
        assert_ne!(text, roll);
        let path = folder.join(name).with_extension("toml");
        std::fs::write(&path, text).unwrap();
        let output = saltus(&["plan", path.to_str().unwrap(), "--json"]);
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["status"], "Solved", "{report}");
        assert!(report["whole_body"]["max_violation"].as_f64().unwrap() <= 1e-6);
        let path = report["path"].as_array().unwrap();
        let [first, last] = [path.first(), path.last()].map(|solve| &solve.unwrap()["kept_apart"]);
        assert_eq!(first, 0, "{name}: {report}");
        assert_eq!(last.as_u64().unwrap() > 0, parted, "{name}: {report}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Two jumps that a solve alone does not find. Where the audit finds friction exceeded between nodes, it is drawn in; where the first try
/// finds no motion, the search goes on on long intervals, and comes back to the short ones with as little torque as the task asks for;
/// where no motion of the legs has the rigid body's durations, they are found on the whole body.
#[test]
#[ignore = "long: cargo xtask suites"]
fn plans_are_made_again_where_the_first_way_ends() {
    let folder = folder("again");
    let spin = built_in("a1/spin-90");
    let longer = spin.replace("max_s = 0.9", "max_s = 1.2");
    let diagonal = built_in("a1/diagonal");
    let further = diagonal.replace("[0.4, -0.3, ", "[0.52, -0.39, ");
    assert_ne!(further, diagonal);
    // Plans that keep to a share of friction have room between their nodes; these use all of it.
    let all_of_it = |text: String| format!("{text}\n[limits]\nfriction_share = 1.0\n");
    // Whose durations, and whether it takes the search.
    let cases = [
        (
            "spin-240",
            all_of_it(longer.replace("90.0", "240.0")),
            "whole body",
            true,
        ),
        ("further", all_of_it(further), "rigid body", false),
    ];
    for (name, text, durations, searched) in cases {
        let path = folder.join(name).with_extension("toml");
        std::fs::write(&path, text).unwrap();
        let output = saltus(&["plan", path.to_str().unwrap(), "--json"]);
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["status"], "Solved", "{name}: {report}");
        let path = report["path"].as_array().unwrap();
        assert!(path.len() > 1, "{name}: {report}");
        let last = path.last().unwrap();
        assert_eq!(last["durations"], durations, "{name}: {report}");
        let friction = last["drawn_in"]["friction"].as_f64().unwrap();
        assert!(friction > 0.0, "{name}: {report}");
        // As little torque as the task asks for, however much the search began with.
        let torque = |solve: &Value| solve["torque_share"].as_f64().unwrap();
        assert_eq!(torque(last), torque(&path[0]), "{name}: {report}");
        let long = path.iter().find(|solve| torque(solve) > torque(last));
        assert_eq!(long.is_some(), searched, "{name}: {report}");
        let intervals = |solve: &Value| solve["intervals"].as_u64().unwrap();
        if let Some(long) = long {
            assert_eq!(4 * intervals(long), intervals(last), "{name}: {report}");
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// What no search finds is found with stronger joints, and the answer says how much stronger they would have to be: as little as had a motion.
#[test]
#[ignore = "long: cargo xtask suites"]
fn a_jump_beyond_the_robot_says_how_strong_joints_would_have_to_be() {
    let folder = folder("stronger");
    let forward = built_in("a1/forward-60");
    let far = forward.replace("goal_m = [0.6, ", "goal_m = [1.1, ");
    assert_ne!(far, forward);
    let path = folder.join("far.toml");
    std::fs::write(&path, far).unwrap();
    let output = saltus(&["plan", path.to_str().unwrap(), "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["status"], "NotFound", "{report}");
    let solves = report["path"].as_array().unwrap();
    let strength = |solve: &&Value| solve["strength"].as_f64().unwrap();
    let ended = |status: &'static str| solves.iter().filter(move |solve| solve["status"] == status);
    let weakest = ended("Solved")
        .map(|s| strength(&s))
        .fold(f64::INFINITY, f64::min);
    assert!(weakest > 1.0 && weakest < 3.0, "{report}");
    // Weaker ones were tried, and none less than a twentieth weaker is left.
    let tried = ended("Stalled").map(|s| strength(&s)).fold(0.0, f64::max);
    assert!(tried < weakest && weakest < 1.06 * tried, "{report}");
    let told = report["answer"]["relaxations"][0].as_str().unwrap();
    assert!(
        told.contains(&format!("{weakest:.2} times as strong")),
        "{told}"
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Three quarters of a turn are not found by the first try, so that the search runs beside it on two cores, and after it on one.
#[test]
#[cfg(target_os = "linux")]
#[ignore = "long: cargo xtask suites"]
fn a_search_finds_the_same_on_any_number_of_cores() {
    let folder = folder("cores");
    let spin = built_in("a1/spin-90").replace("90.0", "270.0");
    let path = folder.join("spin.toml");
    std::fs::write(&path, spin.replace("max_s = 0.9", "max_s = 1.2")).unwrap();
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let allowed = status
        .lines()
        .find_map(|line| line.strip_prefix("Cpus_allowed_list:"));
    let first = allowed.unwrap().trim().split(['-', ',']).next().unwrap();
    let saltus = env!("CARGO_BIN_EXE_saltus");
    let ways: [(&str, &[&str]); 2] = [
        ("one", &["taskset", "-c", first, saltus]),
        ("all", &[saltus]),
    ];
    let [one, all] = ways.map(|(name, command)| {
        let out = folder.join(name);
        let mut plan = Command::new(command[0]);
        plan.args(&command[1..])
            .args(["plan", path.to_str().unwrap()]);
        let output = plan
            .args(["--json", "--out", out.to_str().unwrap()])
            .output()
            .unwrap();
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["status"], "Solved", "{name}: {report}");
        let mut path = report["path"].clone();
        for solve in path.as_array_mut().unwrap() {
            solve["wall_ms"].take();
        }
        (path, std::fs::read(out.join("plan.bin")).unwrap())
    });
    assert!(one.0.as_array().unwrap().len() > 2, "{}", one.0);
    assert_eq!(one, all);
    std::fs::remove_dir_all(&folder).unwrap();
}

fn margins_are_kept(task: &str, plan: &Value) {
    let rows = |key: &str| plan[key].as_array().unwrap().iter().map(numbers);
    let dt = numbers(&plan["dt"]);
    let (q, v, a): (Vec<_>, Vec<_>, Vec<_>) = (
        rows("q").collect(),
        rows("v").collect(),
        rows("a").collect(),
    );
    let turned = plan["R"].as_array().unwrap();
    for torques in rows("tau") {
        assert!(torques.iter().all(|t| t.abs() <= 24.0 + 1e-6), "{task}");
    }
    for forces in plan["F"].as_array().unwrap() {
        for f in forces.as_array().unwrap().iter().map(numbers) {
            assert!(f[0].abs().max(f[1].abs()) <= 0.45 * f[2] + 1e-6, "{task}");
            // The ground's cone is round.
            let cone = 0.57 * f[2] + 1e-5;
            assert!(f[0] * f[0] + f[1] * f[1] <= cone * cone, "{task}");
        }
    }
    for (k, dt) in dt.iter().enumerate().take(dt.len() - 1) {
        // What turns the base is on SO(3).
        for i in (0..3).chain(6..18) {
            let reached = q[k][i] + dt * v[k][i] + 0.5 * dt * dt * a[k][i];
            assert!((reached - q[k + 1][i]).abs() < 1e-7, "{task} {k} {i}");
        }
        for i in 0..18 {
            let speed = v[k][i] + dt * a[k][i];
            assert!((speed - v[k + 1][i]).abs() < 1e-6, "{task} {k} {i}");
        }
        let turn = Vector3::from_fn(|i, _| dt * (v[k][3 + i] + 0.5 * dt * a[k][3 + i]));
        let rotation = |k: usize| Matrix3::from_fn(|i, j| turned[k][i][j].as_f64().unwrap());
        let reached = rotation(k) * so3::exp(&turn).matrix();
        assert!((reached - rotation(k + 1)).norm() < 1e-7, "{task} {k}");
    }
    // Two-leg stance is unstable open loop: it is kept short.
    for phase in plan["phases"].as_array().unwrap() {
        let feet = phase["contacts"].as_array().unwrap();
        let lasts = phase["intervals"].as_f64().unwrap() * phase["dt"].as_f64().unwrap();
        if feet.iter().filter(|on| on.as_bool().unwrap()).count() == 2 {
            assert!(lasts <= 0.35 + 1e-6, "{task}");
        }
    }
    // Feedback of every joint, finite everywhere.
    for gains in plan["tau_by_q"].as_array().unwrap() {
        let gains = gains.as_array().unwrap();
        assert_eq!(gains.len(), 12);
        let finite = |row: &Value| numbers(row).iter().all(|x| x.is_finite());
        assert!(gains.iter().all(finite));
    }
}

/// The plan passes as it is, and is refused with a reason when it is cut, changed, or for another robot.
fn refused_when_damaged(path: &Path) {
    let verify = |path: &Path| {
        let output = saltus(&["verify", path.to_str().unwrap(), "--json"]);
        (
            output.status.code(),
            String::from_utf8(output.stdout).unwrap(),
        )
    };
    let (code, report) = verify(path);
    assert_eq!(code, Some(0), "{report}");
    let bytes = std::fs::read(path).unwrap();
    let bad = path.with_extension("bad");
    let mut changed = bytes.clone();
    changed[1000] ^= 4;
    let mut newer = bytes.clone();
    newer[4] += 1;
    let mut other = bytes.clone();
    other[12] ^= 1;
    for (content, reason) in [
        (&changed[..], "checksum"),
        (&bytes[..bytes.len() - 1], "cut off"),
        (&newer[..], "version"),
        (&other[..], "checksum"),
        (b"hello".as_slice(), "cut off"),
    ] {
        std::fs::write(&bad, content).unwrap();
        let (code, report) = verify(&bad);
        assert_eq!(code, Some(2));
        assert!(report.contains(reason), "{reason}: {report}");
    }
}

/// Absurd and impossible tasks: exit code 2, at once, with what blocks and what would have to change.
#[test]
#[ignore = "long: cargo xtask suites"]
fn impossible_tasks_are_answered() {
    let folder = folder("impossible");
    let lateral = built_in("a1/lateral");
    let down = built_in("a1/lateral-down");
    let cases = [
        (
            "goal",
            down.replace("-0.3]", "5.0]")
                .replace("drop_m = 0.3", "drop_m = -5.0"),
            "force",
        ),
        (
            "friction",
            format!("{lateral}\n[limits]\nfriction = 0.0\n"),
            "friction",
        ),
        (
            "box",
            down.replace("beyond_feet_m = 0.0492", "distance_m = 0.05")
                .replace("drop_m = 0.3", "drop_m = -0.3")
                .replace("-0.3]", "0.3]"),
            "farther",
        ),
        (
            "air",
            lateral.replace("\"FL\", \"FR\", \"RL\", \"RR\"", ""),
            "foot",
        ),
        (
            "sum",
            lateral
                .replace("max_s = 0.8", "max_s = 0.5")
                .replace("guess_s = 0.5", "guess_s = 0.5\nmin_s = 0.4"),
            "longest total duration",
        ),
    ];
    for (name, text, told) in cases {
        let path = folder.join(format!("{name}.toml"));
        std::fs::write(&path, &text).unwrap();
        let output = saltus(&["plan", path.to_str().unwrap(), "--json"]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["status"], "Infeasible", "{report}");
        assert!(report["answer"].to_string().contains(told), "{report}");
    }
    let output = saltus(&[
        "plan",
        "a1/double-backflip",
        "--timing",
        "0.5,0.33,0.2",
        "--json",
    ]);
    assert_eq!(output.status.code(), Some(2));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["status"], "Infeasible", "{report}");
    assert!(
        report["answer"]
            .to_string()
            .contains("flight would have to last")
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

/// What is no task: exit code 2, and the culprit is named.
#[test]
fn bad_input_is_named() {
    let folder = folder("bad");
    let text = built_in("a1/lateral");
    let cases = [
        ("nan", text.replace("0.3, 0.0]", "nan, 0.0]"), "goal_m"),
        ("foot", text.replace("\"FL\"", "\"FX\""), "FX"),
        ("typo", text.replace("guess_s", "gues_s"), "gues_s"),
        (
            "robot",
            text.replace("\"a1\"", "\"nowhere.urdf\""),
            "nowhere.urdf",
        ),
        ("mass", text.replace("\"a1\"", "\"negative.urdf\""), "mass"),
        (
            "weight",
            format!("{text}\n[weights]\nforce = -1.0\n"),
            "weights.force",
        ),
        ("range", text.replace("min_s = 0.5", "min_s = 1.5"), "total"),
    ];
    let negative = r#"<robot name="r"><link name="base"><inertial><mass value="-1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#;
    std::fs::write(folder.join("negative.urdf"), negative).unwrap();
    for (name, content, told) in cases {
        let path = folder.join(format!("{name}.toml"));
        std::fs::write(&path, &content).unwrap();
        let output = saltus(&["plan", path.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains(told), "{name}: {message}");
    }
    for args in [
        &["plan", "a1/nowhere"][..],
        &["plan", "a1/lateral", "--timing", "0.5"],
        &["plan", "a1/lateral", "--timing", "0.5,-1"],
        &["plan", "a1/lateral", "--timing", "0.5,nan"],
        &["plan"],
        &["verify", "nowhere.bin"],
    ] {
        assert_eq!(saltus(args).status.code(), Some(2), "{args:?}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Nothing can be found in no time; that is an answer, with what stands in the way, and no plan lies there.
#[test]
fn a_search_ends_with_the_time_there_is() {
    let folder = folder("within");
    let out = folder.join("plan");
    let arguments = ["plan", "a1/lateral", "--within", "0", "--json", "--out"];
    let output = saltus(&[&arguments[..], &[out.to_str().unwrap()]].concat());
    assert_eq!(output.status.code(), Some(2));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["status"], "OutOfTime", "{report}");
    let because = report["answer"]["because"].as_str().unwrap();
    assert!(
        because.starts_with("after 0 s the body's motion"),
        "{because}"
    );
    assert!(!out.exists());

    let output = saltus(&["plan", "a1/lateral", "--within", "-1"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("--within"), "{said}");
}
