//! A bad input at any tick of a jump: the run ends in the safe state, the fault is named, and no torque leaves its limits.

#![allow(clippy::unwrap_used, reason = "tests")]

use super::Observed;
use super::execute::{HOLD, Run, Trial, run_watched};
use crate::Sim;
use a1_model::MOTORS;
use jump_control::{Fault, Phase};
use jump_planner::reference::{Reference, build};
use jump_planner::task::Task;
use proptest::prelude::{Just, ProptestConfig, prop_assert, prop_assert_eq, prop_oneof, proptest};
use std::sync::OnceLock;

/// The lateral jump, planned once.
fn jump() -> &'static (Task, Reference) {
    static JUMP: OnceLock<(Task, Reference)> = OnceLock::new();
    JUMP.get_or_init(|| {
        let task = Task::load("a1/lateral").unwrap();
        let plan = task.solve().unwrap();
        let reference = build(&task, &plan).unwrap();
        (task, reference)
    })
}

/// Puts `bad` into one number of what the controller is told; the fault that must be named for it.
fn spoil(told: &mut Observed, place: usize, bad: f64) -> Option<Fault> {
    let m = &mut told.measured;
    let i = place % 12;
    match place / 12 {
        0 => m.joints[i] = bad,
        1 => m.joint_velocities[i] = bad,
        2 if i < 3 => m.base.translation[i] = bad,
        2 if i < 6 => m.base_velocity.linear[i - 3] = bad,
        2 if i < 9 => m.base_velocity.angular[i - 6] = bad,
        2 => {
            m.base.rotation =
                nalgebra::Rotation3::from_matrix_unchecked(nalgebra::Matrix3::repeat(bad))
        }
        3 if i < 4 => m.foot_forces[i] = bad,
        3 if i < 8 => m.age = bad,
        3 => m.age = 0.011,
        // Torques are only evidence: a jump goes on without them.
        _ => {
            told.joint_torques[i] = bad;
            return None;
        }
    }
    Some(match place / 12 {
        0 | 1 => Fault::Joint(i),
        2 => Fault::Base,
        3 if i < 4 => Fault::Foot(i),
        _ => Fault::Stale,
    })
}

fn inside(run: &Run) -> bool {
    run.samples
        .iter()
        .flat_map(|s| s.torques.iter().zip(&MOTORS))
        .all(|(tau, motor)| tau.abs() <= motor.torque)
        && run.peak_torque <= MOTORS[0].torque
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(12) })]

    #[test]
    fn one_bad_number_at_any_tick_ends_safely_with_its_name(
        tick in 0_u64..3000,
        place in 0_usize..60,
        bad in prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(1e300)],
    ) {
        let (task, reference) = jump();
        let mut expected = None;
        let run = run_watched(
            task,
            reference,
            Trial::nominal(Sim::Native),
            |k, told| {
                if k == tick {
                    expected = spoil(told, place, bad);
                }
            },
            |_, _| {},
            |_| {},
        )
        .unwrap();
        prop_assert!(inside(&run));
        prop_assert_eq!(run.fault, expected);
        if expected.is_some() {
            prop_assert_eq!(run.final_phase, Phase::Abort);
            // From then on the joints are damped and nothing else: the robot comes to rest.
            let before = run.samples.iter().take_while(|s| s.phase != Phase::Abort).count();
            prop_assert_eq!(before as u64, tick);
            if tick < 2000 {
                let last = run.samples.last().unwrap();
                prop_assert!(last.velocity_w.norm() < 0.1 && last.time > 1.0 - HOLD);
            }
        } else {
            prop_assert!(matches!(run.final_phase, Phase::Landing | Phase::Stand));
        }
    }
}

/// What is lost for good is lost safely too: sensors that fall silent at some tick.
#[test]
fn a_measurement_that_stops_coming_is_stale_after_ten_milliseconds() {
    let (task, reference) = jump();
    for silent in [100_u64, 700, 1000, 1500] {
        let run = run_watched(
            task,
            reference,
            Trial::nominal(Sim::Native),
            |k, told| {
                if k >= silent {
                    told.measured.age = (k - silent) as f64 * 1e-3;
                }
            },
            |_, _| {},
            |_| {},
        )
        .unwrap();
        assert_eq!(run.fault, Some(Fault::Stale));
        assert_eq!(run.final_phase, Phase::Abort);
        assert!(inside(&run));
    }
}
