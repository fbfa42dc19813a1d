//! The example without legs: its derivatives, and that it flips.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "the example's main is not called"
)]

#[path = "../examples/thrust_vector_flip.rs"]
mod flip;

use flip::{Flip, plan, turned};
use ocp_solver::{Problem, Status, derivative_errors};

#[test]
fn the_body_turns_once_and_hovers_again() {
    let (solution, stages) = plan().unwrap();
    assert_eq!(solution.status, Status::Solved, "{solution:?}");
    assert!((turned(&stages) - 2.0 * core::f64::consts::PI).abs() < 1e-3);
    let end = &stages.last().unwrap().state;
    assert!(end.pos_w.norm() < 1e-6 && end.vel_w.norm() < 1e-6 && end.omega_b.norm() < 1e-6);
    for stage in &stages {
        assert!((0.0..=16.0).contains(&stage.control[0]) && stage.control[1].abs() <= 0.25);
    }
}

#[test]
fn its_derivatives_agree_with_differences() {
    let (_, stages) = plan().unwrap();
    for k in [0, 1, 20, 45, 60] {
        let next = stages.get(k + 1).map(|stage| &stage.state);
        let errors = derivative_errors(&Flip, k, &stages[k].state, &stages[k].control, next, 1e-6);
        assert!(errors.worst() < 1e-5, "{k} {errors:?}");
    }
    assert_eq!(Flip.intervals(), 60);
}
