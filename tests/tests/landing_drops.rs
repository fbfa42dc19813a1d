//! Closed loop: A1 dropped on its feet, landing controller against the simulators.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use jump_lab::Sim;
use jump_lab::lab::Disturbance;
use jump_planner::robot::Quadruped;
use saltus_tests::drops::{Drop, Wrong, eighteen, run};

/// Most ticks of a drop whose force program may end at its cap of 20 factorisations: the next tick goes on from there, so that a few in a
/// row say that the program lags behind the robot. Nothing else may end it.
const MOST_CAPPED: u32 = 3;

fn good(sim: Sim, drops: impl Iterator<Item = Drop>) -> usize {
    let robot = Quadruped::a1().unwrap();
    let mut good = 0;
    for drop in drops {
        let end = run(&robot, sim, &drop).unwrap();
        assert_eq!(end.failures, 0, "a QP failed: {drop:?}");
        assert!(end.capped <= MOST_CAPPED, "{drop:?}: {end:?}");
        if end.good() {
            good += 1;
        } else {
            println!("{drop:?}: {end:?}");
        }
    }
    good
}

/// Level and tilted by 20°, at rest and at half a metre per second: what `cargo test` has time for. Index 9 lifts a foot at the touchdown, which comes down again only as long as a standing leg.
#[test]
fn drops_from_30_cm_are_landed() {
    let some = eighteen(0.3).enumerate();
    let some = some.filter(|(i, _)| [0, 7, 9, 15].contains(i));
    assert_eq!(good(Sim::Native, some.map(|(_, drop)| drop)), 4);
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn eighteen_of_eighteen_drops_from_30_cm_are_landed() {
    assert_eq!(good(Sim::Native, eighteen(0.3)), 18);
}

#[test]
#[ignore = "long: cargo xtask suites"]
fn eighteen_of_eighteen_drops_from_one_metre_are_landed() {
    assert_eq!(good(Sim::Native, eighteen(1.0)), 18);
}

/// Each kind of fault on each foot: landed all the same, and the detector names the foot.
#[test]
#[ignore = "long: cargo xtask suites"]
fn a_bad_foot_sensor_does_not_fell_the_robot_and_is_named() {
    let robot = Quadruped::a1().unwrap();
    for wrong in [Wrong::Dead, Wrong::Stuck, Wrong::Chattering] {
        for foot in 0..4 {
            let drop = Drop {
                height: 0.3,
                roll: 0.1,
                pitch: 0.0,
                sideways: 0.0,
                fault: Some((foot, wrong)),
                plant: Disturbance::NOMINAL,
                seed: 0,
            };
            let end = run(&robot, Sim::Native, &drop).unwrap();
            assert!(end.good(), "{drop:?}: {end:?}");
            let named = core::array::from_fn(|i| i == foot);
            assert_eq!(end.faulty, named, "{drop:?}");
        }
    }
}

/// `cargo xtask mujoco test --release -p saltus-tests --features mujoco --test landing_drops`.
#[cfg(feature = "mujoco")]
#[test]
fn mujoco_says_the_same() {
    assert_eq!(good(Sim::MUJOCO, eighteen(1.0)), 18);
    let stuck = eighteen(0.5).enumerate().map(|(i, drop)| Drop {
        fault: Some((i % 4, Wrong::Stuck)),
        ..drop
    });
    assert!(good(Sim::MUJOCO, stuck) >= 17);
}
