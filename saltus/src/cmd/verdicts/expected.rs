//! The file of expected verdicts: which task ends how in which simulator. A jump that ends otherwise, better or worse, is a change that
//! somebody has to look at and write down.

use super::subject::Cell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Task, then simulator, then what fails first, or `target`.
type Table = BTreeMap<String, BTreeMap<String, String>>;

/// The file.
pub(super) struct Expected {
    path: PathBuf,
    table: Table,
}

impl Expected {
    /// Reads the file; tasks that are files are seen from it.
    pub(super) fn read(path: &Path) -> Result<Self, String> {
        let show = |error: &dyn core::fmt::Display| format!("{}: {error}", path.display());
        let text = std::fs::read_to_string(path).map_err(|error| show(&error))?;
        let table: Table = toml::from_str(&text).map_err(|error| show(&error))?;
        Ok(Self {
            path: path.to_owned(),
            table,
        })
    }

    /// The tasks as they are run.
    pub(super) fn tasks(&self) -> Vec<String> {
        self.table.keys().map(|name| self.seen(name)).collect()
    }

    /// A task that is a file, from where the program runs.
    fn seen(&self, name: &str) -> String {
        if !name.ends_with(".toml") {
            return name.to_owned();
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        folder.join(name).display().to_string()
    }

    /// Names every verdict that is not as expected. A simulator that this build does not have is not compared, and that is said.
    pub(super) fn compare(&self, cells: &[Cell]) -> Result<ExitCode, String> {
        let mut wrong = Vec::new();
        let mut skipped = 0;
        for (name, sims) in &self.table {
            for (sim, expected) in sims {
                let task = self.seen(name);
                let cell = cells.iter().find(|cell| cell.task == task && cell.sim.name() == sim);
                match cell {
                    Some(cell) if cell.outcome() == expected => {}
                    Some(cell) => wrong.push(format!(
                        "{name} in {sim}: {expected} is expected, found {}",
                        cell.words()
                    )),
                    None => skipped += 1,
                }
            }
        }
        for line in &wrong {
            eprintln!("saltus: {line}");
        }
        if skipped > 0 {
            eprintln!("saltus: {skipped} verdicts of {} were not compared: their simulator was not run", self.path.display());
        }
        Ok(ExitCode::from(if wrong.is_empty() { 0 } else { 2 }))
    }
}
