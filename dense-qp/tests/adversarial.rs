//! Attempts to make a status lie: bad data, extreme scales, thin and empty feasible sets, f32.
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    clippy::needless_range_loop,
    reason = "tests"
)]

use crate::common::{Draw, Qp, Tally, each};
use dense_qp::{
    Constraint, Error, Problem, Settings, Side, Status, Workspace, infeasibility, kkt_residual,
    resume, solve, solve_warm,
};

const INF: f64 = f64::INFINITY;

/// Every number of a solvable problem replaced in turn by NaN and ±∞: an error that names it or an
/// honest status, never a hang, and the workspace works afterwards.
#[test]
fn bad_numbers_are_named() {
    each::<6, 9>(1, 5, name_bad_numbers);
}

fn name_bad_numbers(mut r: Draw) {
    const N: usize = 6;
    const M: usize = 9;
    let mut q = Qp::<f64, N, M>::zero();
    q.set_hessian(&mut r, N, 0.5);
    q.set_rows(&mut r, 2, false);
    for i in 0..N {
        (q.lb[i], q.ub[i]) = (-9.0, 9.0);
    }
    let settings = Settings::default();
    let mut w = Box::new(Workspace::<f64, N, M>::new());
    let good = *solve(&q.problem(), &settings, &mut w).unwrap().x;
    for bad in [f64::NAN, INF, -INF] {
        for i in 0..N {
            for j in 0..N {
                let mut b = q.clone();
                b.h[i][j] = bad;
                let e = solve_warm(&b.problem(), &settings, &mut w).unwrap_err();
                assert_eq!(e, Error::HessianNotFinite(i), "h[{i}][{j}] = {bad}");
            }
            let mut b = q.clone();
            b.g[i] = bad;
            let e = solve_warm(&b.problem(), &settings, &mut w).unwrap_err();
            assert_eq!(e, Error::GradientNotFinite(i));
            for upper in [false, true] {
                let mut b = q.clone();
                if upper {
                    b.ub[i] = bad;
                } else {
                    b.lb[i] = bad;
                }
                let free = if upper { INF } else { -INF };
                match solve_warm(&b.problem(), &settings, &mut w) {
                    Ok(s) => assert!(bad == free && s.status == Status::Solved),
                    Err(e) => assert_eq!(e, Error::Bounds(i)),
                }
            }
        }
        for i in 0..M {
            for j in 0..N {
                let mut b = q.clone();
                b.a[i][j] = bad;
                let e = solve_warm(&b.problem(), &settings, &mut w).unwrap_err();
                assert_eq!(e, Error::RowNotFinite(i), "a[{i}][{j}] = {bad}");
            }
            for upper in [false, true] {
                let mut b = q.clone();
                if upper {
                    b.u[i] = bad;
                } else {
                    b.l[i] = bad;
                }
                let free = if upper { INF } else { -INF };
                match solve_warm(&b.problem(), &settings, &mut w) {
                    Ok(s) => assert!(bad == free && s.status == Status::Solved),
                    Err(e) => assert_eq!(e, Error::RowLimits(i), "{upper} {bad}"),
                }
            }
        }
    }
    let s = solve_warm(&q.problem(), &settings, &mut w).unwrap();
    assert_eq!(s.status, Status::Solved);
    for i in 0..N {
        assert!((s.x[i] - good[i]).abs() < 1e-10);
    }
}

#[test]
fn inverted_limits_and_concave_costs_are_errors() {
    let mut w = Workspace::<f64, 2, 1>::new();
    let h = [[1.0, 0.0], [0.0, 1.0]];
    let p = Problem::new(&h, &[0.0; 2], &[[1.0, 1.0]], &[1.0], &[0.5]);
    let e = solve(&p, &Settings::default(), &mut w).unwrap_err();
    assert_eq!(e, Error::RowLimits(0));
    let h = [[1.0, 0.0], [0.0, -1e-3]];
    let p = Problem::new(&h, &[0.0; 2], &[[1.0, 1.0]], &[-1.0], &[0.5]);
    let e = solve(&p, &Settings::default(), &mut w).unwrap_err();
    assert_eq!(e, Error::HessianNotConvex(1));
    // Concave only where the equality does not let x go: fine.
    let p = Problem::new(&h, &[0.0; 2], &[[0.0, 1.0]], &[0.5], &[0.5]);
    assert_eq!(
        solve(&p, &Settings::default(), &mut w).unwrap().status,
        Status::Solved
    );
    let h = [[1.0, 0.5], [0.0, 1.0]];
    let p = Problem::new(&h, &[1.0; 2], &[[1.0, 1.0]], &[-1.0], &[0.5]);
    assert!(matches!(
        solve(&p, &Settings::default(), &mut w),
        Err(Error::HessianNotSymmetric(_)) | Ok(_)
    ));
}

/// H = UᵀDU with a pivot of −1e-6 behind pivots of 1 and 0, in any unit: that one is named, whichever sign round-off gives to those of 0. With a
/// third 0 instead H is convex.
#[test]
fn a_small_negative_curvature_is_named_behind_none() {
    each::<6, 0>(60, 14, |mut r| {
        let rows: [[f64; 6]; 6] = core::array::from_fn(|k| {
            core::array::from_fn(|i| match i.cmp(&k) {
                core::cmp::Ordering::Less => 0.0,
                core::cmp::Ordering::Equal => 1.0,
                core::cmp::Ordering::Greater => r.sym(),
            })
        });
        let unit = f64::powi(2.0, r.below(81) as i32 - 40);
        for (last, is_concave) in [(-1e-6, true), (0.0, false)] {
            let mut q = Qp::<f64, 6, 0>::zero();
            for (row, pivot) in rows.iter().zip([1.0, 0.0, 1.0, 0.0, 1.0, last]) {
                q.add_outer(row, unit * pivot);
            }
            let mut w = Workspace::new();
            let outcome = solve(&q.problem(), &Settings::default(), &mut w);
            let error = outcome.map(|s| s.status);
            let expected = if is_concave {
                Err(Error::HessianNotConvex(5))
            } else {
                Ok(Status::Solved)
            };
            assert_eq!(error, expected, "{unit}");
        }
    });
}

/// Rows and costs scaled by 1e-8 to 1e8: the same minimiser and an honest residual.
#[test]
fn scaling() {
    const N: usize = 12;
    const M: usize = 20;
    each::<N, M>(60, 6, |mut r| {
        let mut w = Box::new(Workspace::<f64, N, M>::new());
        let mut q = Qp::<f64, N, M>::zero();
        q.set_hessian(&mut r, N, 0.2);
        let degenerate = r.chance(0.5);
        q.set_rows(&mut r, 3, degenerate);
        let s = solve(&q.problem(), &Settings::default(), &mut w).unwrap();
        assert_eq!(s.status, Status::Solved);
        let x = *s.x;
        let f = 10f64.powf(8.0 * r.sym());
        for i in 0..N {
            q.g[i] *= f;
            for j in 0..N {
                q.h[i][j] *= f;
            }
        }
        for i in 0..M {
            let f = 10f64.powf(8.0 * r.sym());
            for a in &mut q.a[i] {
                *a *= f;
            }
            let equal = q.l[i] == q.u[i];
            q.l[i] *= f;
            q.u[i] = if equal { q.l[i] } else { q.u[i] * f };
        }
        let s = solve(&q.problem(), &Settings::default(), &mut w).unwrap();
        assert_eq!(s.status, Status::Solved);
        for i in 0..N {
            assert!((s.x[i] - x[i]).abs() < 1e-7, "{} {}", s.x[i], x[i]);
        }
    });
}

/// Two rows that miss each other by a margin: infeasible above the tolerance, solved below it.
#[test]
fn margins() {
    let mut w = Workspace::<f64, 3, 2>::new();
    let h = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (margin, expected) in [
        (1e-3, Status::Infeasible),
        (1e-6, Status::Infeasible),
        (1e-8, Status::Infeasible),
        (1e-10, Status::Solved),
        (0.0, Status::Solved),
        (-1e-9, Status::Solved),
    ] {
        let a = [[1.0, 2.0, -1.0], [-1.0, -2.0, 1.0]];
        let u = [1.0, -1.0 - 4.0 * margin];
        let p = Problem::new(&h, &[1.0; 3], &a, &[-INF; 2], &u);
        let s = solve(&p, &Settings::default(), &mut w).unwrap();
        assert_eq!(s.status, expected, "margin {margin}");
        if expected == Status::Infeasible {
            let proof = infeasibility(&p, s.row_multipliers, s.bound_multipliers);
            assert!(proof.combination < 1e-12 && proof.support < 0.0);
            let names: Vec<_> = s.conflict().collect();
            let rows = [
                (Constraint::Row(0), Side::Upper),
                (Constraint::Row(1), Side::Upper),
            ];
            assert_eq!(names, rows);
        }
    }
}

/// Nearly parallel rows meet far away; whatever the status, it is true.
#[test]
fn nearly_dependent_rows() {
    let tally = Tally::default();
    each::<4, 6>(400, 7, |mut r| {
        let mut w = Workspace::<f64, 4, 6>::new();
        let mut q = Qp::<f64, 4, 6>::zero();
        q.set_hessian(&mut r, 4, 0.1);
        let equalities = r.below(3);
        q.set_rows(&mut r, equalities, false);
        for i in 1..6 {
            if r.chance(0.6) {
                let angle = 10f64.powf(-4.0 - 10.0 * r.unit());
                let from = r.below(i);
                for j in 0..4 {
                    q.a[i][j] = q.a[from][j] + angle * r.sym();
                }
                if q.u[i] == q.l[i] && r.chance(0.5) {
                    (q.l[i], q.u[i]) = (q.l[from].max(-9.0), q.l[from].max(-9.0));
                }
            }
        }
        let p = q.problem();
        let s = solve(&p, &Settings::default(), &mut w).unwrap();
        let again = kkt_residual(&p, s.x, s.row_multipliers, s.bound_multipliers);
        match s.status {
            Status::Solved => {
                tally.add("solved");
                let length: f64 = s.x.iter().map(|v| v.abs()).sum();
                let largest = s
                    .row_multipliers
                    .iter()
                    .fold(1.0, |m: f64, v| m.max(v.abs()));
                assert!(again.primal <= 1e-9 + 1e-14 * length, "{again:?}");
                assert!(again.stationarity <= 1e-8 * largest, "{again:?}");
            }
            Status::Infeasible => {
                tally.add("proved");
                let proof = infeasibility(&p, s.row_multipliers, s.bound_multipliers);
                assert!(proof.support < 0.0, "{proof:?}");
                assert!(proof.combination * 10.0 <= -proof.support, "{proof:?}");
            }
            Status::Numerical | Status::Limit => tally.add("gave up"),
            Status::Unbounded => unreachable!("H is definite"),
        }
    });
    let [solved, proved, gave_up] = ["solved", "proved", "gave up"].map(|what| tally.of(what));
    assert!(
        solved > 100 && proved > 100 && gave_up < 20,
        "solved {solved}, proved {proved}, gave up {gave_up}"
    );
}

#[test]
fn unbounded_and_huge_bounds() {
    let mut w = Workspace::<f64, 3, 1>::new();
    let h = [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
    let g = [1.0, -1.0, 0.0];
    let a = [[1.0, 0.0, 1.0]];
    let p = Problem::new(&h, &g, &a, &[-1.0], &[1.0]);
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Unbounded);
    assert!((s.ray().unwrap()[1] - 1.0).abs() < 1e-9);
    for bound in [1e3, 1e6, 1e10] {
        let (lb, ub) = ([-bound; 3], [bound; 3]);
        let p = Problem::new(&h, &g, &a, &[-1.0], &[1.0]).with_bounds(&lb, &ub);
        let s = solve(&p, &Settings::default(), &mut w).unwrap();
        assert_eq!(s.status, Status::Solved, "bound {bound}: {:?}", s.residual);
        assert!((s.x[1] / bound - 1.0).abs() < 1e-9);
    }
}

/// All variables fixed by equalities, more equalities than variables, contradictory ones.
#[test]
fn overdetermined() {
    let mut w = Workspace::<f64, 2, 4>::new();
    let h = [[1.0, 0.0], [0.0, 1.0]];
    let a = [[1.0, 1.0], [1.0, -1.0], [2.0, 0.0], [1.0, 0.0]];
    let b = [3.0, 1.0, 4.0, 2.0];
    let p = Problem::new(&h, &[1.0, 1.0], &a, &b, &b);
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Solved);
    assert!((s.x[0] - 2.0).abs() < 1e-12 && (s.x[1] - 1.0).abs() < 1e-12);
    assert!(s.residual.max() < 1e-12);
    let b = [3.0, 1.0, 4.0, 2.1];
    let p = Problem::new(&h, &[1.0, 1.0], &a, &b, &b);
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Infeasible);
    let proof = infeasibility(&p, s.row_multipliers, s.bound_multipliers);
    assert!(
        proof.combination < 1e-12 && proof.support < -1e-3,
        "{proof:?}"
    );
    let (b, u) = ([3.0, 1.0, 4.0, -INF], [3.0, 1.0, 4.0, 1.9]);
    let p = Problem::new(&h, &[1.0, 1.0], &a, &b, &u);
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Infeasible);
    let proof = infeasibility(&p, s.row_multipliers, s.bound_multipliers);
    assert!(
        proof.combination < 1e-12 && proof.support < -1e-3,
        "{proof:?}"
    );
}

/// The cap is kept, and the status says so.
#[test]
fn cap() {
    each::<16, 32>(1, 9, |mut r| {
        let mut q = Qp::<f64, 16, 32>::zero();
        q.set_hessian(&mut r, 16, 0.1);
        q.set_rows(&mut r, 4, false);
        let mut w = Box::new(Workspace::<f64, 16, 32>::new());
        let free = solve(&q.problem(), &Settings::default(), &mut w)
            .unwrap()
            .iterations;
        assert!(free > 6);
        for max_iterations in 0..free {
            let settings = Settings {
                max_iterations,
                ..Settings::default()
            };
            let s = solve(&q.problem(), &settings, &mut w).unwrap();
            assert!(s.iterations <= max_iterations);
            assert!(s.status == Status::Limit || s.residual.max() < 1e-8);
            assert!(s.x.iter().all(|v| v.is_finite()));
        }
    });
}

/// The cap on steps holds for remembered rows as well, cold, warm and resumed, and what it ends is never called solved.
#[test]
fn cap_on_steps() {
    let tally = Tally::default();
    each::<16, 32>(40, 10, |mut r| {
        let mut w = Box::new(Workspace::<f64, 16, 32>::new());
        let mut q = Qp::<f64, 16, 32>::zero();
        q.set_hessian(&mut r, 16, 0.1);
        q.set_rows(&mut r, 4, false);
        for max_steps in [0, 1, 3, 6, 10, 15, 25, 40] {
            let settings = Settings {
                max_steps,
                ..Settings::default()
            };
            for again in [solve, solve_warm, resume] {
                let s = again(&q.problem(), &settings, &mut w).unwrap();
                // Rows that pull leave together, at most all of them.
                assert!(s.steps <= max_steps + 16 && s.iterations <= s.steps);
                assert!(s.x.iter().all(|v| v.is_finite()));
                match s.status {
                    Status::Limit => tally.add("limits"),
                    status => {
                        assert_eq!(status, Status::Solved);
                        assert!(s.residual.max() < 1e-7, "{:?}", s.residual);
                        tally.add("others");
                    }
                }
            }
        }
    });
    let (limits, others) = (tally.of("limits"), tally.of("others"));
    assert!(limits > 300 && others > 100, "{limits} {others}");
}

/// Limits that go, or move, after a search, infeasible or not: [`resume`] finds what a fresh solve finds, in fewer steps.
#[test]
fn resumed_is_solved() {
    let tally = Tally::default();
    let last = core::cell::RefCell::new(Box::new(Workspace::<f64, 16, 32>::new()));
    let settings = Settings::default();
    each::<16, 32>(200, 11, |mut r| {
        let mut w = last.borrow_mut();
        let mut fresh = Box::new(Workspace::<f64, 16, 32>::new());
        let mut q = Qp::<f64, 16, 32>::zero();
        q.set_hessian(&mut r, 16, 0.1);
        q.set_rows(&mut r, 4, false);
        // Sums that bounds do not allow.
        let narrow = r.chance(0.5);
        let mut tight = q.clone();
        for i in 0..16 {
            let x = if narrow { 0.01 } else { 20.0 };
            (tight.lb[i], tight.ub[i]) = (-x, x);
        }
        let before = solve(&tight.problem(), &settings, &mut w).unwrap();
        if before.status == Status::Infeasible {
            tally.add("infeasible");
        }
        let resumed = resume(&q.problem(), &settings, &mut w).unwrap();
        let truth = solve(&q.problem(), &settings, &mut fresh).unwrap();
        assert_eq!(
            (resumed.status, truth.status),
            (Status::Solved, Status::Solved)
        );
        for (a, b) in resumed.x.iter().zip(truth.x) {
            assert!((a - b).abs() < 1e-7, "{a} {b}");
        }
        tally.count("fresh", truth.steps);
        tally.count("resumed", resumed.steps);
    });
    let infeasible = tally.of("infeasible");
    assert!(infeasible > 20 && infeasible < 200, "{infeasible}");
    assert!(tally.of("resumed") < tally.of("fresh"));
    // Without a last solve it is a solve; after another program it is none that lies.
    each::<16, 32>(1, 12, |mut r| {
        let mut q = Qp::<f64, 16, 32>::zero();
        q.set_hessian(&mut r, 16, 0.1);
        q.set_rows(&mut r, 4, false);
        let mut new = Box::new(Workspace::<f64, 16, 32>::new());
        let s = resume(&q.problem(), &settings, &mut new).unwrap();
        assert_eq!(s.status, Status::Solved);
        let mut old = last.borrow_mut();
        let s = resume(&q.problem(), &settings, &mut old).unwrap();
        assert!(s.status != Status::Solved || s.residual.max() < 1e-7);
    });
}

/// f32 against f64 on the same problems, scaled residual.
#[test]
fn single_precision() {
    fn check<const N: usize, const M: usize>(cases: u32) {
        each::<N, M>(cases, 13, |mut r| {
            let mut w = Box::new(Workspace::<f64, N, M>::new());
            let mut v = Box::new(Workspace::<f32, N, M>::new());
            let mut q = Qp::<f64, N, M>::zero();
            q.set_hessian(&mut r, N, 0.1);
            let degenerate = r.chance(0.5);
            q.set_rows(&mut r, N / 4, degenerate);
            let f = q.single();
            let p = f.problem();
            let s = solve(&p, &Settings::default(), &mut v).unwrap();
            let truth = solve(&q.problem(), &Settings::default(), &mut w).unwrap();
            assert_eq!(truth.status, Status::Solved);
            assert_eq!(s.status, Status::Solved, "N {N}: {:?}", s.residual);
            let scale = truth
                .row_multipliers
                .iter()
                .chain(truth.bound_multipliers)
                .chain(&q.g)
                .fold(1.0, |m: f64, v| m.max(v.abs()));
            let residual = kkt_residual(&p, s.x, s.row_multipliers, s.bound_multipliers);
            assert!(
                f64::from(residual.max()) <= 1e-3 * scale,
                "N {N}: {residual:?}"
            );
        });
    }
    check::<6, 4>(300);
    check::<12, 20>(300);
    check::<35, 60>(150);
    check::<60, 90>(50);
}
