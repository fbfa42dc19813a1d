//! `cargo xtask bench dynamics`: rbd-core beside Pinocchio and CasADi-generated C, in one run.
//!
//! Every program times every algorithm for a few milliseconds, one program after the other, round after round. The
//! ratio of each round compares times taken within seconds of each other; the table shows the median over the rounds.

use std::collections::BTreeMap;
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::run;

/// Arguments of `cargo xtask bench dynamics`.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Rounds over all programs.
    #[arg(long, default_value_t = 9)]
    pub(super) rounds: usize,
    /// Milliseconds of CPU time per algorithm, program and round.
    #[arg(long, default_value_t = 10)]
    pub(super) milliseconds: u32,
    /// Fail if a ratio is above its limit.
    #[arg(long)]
    pub(super) check: bool,
}

/// Compiler flags of our native build: a processor with vectors of 256 bits. For one of 512 bits, which `native` may be, LLVM
/// gathers and scatters what limbs abreast read and write one by one. Peers are built for `native`, which for
/// most of their algorithms is as quick or quicker; for their contact dynamics it is slower by about a tenth.
const NATIVE: &str = "-C target-cpu=x86-64-v3";

/// Its features: peers fuse multiplications and additions, and so do we on a host that wants speed.
const NATIVE_FEATURES: &str = "bench,fused";

/// The feature without which the bench is not built.
pub(crate) const FEATURES: &str = "bench";

/// Pinocchio's names of one algorithm, when there are several conventions: the fastest is the peer.
const PINOCCHIO_BEST: [(&str, &[&str]); 2] = [
    ("crba", &["crba", "crba_local"]),
    ("aba", &["aba", "aba_world"]),
];

/// Algorithms whose limits are the strictest.
const CORE: [&str; 4] = ["rnea", "crba", "aba", "centroidal_map"];

/// Largest ratio to Pinocchio that the project allows itself.
fn limit(robot: &str, model: &str, algorithm: &str) -> f64 {
    match (model, CORE.contains(&algorithm), robot) {
        ("const", true, "a1") => 0.35,
        ("const", true, _) => 0.45,
        ("const", ..) => 0.5,
        _ => 0.6,
    }
}

pub(super) fn run(args: &Args) -> Result<()> {
    let Args {
        rounds,
        milliseconds,
        check,
    } = *args;
    if !cfg!(target_os = "linux") {
        bail!("the peers are built on Linux only");
    }
    let directory = env::var_os("SALTUS_PEERS_DIR")
        .map_or_else(|| run::root().join("target/peers"), PathBuf::from);
    run::succeed(
        Command::new("bash")
            .arg(run::root().join("tests/peers/setup.sh"))
            .arg("bench"),
    )?;
    let programs = programs(&directory)?;
    let mut table = Table::default();
    for round in 0..rounds.max(1) {
        eprint!("\rround {} of {rounds}", round + 1);
        let mut times = Times::default();
        for program in &programs {
            let text = run::stdout(
                program
                    .command(milliseconds, &directory)
                    .current_dir(run::root()),
            )?;
            times.read(&text)?;
        }
        table.add(&times);
    }
    eprintln!();
    table.print();
    let over = table.over();
    for line in &over {
        println!("above its limit: {line}");
    }
    if check && !over.is_empty() {
        bail!("{} ratios above their limits", over.len());
    }
    Ok(())
}

/// One program of the comparison and its arguments.
struct Program {
    path: PathBuf,
    tag: &'static str,
    /// Robots of a C++ peer; ours knows its own.
    robots: &'static [&'static str],
}

impl Program {
    fn command(&self, milliseconds: u32, directory: &Path) -> Command {
        let mut command = Command::new(&self.path);
        if self.robots.is_empty() {
            command
                .args(["time", self.tag, &milliseconds.to_string()])
                .arg(directory);
        } else {
            command.args([self.tag, &milliseconds.to_string()]);
            let shown = directory.display();
            command.args(self.robots.iter().map(|robot| format!("{robot}={shown}")));
        }
        command
    }
}

fn programs(directory: &Path) -> Result<[Program; 5]> {
    let peer = |name: &str| directory.join(name);
    Ok([
        Program {
            path: build(&directory.join("ours/native"), NATIVE, NATIVE_FEATURES)?,
            tag: "native",
            robots: &[],
        },
        Program {
            path: peer("pinocchio"),
            tag: "pinocchio",
            robots: &["a1", "icub23"],
        },
        Program {
            path: peer("casadi-a1"),
            tag: "casadi",
            robots: &["a1"],
        },
        Program {
            path: peer("casadi-icub23"),
            tag: "casadi",
            robots: &["icub23"],
        },
        Program {
            path: build(&directory.join("ours/baseline"), "", FEATURES)?,
            tag: "baseline",
            robots: &[],
        },
    ])
}

/// Builds our bench into a target folder, with the given features and compiler flags, and with no flags that are around.
pub(crate) fn build(target: &Path, flags: &str, features: &str) -> Result<PathBuf> {
    run::succeed(
        run::cargo()
            .args([
                "build",
                "--release",
                "--quiet",
                "--package",
                "saltus-tests",
                "--bin",
                "bench-dynamics",
                "--features",
                features,
            ])
            .arg("--target-dir")
            .arg(target)
            .env_remove("CARGO_ENCODED_RUSTFLAGS")
            .env_remove(run::LTO)
            .env("RUSTFLAGS", flags),
    )?;
    Ok(target.join("release/bench-dynamics"))
}

/// ns by robot, algorithm and tag, of one round.
#[derive(Default)]
struct Times(BTreeMap<(String, String, String), f64>);

impl Times {
    /// Reads lines `robot,algorithm,ns,batches,tag`.
    fn read(&mut self, text: &str) -> Result<()> {
        for line in text.lines() {
            let fields: Vec<&str> = line.split(',').collect();
            let [robot, algorithm, ns, _, tag] = fields[..] else {
                bail!("a bench printed `{line}`");
            };
            let ns = ns
                .parse()
                .with_context(|| format!("a bench printed `{line}`"))?;
            self.0
                .insert((robot.to_owned(), algorithm.to_owned(), tag.to_owned()), ns);
        }
        Ok(())
    }

    fn get(&self, robot: &str, algorithm: &str, tag: &str) -> Option<f64> {
        let best = PINOCCHIO_BEST
            .iter()
            .find(|(name, _)| tag == "pinocchio" && *name == algorithm);
        let names = best.map_or(core::slice::from_ref(&algorithm), |(_, names)| names);
        let times = names
            .iter()
            .map(|name| (robot.to_owned(), (*name).to_owned(), tag.to_owned()));
        times
            .filter_map(|key| self.0.get(&key).copied())
            .min_by(f64::total_cmp)
    }
}

/// Rows of the table, in the order in which our bench lists them: samples over the rounds.
#[derive(Default)]
struct Table(Vec<Row>);

struct Row {
    robot: String,
    algorithm: String,
    /// Pinocchio, CasADi, const native, run-time native, const baseline: ns.
    times: [Vec<f64>; 5],
    /// Const and run-time over Pinocchio, const over CasADi, const baseline over Pinocchio.
    ratios: [Vec<f64>; 4],
}

const TAGS: [&str; 5] = [
    "pinocchio",
    "casadi",
    "native-const",
    "native-run-time",
    "baseline-const",
];

impl Table {
    fn add(&mut self, times: &Times) {
        for (robot, algorithm, _) in times.0.keys().filter(|key| key.2 == TAGS[2]) {
            let known = self
                .0
                .iter()
                .position(|row| row.robot == *robot && row.algorithm == *algorithm);
            let index = known.unwrap_or_else(|| {
                let (robot, algorithm) = (robot.clone(), algorithm.clone());
                self.0.push(Row {
                    robot,
                    algorithm,
                    times: Default::default(),
                    ratios: Default::default(),
                });
                self.0.len() - 1
            });
            let row = &mut self.0[index];
            let now = TAGS.map(|tag| times.get(robot, algorithm, tag));
            for (samples, ns) in row.times.iter_mut().zip(now) {
                samples.extend(ns);
            }
            let over = |a: Option<f64>, b: Option<f64>| Some(a? / b?);
            let ratios = [
                over(now[2], now[0]),
                over(now[3], now[0]),
                over(now[2], now[1]),
                over(now[4], now[0]),
            ];
            for (samples, ratio) in row.ratios.iter_mut().zip(ratios) {
                samples.extend(ratio);
            }
        }
    }

    fn print(&self) {
        println!(
            "ns per call, median; ratios are medians of the ratios of each round; `!` is above the limit"
        );
        let head = [
            "Pinocchio",
            "CasADi",
            "const",
            "run-time",
            "const x86-64",
            "const/Pin",
            "limit",
            "run-time/Pin",
            "limit",
            "const/CasADi",
            "x86-64/Pin",
        ];
        println!("| robot | algorithm | {} |", head.join(" | "));
        println!("|---|---|{}", "---|".repeat(head.len()));
        for row in &self.0 {
            let ns = |k: usize| {
                median(&row.times[k]).map_or_else(|| "–".to_owned(), |x| format!("{x:.0}"))
            };
            let ratio = |k: usize| {
                median(&row.ratios[k]).map_or_else(|| "–".to_owned(), |x| format!("{x:.2}"))
            };
            let limited = |k: usize, model: &str| {
                let limit = limit(&row.robot, model, &row.algorithm);
                let mark = if median(&row.ratios[k]).is_some_and(|x| x > limit) {
                    "!"
                } else {
                    ""
                };
                format!("{}{mark} | {limit}", ratio(k))
            };
            println!(
                "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
                row.robot,
                row.algorithm,
                ns(0),
                ns(1),
                ns(2),
                ns(3),
                ns(4),
                limited(0, "const"),
                limited(1, "run-time"),
                ratio(2),
                ratio(3),
            );
        }
    }

    fn over(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for row in &self.0 {
            for (k, model) in [(0, "const"), (1, "run-time")] {
                let limit = limit(&row.robot, model, &row.algorithm);
                if let Some(x) = median(&row.ratios[k]).filter(|x| *x > limit) {
                    lines.push(format!(
                        "{} {model} {}: {x:.2} > {limit}",
                        row.robot, row.algorithm
                    ));
                }
            }
        }
        lines
    }
}

fn median(samples: &[f64]) -> Option<f64> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}
