//! `cargo xtask mutants`: how many small changes of the source do the tests notice?
//!
//! cargo-mutants lists every change that it knows, a random sample of them is made one after the other, and each runs the unit and
//! integration tests of its own crate, up to the first that fails. A mutant that does not compile is not viable; one with which the tests fail or
//! never end is caught.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};

use crate::random::Random;
use crate::run;

/// The pinned release of cargo-mutants: another knows other mutants.
const VERSION: &str = "25.3.1";
/// What is measured when nothing is named.
const CRATES: [&str; 8] = [
    "state-est",
    "so3",
    "dense-qp",
    "landing",
    "jump-control",
    "wbc-qp",
    "jump-machine",
    "rbd-core",
];
/// Mutants of each crate, and the seed by which they are drawn: a smaller sample is a part of a larger one.
const SIZE: usize = 200;
const SEED: u64 = 22;
/// The smallest share of viable mutants that must be caught.
const LEAST: f64 = 0.85;

/// Arguments of `cargo xtask mutants`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only these crates.
    crates: Vec<String>,
    /// So many mutants of each crate.
    #[arg(long, default_value_t = SIZE)]
    size: usize,
    /// Leave out so many that an earlier run has made: a sample may be made in parts.
    #[arg(long, default_value_t = 0)]
    from: usize,
}

/// What became of the sample of one crate.
struct Outcome {
    name: String,
    listed: usize,
    drawn: usize,
    viable: usize,
    survivors: Vec<String>,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let tool = run::output(run::cargo().args(["mutants", "--version"]))?;
    if tool.stdout.trim_ascii() != format!("cargo-mutants {VERSION}").as_bytes() {
        bail!(
            "cargo-mutants {VERSION} missing: `cargo install --locked cargo-mutants --version {VERSION}`"
        );
    }
    let runner = run::output(run::cargo().args(["nextest", "--version"]))?;
    ensure!(
        runner.status.success(),
        "cargo-nextest missing: `cargo install --locked cargo-nextest`"
    );
    let named = args.crates.iter().map(String::as_str);
    let crates: Vec<&str> = if args.crates.is_empty() {
        CRATES.to_vec()
    } else {
        named.collect()
    };
    let outcomes: Vec<Outcome> = (crates.into_iter())
        .map(|name| measure(name, args).with_context(|| name.to_owned()))
        .collect::<Result<_>>()?;
    print!("{}", table(&outcomes));
    let weak: Vec<&str> = (outcomes.iter())
        .filter(|outcome| outcome.share() < LEAST)
        .map(|outcome| outcome.name.as_str())
        .collect();
    ensure!(
        weak.is_empty(),
        "less than {:.0} % caught: {}",
        100.0 * LEAST,
        weak.join(", ")
    );
    Ok(())
}

/// Makes the sample of one crate, in a copy of the repository.
fn measure(name: &str, args: &Args) -> Result<Outcome> {
    let list =
        run::stdout(run::cargo().args(["mutants", "--list", "--colors=never", "--package", name]))?;
    let listed: Vec<&str> = list.lines().collect();
    let drawn = sample(&listed, args.from, args.size)?;
    // Without a pattern cargo-mutants would make them all.
    ensure!(!drawn.is_empty(), "no mutants");
    let folder = run::root().join("target/mutants").join(name);
    run::remove_folder(&folder)?;
    fs::create_dir_all(&folder)?;
    let mut cargo = run::cargo();
    cargo.args(["mutants", "--package", name, "--output"]);
    cargo.arg(&folder);
    for mutant in &drawn {
        cargo.arg("--re").arg(exactly(mutant));
    }
    // Every copy has builds of its own: cargo tells workspaces apart by their times alone, and would take another copy's mutant for built.
    cargo.env_remove("CARGO_TARGET_DIR");
    // In builds as in tests: without them, examples would be built for every mutant.
    cargo.args(["--cargo-arg=--lib", "--cargo-arg=--test=all"]);
    // A mutant is caught by the first test that fails: libtest would run all others as well.
    cargo.args(["--profile=mutants", "--test-tool=nextest"]);
    // Tests that take three times as long as they should never end.
    cargo.arg("--timeout-multiplier=3");
    let status = cargo.status().context("cannot start cargo mutants")?;
    // 2: some survived; 3: some did not end.
    ensure!(
        matches!(status.code(), Some(0 | 2 | 3)),
        "cargo mutants ended with {status}"
    );
    let lines = |file: &str| lines(&folder.join("mutants.out").join(file));
    let survivors = lines("missed.txt")?;
    let caught = lines("caught.txt")?.len() + lines("timeout.txt")?.len();
    Ok(Outcome {
        name: name.to_owned(),
        listed: listed.len(),
        drawn: drawn.len(),
        viable: caught + survivors.len(),
        survivors,
    })
}

fn lines(path: &Path) -> Result<Vec<String>> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    Ok(text.lines().map(str::to_owned).collect())
}

/// The mutants that are drawn, out of a list with `file:line:column: change` in each line.
///
/// The draw goes by the file and the change, and by how many alike stand before it in the file. Lines that move, and mutants that come
/// or go elsewhere, do not draw others.
fn sample<'a>(listed: &[&'a str], from: usize, size: usize) -> Result<Vec<&'a str>> {
    let mut alike = BTreeMap::new();
    let mut ranked = Vec::new();
    for line in listed {
        let (place, change) = line.split_once(": ").with_context(|| (*line).to_owned())?;
        let file = place.split(':').next().unwrap_or_default();
        let before: &mut usize = alike.entry((file, change)).or_default();
        ranked.push((rank(&format!("{file}: {change}#{before}")), *line));
        *before += 1;
    }
    ranked.sort_unstable();
    Ok(ranked
        .into_iter()
        .skip(from)
        .take(size)
        .map(|(_, line)| line)
        .collect())
}

/// A random number that belongs to this text: the hash FNV-1a (Fowler, Noll, Vo), mixed with the seed.
fn rank(text: &str) -> u64 {
    let hash = text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    Random(hash ^ SEED).next()
}

/// The regular expression of this text and no other.
fn exactly(text: &str) -> String {
    let mut pattern = String::from("^");
    for c in text.chars() {
        if r"\.+*?()|[]{}^$".contains(c) {
            pattern.push('\\');
        }
        pattern.push(c);
    }
    pattern + "$"
}

impl Outcome {
    /// Caught of viable; all where there are none.
    fn share(&self) -> f64 {
        1.0 - self.survivors.len() as f64 / self.viable.max(1) as f64
    }
}

/// The outcomes as a table, and every survivor.
fn table(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "| crate | mutants | drawn | viable | caught | share |\n|---|---|---|---|---|---|\n",
    );
    for outcome in outcomes {
        text += &format!(
            "| {} | {} | {} | {} | {} | {:.1} % |\n",
            outcome.name,
            outcome.listed,
            outcome.drawn,
            outcome.viable,
            outcome.viable - outcome.survivors.len(),
            100.0 * outcome.share()
        );
    }
    let survivors = outcomes.iter().flat_map(|outcome| &outcome.survivors);
    text + &survivors
        .map(|survivor| format!("- {survivor}\n"))
        .collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::{Outcome, exactly, sample, table};

    /// Mutants as they are listed, two of them alike.
    fn listed(first_line: usize) -> Vec<String> {
        let changes = [
            "replace + with - in f",
            "replace + with * in f",
            "delete ! in f",
        ];
        (0..30)
            .map(|i| {
                format!(
                    "a/src/lib.rs:{}:7: {} {}",
                    first_line + i,
                    changes[i % 3],
                    i / 6
                )
            })
            .collect()
    }

    fn drawn(listed: &[String], size: usize) -> Vec<&str> {
        let lines: Vec<&str> = listed.iter().map(String::as_str).collect();
        sample(&lines, 0, size).unwrap_or_default()
    }

    #[test]
    fn a_smaller_sample_is_a_part_of_a_larger_one() {
        let listed = listed(1);
        let all = drawn(&listed, 100);
        assert_eq!(all.len(), 30);
        assert_eq!(drawn(&listed, 7), all[..7]);
        let lines: Vec<&str> = listed.iter().map(String::as_str).collect();
        assert_eq!(sample(&lines, 7, 5).unwrap_or_default(), all[7..12]);
        let mut sorted = all.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert!(sorted.len() == 30 && sorted != all);
    }

    #[test]
    fn moved_lines_and_other_mutants_draw_no_others() {
        let (here, mut there) = (listed(1), listed(101));
        there.push("b/src/lib.rs:1:1: replace + with - in f 0".to_owned());
        let changes = |lines: Vec<&str>| -> Vec<String> {
            let ours = lines.into_iter().filter(|line| line.starts_with('a'));
            ours.filter_map(|line| line.split_once(": ").map(|(_, change)| change.to_owned()))
                .collect()
        };
        assert_eq!(changes(drawn(&here, 31)), changes(drawn(&there, 31)));
    }

    #[test]
    fn a_list_that_cannot_be_read_is_refused() {
        assert!(sample(&["no mutant"], 0, 1).is_err());
    }

    #[test]
    fn signs_of_a_pattern_stand_for_themselves() {
        assert_eq!(
            exactly("src/a.rs:1:2: replace a -> [T; 3] with ()"),
            r"^src/a\.rs:1:2: replace a -> \[T; 3\] with \(\)$"
        );
    }

    #[test]
    fn the_table_counts_what_is_caught_of_what_is_viable() {
        let outcome = Outcome {
            name: "so3".to_owned(),
            listed: 912,
            drawn: 5,
            viable: 4,
            survivors: vec!["so3/src/quat.rs:1:1: delete ! in f".to_owned()],
        };
        let text = table(&[outcome]);
        assert!(text.contains("| so3 | 912 | 5 | 4 | 3 | 75.0 % |"));
        assert!(text.ends_with("- so3/src/quat.rs:1:1: delete ! in f\n"));
    }
}
