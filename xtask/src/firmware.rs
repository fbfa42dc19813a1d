//! `cargo xtask firmware`: whole jumps on the boards, and what their control ticks cost.
//!
//! Every image flies a jump in closed loop with the contact simulator, and must leave the host's bits. The worst call of every
//! tick is compared with two numbers in `firmware/budgets.txt`: what it took when the file was written, of which five per
//! cent more is an error, and the goal of the project, which must not be lost once it is met.

use core::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use object::{Object, ObjectSegment};

use crate::bare::Bare;
use crate::board::{BOARDS, Board, Selection};
use crate::image::Image;
use crate::qemu::{self, Worst};
use crate::{probe, replay, run};

/// What may be added to a stored number before it is an error.
const TOLERANCE: f64 = 1.05;

const HEADER: &str = "\
# Costs of the control ticks at worst over a jump, and of wild states, as `cargo xtask firmware --overwrite` measured them.
# The goals are written by hand and kept; `-` is none.
# board image tick | instructions, goal | bytes of stack, goal
";

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    selection: Selection,
    /// Write what was measured to the file of budgets.
    #[arg(long)]
    overwrite: bool,
}

/// A number with what it was when it was stored, and what it shall be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Budget {
    stored: Option<f64>,
    goal: Option<f64>,
}

impl Budget {
    /// Whether `measured` is within budget: no more than before, and no goal lost that was met.
    fn holds(&self, measured: f64) -> bool {
        let most = self.stored.map_or(f64::INFINITY, |x| x * TOLERANCE);
        measured <= most && (!self.misses(measured) || self.stored.is_some_and(|x| self.misses(x)))
    }

    /// Whether there is a goal that `measured` does not meet.
    fn misses(&self, measured: f64) -> bool {
        self.goal.is_some_and(|goal| measured > goal)
    }
}

/// One line of the file.
#[derive(Clone, Debug, PartialEq)]
struct Line {
    /// `board image tick`.
    key: String,
    instructions: Budget,
    stack: Budget,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let path = run::root().join("firmware/budgets.txt");
    let mut lines = read(&path)?;
    let (mut exceeded, mut ticks, mut missed) = (Vec::new(), 0, 0);
    for board in args.selection.boards() {
        let bare = Bare::find(board.target, args.selection.core)?;
        println!("{}: {}; {bare}", board.name, board.processor);
        for name in args.selection.jumps(board) {
            let image = Image {
                board,
                name,
                bare: &bare,
            };
            let (calls, worst) = qemu::on_board(&image).context(name)?;
            let equal = probe::compare(&qemu::on_host("jumps", name)?, &calls)
                .with_context(|| format!("{name} on {} differs from the host", board.name))?;
            let flash = flash(&image.build()?)?;
            println!(
                "  {name}: {equal} digests of {} calls equal the host's; flash {flash} B",
                calls.len()
            );
            for worst in &worst {
                ticks += 1;
                missed += usize::from(judge(board, name, worst, &mut lines, &mut exceeded));
            }
        }
        if board.name == BOARDS[0].name && args.selection.names_no_image() {
            replay::run(&bare)?;
        }
    }
    ensure!(ticks > 0, "no such image on such a board");
    if args.overwrite {
        write(&path, &lines)?;
    }
    if exceeded.is_empty() {
        println!(
            "firmware: {ticks} ticks equal the host's and cost no more than before; {missed} still miss a goal"
        );
        return Ok(());
    }
    bail!(
        "firmware: {} of {ticks} ticks exceed their budgets: {}",
        exceeded.len(),
        exceeded.join("; ")
    )
}

/// Prints a tick beside its budgets, and stores it; returns whether it misses a goal.
fn judge(
    board: &Board,
    image: &str,
    worst: &Worst,
    lines: &mut Vec<Line>,
    exceeded: &mut Vec<String>,
) -> bool {
    let tick = worst.label.rsplit('/').next().unwrap_or_default();
    let key = format!("{} {image} {}", board.name, tick.replace(' ', "-"));
    let known = lines.iter().position(|line| line.key == key);
    let index = known.unwrap_or_else(|| {
        lines.push(Line {
            key: key.clone(),
            instructions: Budget::default(),
            stack: Budget::default(),
        });
        lines.len() - 1
    });
    let Some(line) = lines.get_mut(index) else {
        return false;
    };
    let stack = f64::from(worst.stack);
    let goal = |budget: &Budget, measured: f64| match budget.goal {
        None => "-".into(),
        Some(goal) if measured > goal => format!("{goal}, missed"),
        Some(goal) => goal.to_string(),
    };
    println!(
        "    {tick:<24} {:>6} calls  {:>8} instructions (goal {})  {:>7} B stack (goal {})",
        worst.calls,
        worst.instructions,
        goal(&line.instructions, worst.instructions),
        worst.stack,
        goal(&line.stack, stack)
    );
    if !line.instructions.holds(worst.instructions) {
        exceeded.push(format!("{key} took {} instructions", worst.instructions));
    }
    if !line.stack.holds(stack) {
        exceeded.push(format!("{key} took {stack} B of stack"));
    }
    line.instructions.stored = Some(worst.instructions);
    line.stack.stored = Some(stack);
    line.instructions.misses(worst.instructions) || line.stack.misses(stack)
}

/// Bytes of the image: code, tables, and what data begin with.
fn flash(image: &Path) -> Result<u64> {
    let bytes = std::fs::read(image).with_context(|| image.display().to_string())?;
    let elf = object::File::parse(&*bytes)?;
    Ok(elf.segments().map(|segment| segment.file_range().1).sum())
}

fn read(path: &PathBuf) -> Result<Vec<Line>> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| parse(line).with_context(|| format!("{}: {line:?}", path.display())))
        .collect()
}

fn parse(line: &str) -> Result<Line> {
    let mut parts = line.split('|').map(str::trim);
    let key = parts.next().unwrap_or_default().to_owned();
    let mut budget = || -> Result<Budget> {
        let part = parts.next().context("a part is missing")?;
        let (stored, goal) = part.split_once(',').context("no goal")?;
        let number = |text: &str| match text.trim() {
            "-" => Ok(None),
            number => number.parse::<f64>().map(Some),
        };
        Ok(Budget {
            stored: number(stored)?,
            goal: number(goal)?,
        })
    };
    Ok(Line {
        instructions: budget()?,
        stack: budget()?,
        key,
    })
}

fn write(path: &PathBuf, lines: &[Line]) -> Result<()> {
    let number = |x: Option<f64>| x.map_or_else(|| "-".into(), |x| x.to_string());
    let mut text = HEADER.to_owned();
    for line in lines {
        let budget = |b: &Budget| format!("{}, {}", number(b.stored), number(b.goal));
        writeln!(
            text,
            "{} | {} | {}",
            line.key,
            budget(&line.instructions),
            budget(&line.stack)
        )?;
    }
    std::fs::write(path, text).with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::{Budget, parse};

    #[test]
    fn five_per_cent_more_or_a_lost_goal_is_an_error() {
        let line = parse("mps2-an500 jump landing-tick | 1000, 2000 | 500, -").ok();
        let budgets = line.map(|line| (line.instructions, line.stack));
        let Some((instructions, stack)) = budgets else {
            unreachable!("the line has all parts")
        };
        assert!(instructions.holds(1050.0) && !instructions.holds(1051.0));
        assert!(stack.holds(525.0) && !stack.holds(526.0));
        let with = |goal| Budget {
            stored: Some(1000.0),
            goal: Some(goal),
        };
        assert!(with(1020.0).holds(1020.0) && !with(1020.0).holds(1030.0));
        // Missed before, and no worse now.
        assert!(with(900.0).holds(1050.0) && with(900.0).misses(1050.0));
        let new = Budget {
            stored: None,
            ..with(900.0)
        };
        assert!(new.holds(900.0) && !new.holds(901.0));
        assert!(parse("no budgets").is_err() && parse("a | 1, x | 1, 2").is_err());
    }
}
