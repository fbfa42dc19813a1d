//! A jump over a link that is whole, lossy, slow, or cut; in simulated time, so that no machine is too slow for it.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::{Flown, Linked, flown_again, fly};
use crate::Sim;
use crate::lab::{Lab, PlantArgument};
use crate::quadruped::Planned;
use crate::quadruped::execute::Trial;
use crate::quadruped::log::Sample;
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

/// It lands as the plan has it: where it should, upright, and without a fault. (What two turns from a box ask of the motors is another matter.)
fn lands(planned: &Planned, flown: &Flown) {
    let verdict = planned.judge(&flown.run).verdict;
    assert_eq!((flown.run.fault, flown.has_tripped), (None, false));
    assert_eq!(flown.run.final_phase, Phase::Stand);
    let stray = |name: &str| name.starts_with("flight") || name.starts_with("stand");
    let failed = verdict.failures.iter().find(|failure| stray(&failure.name));
    assert!(failed.is_none() && verdict.stands(), "{}", verdict.first());
}

/// 1 kHz and 500 Hz, with 5 % of all datagrams lost and up to a millisecond and a half each way.
#[test]
fn a_lossy_link_lands_and_its_recording_replays() {
    let planned = planned();
    for period_ms in [1, 2] {
        let linked = Linked { period_ms, ..WHOLE };
        let air = "loss=0.05,latency_ms=1,jitter_ms=1";
        let (trial, flown) = flown(&planned, air, linked);
        lands(&planned, &flown);
        for tally in &flown.tallies {
            let share = f64::from(tally.missed) / f64::from(tally.missed + tally.heard);
            assert!((0.03..0.07).contains(&share), "{tally:?}");
        }
        let mut recording = flown.recording;
        let again = |recording: &[u8]| flown_again(&planned, &trial, linked, recording);
        assert!(again(&recording).is_ok_and(|turns| turns > 4000));
        // A replay that would not notice a wrong bit compares nothing: of the first turn's time, and of whatever stands in the middle.
        for place in [1, recording.len() / 2] {
            recording[place] ^= 1;
            assert!(again(&recording).is_err(), "byte {place}");
            recording[place] ^= 1;
        }
    }
}

/// Cut in the push-off: the controller knows that it hears nothing, the robot damps, and both stay with it.
#[test]
fn a_cut_link_ends_in_damping_at_both_ends() {
    let planned = planned();
    let linked = Linked {
        cut: Some(0.2),
        ..WHOLE
    };
    let (trial, flown) = flown(&planned, "", linked);
    assert!(flown.has_tripped);
    assert_eq!(flown.run.fault, Some(Fault::Stale));
    let aborts = |sample: &&Sample| sample.phase == Phase::Abort;
    let aborted = flown.run.samples.iter().find(aborts).unwrap().time;
    // 10 ms, and a turn at either end.
    assert!((0.210..0.213).contains(&aborted), "{aborted}");
    assert!(flown_again(&planned, &trial, linked, &flown.recording).is_ok());
}
