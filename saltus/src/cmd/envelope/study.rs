//! One study: many runs of one plan, each disturbed otherwise.
//!
//! Sample i of seed S is the same run on every machine, whatever the shard. Every finished sample is one line in the shard's
//! file, so a run that was stopped goes on where it was, and the files of all shards in one folder make one table.

use super::picture::picture;
use crate::cmd::failure::Failure;
use crate::cmd::folder::{describe, write};
use crate::cmd::interrupt;
use indicatif::ProgressBar;
use jump_lab::Sim;
use jump_lab::lab::{Interface, PlantArgument};
use jump_lab::quadruped::envelope::{Sample, table, trial};
use jump_lab::quadruped::execute;
use jump_lab::quadruped::judge::Judged;
use jump_lab::quadruped::measure::Measure;
use jump_planner::NoPlan;
use jump_planner::planned::Planner;
use jump_planner::reference::Reference;
use jump_planner::task::Task;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use serde_json::{Value, json};
use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// File of a study's folder that says what it is.
const MANIFEST: &str = "manifest.json";
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Part of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shard {
    part: u64,
    of: u64,
}

/// Reads k/n.
pub(super) fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text
        .split_once('/')
        .and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    match numbers {
        Some((part, of)) if 1 <= part && part <= of => Ok(Shard { part, of }),
        _ => Err(format!("{text} is not a shard: write k/n with 1 <= k <= n")),
    }
}

/// What is studied.
#[derive(Clone)]
pub(super) struct Study<'a> {
    pub(super) task: &'a Task,
    pub(super) planner: Planner,
    pub(super) sim: Sim,
    /// Runs over all shards.
    pub(super) samples: u64,
    pub(super) seed: u64,
    /// What differs from the plan in every run; the lab of the run's seed where nothing is said.
    pub(super) plant: Option<PlantArgument>,
    pub(super) interface: Interface,
    pub(super) shard: Shard,
    /// Measures that planner and controller do without.
    pub(super) without: Vec<Measure>,
    pub(super) folder: PathBuf,
}

impl Study<'_> {
    /// The first line of its files: files of another study are told by it.
    fn title(&self) -> String {
        let mut title = format!(
            "# task {} content {} sim {} samples {} seed {}",
            self.task.name,
            self.content(),
            self.sim.name(),
            self.samples,
            self.seed
        );
        if self.planner != Planner::WholeBody {
            title += " planner ";
            title += self.planner.name();
        }
        if let Some(plant) = &self.plant {
            title += &format!(" plant {plant}");
        }
        if self.interface != Interface::Torque {
            title += &format!(" interface {}", self.interface);
        }
        if !self.without.is_empty() {
            title += " without ";
            title += &names(&self.without);
        }
        title
    }

    /// What tells the task from another of its name: a task file, or its robot's, may have been changed since.
    fn content(&self) -> String {
        format!("{:08x}", self.task.digest())
    }

    /// Fails where the folder holds something else.
    pub(super) fn refuse_strangers(&self) -> Result<(), String> {
        refuse_strangers(&self.folder, "shard-")?;
        self.refuse_versions()?;
        self.merge().map(|_| ())
    }

    /// Fails where another version of the program began the study: its samples may be others.
    fn refuse_versions(&self) -> Result<(), String> {
        let path = self.folder.join(MANIFEST);
        let Ok(text) = fs::read_to_string(&path) else {
            return Ok(());
        };
        let manifest: Value =
            serde_json::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))?;
        let version = &manifest["version"];
        if *version == VERSION {
            return Ok(());
        }
        Err(format!(
            "{}: saltus {version} began this study, and this is {VERSION}: choose another --out",
            path.display()
        ))
    }

    /// What the folder's samples are of; all shards write the same but the command.
    fn manifest(&self) -> Value {
        let without: Vec<_> = self.without.iter().map(|measure| measure.name()).collect();
        let plant = self.plant.as_ref();
        json!({
            "version": VERSION,
            "command": std::env::args().collect::<Vec<_>>(),
            "task": self.task.name,
            "content": self.content(),
            "sim": self.sim.name(),
            "planner": self.planner.name(),
            "samples": self.samples,
            "seed": self.seed,
            "plant": plant.map_or_else(|| "lab".to_owned(), ToString::to_string),
            "interface": self.interface.to_string(),
            "without": without,
        })
    }

    /// The plan that is executed.
    pub(super) fn plan(&self) -> Result<Reference, NoPlan> {
        Measure::plan(self.task, self.planner, &self.without)
    }

    /// Runs what is missing, until Ctrl-C, and writes table and picture; the samples of all shards.
    pub(super) fn run(
        &self,
        reference: &Reference,
        bar: &ProgressBar,
    ) -> Result<Vec<Sample>, Failure> {
        let outside = |path: &Path, e: &std::io::Error| Failure::Outside(describe(path, e));
        fs::create_dir_all(&self.folder).map_err(|e| outside(&self.folder, &e))?;
        if !self.folder.join(MANIFEST).exists() {
            let text = format!("{:#}\n", self.manifest());
            write(&self.folder, MANIFEST, text.as_bytes())?;
        }
        let Shard { part, of } = self.shard;
        let path = self.folder.join(format!("shard-{part}-of-{of}.csv"));
        let done: HashSet<u64> = self.read(&path)?.iter().map(|s| s.index).collect();
        let todo: Vec<u64> = (0..self.samples)
            .filter(|i| i % of == part - 1 && !done.contains(i))
            .collect();
        let file = Mutex::new(self.open(&path).map_err(|e| outside(&path, &e))?);
        bar.set_length(todo.len() as u64);
        bar.set_position(0);
        todo.par_iter().try_for_each(|index| {
            if interrupt::asked() {
                return Ok(());
            }
            let sample = self.sample(reference, *index)?;
            // One write per line: what is there is whole.
            let line = format!("{}\n", sample.line());
            let mut file = file.lock().map_err(|e| e.to_string())?;
            file.write_all(line.as_bytes())
                .map_err(|e| outside(&path, &e))?;
            bar.inc(1);
            Ok::<_, Failure>(())
        })?;
        let samples = self.merge()?;
        write(&self.folder, "table.csv", table(&samples).as_bytes())?;
        let picture = picture(&samples, &self.title());
        write(&self.folder, "picture.svg", picture.as_bytes())?;
        Ok(samples)
    }

    fn sample(&self, reference: &Reference, index: u64) -> Result<Sample, String> {
        let trial = trial(
            (self.seed, index),
            self.plant.as_ref(),
            (self.sim, self.interface),
            &self.without,
        );
        let run = execute::run_watched(self.task, reference, trial, |_, _| {}, |_, _| {}, |_| {})?;
        Ok(Sample::new(
            index,
            &trial,
            &Judged::of(self.task, reference, &run),
        ))
    }

    /// The shard's file, at its end.
    fn open(&self, path: &Path) -> std::io::Result<File> {
        let mut file = OpenOptions::new().create(true).append(true).open(path)?;
        if file.metadata()?.len() == 0 {
            writeln!(file, "{}\n{}", self.title(), Sample::header())?;
        }
        // A line that was cut by a stop must not swallow the next.
        if fs::read(path)?.last().is_some_and(|b| *b != b'\n') {
            writeln!(file)?;
        }
        Ok(file)
    }

    /// The samples of one file; none if it is not there. A file of another study is refused.
    fn read(&self, path: &Path) -> Result<Vec<Sample>, String> {
        let Ok(text) = fs::read_to_string(path) else {
            return Ok(Vec::new());
        };
        match text.lines().next() {
            None => Ok(Vec::new()),
            Some(first) if first == self.title() => {
                // A line that was cut by a stop is run again.
                Ok(text.lines().filter_map(Sample::parse).collect())
            }
            Some(_) => Err(format!(
                "{} belongs to another study: choose another --out, nothing is overwritten",
                path.display()
            )),
        }
    }

    /// The samples of all shards in the folder, in order, each once; none if it is not there.
    fn merge(&self) -> Result<Vec<Sample>, String> {
        let mut samples = Vec::new();
        let entries = match fs::read_dir(&self.folder) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(samples),
            entries => entries.map_err(|error| describe(&self.folder, &error))?,
        };
        for entry in entries {
            let path = entry.map_err(|e| e.to_string())?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if name.starts_with("shard-") && name.ends_with(".csv") {
                samples.extend(self.read(&path)?);
            }
        }
        samples.sort_by_key(|sample| sample.index);
        samples.dedup_by_key(|sample| sample.index);
        Ok(samples)
    }
}

/// Measures as a list: `weighing,posture`.
pub(super) fn names(measures: &[Measure]) -> String {
    let names: Vec<&str> = measures.iter().map(|measure| measure.name()).collect();
    names.join(",")
}

/// A folder that is there already must be empty, or hold what begins with `ours`.
pub(super) fn refuse_strangers(folder: &Path, ours: &str) -> Result<(), String> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Ok(());
    };
    let names: Vec<_> = entries.flatten().map(|entry| entry.file_name()).collect();
    let is_ours = |name: &std::ffi::OsString| name.to_string_lossy().starts_with(ours);
    if names.is_empty() || names.iter().any(is_ours) {
        return Ok(());
    }
    Err(format!(
        "{} holds something else than a study: choose another --out, nothing is overwritten",
        folder.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::{Shard, shard};

    #[test]
    fn shards_are_read_and_nonsense_is_refused() {
        assert_eq!(shard("2/5"), Ok(Shard { part: 2, of: 5 }));
        for bad in ["0/5", "6/5", "1", "a/b", "1/0", ""] {
            assert!(shard(bad).is_err(), "{bad}");
        }
    }
}
