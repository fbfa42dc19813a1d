//! Small programs of Hock and Schittkowski and of Maros and Meszaros, with their published optima, in both precisions.
#![allow(clippy::unwrap_used, clippy::needless_range_loop, reason = "tests")]

use crate::common::Qp;
use dense_qp::{Settings, Status, Workspace, solve};

const INF: f64 = f64::INFINITY;

/// Adds (row·x − target)² and returns what of it does not depend on x.
fn square<const N: usize, const M: usize>(
    q: &mut Qp<f64, N, M>,
    row: [f64; N],
    target: f64,
) -> f64 {
    q.add_outer(&row, 2.0);
    for (g, a) in q.g.iter_mut().zip(&row) {
        *g -= 2.0 * target * a;
    }
    target * target
}

/// The published optimum to 1e-8 and, in f32, 1e-3 of 1 + |f|.
fn check<const N: usize, const M: usize>(
    name: &str,
    q: &Qp<f64, N, M>,
    constant: f64,
    optimum: f64,
) {
    let p = q.problem();
    let mut w = Box::new(Workspace::<f64, N, M>::new());
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Solved, "{name}");
    let cost = p.cost(s.x) + constant;
    assert!(
        (cost - optimum).abs() <= 1e-8 * (1.0 + optimum.abs()),
        "{name}: {cost}"
    );
    let f = q.single();
    let mut w = Box::new(Workspace::<f32, N, M>::new());
    let s = solve(&f.problem(), &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Solved, "{name} f32: {:?}", s.residual);
    let cost = p.cost(&s.x.map(f64::from)) + constant;
    assert!(
        (cost - optimum).abs() <= 1e-3 * (1.0 + optimum.abs()),
        "{name} f32: {cost}"
    );
}

#[test]
fn three_and_four_variables() {
    let mut q = Qp::<f64, 2, 1>::zero();
    (q.h[0][0], q.h[1][1]) = (0.02, 2.0);
    (q.a[0], q.l[0]) = ([10.0, -1.0], 10.0);
    (q.lb, q.ub) = ([2.0, -50.0], [50.0, 50.0]);
    check("HS21", &q, -100.0, -99.96);

    let mut q = Qp::<f64, 3, 1>::zero();
    q.h = [[4.0, 2.0, 2.0], [2.0, 4.0, 0.0], [2.0, 0.0, 2.0]];
    q.g = [-8.0, -6.0, -4.0];
    (q.a[0], q.u[0], q.lb) = ([1.0, 1.0, 2.0], 3.0, [0.0; 3]);
    check("HS35", &q, 9.0, 1.0 / 9.0);

    let mut q = Qp::<f64, 4, 3>::zero();
    q.h = [
        [2.0, 0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [-1.0, 0.0, 2.0, 1.0],
        [0.0, 0.0, 1.0, 1.0],
    ];
    q.g = [-1.0, -3.0, 1.0, -1.0];
    q.a = [
        [1.0, 2.0, 1.0, 1.0],
        [3.0, 1.0, 2.0, -1.0],
        [0.0, 1.0, 4.0, 0.0],
    ];
    (q.l, q.u, q.lb) = ([-INF, -INF, 1.5], [5.0, 4.0, INF], [0.0; 4]);
    check("HS76", &q, 0.0, -103.0 / 22.0);
}

/// Three equalities on five variables; the optimum of the first has no gradient.
#[test]
fn equalities_on_five_variables() {
    for (name, first, right, bound, optimum) in [
        ("HS51", [1.0, -1.0], 4.0, INF, 0.0),
        ("HS52", [4.0, -1.0], 0.0, INF, 1859.0 / 349.0),
        ("HS53", [1.0, -1.0], 0.0, 10.0, 176.0 / 43.0),
    ] {
        let mut q = Qp::<f64, 5, 3>::zero();
        let mut constant = square(&mut q, [first[0], first[1], 0.0, 0.0, 0.0], 0.0);
        constant += square(&mut q, [0.0, 1.0, 1.0, 0.0, 0.0], 2.0);
        constant += square(&mut q, [0.0, 0.0, 0.0, 1.0, 0.0], 1.0);
        constant += square(&mut q, [0.0, 0.0, 0.0, 0.0, 1.0], 1.0);
        q.a = [
            [1.0, 3.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 1.0, -2.0],
            [0.0, 1.0, 0.0, 0.0, -1.0],
        ];
        (q.l, q.u) = ([right, 0.0, 0.0], [right, 0.0, 0.0]);
        (q.lb, q.ub) = ([-bound; 5], [bound; 5]);
        check(name, &q, constant, optimum);
    }
    let mut q = Qp::<f64, 10, 8>::zero();
    for i in 0..9 {
        square(
            &mut q,
            core::array::from_fn(|j| f64::from(u8::from(j == i || j == i + 1))),
            0.0,
        );
    }
    for i in 0..8 {
        (q.a[i][i], q.a[i][i + 1], q.a[i][i + 2]) = (1.0, 2.0, 3.0);
        (q.l[i], q.u[i]) = (1.0, 1.0);
    }
    check("GENHS28", &q, 0.0, 0.927_173_692);
}

/// Squares with a common root in a corner of the rows, condition 1e7.
#[test]
fn least_squares_with_a_root() {
    let mut q = Qp::<f64, 5, 5>::zero();
    let mut constant = 0.0;
    for (row, target) in [
        ([-74.0, 80.0, 18.0, -11.0, -4.0], 51.0),
        ([14.0, -69.0, 21.0, 28.0, 0.0], -61.0),
        ([66.0, -72.0, -5.0, 7.0, 1.0], -56.0),
        ([-12.0, 66.0, -30.0, -23.0, 3.0], 69.0),
        ([3.0, 8.0, -7.0, -4.0, 1.0], 10.0),
        ([4.0, -12.0, 4.0, 4.0, 0.0], -12.0),
    ] {
        constant += square(&mut q, row, target);
    }
    q.a = [
        [-1.0, -1.0, -1.0, -1.0, -1.0],
        [10.0, 10.0, -3.0, 5.0, 4.0],
        [-8.0, 1.0, -2.0, -5.0, 3.0],
        [8.0, -1.0, 2.0, 5.0, -3.0],
        [-4.0, -2.0, 3.0, -5.0, 1.0],
    ];
    q.l = [-5.0, 20.0, -40.0, 11.0, -30.0];
    // The cost is a difference of numbers of 1e4: its round-off is 1e-8 even at the root.
    let p = q.problem();
    let mut w = Box::new(Workspace::<f64, 5, 5>::new());
    let s = solve(&p, &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Solved);
    for (x, root) in s.x.iter().zip([1.0, 2.0, -1.0, 3.0, -4.0]) {
        assert!((x - root).abs() < 1e-7, "{:?}", s.x);
    }
    assert!((p.cost(s.x) + constant).abs() < 1e-7);
    let f = q.single();
    let mut w = Box::new(Workspace::<f32, 5, 5>::new());
    let s = solve(&f.problem(), &Settings::default(), &mut w).unwrap();
    assert_eq!(s.status, Status::Solved);
    let cost = p.cost(&s.x.map(f64::from)) + constant;
    assert!(cost.abs() <= 1e-3 * constant, "{cost}");
}

/// Three products over five periods: linear costs with quadratic parts of 1e-4 beside them.
#[test]
fn production_over_five_periods() {
    let mut q = Qp::<f64, 15, 17>::zero();
    for k in 0..5 {
        for (c, (linear, quadratic)) in [(2.3, 1e-4), (1.7, 1e-4), (2.2, 1.5e-4)]
            .into_iter()
            .enumerate()
        {
            let i = 3 * k + c;
            (q.g[i], q.h[i][i]) = (linear, 2.0 * quadratic);
            (q.lb[i], q.ub[i]) = (0.0, [90.0, 120.0, 60.0][c]);
            if k > 0 {
                let row = 3 * (k - 1) + c;
                (q.a[row][i], q.a[row][i - 3]) = (1.0, -1.0);
                (q.l[row], q.u[row]) = (-7.0, [6.0, 7.0, 6.0][c]);
            }
            q.a[12 + k][i] = 1.0;
        }
        q.l[12 + k] = [60.0, 50.0, 70.0, 85.0, 100.0][k];
    }
    q.lb[..3].copy_from_slice(&[8.0, 43.0, 3.0]);
    q.ub[..3].copy_from_slice(&[21.0, 57.0, 16.0]);
    check("HS118", &q, 0.0, 664.820_45);
}
