//! The folder of a run, and why one is none.

use crate::cmd::failure::Failure;
use crate::cmd::folder::describe;
use crate::report;
use crate::report::data::Run;
use core::fmt;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The page of a run in its folder.
pub(super) const REPORT: &str = "report.html";
/// Largest page that is read, bytes: fifty times one of `saltus run`.
const LARGEST: u64 = 200_000_000;

/// Files by which folders of other commands are known: what they are, and what to do.
const OTHERS: [(&str, &str, &str); 5] = [
    (
        "plan.bin",
        "is a plan and no run",
        "fly it first with `saltus run` and its plan.bin",
    ),
    (
        "comparison.html",
        "is a comparison and no run",
        "open its comparison.html, or give the runs",
    ),
    (
        "reproduce.json",
        "is a reproduction of both papers",
        "open its index.html",
    ),
    (
        "gallery.json",
        "is a gallery of many runs",
        "open its index.html, or give folders in it",
    ),
    (
        "table.csv",
        "is a study of `saltus envelope`, which keeps no runs",
        "run one of its seeds with `saltus run --seed`",
    ),
];

/// Why a folder is not a run that can be watched.
#[derive(Debug)]
pub(super) enum NoRun {
    /// It cannot be read: not there, or no folder.
    Unreadable(String),
    /// It is of another command: what it is, and what to do.
    Other(PathBuf, &'static str, &'static str),
    /// It has no report.
    Empty(PathBuf),
    /// Its report is not whole: what is wrong with it.
    Damaged(PathBuf, String),
}

impl fmt::Display for NoRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(why) => f.write_str(why),
            Self::Other(path, what, remedy) => write!(f, "{} {what}: {remedy}", path.display()),
            Self::Empty(path) => write!(
                f,
                "{} has no {REPORT}: give a folder that `saltus run` wrote",
                path.display()
            ),
            Self::Damaged(path, why) => write!(f, "{} {why}", path.display()),
        }
    }
}

impl From<NoRun> for Failure {
    fn from(error: NoRun) -> Self {
        Self::Refused(error.to_string())
    }
}

/// Reads the run in a folder.
pub(super) fn read(folder: &Path) -> Result<Run, NoRun> {
    let unreadable = |path: &Path, error: &std::io::Error| NoRun::Unreadable(describe(path, error));
    let there = fs::metadata(folder).map_err(|error| unreadable(folder, &error))?;
    if !there.is_dir() {
        let parent = folder.parent().unwrap_or(folder);
        return Err(NoRun::Unreadable(format!(
            "{} is a file: give the folder that `saltus run` wrote, such as {}",
            folder.display(),
            parent.display()
        )));
    }
    let path = folder.join(REPORT);
    let size = match fs::metadata(&path) {
        Ok(file) => file.len(),
        Err(error) if error.kind() == ErrorKind::NotFound => return Err(other(folder)),
        Err(error) => return Err(unreadable(&path, &error)),
    };
    let damaged = |why: String| NoRun::Damaged(path.clone(), why);
    if size > LARGEST {
        return Err(damaged(format!(
            "has {size} bytes, no report has: run the task again"
        )));
    }
    let bytes = fs::read(&path).map_err(|error| unreadable(&path, &error))?;
    let text = String::from_utf8(bytes)
        .map_err(|_| damaged("is not text: run the task again".to_owned()))?;
    let run = report::read(&text).map_err(damaged)?;
    if run.result.is_null() {
        let why = "has no result of a run: give a folder that `saltus run` wrote";
        return Err(NoRun::Damaged(path, why.to_owned()));
    }
    Ok(run)
}

/// What a folder without a report is.
fn other(folder: &Path) -> NoRun {
    let found = OTHERS.iter().find(|(file, ..)| folder.join(file).exists());
    match found {
        Some((_, what, remedy)) => NoRun::Other(folder.to_owned(), what, remedy),
        None => NoRun::Empty(folder.to_owned()),
    }
}
