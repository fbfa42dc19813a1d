//! How fast a foot lets go before it leaves the ground.

use crate::common::{BASES, Data, FEET, N, NI, NU, NX, data, jump};
use nalgebra::Vector3;
use ocp_solver::{Problem as Ocp, SparseStage};
use wb_opt::{Problem, State};

/// Largest normal forces in interval `k`, N, of the feet that have one; forces are in units of 50 N.
fn most(problem: &mut Problem<'_, f64, N, FEET>, k: usize, release: f64) -> Vec<f64> {
    let mut upper = |release: f64| {
        problem.release = release;
        let (mut lower, mut upper) = ([0.0; NI], [0.0; NI]);
        Ocp::<f64, NX, NU, NI>::bounds(&*problem, k, &mut lower, &mut upper);
        upper
    };
    let free = upper(f64::INFINITY);
    let bound = upper(release);
    let rows = bound.iter().zip(&free).filter(|(a, b)| a != b);
    rows.map(|(most, free)| {
        assert_eq!(*free, f64::INFINITY);
        50.0 * most
    })
    .collect()
}

/// A jump in which two feet never leave the ground.
fn standing_on_two() -> Data {
    let mut data = data();
    for phase in &mut data.phases[1..] {
        phase.contacts = [false, true, true, false];
    }
    data
}

#[test]
fn a_foot_bears_what_it_can_let_go_of_until_it_leaves() {
    // Twelve intervals of 10 ms on four feet, eight of 12 ms on the rear ones, then flight.
    let data = data();
    let mut problem = jump(&data, BASES[2]);
    for (k, times) in [
        (0, vec![0.115, 0.115, 0.211, 0.211]),
        (11, vec![0.005, 0.005, 0.101, 0.101]),
        (12, vec![0.09, 0.09]),
        (19, vec![0.006, 0.006]),
        (20, vec![]),
    ] {
        let found = most(&mut problem, k, 3e4);
        assert_eq!(found.len(), times.len(), "{k}");
        for (found, time) in found.iter().zip(times) {
            assert!((found - 3e4 * time).abs() < 1e-9, "{k}: {found}");
        }
    }
    // Nothing asks a foot to let go that stands to the end.
    let standing = standing_on_two();
    let mut problem = jump(&standing, BASES[2]);
    assert_eq!(most(&mut problem, 5, 3e4).len(), 2);
    assert!(most(&mut problem, 15, 3e4).is_empty());
    for bad in [0.0, -1.0, f64::NAN] {
        problem.release = bad;
        assert!(problem.check().is_err(), "{bad}");
    }
}

/// A largest force holds for feet that stand to the end too; and whatever they let go by, feet may push with the least force.
#[test]
fn forces_keep_between_the_least_and_the_largest() {
    let standing = standing_on_two();
    let mut problem = jump(&standing, BASES[2]);
    problem.max_force = 60.0;
    let near = |found: Vec<f64>, wanted: &[f64]| {
        let pairs = found.iter().zip(wanted);
        assert!(
            found.len() == wanted.len() && pairs.clone().all(|(a, b)| (a - b).abs() < 1e-9),
            "{found:?} {wanted:?}"
        );
    };
    let upper = |problem: &Problem<'_, f64, N, FEET>, k: usize| {
        let (mut lower, mut upper) = ([0.0; NI], [0.0; NI]);
        Ocp::<f64, NX, NU, NI>::bounds(problem, k, &mut lower, &mut upper);
        let least = problem.least_force / 50.0;
        let forces = lower.iter().zip(upper).filter(|(low, _)| **low == least);
        forces.map(|(_, high)| 50.0 * high).collect::<Vec<_>>()
    };
    problem.least_force = 3.0;
    problem.release = 1e3;
    near(upper(&problem, 5), &[60.0, 60.0, 60.0, 60.0]);
    near(upper(&problem, 11), &[5.0, 60.0, 60.0, 5.0]);
    problem.release = 1e2;
    near(upper(&problem, 11), &[3.0, 60.0, 60.0, 3.0]);
    for bad in [0.0, 3.0, -1.0, f64::NAN] {
        problem.max_force = bad;
        assert!(problem.check().is_err(), "{bad}");
    }
}

/// A robot that stands on four feet, then on two: those that leave bear a quarter of the weight to the last.
#[test]
fn the_judge_sees_feet_that_let_go_too_fast() {
    let data = standing_on_two();
    let mut problem = jump(&data, BASES[2]);
    let weight = 12.453 * 9.81;
    let mut stages =
        vec![
            SparseStage::<f64, State<f64, N>, NX, NU, NI>::sparse(State::at_rest(problem.start));
            35
        ];
    let share = |k: usize, _| Vector3::new(0.0, 0.0, weight / if k < 12 { 4.0 } else { 2.0 });
    problem.write_guess(&mut stages, &[problem.start; 35], share, || 0.0);
    let mut violation = |release: f64| {
        problem.release = release;
        let motion = stages.iter().map(|stage| (&stage.state, &stage.control));
        problem.judge(motion).max_violation
    };
    // It stands 10 cm from a goal of 2 cm, and its centre of mass not quite over the feet.
    let (never, slow) = (violation(f64::INFINITY), violation(1e3));
    assert!(never < 3.0, "{never}");
    assert!((slow - (weight / 4.0 - 5.0)).abs() < 1e-6, "{slow}");
    assert!((violation(1e5) - never).abs() < 1e-12);
}
