//! `saltus envelope`: how often a jump succeeds, over what may differ from the plan.
//!
//! Sample i of seed S is the same run on every machine, whatever the shard. Every finished sample is one line in the shard's
//! file, so a run that was stopped goes on where it was, and the files of all shards in one folder make one table.

use super::folder::describe;
use super::interrupt;
use super::output::Output;
use crate::jump::envelope::{Sample, picture, table};
use crate::jump::execute;
use crate::jump::judge::Verdict;
use crate::jump::planned::Planner;
use crate::jump::plant::{Disturbance, Sim};
use crate::jump::task::Task;
use serde_json::json;
use std::collections::HashSet;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Options of `saltus envelope`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Task, such as a1/lateral.
    task: String,
    /// Number of runs over all shards.
    #[arg(long, default_value_t = 100, allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(1..))]
    samples: u64,
    /// Seed of the whole study.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Simulator.
    #[arg(long, default_value = "native")]
    sim: Sim,
    /// Part k of n, from 1/n to n/n; every part may run on a machine of its own.
    #[arg(long, default_value = "1/1", value_parser = shard)]
    shard: Shard,
    /// Folder of the study; by default out/envelope-TASK. A study that is there already goes on.
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Part of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shard {
    part: u64,
    of: u64,
}

fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text
        .split_once('/')
        .and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    match numbers {
        Some((part, of)) if 1 <= part && part <= of => Ok(Shard { part, of }),
        _ => Err(format!("{text} is not a shard: write k/n with 1 <= k <= n")),
    }
}

/// Runs the command. Exit code 0 when the study or its shard is complete; Ctrl-C leaves the table of the samples so far.
pub(crate) fn run(args: &Args) -> Result<ExitCode, String> {
    let task = Task::load(&args.task)?;
    let folder = args.out.clone().unwrap_or_else(|| {
        Path::new("out").join(format!("envelope-{}", task.name.replace('/', "-")))
    });
    let study = format!(
        "# task {} sim {} samples {} seed {}",
        task.name,
        args.sim.name(),
        args.samples,
        args.seed
    );
    refuse_strangers(&folder)?;
    merge(&folder, &study)?;
    interrupt::listen()?;
    let bar = args
        .output
        .bar(0, "{msg}{pos}/{len} [{bar:40}] {elapsed}, {eta} left")?;
    bar.set_message("planning ");
    let plan = task.solve()?;
    let reference = Planner::WholeBody.plan(&task, &plan)?;
    bar.set_message("");
    fs::create_dir_all(&folder).map_err(|e| describe(&folder, &e))?;
    let path = folder.join(format!(
        "shard-{}-of-{}.csv",
        args.shard.part, args.shard.of
    ));
    let done: HashSet<u64> = read(&path, &study)?.iter().map(|s| s.index).collect();
    let todo: Vec<u64> = (0..args.samples)
        .filter(|i| i % args.shard.of == args.shard.part - 1 && !done.contains(i))
        .collect();
    let mut file = OpenOptions::new()
        .create(true)
        .append(true)
        .open(&path)
        .map_err(|e| describe(&path, &e))?;
    if file.metadata().map_err(|e| describe(&path, &e))?.len() == 0 {
        writeln!(file, "{study}\n{}", Sample::HEADER).map_err(|e| describe(&path, &e))?;
    }

    // A line that was cut by a stop must not swallow the next.
    if fs::read(&path).is_ok_and(|bytes| bytes.last().is_some_and(|b| *b != b'\n')) {
        writeln!(file).map_err(|e| describe(&path, &e))?;
    }

    bar.set_length(todo.len() as u64);
    let next = AtomicUsize::new(0);
    let file = Mutex::new(file);
    let work = || -> Result<(), String> {
        while let Some(index) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
            if interrupt::asked() {
                return Ok(());
            }
            // Seed 0 would be the nominal run.
            let seed = crate::noise::mix(args.seed, *index).max(1);
            let run = execute::run(&task, &reference, args.sim, seed, |_, _| {})?;
            let verdict = Verdict::of(&task, &run);
            let sample = Sample::new(*index, seed, &Disturbance::draw(seed), &run, &verdict);
            // One write per line: what is there is whole.
            let line = format!("{}\n", sample.line());
            let mut file = file.lock().map_err(|e| e.to_string())?;
            file.write_all(line.as_bytes())
                .map_err(|e| describe(&path, &e))?;
            bar.inc(1);
        }
        Ok(())
    };
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .try_for_each(|worker| match worker.join() {
                Ok(result) => result,
                Err(_) => Err("a worker panicked".to_owned()),
            })
    })?;
    bar.finish_and_clear();

    let samples = merge(&folder, &study)?;
    let text = table(&samples);
    for (name, content) in [
        ("table.csv", &text),
        ("picture.svg", &picture(&samples, &study)),
    ] {
        let path = folder.join(name);
        fs::write(&path, content).map_err(|e| describe(&path, &e))?;
    }
    let complete = !interrupt::asked();
    if args.output.json {
        let on_target = samples.iter().filter(|sample| sample.good()).count();
        let report = json!({
            "task": task.name,
            "sim": args.sim.name(),
            "seed": args.seed,
            "samples": args.samples,
            "done": samples.len(),
            "on_target": on_target,
            "complete": complete,
            "folder": folder,
        });
        println!("{report}");
    } else if !args.output.quiet {
        print!("{text}");
        println!(
            "{} of {} samples in {}",
            samples.len(),
            args.samples,
            folder.display()
        );
    }
    Ok(if complete {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(interrupt::CODE)
    })
}

/// A folder that is there already must be a study's, or empty.
fn refuse_strangers(folder: &Path) -> Result<(), String> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Ok(());
    };
    let names: Vec<_> = entries.flatten().map(|entry| entry.file_name()).collect();
    let is_shard = |name: &std::ffi::OsString| name.to_string_lossy().starts_with("shard-");
    if names.is_empty() || names.iter().any(is_shard) {
        return Ok(());
    }
    Err(format!(
        "{} holds something else than a study: choose another --out, nothing is overwritten",
        folder.display()
    ))
}

/// The samples of one file; none if it is not there. A file of another study is refused.
fn read(path: &Path, study: &str) -> Result<Vec<Sample>, String> {
    let Ok(text) = fs::read_to_string(path) else {
        return Ok(Vec::new());
    };
    match text.lines().next() {
        None => Ok(Vec::new()),
        Some(first) if first == study => {
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
fn merge(folder: &Path, study: &str) -> Result<Vec<Sample>, String> {
    let mut samples = Vec::new();
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(samples),
        entries => entries.map_err(|error| describe(folder, &error))?,
    };
    for entry in entries {
        let path = entry.map_err(|e| e.to_string())?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("shard-") && name.ends_with(".csv") {
            samples.extend(read(&path, study)?);
        }
    }
    samples.sort_by_key(|sample| sample.index);
    samples.dedup_by_key(|sample| sample.index);
    Ok(samples)
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
