//! Landing alone, A1 dropped on its feet: `cargo run --release -p saltus-tests --example drops -- [DROPS] [SEED]`, and with MuJoCo
//! `cargo xtask mujoco run --release -p saltus-tests --features mujoco --example drops -- [DROPS] [SEED]`.
//!
//! DROPS (100) from 0.3 to 1.0 m, each again with one foot sensor dead, stuck or chattering; then a fifth of that from higher up, beside
//! the height that the joints' energy allows.
#![allow(missing_docs, reason = "a program")]

use jump_lab::Sim;
use jump_planner::robot::Quadruped;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use saltus_tests::drops::{Drop, End, Wrong, drawn, energy_bound, run, with_fault};

/// Runs drops 0 to `count` on all cores.
fn all(
    (robot, sim): (&Quadruped, Sim),
    count: u64,
    drop: impl Fn(u64) -> Drop + Sync,
) -> Result<Vec<(Drop, End)>, String> {
    (0..count)
        .into_par_iter()
        .map(|index| {
            let drop = drop(index);
            Ok((drop, run(robot, sim, &drop)?))
        })
        .collect()
}

/// Prints a row, and the drops that went wrong; the number of good ones.
fn row(what: &str, ends: &[&(Drop, End)]) -> usize {
    let good = ends.iter().filter(|(_, end)| end.good()).count();
    let failures: u32 = ends.iter().map(|(_, end)| end.failures).sum();
    let share = 100.0 * good as f64 / ends.len().max(1) as f64;
    println!(
        "{what:40} {good:4} of {:4}  {share:5.1} %  {failures} QPs failed",
        ends.len()
    );
    for (drop, end) in ends.iter().filter(|(_, end)| !end.good()).take(20) {
        println!(
            "    {:.2} m, roll {:.0}, pitch {:.0}, {:.2} m/s, {:?}: upright {}, trunk touched {}, at rest {}, {:?}",
            drop.height,
            drop.roll.to_degrees(),
            drop.pitch.to_degrees(),
            drop.sideways,
            drop.fault,
            end.upright,
            end.trunk_touched,
            end.at_rest,
            end.phase
        );
    }
    good
}

fn study(sim: Sim, count: u64, seed: u64) -> Result<(), String> {
    println!(
        "{}, seed {seed}: tilted by up to 20 degrees, up to 0.5 m/s sideways",
        sim.name()
    );
    let robot = Quadruped::a1().map_err(|error| error.to_string())?;
    let low = [0.3, 1.0];
    let right = all((&robot, sim), count, |i| drawn(seed, i, low))?;
    let wrong = all((&robot, sim), count, |i| {
        with_fault(&drawn(seed, i, low), i)
    })?;
    let good = row("0.3 to 1.0 m", &right.iter().collect::<Vec<_>>());
    let still = row(
        "the same, one foot sensor wrong",
        &wrong.iter().collect::<Vec<_>>(),
    );
    let lost = 100.0 * (good as f64 - still as f64) / count as f64;
    println!("    points lost: {lost:.1}");
    for kind in [Wrong::Dead, Wrong::Stuck, Wrong::Chattering] {
        let of_kind = |(drop, _): &&(Drop, End)| drop.fault.is_some_and(|(_, is)| is == kind);
        row(
            &format!("    {kind:?}"),
            &wrong.iter().filter(of_kind).collect::<Vec<_>>(),
        );
    }
    println!(
        "the knees alone can take up a level fall of {:.2} m",
        energy_bound(&robot)
    );
    for height in [1.0, 1.25, 1.5, 1.75, 2.0] {
        let ends = all((&robot, sim), count.div_ceil(5), |i| {
            drawn(seed, i, [height, height])
        })?;
        row(&format!("{height} m"), &ends.iter().collect::<Vec<_>>());
    }
    Ok(())
}

fn main() -> Result<(), String> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: u64| match arguments.next() {
        None => Ok(default),
        Some(text) => text
            .parse::<u64>()
            .map_err(|error| format!("{text}: {error}: give DROPS and SEED as numbers")),
    };
    let (count, seed) = (number(100)?, number(1)?);
    let sim = if cfg!(feature = "mujoco") {
        Sim::MUJOCO
    } else {
        Sim::Native
    };
    study(sim, count, seed)
}
