//! Landing alone, A1 dropped on its feet: `cargo run --release -p saltus-tests --example drops -- [DROPS] [SEED] [PLANT]`, and with MuJoCo
//! `cargo xtask mujoco run --release -p saltus-tests --features mujoco --example drops -- [DROPS] [SEED] [PLANT]`.
//!
//! DROPS (100) from 0.3 to 1.25 m, each again with one foot sensor dead, stuck or chattering; then a fifth of that from each of some heights,
//! beside the one that the joints' energy allows. Robot, sensors and ground are those of a nominal run, or what PLANT says as `saltus run --plant`
//! takes it: `lab` for another lab with every drop, `noise,latency_ms=3` for something of it.
#![allow(missing_docs, reason = "a program")]

use jump_lab::Sim;
use jump_lab::lab::{Disturbance, Lab, PlantArgument};
use jump_planner::robot::Quadruped;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use saltus_tests::drops::{Drop, End, Wrong, drawn, energy_bound, run, with_fault};

/// Most drops that went wrong which a row names.
const NAMED: usize = 20;

/// Who drops what.
struct Study {
    robot: Quadruped,
    sim: Sim,
    seed: u64,
    plant: Option<PlantArgument>,
}

impl Study {
    /// Drop number `index` between two heights.
    fn drop(&self, index: u64, heights: [f64; 2]) -> Drop {
        let lab = self.seed.wrapping_mul(100_000).wrapping_add(index);
        Drop {
            plant: self.plant.map_or(Disturbance::NOMINAL, |plant| {
                PlantArgument::plant(Some(&plant), Lab::A1, lab)
            }),
            ..drawn(self.seed, index, heights)
        }
    }

    /// Runs drops 0 to `count` on all cores.
    fn all(
        &self,
        count: u64,
        drop: impl Fn(u64) -> Drop + Sync,
    ) -> Result<Vec<(Drop, End)>, String> {
        (0..count)
            .into_par_iter()
            .map(|index| {
                let drop = drop(index);
                Ok((drop, run(&self.robot, self.sim, &drop)?))
            })
            .collect()
    }

    /// Prints a row, and the drops that went wrong; the number of good ones.
    fn row(&self, what: &str, ends: &[&(Drop, End)]) -> usize {
        let good = ends.iter().filter(|(_, end)| end.good()).count();
        let on_feet = |end: &End| end.good() && end.links(&self.robot).next().is_none();
        let feet = ends.iter().filter(|(_, end)| on_feet(end)).count();
        let failures: u32 = ends.iter().map(|(_, end)| end.failures).sum();
        let share = 100.0 * good as f64 / ends.len().max(1) as f64;
        println!(
            "{what:32} {good:4} of {:4}  {share:5.1} %, {feet:4} on nothing but feet, {failures} QPs failed",
            ends.len()
        );
        let wrong = ends.iter().filter(|(_, end)| !on_feet(end));
        for (drop, end) in wrong.take(NAMED) {
            println!(
                "    {:.2} m, roll {:.0}, pitch {:.0}, {:.2} m/s, {:?}: upright {}, at rest {}, {:?} {:?}, touched {:?}; {}",
                drop.height,
                drop.roll.to_degrees(),
                drop.pitch.to_degrees(),
                drop.sideways,
                drop.fault,
                end.upright,
                end.at_rest,
                end.phase,
                end.fault,
                end.links(&self.robot).collect::<Vec<_>>(),
                drop.plant,
            );
        }
        good
    }

    fn print(&self, count: u64) -> Result<(), String> {
        println!(
            "{}, seed {}, plant {}: tilted by up to 20 degrees, up to 0.5 m/s sideways",
            self.sim.name(),
            self.seed,
            self.plant
                .map_or_else(|| "nominal".to_owned(), |plant| plant.to_string()),
        );
        let low = [0.3, 1.25];
        let right = self.all(count, |i| self.drop(i, low))?;
        let wrong = self.all(count, |i| with_fault(&self.drop(i, low), i))?;
        let good = self.row("0.3 to 1.25 m", &right.iter().collect::<Vec<_>>());
        let still = self.row(
            "the same, one foot sensor wrong",
            &wrong.iter().collect::<Vec<_>>(),
        );
        let lost = 100.0 * (good as f64 - still as f64) / count as f64;
        println!("    points lost: {lost:.1}");
        for kind in [Wrong::Dead, Wrong::Stuck, Wrong::Chattering] {
            let of_kind = |(drop, _): &&(Drop, End)| drop.fault.is_some_and(|(_, is)| is == kind);
            let some = wrong.iter().filter(of_kind).collect::<Vec<_>>();
            let good = some.iter().filter(|(_, end)| end.good()).count();
            println!("    {kind:?}: {good} of {}", some.len());
        }
        println!(
            "the knees alone can take up a level fall of {:.2} m",
            energy_bound(&self.robot)
        );
        for height in [0.95, 1.25, 1.5, 1.75, 2.0] {
            let ends = self.all(count.div_ceil(5), |i| self.drop(i, [height, height]))?;
            self.row(&format!("{height} m"), &ends.iter().collect::<Vec<_>>());
        }
        Ok(())
    }
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
    let study = Study {
        robot: Quadruped::a1().map_err(|error| error.to_string())?,
        sim: if cfg!(feature = "mujoco") {
            Sim::MUJOCO
        } else {
            Sim::Native
        },
        seed,
        plant: arguments.next().map(|text| text.parse()).transpose()?,
    };
    study.print(count)
}
