//! Programs on which the solver used to say what was not so, or to end late: statuses, costs and steps of each.
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    clippy::needless_range_loop,
    reason = "tests"
)]

use crate::common::{Draw, INF, Qp, Tally, dot, each};
use dense_qp::{Problem, Settings, Solution, Status, Workspace, infeasibility, solve, solve_warm};
use so3::Scalar;

/// Solves cold with a new workspace and hands the outcome on.
fn run<T: Scalar, const N: usize, const M: usize, R>(
    p: &Problem<'_, T, N, M>,
    look: impl FnOnce(Solution<'_, T, N, M>) -> R,
) -> R {
    let mut w = Box::new(Workspace::<T, N, M>::new());
    look(solve(p, &Settings::default(), &mut w).unwrap())
}

/// min ½x₀² − x₁ with x₀ + 0.01 x₁ ≤ 1, x₀ ≥ 0 has its optimum at (0, 100): an entry of 1 % is no round-off, not in f32 either.
#[test]
fn small_entry_is_a_limit() {
    fn check<T: Scalar>() {
        let (t, inf) = (T::of, T::INFINITY);
        let h = [[t(1.0), T::ZERO], [T::ZERO; 2]];
        let (g, a) = ([T::ZERO, t(-1.0)], [[t(1.0), t(0.01)]]);
        let (lb, ub) = ([T::ZERO, -inf], [inf; 2]);
        let (l, u) = ([-inf], [t(1.0)]);
        let p = Problem::new(&h, &g, &a, &l, &u).with_bounds(&lb, &ub);
        run(&p, |s| {
            assert_eq!(s.status, Status::Solved);
            assert!((p.cost(s.x).to_f64() + 100.0).abs() < 1e-3, "{:?}", s.x);
        });
    }
    check::<f32>();
    check::<f64>();
}

/// Where the optimum has no gradient at all, there is no term beside which round-off looks small: the search ends nevertheless.
#[test]
fn optimum_without_gradient_is_solved() {
    fn check<const N: usize, const M: usize>(rank: usize) {
        each::<N, M>(60, 1, |mut r| {
            let mut q = Qp::<f64, N, M>::zero();
            q.set_hessian(&mut r, rank, 0.0);
            q.set_rows(&mut r, 0, false);
            q.g = [0.0; N];
            let f = q.single();
            run(&q.problem(), |s| {
                assert_eq!(s.status, Status::Solved, "{:?}", s.residual);
                assert!(s.steps <= 3 * (N + M) as u32, "{} steps", s.steps);
            });
            run(&f.problem(), |s| {
                assert_eq!(s.status, Status::Solved, "f32: {:?}", s.residual);
                assert!(s.steps <= 3 * (N + M) as u32, "f32: {} steps", s.steps);
            });
        });
    }
    check::<6, 4>(3);
    check::<12, 20>(6);
    check::<30, 40>(12);
}

/// g = −H x* with a singular H and x* inside all limits: the least cost is −½ x*ᵀHx*, reached along a whole plane.
#[test]
fn reachable_target_is_reached() {
    fn check<const N: usize, const M: usize>(rank: usize) {
        each::<N, M>(60, 2, |mut r| {
            let mut q = Qp::<f64, N, M>::zero();
            q.set_hessian(&mut r, rank, 0.0);
            let x: [f64; N] = core::array::from_fn(|_| 0.5 * r.sym());
            for i in 0..M {
                q.a[i] = core::array::from_fn(|_| r.sym());
                let v = dot(&q.a[i], &x);
                (q.l[i], q.u[i]) = (v - r.unit(), v + r.unit());
            }
            (q.lb, q.ub) = ([-1.0; N], [1.0; N]);
            q.aim(&x);
            let least = q.problem().cost(&x);
            let f = q.single();
            run(&q.problem(), |s| {
                assert_eq!(s.status, Status::Solved, "{:?}", s.residual);
                let cost = q.problem().cost(s.x);
                assert!((cost - least).abs() <= 1e-9 * (1.0 + least.abs()));
                assert!(s.steps <= 3 * (N + M) as u32, "{} steps", s.steps);
            });
            run(&f.problem(), |s| {
                assert_eq!(s.status, Status::Solved, "f32: {:?}", s.residual);
                let cost = q.problem().cost(&s.x.map(f64::from));
                assert!((cost - least).abs() <= 1e-3 * (1.0 + least.abs()));
                assert!(s.steps <= 3 * (N + M) as u32, "f32: {} steps", s.steps);
            });
        });
    }
    check::<6, 4>(3);
    check::<12, 20>(4);
    check::<30, 40>(20);
}

/// A proof of infeasibility, by the caller's own numbers: no point nearer than `reach` meets the rows.
fn assert_proof<T: Scalar, const N: usize, const M: usize>(
    p: &Problem<'_, T, N, M>,
    s: &Solution<'_, T, N, M>,
    reach: f64,
) {
    assert_eq!(s.status, Status::Infeasible, "cost {}", p.cost(s.x));
    let proof = infeasibility(p, s.row_multipliers, s.bound_multipliers);
    let (combination, support) = (proof.combination.to_f64(), proof.support.to_f64());
    assert!(
        support < 0.0 && combination * reach <= -support,
        "{proof:?}"
    );
    assert!(s.conflict().count() > 0);
    assert!(s.x.iter().all(|x| x.is_finite_number()));
}

/// Limits that contradict each other by up to a million times their size, with a singular H, in both precisions.
#[test]
fn gross_contradictions_are_proved() {
    fn check<const N: usize, const M: usize>(rank: usize) {
        each::<N, M>(40, 3, |mut r| {
            let big = 10f64.powi(r.below(7) as i32);
            let mut base = Qp::<f64, N, M>::zero();
            base.set_hessian(&mut r, rank, 0.0);
            for i in 0..M {
                base.a[i] = core::array::from_fn(|_| r.sym());
            }
            base.g = core::array::from_fn(|_| 10.0 * r.sym());
            // Sums that bounds do not allow by far.
            let mut sums = base.clone();
            (sums.l, sums.u) = ([big * N as f64; M], [2.0 * big * N as f64; M]);
            (sums.lb, sums.ub) = ([-1.0; N], [1.0; N]);
            // One row against a combination of all others.
            let mut ring = base.clone();
            let (mut row, mut limit) = ([0.0; N], 0.0);
            for i in 0..M - 1 {
                ring.u[i] = r.sym();
                let f = 0.01 + r.unit();
                for j in 0..N {
                    row[j] -= f * ring.a[i][j];
                }
                limit -= f * ring.u[i];
            }
            (ring.a[M - 1], ring.u[M - 1]) = (row, limit - big);
            // Equalities twice, with different right-hand sides.
            let mut twice = base;
            for i in 0..2 {
                let b = r.sym();
                (twice.l[i], twice.u[i]) = (b, b);
                twice.a[i + 2] = twice.a[i];
                (twice.l[i + 2], twice.u[i + 2]) = (b + big, b + big);
            }
            for q in [&sums, &ring, &twice] {
                run(&q.problem(), |s| assert_proof(&q.problem(), &s, 1e6));
                let f = q.single();
                run(&f.problem(), |s| assert_proof(&f.problem(), &s, 1e2));
            }
        });
    }
    check::<6, 9>(3);
    check::<12, 20>(6);
    check::<30, 40>(10);
}

/// Torques of a humanoid in SI units, as nobody should hand them to f32: accelerations in m/s², forces in N, moments in N m, task weights
/// from 1e-3 to 1e3, a mass of 32 kg. The equalities are the base's equations of motion.
fn torque_program(r: &mut Draw) -> Box<Qp<f64, 35, 60>> {
    let mut q = Qp::<f64, 35, 60>::zero();
    for i in 0..29 {
        let row = core::array::from_fn(|j| if j < 29 { r.sym() } else { 0.0 });
        let (w, target) = (10f64.powf(2.0 * r.sym()), 5.0 * r.sym());
        q.add_outer(&row, w);
        for j in 0..29 {
            q.g[j] -= w * row[j] * target;
        }
        q.h[i][i] += 1e-3;
    }
    for j in 29..35 {
        q.h[j][j] += 1e-6;
    }
    for i in 0..6 {
        for j in 0..29 {
            q.a[i][j] = 3.0 * r.sym() + if i == j { 32.0 } else { 0.0 };
        }
        q.a[i][29 + i] = -1.0;
        let b = if i == 2 { -316.0 } else { 10.0 * r.sym() };
        (q.l[i], q.u[i]) = (b, b);
    }
    for i in 6..14 {
        // Friction and centre of pressure.
        q.a[i][29 + i % 2] = if i % 4 < 2 { 1.0 } else { -1.0 };
        q.a[i][31] = -if i < 10 { 0.5 } else { 0.05 };
        if i >= 10 {
            q.a[i].swap(29 + i % 2, 32 + i % 2);
        }
        q.u[i] = 0.0;
    }
    for i in 14..60 {
        for j in 0..35 {
            q.a[i][j] = if j < 29 { r.sym() } else { 0.2 * r.sym() };
        }
        (q.l[i], q.u[i]) = (-45.0, 45.0);
    }
    q
}

/// Where f64 is solved, f32 is, with a cost within 1e-3 and not many times the steps.
#[test]
fn single_precision_solves_torques_in_si_units() {
    let tally = Tally::default();
    each::<35, 60>(60, 4, |mut r| {
        let q = torque_program(&mut r);
        let f = q.single();
        let p = q.problem();
        let (cost, steps) = run(&p, |s| {
            assert_eq!(s.status, Status::Solved);
            (p.cost(s.x), s.steps)
        });
        run(&f.problem(), |s| {
            assert_eq!(s.status, Status::Solved, "{:?}", s.residual);
            let single = p.cost(&s.x.map(f64::from));
            let apart = (single - cost).abs() / (1.0 + cost.abs());
            assert!(apart <= 1e-3, "{single} {cost}");
            assert!(s.steps <= 2 * steps + 12, "{} for {steps}", s.steps);
        });
        tally.add(if steps > 3 { "rows" } else { "none" });
    });
    assert!(tally.of("rows") > 20, "{}", tally.of("rows"));
}

/// Jerks of a pendulum over 16 samples that keep its zero-moment point on the feet to come; at `t`, from `start`.
fn walking(t: f64, start: [f64; 3]) -> Box<Qp<f64, 16, 32>> {
    let (dt, height) = (0.1, 0.8 / 9.81);
    let mut q = Qp::<f64, 16, 32>::zero();
    for i in 0..16 {
        let n = (i + 1) as f64 * dt;
        let free = start[0] + n * start[1] + (0.5 * n * n - height) * start[2];
        let zmp = core::array::from_fn(|j| {
            let m = i as f64 - j as f64;
            let effect = (1.0 + 3.0 * m + 3.0 * m * m) * dt * dt * dt / 6.0 - dt * height;
            if j <= i { effect } else { 0.0 }
        });
        let foot = if (((t + n) / 0.8) as usize).is_multiple_of(2) {
            0.08
        } else {
            -0.08
        };
        // One row per limit, as in the public walking programs.
        (q.a[2 * i], q.u[2 * i]) = (zmp, foot + 0.04 - free);
        (q.a[2 * i + 1], q.u[2 * i + 1]) = (zmp.map(|z| -z), 0.04 - foot + free);
        let speed = core::array::from_fn(|j| {
            let m = i as f64 - j as f64 + 0.5;
            if j <= i { dt * dt * m } else { 0.0 }
        });
        q.add_outer(&speed, 1.0);
        for j in 0..16 {
            q.g[j] += speed[j] * (start[1] + n * start[2]);
        }
        q.h[i][i] += 1e-6;
    }
    q
}

/// A walk planned again every `period`: no walk is dearer warm than cold, and no tick by more than a step. With a period of a sample,
/// limits move by two rows per tick and what was active says nothing; with a fifth, it says nearly everything.
#[test]
fn walks_are_never_dearer_warm() {
    for period in [0.1, 0.05, 0.02, 0.01] {
        let mut warm = Box::new(Workspace::<f64, 16, 32>::new());
        let (mut x, mut total) = ([0.0; 3], [0, 0]);
        for k in 0..200 {
            let q = walking(k as f64 * period, x);
            let steps = run(&q.problem(), |s| {
                assert_eq!(s.status, Status::Solved);
                s.steps
            });
            let s = solve_warm(&q.problem(), &Settings::default(), &mut warm).unwrap();
            assert_eq!(s.status, Status::Solved);
            assert!(s.steps <= steps + 1, "{period}, {k}: {} {steps}", s.steps);
            total = [total[0] + steps, total[1] + s.steps];
            let (d, jerk) = (period, s.x[0]);
            x = [
                x[0] + d * x[1] + d * d / 2.0 * x[2] + d * d * d / 6.0 * jerk,
                x[1] + d * x[2] + d * d / 2.0 * jerk,
                x[2] + d * jerk,
            ];
        }
        let [cold, warm] = total;
        assert!(warm <= cold, "{period}: {warm} {cold}");
    }
}

/// A linear program whose first proximal step corrects a bounded variable by 2e-10: that rate is no limit to run to, 1e14 away.
#[test]
fn a_correction_is_no_limit_of_a_ray() {
    let inf = f64::INFINITY;
    let mut q = Qp::<f64, 6, 4>::zero();
    q.a = [
        [
            0.7430654376963215,
            0.48467974046011997,
            0.0737736777919824,
            -0.40822056659561734,
            0.7820261422252981,
            -0.1835567873854531,
        ],
        [0., 0., 0., 0., 0.23643710453014988, -0.27110444453911975],
        [0., 0.7488298734965848, -0.9685559996974866, 0., 0., 0.],
        [
            -0.5108850431245251,
            0.1622740025882934,
            -0.16123374566581217,
            -0.833848463593234,
            0.134871893518276,
            0.9833653949761596,
        ],
    ];
    q.g = [
        2.9128825224317167,
        4.619931915199781,
        -2.498071577574107,
        -2.599273130645274,
        2.82271857825887,
        0.21420467965330814,
    ];
    (q.l, q.u) = (
        [
            1.266168497998183,
            -inf,
            -1.2879977948935422,
            -2.687735608675929,
        ],
        [
            1.6520613131760677,
            1.6178654207597571,
            -0.9884912092937492,
            -1.6415223530776042,
        ],
    );
    (q.lb[1], q.ub[1]) = (-0.6609386199806107, 0.23948396791437176);
    (q.lb[2], q.ub[2]) = (0.42919283124956453, 1.5704695671734048);
    run(&q.problem(), |s| {
        assert_eq!(s.status, Status::Unbounded);
        let residual = s.residual;
        assert!(residual.primal <= 1e-9, "{residual:?}");
    });
}

/// Lengths of 0.5 to 170, as bounds and rows say them, are alike: with equal weights the ray is found, with others steps bend it.
#[test]
fn a_ray_between_lengths_that_are_alike_is_straight() {
    let g = [
        2.3181973964811275,
        1.3324610732705289,
        -0.651681739649585,
        -1.2475321791981915,
        -1.392721242204082,
        -2.3150098464439623,
    ];
    let a = [
        [0.0, 0.0, 0.0, 0.3707969951361465, -0.13378684192920443, 0.0],
        [
            -0.8294957677147108,
            0.3377044227057089,
            0.33140887827057064,
            0.4738294873942219,
            0.0028142455285309342,
            0.5192840343282927,
        ],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [
            0.849075888795995,
            0.10243203849998239,
            -0.7823997529099351,
            -0.5794760300570949,
            -0.7250564106249213,
            0.9854281882550269,
        ],
    ];
    let (l, u) = (
        [
            -3.3635182800967307,
            -0.5571846275267411,
            -0.9681754894105818,
            -1.4285955032429178,
        ],
        [
            -0.3635182800967306,
            2.442815372473259,
            0.9045114324727886,
            1.5714044967570822,
        ],
    );
    let lower = [-INF, -INF, -INF, -INF, -0.6725263936221599, -INF];
    let upper = [
        1.9201799488704934,
        0.5379379817079653,
        1.8539251278313016,
        0.6220409734418115,
        1.32747360637784,
        1.8070753543476001,
    ];
    let p = Problem::new(&[[0.0; 6]; 6], &g, &a, &l, &u).with_bounds(&lower, &upper);
    let mut w = Workspace::new();
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Unbounded, "{} steps", s.steps);
}

/// min ½x₀² − x₀ − s x₁ has x₀ = 1, and x₁ as far as its bound or its row lets it, or no end. The slope s is so small beside that of x₀ that it looks
/// like round-off of a gradient, and a proximal step gains next to nothing by it. But the cost falls by s times the way to the limit, and that is more
/// than may be left to gain: the share `optimality` of |x₀|(|x₀| + 1) = 2. Only the way to the limit ahead tells so. The one behind is as near as x₁
/// is when the search begins, or as 1. All this upwards and downwards.
#[test]
fn a_small_slope_counts_by_the_way_ahead() {
    let settings = Settings::<f64>::default();
    let may_be_left = 2.0 * settings.optimality;
    for (slope, [behind, ahead], row) in [
        (8e-13, [0.0, 500.0], INF),
        (6e-15, [1.0, INF], 1e10),
        (8e-13, [0.0, INF], INF),
        (8e-13, [1.0, INF], INF),
    ] {
        let fall = slope * ahead.min(row);
        assert!(slope < 0.01 * settings.optimality && fall >= 2.0 * may_be_left);
        for up in [true, false] {
            let sign = if up { 1.0 } else { -1.0 };
            let [l, u] = if up {
                [-behind, ahead]
            } else {
                [-ahead, behind]
            };
            let (lower, upper) = ([-INF, l], [INF, u]);
            let (h, g) = ([[1.0, 0.0], [0.0; 2]], [-1.0, -sign * slope]);
            let (a, limit) = ([[0.0, sign]], [row]);
            let p = Problem::new(&h, &g, &a, &[-INF], &limit).with_bounds(&lower, &upper);
            run(&p, |s| {
                let status = if fall < INF {
                    Status::Solved
                } else {
                    Status::Unbounded
                };
                assert_eq!(s.status, status, "{slope} up to {ahead}, {up}");
                let left = p.cost(s.x) + 0.5 + fall;
                assert!(fall == INF || left.abs() <= may_be_left, "{left} of {fall}");
            });
        }
    }
}
