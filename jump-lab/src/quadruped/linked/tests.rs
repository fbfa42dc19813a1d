//! A jump over a link that is whole, lossy, slow, or cut; in simulated time, so that no machine is too slow for it.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::{Flown, Linked, flown_again, fly};
use crate::Sim;
use crate::lab::{Lab, PlantArgument};
use crate::quadruped::Planned;
use crate::quadruped::execute::Trial;
use jump_control::{Fault, Phase};
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;

const PLAN: &[u8] = include_bytes!("../../../../firmware/probe/plans/a1-double-backflip.bin");

const WHOLE: Linked = Linked {
    period_ms: 1,
    cut: None,
};

fn planned() -> Planned {
    Planned::open(&Quadruped::a1().unwrap(), PLAN, Task::load).unwrap()
}

fn flown(planned: &Planned, air: &str, linked: Linked) -> (Trial<'static>, Flown) {
    let plant: PlantArgument = air.parse().unwrap();
    let trial = Trial {
        disturbance: PlantArgument::plant(Some(&plant), Lab::A1, 0),
        seed: 5,
        ..Trial::nominal(Sim::Native)
    };
    (trial, fly(planned, trial, linked).unwrap())
}

#[test]
fn what() {
    let planned = planned();
    for (air, period_ms) in [
        ("", 1),
        ("", 2),
        ("loss=0.05", 1),
        ("loss=0.05", 2),
        ("loss=0.05,latency_ms=1,jitter_ms=1", 1),
        ("loss=0.05,latency_ms=1,jitter_ms=1", 2),
        ("loss=0.05,latency_ms=2,jitter_ms=1", 1),
        ("loss=0.05,latency_ms=2,jitter_ms=1", 2),
    ] {
        let clock = std::time::Instant::now();
        let (trial, flown) = flown(&planned, air, Linked { period_ms, ..WHOLE });
        let judged = planned.judge(&flown.run);
        println!(
            "{air} {period_ms}: {} {:?} {:?} {:?} {} s",
            judged.verdict.first(),
            flown.run.final_phase,
            flown.run.fault,
            flown.tallies,
            clock.elapsed().as_secs_f64()
        );
        println!(
            "{:?}",
            flown_again(
                &planned,
                &trial,
                Linked { period_ms, ..WHOLE },
                &flown.recording
            )
        );
    }
}
