//! `cargo xtask qemu`: the image computes on a board what the host computes, bit for bit.

use core::time::Duration;
use std::path::Path;

use anyhow::{Context, Result, ensure};

use crate::bare::Bare;
use crate::board::{Board, Selection};
use crate::image::Image;
use crate::probe::{self, Call};
use crate::run;

/// Every instruction takes 2^6 ns of virtual time: more than one SysTick period, so that none is lost in the count.
const ICOUNT: &str = "shift=6,align=off,sleep=off";

/// A run takes seconds; a board that hangs is stopped.
const LIMIT: Duration = Duration::from_secs(300);

/// Arguments of cargo for what is over in a second on the host and takes two minutes to optimise; its bits are the same at every level.
const UNOPTIMISED: [&str; 2] = ["--config", "profile.host.package.saltus-probe.opt-level=0"];

/// Instructions per turn of the image's counted loop.
const LOOP_INSTRUCTIONS: f64 = 2.0;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    selection: Selection,
}

/// The most that calls of one algorithm cost.
pub(crate) struct Worst {
    /// `subject/scalar/algorithm`.
    pub(crate) label: String,
    pub(crate) calls: usize,
    pub(crate) instructions: f64,
    pub(crate) stack: u32,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let mut total = 0;
    for board in args.selection.boards() {
        let bare = Bare::find(board.target, args.selection.core)?;
        println!("{}: {}; {bare}", board.name, board.processor);
        for name in args.selection.images(board) {
            let image = Image {
                board,
                name,
                bare: &bare,
            };
            let (calls, worst) = on_board(&image).context(name)?;
            print(&worst);
            let here = on_host("saltus-probe", name, &UNOPTIMISED)?;
            let equal = probe::compare(&here, &calls)
                .with_context(|| format!("{name} on {} differs from the host", board.name))?;
            println!(
                "  {name}: {equal} numbers of {} calls equal the host's",
                calls.len()
            );
            total += equal;
        }
    }
    ensure!(total > 0, "no such image on such a board");
    println!("qemu: {total} numbers equal the host's bit for bit");
    Ok(())
}

/// What a program of the probe computes on the host, built with these arguments of cargo.
pub(crate) fn on_host(program: &str, part: &str, arguments: &[&str]) -> Result<Vec<Call>> {
    let mut cargo = run::firmware_cargo();
    cargo.args(["run", "--quiet", "--profile=host", "--locked"]);
    cargo.args(arguments);
    cargo.args(["--package", "saltus-probe", "--bin", program, part]);
    probe::parse(&run::stdout(&mut cargo)?).context("the host's probe")
}

/// Runs the image; returns its calls and what they cost at worst.
pub(crate) fn on_board(image: &Image<'_>) -> Result<(Vec<Call>, Vec<Worst>)> {
    if !run::exists("qemu-system-arm") {
        run::install_debian(&["qemu-system-arm"])?;
    }
    let mut calls = probe::parse(&simulate(image.board, &image.build()?)?)?;
    let clock: Vec<Call> = calls
        .extract_if(.., |call| call.label.starts_with("clock/"))
        .collect();
    let clock = Clock::learn(&clock).context("the image's counted loops")?;
    let worst = worst(&calls, &clock)?;
    Ok((calls, worst))
}

fn simulate(board: &Board, image: &Path) -> Result<String> {
    run::stdout_within(board.emulator(image).args(["-icount", ICOUNT]), LIMIT)
}

/// How ticks become instructions.
struct Clock {
    ticks_per_instruction: f64,
    /// Ticks of a call that does nothing.
    overhead: f64,
}

impl Clock {
    /// From two calls of a loop of known length.
    fn learn(calls: &[Call]) -> Result<Self> {
        let point = |call: &Call| -> Result<(f64, f64)> {
            let turns = call
                .label
                .rsplit('/')
                .next()
                .unwrap_or_default()
                .parse::<f64>()?;
            let cost = call.cost.context("no cost")?;
            Ok((turns * LOOP_INSTRUCTIONS, f64::from(cost.ticks)))
        };
        let [short, long] = calls else {
            anyhow::bail!("{} calls, not 2", calls.len())
        };
        let ((n0, t0), (n1, t1)) = (point(short)?, point(long)?);
        let ticks_per_instruction = (t1 - t0) / (n1 - n0);
        let overhead = t0 - n0 * ticks_per_instruction;
        ensure!(
            ticks_per_instruction >= 1.0 && overhead >= 0.0 && overhead < 0.1 * t0,
            "{ticks_per_instruction} ticks per instruction, {overhead} ticks of overhead: not a counter of instructions"
        );
        Ok(Self {
            ticks_per_instruction,
            overhead,
        })
    }

    fn instructions(&self, ticks: u32) -> f64 {
        ((f64::from(ticks) - self.overhead) / self.ticks_per_instruction)
            .max(0.0)
            .round()
    }
}

/// The worst call of every algorithm, in the order of their first calls.
fn worst(calls: &[Call], clock: &Clock) -> Result<Vec<Worst>> {
    let mut worst: Vec<Worst> = Vec::new();
    for call in calls {
        let cost = call
            .cost
            .with_context(|| format!("{} without cost", call.label))?;
        ensure!(
            cost.ticks != u32::MAX,
            "{} ran longer than SysTick counts",
            call.label
        );
        ensure!(
            cost.stack != u32::MAX,
            "{} used more stack than is watched",
            call.label
        );
        let instructions = clock.instructions(cost.ticks);
        match worst.iter_mut().find(|entry| entry.label == call.label) {
            Some(entry) => {
                entry.calls += 1;
                entry.instructions = entry.instructions.max(instructions);
                entry.stack = entry.stack.max(cost.stack);
            }
            None => {
                let label = call.label.clone();
                worst.push(Worst {
                    label,
                    calls: 1,
                    instructions,
                    stack: cost.stack,
                });
            }
        }
    }
    Ok(worst)
}

fn print(worst: &[Worst]) {
    println!(
        "  {:<40} {:>6} {:>13} {:>12}",
        "algorithm", "calls", "instructions", "stack bytes"
    );
    for Worst {
        label,
        calls,
        instructions,
        stack,
    } in worst
    {
        println!("  {label:<40} {calls:>6} {instructions:>13} {stack:>12}");
    }
}

#[cfg(test)]
mod tests {
    use super::Clock;
    use crate::probe;

    fn learn(text: &str) -> Option<Clock> {
        Clock::learn(&probe::parse(text).ok()?).ok()
    }

    #[test]
    fn the_counted_loops_give_instructions_without_the_overhead() {
        // 1.6 ticks per instruction and 16 ticks of overhead, as a 25 MHz SysTick gives at 64 ns per instruction.
        let clock = learn("call clock/loop/1000\ncost c90 0\ncall clock/loop/2000\ncost 1910 0\n");
        assert_eq!(clock.map(|clock| clock.instructions(16 + 160)), Some(100.0));
    }

    #[test]
    fn a_clock_that_does_not_count_instructions_is_refused() {
        assert!(
            learn("call clock/loop/1000\ncost 10 0\ncall clock/loop/2000\ncost 10 0\n").is_none()
        );
        assert!(learn("call clock/loop/1000\ncost 10 0\n").is_none());
    }
}
