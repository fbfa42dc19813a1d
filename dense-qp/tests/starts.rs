//! What solves that begin where another ended promise: when remembered rows are tried, what is counted, and what a cap may end.
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    clippy::needless_range_loop,
    reason = "tests"
)]

use crate::common::{Draw, INF, Qp, Tally, dot, each};
use dense_qp::{Settings, Status, Workspace, kkt_residual, resume, solve, solve_warm};

const N: usize = 8;
const M: usize = 6;

/// Upper limits of independent rows, all of which the unconstrained minimum exceeds, and by how much.
fn exceeded(r: &mut Draw, unit: f64) -> (Box<Qp<f64, N, M>>, [f64; M]) {
    let mut q = Qp::zero();
    q.set_hessian(r, N, 0.5);
    let x: [f64; N] = core::array::from_fn(|_| unit * r.sym());
    q.aim(&x);
    let excess = core::array::from_fn(|_| unit * (0.5 + r.unit()));
    for i in 0..M {
        q.a[i] = core::array::from_fn(|j| 0.2 * r.sym() + if i == j { 1.0 } else { 0.0 });
        q.u[i] = dot(&q.a[i], &x) - excess[i];
    }
    (q, excess)
}

/// Remembered rows are tried where the start is violated by as much as last time, to a tenth, whatever the unit of x. Where it is by a third
/// more or less, the solve is a cold one. Tried rows count as steps, not as iterations.
#[test]
fn remembered_rows_are_tried_where_the_start_looks_alike() {
    each::<N, M>(20, 31, |mut r| {
        for unit in [1e-3, 1.0, 1e3] {
            let (q, excess) = exceeded(&mut r, unit);
            for (factor, is_alike) in [(0.95, true), (1.05, true), (0.7, false), (1.33, false)] {
                let mut next = q.clone();
                for i in 0..M {
                    next.u[i] += (1.0 - factor) * excess[i];
                }
                let (settings, mut w) = (Settings::default(), Workspace::new());
                let cold = solve(&next.problem(), &settings, &mut w).unwrap();
                let (x, steps) = (*cold.x, cold.steps);
                solve(&q.problem(), &settings, &mut w).unwrap();
                let s = solve_warm(&next.problem(), &settings, &mut w).unwrap();
                assert_eq!(s.status, Status::Solved);
                assert_eq!(s.steps > s.iterations, is_alike, "{unit}, {factor}");
                assert!(is_alike || s.steps == steps, "{} {steps}", s.steps);
                for (a, b) in s.x.iter().zip(x) {
                    assert!((a - b).abs() < 1e-9 * unit, "{a} {b}");
                }
            }
        }
    });
}

/// Every row that leaves because its limit is gone is a step, and no iteration: it counts for the cap on time.
#[test]
fn resume_counts_the_rows_that_lose_their_limits() {
    each::<N, M>(20, 32, |mut r| {
        let (mut q, _) = exceeded(&mut r, 1.0);
        let mut w = Workspace::new();
        let settings = Settings::default();
        assert_eq!(
            solve(&q.problem(), &settings, &mut w).unwrap().status,
            Status::Solved
        );
        let active = w.active().count() as u32;
        assert!(active > 0);
        q.u = [INF; M];
        let s = resume(&q.problem(), &settings, &mut w).unwrap();
        assert_eq!(s.status, Status::Solved);
        assert_eq!(s.steps - s.iterations, active);
        assert_eq!(w.active().count(), 0);
    });
}

/// So is every row that leaves because it would pull, its limit having moved away. Where nothing has moved, no row leaves.
#[test]
fn resume_counts_the_rows_that_would_pull() {
    each::<N, M>(20, 34, |mut r| {
        let (mut q, excess) = exceeded(&mut r, 1.0);
        let (settings, mut w) = (Settings::default(), Workspace::new());
        solve(&q.problem(), &settings, &mut w).unwrap();
        let active: Vec<_> = w.active().collect();
        assert!(!active.is_empty());
        let s = resume(&q.problem(), &settings, &mut w).unwrap();
        assert_eq!((s.status, s.steps), (Status::Solved, s.iterations));
        assert_eq!(w.active().collect::<Vec<_>>(), active);
        for i in 0..M {
            q.u[i] += 3.0 * excess[i];
        }
        let s = resume(&q.problem(), &settings, &mut w).unwrap();
        assert_eq!(s.status, Status::Solved);
        assert_eq!(s.steps - s.iterations, active.len() as u32);
        assert_eq!(w.active().count(), 0);
    });
}

/// However soon a warm or resumed solve is capped, also while a remembered row pulls that there is no time to let go: what is called solved is
/// optimal, signs of multipliers included.
#[test]
fn what_a_cap_ends_is_not_called_solved() {
    const N: usize = 12;
    const M: usize = 16;
    let tally = Tally::default();
    each::<N, M>(120, 33, |mut r| {
        let mut q = Qp::<f64, N, M>::zero();
        q.set_hessian(&mut r, N, 0.1);
        q.set_rows(&mut r, 0, false);
        let (settings, mut last) = (Settings::default(), Workspace::new());
        solve(&q.problem(), &settings, &mut last).unwrap();
        for g in &mut q.g {
            *g *= 1.0 + 0.1 * r.sym();
        }
        for (l, u) in q.l.iter_mut().zip(&mut q.u) {
            let by = 0.3 * r.sym();
            (*l, *u) = (*l + by, *u + by);
        }
        let p = q.problem();
        for max_steps in 1..30 {
            for again in [solve_warm, resume] {
                let mut w = last.clone();
                let capped = Settings {
                    max_steps,
                    ..settings
                };
                let s = again(&p, &capped, &mut w).unwrap();
                match s.status {
                    Status::Solved => {
                        tally.add("solved");
                        let off = kkt_residual(&p, s.x, s.row_multipliers, s.bound_multipliers);
                        assert!(off.max() < 1e-7, "{max_steps}: {off:?}");
                    }
                    Status::Limit => tally.add("capped"),
                    // Limits have moved towards each other.
                    status => assert_eq!(status, Status::Infeasible),
                }
            }
        }
    });
    let (capped, solved) = (tally.of("capped"), tally.of("solved"));
    assert!(capped > 1000 && solved > 1000, "{capped} {solved}");
}
