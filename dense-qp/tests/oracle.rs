//! Status and optimum against Clarabel on random problems of 5 to 60 variables.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::needless_range_loop,
    reason = "tests"
)]

use crate::common::oracle::{Oracle, clarabel};
use crate::common::{Draw, Qp, each, largest_term, worth_of_misses};
use clarabel::solver::SolverStatus;
use dense_qp::{
    Settings, Solution, Status, Workspace, infeasibility, kkt_residual, solve, solve_warm,
};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Regular,
    Equalities,
    Degenerate,
    Semidefinite,
    Linear,
    Infeasible,
}

fn generate<const N: usize, const M: usize>(kind: Kind, r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    let few = r.below(N.min(M) / 2 + 1);
    match kind {
        Kind::Regular => {
            q.set_hessian(r, N, 0.1);
            q.set_rows(r, 0, false);
        }
        Kind::Equalities => {
            q.set_hessian(r, N, 0.01);
            q.set_rows(r, few, false);
        }
        Kind::Degenerate => {
            q.set_hessian(r, N, 0.1);
            q.set_rows(r, few, true);
        }
        Kind::Semidefinite => {
            q.set_hessian(r, N / 2, 0.0);
            q.set_rows(r, few / 2, false);
        }
        Kind::Linear => q.set_rows(r, few / 2, false),
        Kind::Infeasible => {
            q.set_hessian(r, N, 0.1);
            q.set_rows(r, few, true);
            // The last row contradicts a positive combination of limits that exist.
            let last = M - 1;
            let mut row = [0.0; N];
            let mut limit = 0.0;
            for i in 0..last {
                if q.u[i] < f64::INFINITY && r.chance(0.3) {
                    let f = r.unit();
                    for j in 0..N {
                        row[j] += f * q.a[i][j];
                    }
                    limit += f * q.u[i];
                }
            }
            q.a[last] = row;
            q.l[last] = limit + 1e-3 + r.unit();
            q.u[last] = f64::INFINITY;
        }
    }
    q
}

/// Conditions of optimality to 1e-8, or to the round-off of their terms as [`Settings`] promises it: a singular H may leave x near 10⁶, where
/// a row or a gradient is not known to 1e-8 by anyone.
fn assert_optimal<const N: usize, const M: usize>(
    q: &Qp<f64, N, M>,
    s: &Solution<'_, f64, N, M>,
    label: &str,
) {
    let (x, rows, bounds) = (s.x, s.row_multipliers, s.bound_multipliers);
    let again = kkt_residual(&q.problem(), x, rows, bounds);
    let most = 1e-8 + 1024.0 * f64::EPSILON * largest_term(q, x, rows, bounds);
    assert!(
        s.residual.max() <= most && again.max() <= most,
        "{label}: {:?} {again:?} {most:e}",
        s.residual
    );
}

/// Warm from the answer: the same point at once.
fn assert_remembered<const N: usize, const M: usize>(
    kind: Kind,
    q: &Qp<f64, N, M>,
    x: &[f64; N],
    w: &mut Workspace<f64, N, M>,
    label: &str,
) {
    let again = solve_warm(&q.problem(), &Settings::default(), w).unwrap();
    assert_eq!(again.status, Status::Solved, "{label} warm");
    assert_optimal(q, &again, &format!("{label} warm"));
    if kind == Kind::Regular || kind == Kind::Equalities {
        let iterations = again.iterations;
        assert!(iterations <= 3, "{label} warm {iterations}");
        let gaps = again.x.iter().zip(x).map(|(a, b)| (a - b).abs());
        let off = gaps.fold(0., f64::max);
        assert!(off < 1e-8, "{label}: warm off by {off}");
    }
}

fn check<const N: usize, const M: usize>(kind: Kind, seed: u64, count: u64) {
    each::<N, M>(count as u32, seed, |mut r| {
        let mut w = Box::new(Workspace::<f64, N, M>::new());
        let settings = Settings::default();
        let q = generate::<N, M>(kind, &mut r);
        let p = q.problem();
        let s = solve(&p, &settings, &mut w).unwrap();
        let truth = clarabel(&p);
        let label = format!("{kind:?} N={N} M={M} : {:?}", s.status);
        match truth.status {
            // An interior point that follows a ray until its tolerances, relative to x, are met calls that an optimum.
            SolverStatus::Solved | SolverStatus::AlmostSolved
                if s.status == Status::Unbounded && truth.x.iter().any(|x| x.abs() > 1e9) =>
            {
                assert_unbounded(&q, &s, &label);
            }
            SolverStatus::Solved | SolverStatus::AlmostSolved => {
                assert_eq!(
                    s.status,
                    Status::Solved,
                    "{label} against {:?}",
                    truth.status
                );
                assert_optimal(&q, &s, &label);
                assert_costs(&q, &s, &truth, &label);
                if kind == Kind::Regular {
                    let off =
                        s.x.iter()
                            .zip(&truth.x)
                            .map(|(a, b)| (a - b).abs())
                            .fold(0., f64::max);
                    assert!(off < 1e-4, "{label}: x off by {off}");
                }
                let x = *s.x;
                assert_remembered(kind, &q, &x, &mut w, &label);
            }
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                assert_eq!(s.status, Status::Infeasible, "{label}");
                let proof = infeasibility(&p, s.row_multipliers, s.bound_multipliers);
                assert!(
                    proof.support < 0.0 && proof.combination < 1e-9,
                    "{label} {proof:?}"
                );
                assert!(s.conflict().count() > 0);
            }
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => {
                assert_eq!(s.status, Status::Unbounded, "{label}");
                assert_unbounded(&q, &s, &label);
            }
            // The oracle gave up: our answer carries its own proof.
            other => match s.status {
                Status::Solved => assert_optimal(&q, &s, &label),
                Status::Unbounded => assert_unbounded(&q, &s, &label),
                Status::Infeasible => {
                    let proof = infeasibility(&p, s.row_multipliers, s.bound_multipliers);
                    assert!(
                        proof.support < 0.0 && proof.combination < 1e-9,
                        "{label} {proof:?}"
                    );
                }
                _ => panic!("{label}: the oracle says {other:?}"),
            },
        }
    });
}

/// No point of the oracle's is cheaper by more than what it misses limits by is worth: where rows are nearly dependent, its 1e-9 of a row
/// times a multiplier of 10⁶ is. Nor is its optimum dearer, unless it says itself that it has not found it.
fn assert_costs<const N: usize, const M: usize>(
    q: &Qp<f64, N, M>,
    s: &Solution<'_, f64, N, M>,
    truth: &Oracle,
    label: &str,
) {
    let cost = q.problem().cost(s.x);
    let x = core::array::from_fn(|i| truth.x[i]);
    let excess = cost - q.problem().cost(&x);
    let misses = worth_of_misses(q, &x, s.row_multipliers, s.bound_multipliers);
    let slack = 2e-6 * (1.0 + cost.abs());
    assert!(
        excess <= slack + misses && (excess >= -slack || truth.status != SolverStatus::Solved),
        "{label}: {cost}, {excess:e}, {misses:e}"
    );
}

/// x is feasible, and the ray is a direction of recession without curvature that lowers the cost.
fn assert_unbounded<const N: usize, const M: usize>(
    q: &Qp<f64, N, M>,
    s: &Solution<'_, f64, N, M>,
    label: &str,
) {
    let d = s.ray().unwrap();
    let dot = |a: &[f64; N]| a.iter().zip(d).map(|(a, d)| a * d).sum::<f64>();
    assert!(s.residual.primal < 1e-6, "{label}: {:?}", s.residual);
    assert!(dot(&q.g) < -1e-6, "{label}: no descent");
    assert!(
        q.h.iter().all(|h| dot(h).abs() < 1e-9),
        "{label}: curvature along the ray"
    );
    for i in 0..M {
        let rate = dot(&q.a[i]);
        assert!(
            rate < 1e-9 || q.u[i] == f64::INFINITY,
            "{label}: row {i} stops the ray"
        );
        assert!(
            rate > -1e-9 || q.l[i] == -f64::INFINITY,
            "{label}: row {i} stops the ray"
        );
    }
    for i in 0..N {
        assert!(
            d[i] < 1e-9 || q.ub[i] == f64::INFINITY,
            "{label}: bound {i} stops the ray"
        );
        assert!(
            d[i] > -1e-9 || q.lb[i] == -f64::INFINITY,
            "{label}: bound {i} stops the ray"
        );
    }
}

fn sizes(kind: Kind, count: u64) {
    check::<6, 4>(kind, 1, 4 * count);
    check::<12, 20>(kind, 2, 3 * count);
    check::<16, 32>(kind, 3, 2 * count);
    check::<35, 60>(kind, 4, count);
    check::<60, 40>(kind, 5, count);
    check::<60, 90>(kind, 6, count / 2);
}

#[test]
fn regular() {
    sizes(Kind::Regular, 20);
}
#[test]
fn equalities() {
    sizes(Kind::Equalities, 20);
}
#[test]
fn degenerate() {
    sizes(Kind::Degenerate, 20);
}
#[test]
fn semidefinite() {
    sizes(Kind::Semidefinite, 20);
}
/// Draws that end at a ray far out on it, where rows are missed by round-off.
#[test]
fn semidefinite_far_out() {
    for seed in [2, 11] {
        check::<6, 4>(Kind::Semidefinite, seed, 80);
        check::<12, 20>(Kind::Semidefinite, seed, 60);
        check::<16, 32>(Kind::Semidefinite, seed, 40);
    }
}
#[test]
fn linear() {
    sizes(Kind::Linear, 20);
}
#[test]
fn infeasible() {
    sizes(Kind::Infeasible, 20);
}
