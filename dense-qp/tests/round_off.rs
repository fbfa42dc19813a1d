//! What counts as round-off of a row's own terms, and what does not: the same gap far from the origin and near it.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests")]

use crate::common::INF;
use dense_qp::{Constraint, Problem, Settings, Side, Status, Workspace, solve, solve_warm};

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

const SECOND: (Constraint, Side) = (Constraint::Row(1), Side::Upper);

/// x₀ + x₁ ≤ 2 and x₀ + x₁ + x₂ ≤ 2 − gap, where the first row leaves x at (f − 3, −f + 5, 0): of terms of 1e8 a gap of 2⁻²² is round-off,
/// for which no row enters; of terms of 10 it is not. Nor is one of 2⁻¹³, beside limits of 2, wherever x has run away to. In any units of
/// the row.
#[test]
fn no_row_enters_for_round_off_of_its_terms() {
    let power = |exponent| f64::powi(2.0, exponent);
    for (far, gap, is_round_off) in [
        (power(27), power(-22), true),
        (16.0, power(-22), false),
        (power(36), power(-13), false),
    ] {
        for unit in [power(-20), 1.0, power(20)] {
            let (h, g) = (IDENTITY, [-far, far - 8.0, 0.0]);
            let a = [[1.0, 1.0, 0.0], [unit; 3]];
            let (l, u) = ([-INF; 2], [2.0, unit * (2.0 - gap)]);
            let p = Problem::new(&h, &g, &a, &l, &u);
            let mut w = Workspace::new();
            let s = solve(&p, &Settings::default(), &mut w).unwrap();
            assert_eq!(s.status, Status::Solved, "{far} {unit}");
            let enters = w.active().any(|active| active == SECOND);
            assert_eq!(enters, !is_round_off, "{far} {unit}");
        }
    }
}

/// xᵢ ≤ f and xᵢ + xⱼ ≤ f − 2⁻²² with f = 2²⁷: the gap is round-off of xᵢ, whichever of nine variables that is.
#[test]
fn round_off_of_any_variable_counts() {
    let (far, gap) = (f64::powi(2.0, 27), f64::powi(2.0, -22));
    for i in 0..9 {
        let unit = |i: usize| core::array::from_fn::<_, 9, _>(|j| f64::from(u8::from(i == j)));
        let h = core::array::from_fn::<_, 9, _>(unit);
        let g = unit(i).map(|e| -2.0 * far * e);
        let mut a = [unit(i); 2];
        a[1][(i + 1) % 9] = 1.0;
        let u = [far, far - gap];
        let p = Problem::new(&h, &g, &a, &[-INF; 2], &u);
        let mut w = Workspace::new();
        let s = solve(&p, &Settings::default(), &mut w).unwrap();
        assert_eq!(s.status, Status::Solved, "{i}");
        let active: Vec<_> = w.active().collect();
        assert_eq!(active, [(Constraint::Row(0), Side::Upper)], "{i}");
    }
}

/// x₀ ≤ 1 leaves x at (1, 1), which misses 0.8 x₀ + x₁ ≤ 1.8 − gap by less than the tolerance or more. Only for more does that row enter, though
/// the list of violated rows or the memory of the last solve has it, in any units.
#[test]
fn a_listed_or_remembered_row_enters_for_more_than_the_tolerance() {
    let settings = Settings::default();
    for unit in [f64::powi(2.0, -20), 1.0, f64::powi(2.0, 20)] {
        let a = [[1.0, 0.0], [0.8 * unit, unit]];
        let limits = |gap: f64| [1.0, (1.8 - gap) * unit];
        let (less, more) = (limits(5e-10), limits(5e-9));
        let of = |u| Problem::new(&[[1.0, 0.0], [0.0, 1.0]], &[-2.0, -1.0], &a, &[-INF; 2], u);
        let mut w = Workspace::new();
        for (u, enters) in [(&less, false), (&more, true), (&less, false)] {
            let mut cold = Workspace::new();
            for (w, from) in [(&mut cold, "cold"), (&mut w, "warm")] {
                let s = solve_warm(&of(u), &settings, w).unwrap();
                assert_eq!(s.status, Status::Solved, "{from} {unit}");
                let active = w.active().any(|active| active == SECOND);
                assert_eq!(active, enters, "{from} {unit}");
            }
        }
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

/// The tolerance is one of violation / max|aᵢ|, however many entries a row has: one that is missed by twice as much is met.
#[test]
fn the_tolerance_of_a_row_is_that_of_its_largest_entry() {
    let h = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))));
    let settings = Settings::default();
    for (limit, is_met) in [(0.5, false), (2.0, true)] {
        let limit = [limit * settings.feasibility];
        let p = Problem::new(&h, &[0.0; 16], &[[1.0; 16]], &limit, &[INF]);
        let mut w = Workspace::new();
        let s = solve(&p, &settings, &mut w).unwrap();
        assert_eq!(s.status, Status::Solved);
        let sum: f64 = s.x.iter().sum();
        assert_eq!(sum > 0.99 * limit[0], is_met, "{sum:e}");
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
