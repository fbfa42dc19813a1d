//! Laws of every optimum, on programs that proptest draws: KKT conditions, duality, limits, units, order, memory.
#![allow(
    clippy::unwrap_used,
    clippy::needless_range_loop,
    clippy::disallowed_methods,
    reason = "tests"
)]

use crate::common::{INF, Qp, definite, dot, semidefinite};
use dense_qp::{Constraint, Problem, Settings, Side, Status, Workspace};
use dense_qp::{infeasibility, kkt_residual, resume, solve, solve_warm};
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
fn in_units<const N: usize, const M: usize>(
    q: &Qp<f64, N, M>,
    units: &[f64; M],
) -> Box<Qp<f64, N, M>> {
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

/// The limit of a row or bound that x is farthest outside of, by |violation| / |a|₂.
fn farthest<const N: usize, const M: usize>(
    q: &Qp<f64, N, M>,
    x: &[f64; N],
) -> Option<(Constraint, Side)> {
    let rows = (0..M).map(|i| {
        let length = dot(&q.a[i], &q.a[i]).sqrt();
        (Constraint::Row(i), dot(&q.a[i], x), q.l[i], q.u[i], length)
    });
    let bounds = (0..N).map(|i| (Constraint::Bound(i), x[i], q.lb[i], q.ub[i], 1.0));
    let limits = rows
        .chain(bounds)
        .flat_map(|(constraint, v, l, u, length)| {
            let upper = (constraint, Side::Upper, (v - u) / length);
            [upper, (constraint, Side::Lower, (l - v) / length)]
        });
    let outside = limits.filter(|(.., distance)| *distance > 0.0);
    let worst = outside.max_by(|a, b| a.2.total_cmp(&b.2));
    worst.map(|(constraint, side, _)| (constraint, side))
}

/// A multiplier whose limit is there counts by the distance from that, one whose limit is not there in full.
#[test]
fn a_multiplier_without_a_limit_counts_in_full() {
    let (x, h, g) = ([0.25], [[0.0]], [0.0]);
    for (l, u) in [(-1.0, 1.0), (-INF, 1.0), (-1.0, INF), (-INF, INF)] {
        let (lower, upper) = ([l], [u]);
        for y in [2.0, -2.0] {
            let room = if y > 0.0 { u - x[0] } else { x[0] - l };
            let off = 2.0 * if room < INF { room } else { 1.0 };
            let row = Problem::new(&h, &g, &[[1.0]], &lower, &upper);
            let r = kkt_residual(&row, &x, &[y], &[0.0]);
            assert_eq!(r.complementarity, off, "{l} {u} {y}");
            let bound = Problem::new(&h, &g, &[[0.0]], &[-INF], &[INF]).with_bounds(&lower, &upper);
            let r = kkt_residual(&bound, &x, &[0.0], &[y]);
            assert_eq!(r.complementarity, off, "{l} {u} {y}");
        }
    }
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

    /// Nor do they to a contradiction of one row with a sum of others, or with equalities: it is proved in as many steps, by the same rows.
    #[test]
    fn units_of_rows_do_not_matter_to_contradictions(
        q in definite::<N, M>(2), shares in prop::collection::vec(0.01..1.0_f64, M), rows in powers::<M>(), equal in any::<bool>()
    ) {
        let mut q = q;
        let sum: Vec<usize> = (0..M - 1).filter(|i| q.u[*i] < INF && (q.l[*i] == q.u[*i]) == equal).take(4).collect();
        prop_assume!(!sum.is_empty());
        q.a[M - 1] = core::array::from_fn(|j| -sum.iter().map(|i| shares[*i] * q.a[*i][j]).sum::<f64>());
        // A row of zeros has no unit.
        prop_assume!(q.a[M - 1].iter().any(|a| a.abs() > 1e-3));
        let limit: f64 = sum.iter().map(|i| shares[*i] * q.u[*i]).sum();
        (q.l[M - 1], q.u[M - 1]) = (-INF, -limit - shares[M - 1]);
        let s = in_units(&q, &rows.map(|unit| unit * unit));
        let outcomes = [&q, &s].map(|q| {
            let (p, mut w) = (q.problem(), Box::new(Workspace::<f64, N, M>::new()));
            let s = solve(&p, &Settings::default(), &mut w).unwrap();
            let proof = infeasibility(&p, s.row_multipliers, s.bound_multipliers);
            let is_proved = proof.support < 0.0 && proof.combination * 1e6 <= -proof.support;
            (s.status, is_proved, s.conflict().collect::<Vec<_>>(), s.steps)
        });
        prop_assert_eq!((outcomes[0].0, outcomes[0].1), (Status::Infeasible, true));
        prop_assert_eq!(&outcomes[0], &outcomes[1]);
    }

    /// Nor does the unit of an equality to one that contradicts it, a millionth away, nor do those of others.
    #[test]
    fn units_of_equalities_do_not_matter_to_those_that_contradict_them(
        q in definite::<N, M>(3), share in 0.01..1.0_f64, margin in -6.0..0.0_f64, rows in powers::<M>()
    ) {
        let mut q = q;
        prop_assume!(q.a[0].iter().any(|a| a.abs() > 0.1));
        q.a[M - 1] = q.a[0].map(|a| a * share);
        (q.l[M - 1], q.u[M - 1]) = ([q.l[0] * share + 10f64.powf(margin); 2]).into();
        for q in [&q, &in_units(&q, &rows.map(|unit| unit * unit))] {
            let (p, mut w) = (q.problem(), Box::new(Workspace::<f64, N, M>::new()));
            let s = solve(&p, &Settings::default(), &mut w).unwrap();
            prop_assert_eq!(s.status, Status::Infeasible);
            let names: Vec<_> = s.conflict().map(|(of, _)| of).collect();
            prop_assert!([0, M - 1].iter().all(|i| names.contains(&Constraint::Row(*i))), "{:?}", names);
            // Others only by the round-off of what an elimination leaves of them.
            let force = |i: usize| s.row_multipliers[i].abs() * q.a[i].iter().fold(0.0, |size: f64, a| size.max(a.abs()));
            prop_assert!((1..M - 1).all(|i| force(i) <= 1e-12 * force(0)), "{:?}", s.row_multipliers);
        }
    }

    /// Nor do units of variables to proximal steps between limits, whether they share a curvature, have one of their own or none, with bounds on both
    /// sides, on one or none: the least cost is the same. That there is none may be missed, but nothing else be said.
    #[test]
    fn units_of_variables_do_not_matter_to_proximal_steps(
        q in (0..6_usize).prop_flat_map(semidefinite::<6, 4>), linear in prop::collection::vec(prop::bool::weighted(0.3), 6),
        middle in prop::collection::vec(-1.0..1.0_f64, 6), open in prop::collection::vec(prop::bool::weighted(0.25), 12), units in powers::<6>()
    ) {
        let mut q = q;
        q.lb = core::array::from_fn(|i| if open[i] { -INF } else { middle[i] - 1.0 });
        q.ub = core::array::from_fn(|i| if open[6 + i] { INF } else { middle[i] + 1.0 });
        for i in 0..4 {
            let value = dot(&q.a[i], &middle);
            (q.l[i], q.u[i]) = (q.l[i].min(value), q.u[i].max(value));
        }
        for i in 0..6 {
            for j in 0..6 {
                q.h[i][j] *= f64::from(u8::from(!linear[i] && !linear[j]));
            }
        }
        let mut s = q.clone();
        for i in 0..6 {
            s.g[i] *= units[i];
            (s.lb[i], s.ub[i]) = (q.lb[i] / units[i], q.ub[i] / units[i]);
            for j in 0..6 {
                s.h[i][j] *= units[i] * units[j];
            }
            for row in &mut s.a {
                row[i] *= units[i];
            }
        }
        let outcomes = [&q, &s].map(|q| {
            let (p, mut w) = (q.problem(), Box::new(Workspace::new()));
            let s = solve(&p, &Settings::default(), &mut w).unwrap();
            // What all limits missed by as much as they may be are worth.
            let sizes = q.a.iter().map(|a| a.iter().fold(0.0, |size: f64, a| size.max(a.abs())));
            let of_rows = s.row_multipliers.iter().zip(sizes).map(|(y, size)| y.abs() * size);
            let of_bounds = s.bound_multipliers.iter().map(|y| y.abs());
            let slack: f64 = of_rows.chain(of_bounds).sum();
            (s.status, p.cost(s.x), slack * Settings::<f64>::default().feasibility)
        });
        let [(status, cost, slack), (in_units, other, other_slack)] = outcomes;
        // One in ten thousand is given up in any units.
        prop_assume!(status != Status::Limit && status != Status::Numerical);
        if status == Status::Unbounded {
            prop_assert!(in_units != Status::Solved && in_units != Status::Infeasible);
            return Ok(());
        }
        prop_assert_eq!((status, in_units), (Status::Solved, Status::Solved));
        let most = 1e-7 * (1.0 + cost.abs()) + slack + other_slack;
        prop_assert!((cost - other).abs() <= most, "{} {}", cost, other);
    }

    /// Nor does the unit of the cost: without equalities, whose pivots are chosen by curvatures, the same bits of x or of the ray, whatever the
    /// rank of H.
    #[test]
    fn the_unit_of_the_cost_does_not_matter(
        q in (0..4_usize).prop_flat_map(semidefinite::<6, 4>), exponent in -20..=20_i32
    ) {
        let unit = f64::powi(4.0, exponent);
        let mut s = q.clone();
        s.g = q.g.map(|g| g * unit);
        s.h = q.h.map(|h| h.map(|h| h * unit));
        let (mut v, mut w) = (Box::new(Workspace::new()), Box::new(Workspace::new()));
        let a = solve(&q.problem(), &Settings::default(), &mut v).unwrap();
        let b = solve(&s.problem(), &Settings::default(), &mut w).unwrap();
        prop_assert_eq!((a.status, a.steps, a.x, a.ray()), (b.status, b.steps, b.x, b.ray()));
        let rows = a.row_multipliers.map(|y| y * unit);
        prop_assert_eq!(&rows, b.row_multipliers);
    }

    /// The limit that the least point without any is farthest outside of, by the distance |violation| / |a|₂, enters first, in any units.
    #[test]
    fn the_farthest_limit_enters_first(q in definite::<7, 9>(0), rows in powers::<9>()) {
        let mut open = q.clone();
        (open.l, open.u, open.lb, open.ub) = ([-INF; 9], [INF; 9], [-INF; 7], [INF; 7]);
        let mut w = Box::new(Workspace::<f64, 7, 9>::new());
        let x = *solve(&open.problem(), &Settings::default(), &mut w).unwrap().x;
        let settings = Settings { max_iterations: 2, ..Settings::default() };
        let s = in_units(&q, &rows.map(|unit| unit.powi(6)));
        for q in [&q, &s] {
            let _ = solve(&q.problem(), &settings, &mut w).unwrap();
            prop_assert_eq!(w.active().next(), farthest(q, &x));
            prop_assert!(w.active().count() <= 1);
        }
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
