//! What counts as round-off of a row's own terms, and what does not: the same gap far from the origin and near it.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests")]

use crate::common::INF;
use dense_qp::{Constraint, Problem, Settings, Side, Status, Workspace, solve};

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// x₀ + x₁ ≤ 2 and x₀ + x₁ + x₂ ≤ 2 − 2⁻²², where the first row leaves x at (f − 3, −f + 5, 0): of terms of 1e8 the gap is round-off, for
/// which no row enters; of terms of 10 it is not.
#[test]
fn no_row_enters_for_round_off_of_its_terms() {
    let gap = f64::powi(2.0, -22);
    for (far, is_round_off) in [(f64::powi(2.0, 27), true), (16.0, false)] {
        let (h, g) = (IDENTITY, [-far, far - 8.0, 0.0]);
        let a = [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
        let (l, u) = ([-INF; 2], [2.0, 2.0 - gap]);
        let p = Problem::new(&h, &g, &a, &l, &u);
        let mut w = Workspace::new();
        let s = solve(&p, &Settings::default(), &mut w).unwrap();
        assert_eq!(s.status, Status::Solved, "{far}");
        let second = (Constraint::Row(1), Side::Upper);
        let enters = w.active().any(|active| active == second);
        assert_eq!(enters, !is_round_off, "{far}");
    }
}

/// x₀ = f + 1, x₁ = f and x₀ − x₁ = 1 + 2⁻²⁴: with f = 2²⁸ the third says the same as the others to the last digit of f, near the origin
/// it contradicts them, and by 1 it does so anywhere.
#[test]
fn an_equality_may_differ_by_round_off_of_others() {
    let (far, digit) = (f64::powi(2.0, 28), f64::powi(2.0, -24));
    for (f, gap, status) in [
        (far, digit, Status::Solved),
        (0.0, digit, Status::Infeasible),
        (far, 1.0, Status::Infeasible),
    ] {
        let a = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, -1.0, 0.0]];
        let b = [f + 1.0, f, 1.0 + gap];
        let p = Problem::new(&IDENTITY, &[0.0; 3], &a, &b, &b);
        let mut w = Workspace::new();
        let s = solve(&p, &Settings::default(), &mut w).unwrap();
        assert_eq!(s.status, status, "{f}, {gap}");
    }
}

/// A point may be as far outside a row as the tolerance says, and no farther.
#[test]
fn a_row_may_be_missed_by_the_tolerance() {
    let feasibility = f64::powi(2.0, -20);
    let settings = Settings {
        feasibility,
        ..Settings::default()
    };
    for (limit, x) in [
        (feasibility, 0.0),
        (feasibility.next_up(), feasibility.next_up()),
    ] {
        let limit = [limit];
        let p = Problem::new(&[[1.0]], &[0.0], &[[1.0]], &limit, &[INF]);
        let mut w = Workspace::new();
        let s = solve(&p, &settings, &mut w).unwrap();
        assert_eq!((s.status, s.x[0]), (Status::Solved, x));
    }
}

/// Finite numbers whose row has no finite value at the least cost: nothing can be confirmed, which is said without running to the cap.
#[test]
fn an_overflow_is_given_up() {
    let p = Problem::new(&[[1.0]], &[-1e200], &[[1e200]], &[-INF], &[1.0]);
    let mut w = Workspace::new();
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Numerical, "{} steps", s.steps);
    assert!(s.steps < Workspace::<f64, 1, 1>::STEPS / 4, "{}", s.steps);
}

/// Three rows whose vertex at the origin is the optimum: N + M steps and a few, though no cost and no length is left by which to measure.
#[test]
fn a_vertex_at_the_origin_is_found_at_once() {
    let a = [[-2.0, 0.0, 2.0], [3.0, -2.0, 1.0], [0.0, 2.0, 2.0]];
    let p = Problem::new(&IDENTITY, &[1.0, -3.0, -7.0], &a, &[-INF; 3], &[0.0; 3]);
    let mut w = Workspace::new();
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Solved);
    assert!(s.steps <= 9, "{} steps", s.steps);
}
