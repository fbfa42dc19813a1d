//! What the program says to mistakes and to malice: a code that is documented, a reason, a remedy, and nothing half done.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn saltus(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
    command
        .args(arguments)
        .current_dir(folder())
        .output()
        .unwrap()
}

/// A folder with the files that the commands below name.
fn folder() -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hostile");
    std::fs::create_dir_all(path.join("folder.urdf")).unwrap();
    let lateral = include_str!("../../jump-planner/tasks/a1/lateral.toml");
    let goal = |goal: &str| {
        let lines = lateral.lines().map(|line| match line {
            _ if line.starts_with("goal_m") => format!("goal_m = [{goal}]\n"),
            _ => format!("{line}\n"),
        });
        lines.collect::<String>()
    };
    let arm = "<robot name='arm'><link name='a'><inertial><mass value='1'/>\
               <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>";
    for (name, text) in [
        ("empty.toml", String::new()),
        ("nan.toml", goal("nan, 0.3, 0.0")),
        ("far.toml", goal("50.0, 0.3, 0.0")),
        ("short.bin", "SLTS".to_owned()),
        (
            "old.bin",
            "SLTS\u{1}\0\u{c}\u{4}its sixteen bytes".to_owned(),
        ),
        ("arm.urdf", arm.to_owned()),
        ("urdf.txt", "not XML".to_owned()),
    ] {
        // Tests run at the same time: a file never shrinks while another reads it.
        let file = path.join(name);
        if !std::fs::read_to_string(&file).is_ok_and(|old| old == text) {
            std::fs::write(file, text).unwrap();
        }
    }
    path
}

/// Command line, and words that the answer must hold. What is refused, and what cannot be, has one exit code in all commands: 2.
const MISTAKES: &[(&[&str], &[&str])] = &[
    (&[], &["Usage", "saltus help COMMAND"]),
    (&["runn", "a1/lateral"], &["a similar subcommand", "run"]),
    (&["run"], &["<TASK|PLAN>"]),
    (
        &["run", "a1/moonwalk"],
        &["no task `a1/moonwalk`", "a1/lateral"],
    ),
    (
        &["plan", "a1/moonwalk"],
        &["no task `a1/moonwalk`", "a1/lateral"],
    ),
    (&["run", "nowhere.toml"], &["nowhere.toml"]),
    (&["run", "empty.toml"], &["empty.toml", "missing field"]),
    (&["run", "nan.toml"], &["goal_m", "finite"]),
    (&["run", "far.toml"], &["Infeasible", "friction"]),
    (
        &["envelope", "far.toml"],
        &[
            "far.toml: Infeasible",
            "infeasible: with 0.75 of the ground",
        ],
    ),
    (
        &["envelope", "far.toml", "--ablate"],
        &[
            "far.toml: Infeasible",
            "infeasible: with 0.75 of the ground",
        ],
    ),
    (
        &["run", "short.bin"],
        &["short.bin", "cut off", "copy the plan again"],
    ),
    (&["run", "old.bin"], &["old.bin", "version 1", "plan again"]),
    (&["run", "urdf.txt"], &["urdf.txt", "cut off"]),
    (
        &["run", "a1/lateral", "--task", "a1/lateral"],
        &["--task", "alone"],
    ),
    (&["run", "a1/lateral", "--seed", "-1"], &["--seed"]),
    (
        &["run", "a1/lateral", "--plant", "wind=2"],
        &["wind=2", "payload"],
    ),
    (
        &["run", "a1/lateral", "--plant", ""],
        &["--plant", "nothing is named", "KEY=VALUE"],
    ),
    (
        &["envelope", "a1/lateral", "--plant", ","],
        &["--plant", "nothing is named", "KEY=VALUE"],
    ),
    (
        &["verdicts", "a1/lateral", "--plant", ""],
        &["--plant", "nothing is named", "KEY=VALUE"],
    ),
    (
        &["run", "a1/lateral", "--json", "--quiet"],
        &["cannot be used with"],
    ),
    (
        &["run", "icub/velocity", "--height", "nan"],
        &["--height", "0.04"],
    ),
    (
        &["run", "icub/velocity", "--torque-share", "-1"],
        &["--torque-share", "0.8"],
    ),
    (
        &["run", "icub/velocity", "--plant", "mass=0"],
        &["mass=0", "from 0.1"],
    ),
    (
        &["run", "a1/lateral", "--out", "folder.urdf"],
        &["nothing is overwritten"],
    ),
    (
        &["run", "a1/lateral", "--out", "short.bin"],
        &["nothing is overwritten"],
    ),
    (
        &["verdicts", "far.toml", "far.toml", "--out", "gallery"],
        &["far.toml is given twice"],
    ),
    (
        &[
            "verdicts", "far.toml", "--sim", "native", "--sim", "native", "--out", "gallery",
        ],
        &["native is given twice"],
    ),
    (
        &["envelope", "a1/lateral", "--samples", "0"],
        &["--samples"],
    ),
    (
        &["envelope", "a1/lateral", "--samples", "-3"],
        &["--samples"],
    ),
    (
        &["envelope", "a1/lateral", "--shard", "3/2"],
        &["1 <= k <= n"],
    ),
    (
        &["envelope", "a1/lateral", "--out", "."],
        &["something else than a study"],
    ),
    (&["envelope", "icub/velocity"], &["no task"]),
    (
        &["envelope", "a1/lateral", "--without", "luck"],
        &["luck", "weighing"],
    ),
    (
        &["envelope", "a1/lateral", "--ablate", "--without", "posture"],
        &["--ablate"],
    ),
    (
        &[
            "envelope",
            "a1/lateral",
            "--planner",
            "kinematics",
            "--without",
            "drives",
        ],
        &["whole-body"],
    ),
    (&["plan", "a1/lateral", "--timing", "0.5,nan"], &["timing"]),
    (
        &["plan", "a1/lateral", "--robot", "folder.urdf"],
        &["folder.urdf", "folder"],
    ),
    (
        &["plan", "a1/lateral", "--robot", "arm.urdf"],
        &["arm.urdf", "12 movable joints"],
    ),
    (
        &["plan", "--reference", "nope"],
        &["no task `nope`", "spin"],
    ),
    (&["plan", "--problem", "empty.toml"], &["empty.toml"]),
    (&["verify", "short.bin"], &["short.bin", "cut off"]),
    (
        &["verify", "old.bin"],
        &["old.bin", "version 1", "plan again"],
    ),
    (&["verify", "folder.urdf"], &["folder.urdf", "give a file"]),
    (&["verify", "nowhere"], &["nowhere", "check the path"]),
    (&["watch"], &["<RUN>"]),
    (&["watch", "nowhere"], &["nowhere", "check the path"]),
    (
        &["watch", "short.bin"],
        &["short.bin is a file", "give the folder"],
    ),
    (
        &["watch", "folder.urdf"],
        &["folder.urdf has no report.html", "give a folder"],
    ),
    (
        &["watch", ".", "--out", "here"],
        &["--out is for several runs"],
    ),
    (
        &["watch", "a", "b", "c", "d", "e", "f", "g"],
        &["7 runs", "up to 6"],
    ),
    (&["import", "folder.urdf"], &["folder.urdf", "give a file"]),
    (&["import", "urdf.txt"], &["urdf.txt", "not XML"]),
    (&["completions", "tcl"], &["bash", "zsh"]),
];

#[test]
fn mistakes_are_named_with_their_remedy() {
    for (arguments, words) in MISTAKES {
        let output = saltus(arguments);
        let said = [output.stdout, output.stderr].concat();
        let said = String::from_utf8(said).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        for word in *words {
            assert!(
                said.contains(word),
                "{arguments:?} does not say `{word}`: {said}"
            );
        }
        assert!(
            !said.contains('\u{1b}'),
            "colours without a terminal: {said}"
        );
    }
    assert!(!folder().join("out").exists(), "a mistake left a folder");
}

#[test]
fn with_json_an_error_is_one_object_too() {
    for (arguments, _) in MISTAKES {
        if arguments.contains(&"--quiet") {
            continue;
        }
        let output = saltus(&[*arguments, &["--json"]].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(
            report["error"].is_string() || report["answer"].is_object(),
            "{report}"
        );
    }
}

#[test]
fn quiet_says_nothing_but_errors() {
    let good = saltus(&["plan", "a1/lateral", "--quiet"]);
    assert_eq!(good.status.code(), Some(0));
    assert!(good.stdout.is_empty() && good.stderr.is_empty());
    let bad = saltus(&["plan", "a1/moonwalk", "--quiet"]);
    assert!(bad.stdout.is_empty() && !bad.stderr.is_empty());
}

#[test]
fn every_command_explains_itself_and_its_exit_codes() {
    for command in [
        "plan",
        "verify",
        "import",
        "run",
        "watch",
        "envelope",
        "verdicts",
        "reproduce",
    ] {
        let help = String::from_utf8(saltus(&[command, "--help"]).stdout).unwrap();
        assert!(
            help.contains("Examples:") && help.contains("Exit codes:"),
            "{help}"
        );
    }
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = String::from_utf8(saltus(&["completions", shell]).stdout).unwrap();
        assert!(
            script.contains("envelope") && script.contains("no-momentum"),
            "{shell}"
        );
    }
}
