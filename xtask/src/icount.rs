//! `cargo xtask icount`: instructions per call of every algorithm, counted by callgrind and compared with a golden
//! file.
//!
//! The counted build is the plain release build for baseline x86-64, and only what happens inside `counted_calls` of the
//! bench is counted: the counts depend on the source, the compiler and its version, but not on the processor, its load
//! or the folder. Another compiler than the golden file's makes changes a notice instead of an error.

use core::fmt::Write as _;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread;

use anyhow::{Context, Result, bail};

use crate::bench::dynamics;
use crate::run;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Write the golden file instead of comparing with it.
    #[arg(long)]
    overwrite: bool,
}

/// Relative change that fails the check.
const TOLERANCE: f64 = 0.05;

const GOLDEN: &str = "tests/data/icount.txt";

/// Instructions per call, by `robot model algorithm`.
type Counts = BTreeMap<String, u64>;

pub(crate) fn run(args: &Args) -> Result<()> {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        bail!("instructions are counted on x86-64 Linux only");
    }
    if !run::exists("valgrind") {
        run::install_debian(&["valgrind"])?;
    }
    let target = run::root().join("target");
    let counts = measure(&dynamics::build(&target, "", dynamics::FEATURES)?)?;
    let path = run::root().join(GOLDEN);
    if args.overwrite {
        fs::write(&path, format(&counts)?).with_context(|| GOLDEN.to_owned())?;
        println!("{GOLDEN}: {} counts", counts.len());
        return Ok(());
    }
    let text = fs::read_to_string(&path).with_context(|| GOLDEN.to_owned())?;
    let changes = compare(&parse(&text)?, &counts);
    if !changes.is_empty() {
        let compiler = rustc()?;
        if !text.contains(&compiler) {
            println!(
                "{GOLDEN} is from another compiler than {compiler}, so these changes are no error:\n{}",
                changes.join("\n")
            );
            return Ok(());
        }
        bail!(
            "{}\n`cargo xtask icount --overwrite` accepts these counts",
            changes.join("\n")
        );
    }
    println!(
        "{} instruction counts are within {:.0} % of {GOLDEN}",
        counts.len(),
        TOLERANCE * 100.0
    );
    Ok(())
}

/// Counts every algorithm that the bench lists; the loop over the states is measured as `none` and subtracted.
fn measure(bench: &Path) -> Result<Counts> {
    let list = run::stdout(Command::new(bench).arg("list"))?;
    let rows: Vec<(&str, u64)> = list
        .lines()
        .map(|line| {
            let (name, states) = line.rsplit_once(' ').context("no states")?;
            Ok((name, states.parse()?))
        })
        .collect::<Result<_>>()
        .with_context(|| format!("{} list", bench.display()))?;
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let chunk = rows.len().div_ceil(workers).max(1);
    let collected: Result<Vec<Vec<(&str, u64)>>> = thread::scope(|scope| {
        let handles: Vec<_> = rows
            .chunks(chunk)
            .map(|part| {
                scope.spawn(move || {
                    part.iter()
                        .map(|(name, _)| Ok((*name, callgrind(bench, name)?)))
                        .collect()
                })
            })
            .collect();
        let join = |handle: thread::ScopedJoinHandle<'_, Result<Vec<_>>>| match handle.join() {
            Ok(counts) => counts,
            Err(_) => bail!("a counting thread panicked"),
        };
        handles.into_iter().map(join).collect()
    });
    let total: BTreeMap<&str, u64> = collected?.into_iter().flatten().collect();
    let mut counts = Counts::new();
    for (name, states) in rows {
        let (model, algorithm) = name.rsplit_once(' ').context("no algorithm")?;
        if algorithm != "none" {
            let start = total
                .get(format!("{model} none").as_str())
                .context("no `none` to subtract")?;
            let all = total.get(name).context("not counted")?;
            counts.insert(name.to_owned(), all.saturating_sub(*start) / states.max(1));
        }
    }
    Ok(counts)
}

/// Instructions of one run of the bench.
fn callgrind(bench: &Path, name: &str) -> Result<u64> {
    let output = run::output(
        Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg("--toggle-collect=*counted_calls*")
            .arg(bench)
            .arg("count")
            .args(name.split(' ')),
    )?;
    let text = String::from_utf8_lossy(&output.stderr);
    let collected = text
        .lines()
        .find_map(|line| line.split_once("Collected : "));
    match collected {
        Some((_, count)) if output.status.success() => Ok(count.trim().parse()?),
        _ => bail!("callgrind failed on {name}: {text}"),
    }
}

fn compare(golden: &Counts, counts: &Counts) -> Vec<String> {
    let mut changes = Vec::new();
    for (name, &count) in counts {
        match golden.get(name) {
            None => changes.push(format!("{name}: {count}, not in the golden file")),
            Some(&old) => {
                let change = count as f64 / old.max(1) as f64 - 1.0;
                if change.abs() > TOLERANCE {
                    changes.push(format!(
                        "{name}: {old} became {count} ({:+.1} %)",
                        change * 100.0
                    ));
                }
            }
        }
    }
    let gone = golden.keys().filter(|name| !counts.contains_key(*name));
    changes.extend(gone.map(|name| format!("{name}: in the golden file, but no longer measured")));
    changes
}

fn rustc() -> Result<String> {
    Ok(run::stdout(Command::new("rustc").arg("--version"))?
        .trim()
        .to_owned())
}

fn format(counts: &Counts) -> Result<String> {
    let mut text = String::from(
        "# Instructions per call in f64, counted by callgrind in the release build for baseline x86-64.\n\
         # Written by `cargo xtask icount --overwrite`; compared by `cargo xtask icount`.\n",
    );
    writeln!(text, "# {}", rustc()?)?;
    for (name, count) in counts {
        writeln!(text, "{name} {count}")?;
    }
    Ok(text)
}

fn parse(text: &str) -> Result<Counts> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| {
            let (name, count) = line
                .rsplit_once(' ')
                .with_context(|| format!("{GOLDEN}: `{line}`"))?;
            Ok((name.to_owned(), count.parse()?))
        })
        .collect()
}
