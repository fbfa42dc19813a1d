//! More of what must be refused at once, with the file, the key or the option, and what is accepted; and cases that the fuzzer
//! (`cargo xtask fuzz`) has found.

use crate::command::saltus;
use core::time::Duration;
use std::fs;
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    crate::command::folder(&format!("refusals-{name}"))
}

fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    crate::refused::refused(Duration::from_secs(20), folder, arguments, words);
}

/// Every command that reads a file names it, whatever is in it, and says what to do.
#[test]
fn files_that_are_none_are_named() {
    let folder = folder("files");
    fs::create_dir(folder.join("folder")).unwrap();
    fs::write(folder.join("empty"), "").unwrap();
    fs::write(folder.join("junk"), [0xff, 0, 0xfe, 0x80]).unwrap();
    std::os::unix::fs::symlink("ring", folder.join("ring")).unwrap();
    for file in ["folder", "empty", "junk", "ring"] {
        for arguments in [
            &["verify", file][..],
            &["verify", "empty", "--robot", file],
            &["import", file],
            &["plan", "a1/lateral", "--robot", file],
            &["run", "a1/lateral", "--robot", file],
            &["plan", "--problem", file],
            &[
                "plan",
                "--reference",
                "spin",
                "--stage",
                "whole-body",
                "--srb",
                file,
            ],
            &["verdicts", "--expect", file],
            &["reproduce", "--quick", "--expect", file],
        ] {
            refused(&folder, arguments, &[file]);
        }
    }
    refused(
        &folder,
        &["verdicts", "--expect", "folder"],
        &["give a file, not a folder"],
    );
    refused(
        &folder,
        &["verify", "empty", "--robot", "nowhere"],
        &["nowhere", "check the path"],
    );
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 4);
}

#[test]
fn numbers_of_options_say_what_they_may_be() {
    let folder = folder("numbers");
    let most = "18446744073709551615";
    for (arguments, words) in [
        (
            &["run", "a1/lateral", "--seed", "18446744073709551616"][..],
            &["--seed", most][..],
        ),
        (
            &["run", "a1/lateral", "--seed", "1.5"],
            &["--seed", "whole number"],
        ),
        (
            &["envelope", "a1/lateral", "--seed", "-1"],
            &["--seed", most],
        ),
        (
            &["envelope", "a1/lateral", "--samples", "1e3"],
            &["--samples", "from 1 to 10000000"],
        ),
        (&["verdicts", "--seed", "nan"], &["--seed", most]),
        (
            &["verdicts", "--conditions", "--lab", most],
            &["--lab", "100000"],
        ),
        (
            &["plan", "--reference", "spin", "--repeat", most],
            &["--repeat", "from 1 to 1000"],
        ),
        (
            &["plan", "--reference", "spin", "--repeat", "0"],
            &["--repeat", "from 1 to 1000"],
        ),
        (
            &["run", "a1/lateral", "--plant", "mass=1,mass=2"],
            &["mass", "twice"],
        ),
        (
            &["import", "r.urdf", "--axis-rounding", "nan"],
            &["--axis-rounding", "0 to 0.1"],
        ),
        (
            &["import", "r.urdf", "--axis-rounding", "-1"],
            &["--axis-rounding", "0 to 0.1"],
        ),
    ] {
        refused(&folder, arguments, words);
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

/// What this build, or this folder, cannot do is said before the work.
#[test]
fn what_cannot_be_is_said_before_the_work() {
    let folder = folder("before");
    std::os::unix::fs::symlink("nowhere", folder.join("dangling")).unwrap();
    let long = "x".repeat(300);
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/a1.urdf");
    let robot = robot.to_str().unwrap();
    for out in ["dangling", &long] {
        for arguments in [
            &["plan", "a1/lateral", "--out", out][..],
            &["run", "a1/lateral", "--out", out],
            &["envelope", "a1/lateral", "--out", out],
            &["reproduce", "--quick", "--out", out],
            &["verdicts", "--out", out],
            &["watch", "one", "another", "--out", out],
            &["import", robot, "--out", out],
        ] {
            refused(&folder, arguments, &[out.get(..8).unwrap()]);
        }
    }
    refused(
        &folder,
        &["plan", "a1/lateral", "--solution", &long],
        &["xxxx"],
    );
    if cfg!(not(feature = "mujoco")) {
        for command in ["run", "envelope", "verdicts"] {
            let arguments = [command, "a1/lateral", "--sim", "mujoco"];
            refused(&folder, &arguments, &["cargo xtask mujoco run"]);
        }
        let told = saltus(&folder, &["--version"]).stdout;
        assert!(
            String::from_utf8(told)
                .unwrap()
                .contains("cargo xtask mujoco build")
        );
    }
    for (package, words) in [
        ("std", "another crate"),
        ("1", "a letter first"),
        ("fn", "a keyword of Rust"),
        ("Self", "a keyword of Rust"),
    ] {
        let arguments = ["import", robot, "--out", "new", "--package", package];
        refused(&folder, &arguments, &[package, words]);
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

/// Robots like feathers and mountains kept the planner busy for more than a minute.
#[test]
fn a_robot_of_no_robots_size_is_refused() {
    let folder = folder("sizes");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/a1.urdf");
    let urdf = fs::read_to_string(path).unwrap();
    let masses = |value: &str| {
        let mut parts = urdf.split("mass value=\"");
        let mut out = parts.next().unwrap().to_owned();
        for part in parts {
            let (_, rest) = part.split_once('"').unwrap();
            out += &format!("mass value=\"{value}\"{rest}");
        }
        out
    };
    for (value, word) in [
        ("1e-200", "mass, kg: must be above 0.01"),
        ("1e200", "at most 1e9"),
    ] {
        fs::write(folder.join("r.urdf"), masses(value)).unwrap();
        let arguments = ["plan", "a1/lateral", "--robot", "r.urdf"];
        refused(&folder, &arguments, &["r.urdf", word]);
    }
}

/// Folders of `kept`: the files of a command line that once went wrong, with it in `command`, one argument in a line.
#[test]
fn what_the_fuzzer_found_is_answered() {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/kept");
    let here = folder("kept");
    for entry in fs::read_dir(kept).into_iter().flatten() {
        let case = entry.unwrap().path();
        let to = here.join(case.file_name().unwrap());
        fs::create_dir_all(&to).unwrap();
        for file in fs::read_dir(&case).unwrap() {
            let file = file.unwrap();
            fs::copy(file.path(), to.join(file.file_name())).unwrap();
        }
        let command = fs::read_to_string(to.join("command")).unwrap();
        refused(&to, &command.lines().collect::<Vec<_>>(), &[]);
    }
}
