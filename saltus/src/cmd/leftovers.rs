//! Results that are not complete yet have a name that tells who makes them, so that what a killed process leaves is found and removed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const PREFIX: &str = ".saltus-";

/// Where this process makes what will appear in `parent`.
pub(crate) fn unfinished(parent: &Path) -> PathBuf {
    parent.join(format!("{PREFIX}{}@{}", std::process::id(), host()))
}

/// Removes what processes of this machine that are gone have left in `parent`. Best effort: it is in nobody's way.
pub(crate) fn remove(parent: &Path) {
    let entries = fs::read_dir(parent).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    for name in names.filter(|name| is_abandoned(name)) {
        let path = parent.join(name);
        let _ = fs::remove_dir_all(&path).or_else(|_| fs::remove_file(&path));
    }
}

/// Whether this is the name of an unfinished result of a process that is gone. Processes of other machines, which may share the folder,
/// are not known here.
fn is_abandoned(name: &str) -> bool {
    let Some(owner) = name.strip_prefix(PREFIX) else {
        return false;
    };
    // Earlier versions did not name the machine.
    let here = host();
    let (process, machine) = owner.split_once('@').unwrap_or((owner, &here));
    machine == here
        && process
            .parse()
            .is_ok_and(|process: u32| !is_running(process))
}

/// Whether a process runs; where that cannot be told, it does.
fn is_running(process: u32) -> bool {
    if Path::new("/proc/self").exists() {
        return Path::new("/proc").join(process.to_string()).exists();
    }
    let mut ps = Command::new("ps");
    ps.args(["-p", &process.to_string()]).stdout(Stdio::null());
    ps.status().map_or(true, |status| status.success())
}

/// Name of this machine, or container: what numbers its processes.
fn host() -> String {
    let kernel = fs::read_to_string("/proc/sys/kernel/hostname");
    let name = kernel
        .or_else(|_| std::env::var("HOSTNAME"))
        .unwrap_or_default();
    name.chars()
        .filter(|c| c.is_ascii_alphanumeric() || *c == '-')
        .collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{host, is_abandoned, remove, unfinished};
    use std::fs;
    use std::process::Command;

    #[test]
    fn only_what_processes_that_are_gone_have_left_is_removed() {
        let root = std::env::temp_dir().join(format!("saltus-leftovers-{}", std::process::id()));
        let mut gone = Command::new("true").spawn().unwrap();
        gone.wait().unwrap();
        let ours = unfinished(&root);
        fs::create_dir_all(&ours).unwrap();
        let foreign = root.join(format!(".saltus-{}@another-{}", gone.id(), host()));
        fs::create_dir_all(&foreign).unwrap();
        for name in [
            format!(".saltus-{}", gone.id()),
            format!(".saltus-{}@{}", gone.id(), host()),
        ] {
            assert!(is_abandoned(&name));
            fs::create_dir_all(root.join(&name).join("in")).unwrap();
        }
        fs::write(root.join(".saltus-notes"), "mine").unwrap();
        remove(&root);
        assert!(ours.exists() && foreign.exists() && root.join(".saltus-notes").exists());
        assert_eq!(fs::read_dir(&root).unwrap().count(), 3);
        fs::remove_dir_all(&root).unwrap();
    }
}
