//! The shapes of the public collections (Maros-Meszaros' small programs, condensed model predictive control, the ill-conditioned ones of
//! free-for-all): no status that is wrong, in f64 and in f32, beside Clarabel on the same numbers.
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    clippy::needless_range_loop,
    reason = "tests"
)]

use crate::common::oracle::clarabel;
use crate::common::{Draw, Qp, Tally, dot, each, worth_of_misses};
use clarabel::solver::SolverStatus;
use dense_qp::{Settings, Status, Workspace, solve};

const INF: f64 = f64::INFINITY;

/// What Clarabel says; nothing where it gives up.
fn truth<const N: usize, const M: usize>(q: &Qp<f64, N, M>) -> Option<(Status, f64)> {
    let oracle = clarabel(&q.problem());
    match oracle.status {
        SolverStatus::Solved => Some((Status::Solved, oracle.cost)),
        SolverStatus::PrimalInfeasible => Some((Status::Infeasible, 0.0)),
        SolverStatus::DualInfeasible => Some((Status::Unbounded, 0.0)),
        _ => None,
    }
}

/// Entries and limits as f32 has them, so that both precisions and the oracle are given one program.
fn rounded<const N: usize, const M: usize>(q: &mut Qp<f64, N, M>) {
    let round = |x: &mut f64| *x = f64::from(*x as f32);
    q.h.as_flattened_mut().iter_mut().for_each(round);
    q.a.as_flattened_mut().iter_mut().for_each(round);
    for list in [&mut q.l[..], &mut q.u, &mut q.g, &mut q.lb, &mut q.ub] {
        list.iter_mut().for_each(round);
    }
}

/// Solves in both precisions and compares statuses and costs with the oracle's; f32 may give up, and the tally says how often.
fn judge<const N: usize, const M: usize>(mut q: Box<Qp<f64, N, M>>, label: &str, tally: &Tally) {
    rounded(&mut q);
    let p = q.problem();
    let Some((status, cost)) = truth(&q) else {
        tally.add("oracle gave up");
        return;
    };
    let mut w = Box::new(Workspace::<f64, N, M>::new());
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, status, "{label} {N}x{M}: {:?}", s.residual);
    // The size of the terms that the cost is the difference of.
    let size = |x: &[f64; N]| {
        let terms = x.iter().zip(&q.h).zip(&q.g);
        1.0 + terms
            .map(|((x, h), g)| x.abs() * (0.5 * dot(h, s.x).abs() + g.abs()))
            .sum::<f64>()
    };
    // What f32 may miss limits by is worth something: its cost may be lower by that.
    let misses = |x: &[f64; N]| worth_of_misses(&q, x, s.row_multipliers, s.bound_multipliers);
    if status == Status::Solved {
        let gap = (p.cost(s.x) - cost).abs() / size(s.x);
        assert!(gap <= 1e-6, "{label}: {} {cost}", p.cost(s.x));
    }
    let f = q.single();
    let mut v = Box::new(Workspace::<f32, N, M>::new());
    let single = solve(&f.problem(), &Settings::default(), &mut v).unwrap();
    match single.status {
        Status::Numerical | Status::Limit => tally.add("f32 gave up"),
        said => assert_eq!(said, status, "{label} {N}x{M} f32: {:?}", single.residual),
    }
    if single.status == Status::Solved {
        let x = single.x.map(f64::from);
        let (excess, slack) = (p.cost(&x) - cost, 1e-3 * size(s.x));
        assert!(
            excess <= slack && excess >= -slack - misses(&x),
            "{label} f32: {} {cost} {}",
            p.cost(&x),
            misses(&x)
        );
        assert_feasible(&q, &x, label);
    }
    tally.add(match status {
        Status::Solved => "solved",
        Status::Infeasible => "infeasible",
        _ => "unbounded",
    });
}

/// Limits are met to the tolerance of f32, as a distance, and the round-off of their terms.
fn assert_feasible<const N: usize, const M: usize>(q: &Qp<f64, N, M>, x: &[f64; N], label: &str) {
    let settings = Settings::<f32>::default();
    let (feasibility, noise) = (
        f64::from(settings.feasibility),
        32.0 * f64::from(f32::EPSILON),
    );
    for (a, (l, u)) in q.a.iter().zip(q.l.iter().zip(&q.u)) {
        let (mut value, mut terms, mut scale) = (0.0, 0.0, 0.0_f64);
        for (a, x) in a.iter().zip(x) {
            value += a * x;
            terms += (a * x).abs();
            scale = scale.max(a.abs());
        }
        let miss = (value - u).max(l - value);
        assert!(
            miss <= feasibility * scale + noise * terms,
            "{label} f32: {miss}"
        );
    }
    for (x, (l, u)) in x.iter().zip(q.lb.iter().zip(&q.ub)) {
        let miss = (x - u).max(l - x);
        assert!(miss <= feasibility + noise * x.abs(), "{label} f32: {miss}");
    }
}

/// A family in three sizes. `gives_up` is how many of its 36 programs f32 may leave without an answer.
macro_rules! family {
    ($name:ident, $make:ident, $seed:expr, $gives_up:expr) => {
        #[test]
        fn $name() {
            let tally = Tally::default();
            let label = stringify!($name);
            each::<6, 9>(12, $seed, |mut r| {
                judge($make::<6, 9>(&mut r), label, &tally)
            });
            each::<16, 32>(12, $seed + 100, |mut r| {
                judge($make::<16, 32>(&mut r), label, &tally)
            });
            each::<30, 40>(12, $seed + 200, |mut r| {
                judge($make::<30, 40>(&mut r), label, &tally)
            });
            let [gave_up, oracle] = ["f32 gave up", "oracle gave up"].map(|what| tally.of(what));
            assert!(
                gave_up <= $gives_up && oracle <= 4,
                "f32 gave up {gave_up}, the oracle {oracle}"
            );
        }
    };
}

/// Costs over the unit simplex: one dense equality, x ≥ 0 (DUAL1 to DUAL4).
fn simplex<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    q.set_hessian(r, N, 0.0);
    (q.a[0], q.l[0], q.u[0]) = ([1.0; N], 1.0, 1.0);
    (q.lb, q.ub) = ([0.0; N], [1.0; N]);
    q.g = core::array::from_fn(|_| r.sym());
    q
}
family!(costs_over_a_simplex, simplex, 1, 0);

/// Few variables whose rows bound one another tightly, with entries of 1e2 to 1e4 beside limits of the same size (DUALC1 to DUALC8).
fn large_entries<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    for _ in 0..N {
        let v = core::array::from_fn(|_| 100.0 * r.sym());
        q.add_outer(&v, 1.0);
    }
    (q.a[0], q.l[0], q.u[0]) = ([1.0; N], 1.0, 1.0);
    for i in 1..M {
        q.a[i] = core::array::from_fn(|_| 1e3 * r.unit());
        q.l[i] = dot(&q.a[i], &[1.0 / N as f64; N]) - 100.0 * r.unit();
    }
    (q.lb, q.ub) = ([0.0; N], [1.0; N]);
    q
}
family!(large_entries_in_dense_rows, large_entries, 2, 0);

/// Chains of differences with quadratic and linear parts of sizes 1e-4 and 1 (HS118, LISWET).
fn chain<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    for i in 0..N {
        q.h[i][i] = 2e-4 * (1.0 + r.unit());
        q.g[i] = 2.0 + r.sym();
        (q.lb[i], q.ub[i]) = (0.0, 60.0 + 60.0 * r.unit());
    }
    for i in 0..N - 1 {
        (q.a[i][i], q.a[i][i + 1]) = (-1.0, 1.0);
        (q.l[i], q.u[i]) = (-7.0, 6.0);
    }
    for i in N - 1..M {
        let from = r.below(N - 2);
        for j in from..from + 3 {
            q.a[i][j] = 1.0;
        }
        q.l[i] = 20.0 + 40.0 * r.unit();
    }
    q
}
family!(chains_of_differences, chain, 3, 0);

/// Nearly as many equalities as variables, copies among them, and a singular Hessian (GENHS28, HS51 to HS53, AUG2D, HUES-MOD). Dyadic
/// numbers, in which copies agree to the bit: whether 1e-8 is a contradiction is no question for an oracle.
fn equalities<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    for i in 0..N - 1 {
        let v = core::array::from_fn(|j| f64::from(u8::from(j == i || j == i + 1)));
        q.add_outer(&v, 1.0);
    }
    let x: [f64; N] = core::array::from_fn(|_| dyadic(r));
    let many = N - 1 - r.below(N / 3);
    for i in 0..many {
        let from = r.below(N - 2);
        for k in 0..3 {
            q.a[i][from + k] = (k + 1) as f64;
        }
        let b = dot(&q.a[i], &x);
        (q.l[i], q.u[i]) = (b, b);
    }
    if r.chance(0.5) {
        (q.lb, q.ub) = ([-0.75; N], [1.5; N]);
    }
    q
}
family!(equalities_and_little_else, equalities, 4, 0);

/// A linear program with ties: rows through one vertex, copies, costs orthogonal to faces (QAFIRO's and QSHARE's shape without H).
fn linear<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    for i in 0..M {
        for j in 0..N {
            q.a[i][j] = if r.chance(0.4) {
                (r.below(5) as f64) - 1.0
            } else {
                0.0
            };
        }
        // Many rows meet in the same vertex, at zero.
        q.u[i] = if r.chance(0.5) {
            0.0
        } else {
            1.0 + r.below(4) as f64
        };
        if i > 0 && r.chance(0.2) {
            (q.a[i], q.u[i]) = (q.a[i - 1], q.u[i - 1]);
        }
    }
    (q.lb, q.ub) = ([0.0; N], [4.0; N]);
    q.g = core::array::from_fn(|_| (r.below(7) as f64) - 4.0);
    q
}
family!(degenerate_linear_programs, linear, 5, 0);

/// The same with a few quadratic terms in a corner of H, and no upper bounds: bounded by rows alone, or not at all.
fn corner<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = linear::<N, M>(r);
    for i in 0..N / 3 {
        q.h[i][i] = 1.0 + r.below(3) as f64;
    }
    q.h[0][1] = 0.5;
    q.h[1][0] = 0.5;
    q.ub = [INF; N];
    if r.chance(0.5) {
        (q.a[M - 1], q.u[M - 1]) = ([1.0; N], 8.0);
    }
    q
}
family!(linear_programs_with_a_quadratic_corner, corner, 6, 0);

/// A multiple of 1/64 in [−1, 1): products and short sums of them are exact in f32, so that a rank stays what it is.
fn dyadic(r: &mut Draw) -> f64 {
    (64.0 * r.sym()).floor() / 64.0
}

/// H of low rank, its range and the costs' aim crossing all bounds (HS268, LASER, the least-squares programs).
fn low_rank<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    for _ in 0..=r.below(N - 1) {
        let v = core::array::from_fn(|_| dyadic(r));
        q.add_outer(&v, 1.0);
    }
    let x: [f64; N] = core::array::from_fn(|_| 2.0 * dyadic(r));
    q.aim(&x);
    for i in 0..M {
        q.a[i] = core::array::from_fn(|_| r.sym());
        q.u[i] = r.unit();
    }
    (q.lb, q.ub) = ([-1.0; N], [1.0; N]);
    q
}
family!(least_squares_of_low_rank, low_rank, 7, 0);

/// Columns in units from 1e-2 to 1e2 and rows from 1e-3 to 1e3 (CVXQP's and STADAT's numbers, GNAR's condition).
fn badly_scaled<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    q.set_hessian(r, N, 0.1);
    q.set_rows(r, N / 4, false);
    let units: [f64; N] = core::array::from_fn(|_| 10f64.powf(2.0 * r.sym()));
    for i in 0..N {
        for j in 0..N {
            q.h[i][j] *= units[i] * units[j];
        }
        q.g[i] *= units[i];
        (q.lb[i], q.ub[i]) = (q.lb[i] / units[i], q.ub[i] / units[i]);
    }
    for i in 0..M {
        let unit = 10f64.powf(3.0 * r.sym());
        for j in 0..N {
            q.a[i][j] *= unit * units[j];
        }
        (q.l[i], q.u[i]) = (q.l[i] * unit, q.u[i] * unit);
    }
    q
}
family!(units_that_do_not_match, badly_scaled, 8, 0);

/// Sums that bounds or another row do not allow, by a tenth of their size or by many times it.
fn infeasible<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = low_rank::<N, M>(r);
    let by = 10f64.powf(5.0 * r.unit() - 1.0);
    let last = M - 1;
    if r.chance(0.5) {
        // More than the bounds can give.
        let most: f64 = q.a[last].iter().map(|a| a.abs()).sum();
        (q.l[last], q.u[last]) = (most * (1.0 + by), INF);
    } else {
        // The opposite of a sum of others.
        let mut limit = 0.0;
        q.a[last] = [0.0; N];
        for i in 0..last.min(4) {
            let f = 0.5 + r.unit();
            for j in 0..N {
                q.a[last][j] += f * q.a[i][j];
            }
            limit += f * q.u[i];
        }
        (q.l[last], q.u[last]) = (limit + by, INF);
    }
    q
}
family!(demands_that_exclude_each_other, infeasible, 9, 0);

/// A direction that neither H nor rows nor bounds see, along which g falls, or only nearly so: one row stops it, with an entry of 1 %.
fn endless<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    for _ in 0..N {
        let v = core::array::from_fn(|j| if j == N - 1 { 0.0 } else { dyadic(r) });
        q.add_outer(&v, 1.0);
    }
    q.g = core::array::from_fn(|_| r.sym());
    q.g[N - 1] = -1.0;
    for i in 0..M {
        q.a[i] = core::array::from_fn(|j| if j == N - 1 { -r.unit() } else { r.sym() });
        q.u[i] = r.unit();
    }
    if r.chance(0.5) {
        q.a[0][N - 1] = 0.01;
    }
    q.lb[..N - 1].fill(-2.0);
    q.ub[..N - 1].fill(2.0);
    q.lb[N - 1] = 0.0;
    q
}
family!(descents_that_end_or_do_not, endless, 10, 0);

/// Condensed control of a double integrator: H from its response, rows on position and speed over the horizon, bounded input
/// (QUADCMPC, WHLIPBAL, LIPMWALK; the response of the last samples is 1e-2 of the first's).
fn predictive<const N: usize, const M: usize>(r: &mut Draw) -> Box<Qp<f64, N, M>> {
    let mut q = Qp::<f64, N, M>::zero();
    let dt = 0.1;
    let start = [0.8 * r.sym(), r.sym()];
    for k in 0..N {
        let n = (k + 1) as f64 * dt;
        let position: [f64; N] = core::array::from_fn(|j| {
            if j <= k {
                ((k - j) as f64 + 0.5) * dt * dt
            } else {
                0.0
            }
        });
        let speed: [f64; N] = core::array::from_fn(|j| if j <= k { dt } else { 0.0 });
        let free = [start[0] + n * start[1], start[1]];
        q.add_outer(&position, 10.0);
        q.add_outer(&speed, 1.0);
        for j in 0..N {
            q.g[j] += 10.0 * position[j] * free[0] + speed[j] * free[1];
        }
        q.h[k][k] += 1e-3;
        if k < M {
            (q.a[k], q.l[k], q.u[k]) = (position, -1.2 - free[0], 1.2 - free[0]);
        }
        if k + N < M {
            (q.a[k + N], q.l[k + N], q.u[k + N]) = (speed, -1.5 - free[1], 1.5 - free[1]);
        }
    }
    (q.lb, q.ub) = ([-3.0; N], [3.0; N]);
    q
}
family!(predictive_control, predictive, 11, 0);
