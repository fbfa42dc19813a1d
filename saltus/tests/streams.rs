//! Standard output that takes nothing, targets that cannot be, processes that were killed: an exit code, a reason, nothing half done.
#![cfg(target_os = "linux")]

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// A new folder of a test's own.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("streams-{name}"));
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn saltus(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_saltus"));
    command.args(arguments).current_dir(folder);
    command
}

fn full() -> Stdio {
    File::options()
        .write(true)
        .open("/dev/full")
        .unwrap()
        .into()
}

/// Commands that print, in every way of printing.
const LOUD: [&[&str]; 10] = [
    &["--help"],
    &["--version"],
    &["help", "run"],
    &["completions", "bash"],
    &["verdicts", "--ranges"],
    &["plan", "a1/lateral"],
    &["plan", "a1/lateral", "--json"],
    &["plan", "--reference", "spin", "--trace"],
    &["run", "a1/moonwalk", "--json"],
    &["verify", "nowhere", "--json"],
];

#[test]
fn a_full_disk_behind_standard_output_is_exit_code_1_with_the_reason() {
    let folder = folder("full");
    for arguments in LOUD {
        let output = saltus(&folder, arguments).stdout(full()).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
        assert!(
            said.contains("standard output cannot be written: No space"),
            "{said}"
        );
        assert!(!said.contains("panicked"), "{said}");
    }
}

#[test]
fn a_reader_that_has_gone_is_exit_code_141_in_silence() {
    let folder = folder("gone");
    for arguments in LOUD {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = saltus(&folder, arguments).stdout(writer).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(141), "{arguments:?}: {said}");
        assert!(
            !said.contains("standard output") && !said.contains("panicked"),
            "{said}"
        );
    }
}

#[test]
fn standard_error_that_takes_nothing_is_no_panic() {
    let folder = folder("silent");
    for arguments in [
        ["run", "a1/moonwalk"],
        ["plan", "--seed"],
        ["verify", "nowhere"],
    ] {
        let status = saltus(&folder, &arguments).stderr(full()).status().unwrap();
        assert_eq!(status.code(), Some(1), "{arguments:?}");
    }
    let mut trace = saltus(
        &folder,
        &["plan", "--reference", "spin", "--trace", "--quiet"],
    );
    assert_eq!(trace.stderr(full()).status().unwrap().code(), Some(1));
}

/// The run is there, though nobody could read about it.
#[test]
#[ignore = "long: cargo xtask suites"]
fn work_is_not_lost_with_its_text() {
    let folder = folder("work");
    let mut run = saltus(
        &folder,
        &[
            "run",
            "a1/lateral",
            "--planner",
            "kinematics",
            "--out",
            "it",
        ],
    );
    let output = run.stdout(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(folder.join("it/result.json").exists() && folder.join("it/report.html").exists());
}

#[test]
fn targets_are_tried_before_the_work() {
    let folder = folder("targets");
    fs::write(folder.join("file"), "").unwrap();
    std::os::unix::fs::symlink("nowhere/deep", folder.join("link")).unwrap();
    let clock = Instant::now();
    for arguments in [
        &["run", "a1/lateral", "--out", "/proc/saltus"][..],
        &["run", "icub/velocity", "--out", "/proc/saltus"],
        &["run", "a1/lateral", "--out", "file/below"],
        &["plan", "a1/lateral", "--out", "/proc/saltus"],
        &["plan", "a1/lateral", "--solution", "/proc/saltus.json"],
        &["plan", "a1/lateral", "--solution", "."],
        &["plan", "--reference", "spin", "--solution", "file/below"],
        &["plan", "a1/lateral", "--solution", "link"],
        &["plan", "a1/lateral", "--solution", "new/"],
        &["plan", "a1/lateral", "--out", "it", "--solution", "it"],
        &[
            "plan",
            "a1/lateral",
            "--out",
            "it",
            "--solution",
            "it/s.json",
        ],
        &["envelope", "a1/lateral", "--out", "/proc/self"],
        &["envelope", "a1/lateral", "--out", "/proc/saltus"],
        &["reproduce", "--quick", "--out", "/proc/saltus"],
        &["verdicts", "a1/lateral", "--out", "/proc/saltus"],
        &["watch", "one", "another", "--out", "/proc/saltus"],
    ] {
        let output = saltus(&folder, arguments).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(
            said.contains(arguments.last().unwrap()),
            "{arguments:?}: {said}"
        );
    }
    // So many plans, runs and studies would take far longer.
    assert!(clock.elapsed().as_secs() < 20);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
}

/// A file's folder is made with it, as a plan's is: it was missed after the work.
#[test]
fn a_solution_may_go_into_a_new_folder() {
    let folder = folder("new");
    let plan = ["plan", "--reference", "spin", "--solution", "a/b/s.json"];
    assert!(saltus(&folder, &plan).status().unwrap().success());
    let text = fs::read_to_string(folder.join("a/b/s.json")).unwrap();
    assert!(text.starts_with('{'));
    assert_eq!(fs::read_dir(folder.join("a/b")).unwrap().count(), 1);
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn what_a_killed_process_leaves_is_removed_by_the_next() {
    let folder = folder("killed");
    let out = folder.join("out");
    let mut gone = Command::new("true").spawn().unwrap();
    gone.wait().unwrap();
    let mut host = String::new();
    File::open("/proc/sys/kernel/hostname")
        .unwrap()
        .read_to_string(&mut host)
        .unwrap();
    let old = out.join(format!(".saltus-{}", gone.id()));
    let new = out.join(format!(".saltus-{}@{}", gone.id(), host.trim()));
    let runs = out.join(format!(".saltus-{}", std::process::id()));
    for path in [&old, &new, &runs] {
        fs::create_dir_all(path.join("half")).unwrap();
    }
    let run = ["run", "a1/lateral", "--planner", "kinematics", "--quiet"];
    saltus(&folder, &run).status().unwrap();
    assert!(!old.exists() && !new.exists() && runs.exists());
    assert!(out.join("a1-lateral/result.json").exists());
}

/// A device that never ends is no file.
#[test]
fn endless_files_are_refused() {
    let folder = folder("endless");
    for arguments in [
        &["plan", "--problem", "/dev/zero"][..],
        &["verify", "/dev/zero"],
        &["import", "/dev/zero"],
        &["verdicts", "--expect", "/dev/zero"],
        &["plan", "a1/lateral", "--robot", "/dev/zero"],
    ] {
        let output = saltus(&folder, arguments).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains("64 MiB"), "{said}");
    }
}
