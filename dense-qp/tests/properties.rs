//! Laws of every optimum, on programs that proptest draws: KKT conditions, duality, limits, units, order, memory.
#![allow(
    clippy::unwrap_used,
    clippy::needless_range_loop,
    clippy::disallowed_methods,
    reason = "tests"
)]

use crate::common::{INF, Qp, definite, dot, semidefinite};
use dense_qp::{Settings, Status, Workspace, kkt_residual, resume, solve, solve_warm};
use proptest::prelude::*;

const N: usize = 12;
const M: usize = 20;

/// Least point, multipliers of rows and bounds, steps.
struct Optimum {
    x: [f64; N],
    rows: [f64; M],
    bounds: [f64; N],
    steps: u32,
}

fn optimum(q: &Qp<f64, N, M>) -> Optimum {
    let mut w = Box::new(Workspace::<f64, N, M>::new());
    let s = solve(&q.problem(), &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Solved);
    Optimum {
        x: *s.x,
        rows: *s.row_multipliers,
        bounds: *s.bound_multipliers,
        steps: s.steps,
    }
}

fn off(a: &[f64], b: &[f64]) -> f64 {
    let gaps = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    gaps.fold(0.0, f64::max)
}

/// Powers of two from 2⁻²⁰ to 2²⁰.
fn powers<const K: usize>() -> impl Strategy<Value = [f64; K]> {
    prop::collection::vec(-20..=20_i32, K)
        .prop_map(|v| core::array::from_fn(|i| f64::powi(2.0, v[i])))
}

/// The same program with every row times a unit.
fn in_units(q: &Qp<f64, N, M>, units: &[f64; M]) -> Box<Qp<f64, N, M>> {
    let mut s = Box::new(q.clone());
    for i in 0..M {
        s.a[i] = s.a[i].map(|a| a * units[i]);
        s.l[i] *= units[i];
        s.u[i] *= units[i];
    }
    s
}

/// A permutation of 0..K.
fn order(k: usize) -> impl Strategy<Value = Vec<usize>> {
    Just((0..k).collect::<Vec<_>>()).prop_shuffle()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Hx + g + Aᵀλ + μ = 0, limits met, multipliers of the right sign and zero off their limits; the residual that the solver reports is
    /// that of an independent look.
    #[test]
    fn conditions_of_optimality(q in definite::<N, M>(2)) {
        let p = q.problem();
        let mut w = Box::new(Workspace::<f64, N, M>::new());
        let s = solve(&p, &Settings::default(), &mut w).unwrap();
        prop_assert_eq!(s.status, Status::Solved);
        let r = kkt_residual(&p, s.x, s.row_multipliers, s.bound_multipliers);
        prop_assert!(r.max() < 1e-8 && s.residual.max() < 1e-8, "{:?} {:?}", r, s.residual);
        let limits = q.l.iter().zip(&q.u).zip(s.row_multipliers);
        for ((l, u), y) in limits.chain(q.lb.iter().zip(&q.ub).zip(s.bound_multipliers)) {
            prop_assert!(l == u || *y >= 0.0 || *l > -INF);
            prop_assert!(l == u || *y <= 0.0 || *u < INF);
        }
    }

    /// The dual cost −½xᵀHx − Σ max(y,0) u + min(y,0) l equals the cost, and no feasible point is cheaper than it.
    #[test]
    fn duality(q in definite::<N, M>(2), t in 0.0..1.0_f64) {
        let p = q.problem();
        let o = optimum(&q);
        let quadratic: f64 = q.h.iter().zip(&o.x).map(|(h, x)| x * dot(h, &o.x)).sum();
        let support = |y: &[f64], l: &[f64], u: &[f64]| -> f64 {
            let rows = y.iter().zip(l.iter().zip(u)).filter(|(y, _)| **y != 0.0);
            rows.map(|(y, (l, u))| y * if *y > 0.0 { u } else { l }).sum()
        };
        let dual = -0.5 * quadratic - support(&o.rows, &q.l, &q.u) - support(&o.bounds, &q.lb, &q.ub);
        let cost = p.cost(&o.x);
        prop_assert!((cost - dual).abs() < 1e-7 * (1.0 + cost.abs()), "{} {}", cost, dual);
        // Another feasible point: the optimum of another cost; and those between.
        let mut other = q.clone();
        other.g = q.g.map(|g| -g);
        let y = optimum(&other).x;
        let between: [f64; N] = core::array::from_fn(|i| o.x[i] + t * (y[i] - o.x[i]));
        prop_assert!(p.cost(&between) >= cost - 1e-7 * (1.0 + cost.abs()));
    }

    /// Wider limits never cost more, and moving one limit changes the cost at the rate of its multiplier, from above.
    #[test]
    fn wider_limits_cost_less(q in definite::<N, M>(0), row in 0..M, by in 0.0..2.0_f64) {
        let o = optimum(&q);
        let mut wide = q.clone();
        wide.l[row] -= by;
        wide.u[row] += by;
        let (narrow_cost, cost) = (q.problem().cost(&o.x), wide.problem().cost(&optimum(&wide).x));
        let slack = 1e-7 * (1.0 + narrow_cost.abs());
        prop_assert!(cost <= narrow_cost + slack);
        prop_assert!(cost >= narrow_cost - o.rows[row].abs() * by - slack, "{} {}", cost, narrow_cost);
    }

    /// Rows in other units, by powers of two: the same bits of x in the same steps. The cost as well: the same x, multipliers in the new
    /// units.
    #[test]
    fn units_of_rows_do_not_matter(q in definite::<N, M>(2), cost in powers::<1>(), rows in powers::<M>()) {
        let mut s = in_units(&q, &rows);
        let (a, b) = (optimum(&q), optimum(&s));
        prop_assert_eq!((a.x, a.steps), (b.x, b.steps));
        for (h, g) in s.h.iter_mut().zip(&mut s.g) {
            *g *= cost[0];
            h.iter_mut().for_each(|h| *h *= cost[0]);
        }
        let b = optimum(&s);
        prop_assert!(off(&a.x, &b.x) < 1e-8, "{}", off(&a.x, &b.x));
        for i in 0..M {
            let y = b.rows[i] * rows[i] / cost[0];
            prop_assert!((a.rows[i] - y).abs() < 1e-6 * (1.0 + a.rows[i].abs()), "{} {}", a.rows[i], y);
        }
    }

    /// Nor where H is singular and the optimum is come to by proximal steps: what is near enough, and which row pulls most, is measured by
    /// forces, not by multipliers.
    #[test]
    fn units_of_rows_do_not_matter_to_proximal_steps(q in semidefinite::<N, M>(4), rows in powers::<M>()) {
        let settings = Settings::default();
        let (mut a, mut b) = (Box::new(Workspace::new()), Box::new(Workspace::new()));
        let s = in_units(&q, &rows);
        let a = solve(&q.problem(), &settings, &mut a).unwrap();
        let b = solve(&s.problem(), &settings, &mut b).unwrap();
        prop_assert_eq!((a.status, a.x, a.steps), (b.status, b.x, b.steps));
    }

    /// Variables and rows in another order: the same optimum.
    #[test]
    fn order_does_not_matter(q in definite::<N, M>(2), v in order(N), r in order(M)) {
        let mut s = Qp::<f64, N, M>::zero();
        for i in 0..N {
            s.h[i] = core::array::from_fn(|j| q.h[v[i]][v[j]]);
            (s.g[i], s.lb[i], s.ub[i]) = (q.g[v[i]], q.lb[v[i]], q.ub[v[i]]);
        }
        for i in 0..M {
            s.a[i] = core::array::from_fn(|j| q.a[r[i]][v[j]]);
            (s.l[i], s.u[i]) = (q.l[r[i]], q.u[r[i]]);
        }
        let (a, b) = (optimum(&q), optimum(&s));
        let x: [f64; N] = core::array::from_fn(|i| a.x[v[i]]);
        prop_assert!(off(&x, &b.x) < 1e-7, "{}", off(&x, &b.x));
    }

    /// Whatever a workspace remembers, it finds what a new one finds; the same program again at once.
    #[test]
    fn warm_is_cold(q in definite::<N, M>(2), other in definite::<N, M>(1), push in prop::collection::vec(-0.1..0.1_f64, N)) {
        let settings = Settings::default();
        let mut w = Box::new(Workspace::<f64, N, M>::new());
        let _ = solve(&other.problem(), &settings, &mut w).unwrap();
        let cold = optimum(&q);
        let s = solve_warm(&q.problem(), &settings, &mut w).unwrap();
        prop_assert_eq!(s.status, Status::Solved);
        prop_assert!(off(s.x, &cold.x) < 1e-8);
        let s = solve_warm(&q.problem(), &settings, &mut w).unwrap();
        prop_assert!(s.steps <= cold.steps + 1 && off(s.x, &cold.x) < 1e-8, "{} {}", s.steps, cold.steps);
        // A tick later.
        let mut next = q.clone();
        for (g, p) in next.g.iter_mut().zip(&push) {
            *g += p;
        }
        let cold = optimum(&next);
        let s = solve_warm(&next.problem(), &settings, &mut w).unwrap();
        prop_assert!(s.status == Status::Solved && off(s.x, &cold.x) < 1e-8);
        // Limits alone.
        let mut free = next;
        free.u[M - 1] += 0.5;
        free.lb[0] = -INF;
        free.ub[0] = INF;
        let cold = optimum(&free);
        let s = resume(&free.problem(), &settings, &mut w).unwrap();
        prop_assert!(s.status == Status::Solved && off(s.x, &cold.x) < 1e-7);
    }
}
