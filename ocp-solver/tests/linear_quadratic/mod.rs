//! Equality-constrained linear-quadratic problems against a dense solve of their KKT conditions.

mod parts;
mod problem;

use crate::common::config;
use core::ops::ControlFlow;
use nalgebra::{DMatrix, DVector};
use ocp_solver::{Settings, Solver, Stage, Status, blocking_rows};
use problem::{Lq, Node};
use proptest::prelude::*;

const NX: usize = 8;
const NU: usize = 4;
const NI: usize = 12;

/// Numbers in (−1, 1) that proptest drew, used one after the other and then again.
#[derive(Clone, Debug)]
struct Draw {
    numbers: Vec<f64>,
    at: usize,
}

/// As many numbers as the largest problem here takes.
fn draw() -> impl Strategy<Value = Draw> {
    prop::collection::vec(-1.0..1.0_f64, 4096).prop_map(|numbers| Draw { numbers, at: 0 })
}

impl Draw {
    fn next(&mut self) -> f64 {
        let x = self.numbers[self.at % self.numbers.len()];
        self.at += 1;
        x
    }

    fn matrix(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| self.next())
    }

    fn vector(&mut self, rows: usize) -> DVector<f64> {
        DVector::from_fn(rows, |_, _| self.next())
    }

    fn positive(&mut self, n: usize) -> DMatrix<f64> {
        let a = self.matrix(n, n);
        &a * a.transpose() + DMatrix::identity(n, n) * 0.3
    }
}

/// What is wrong with a solution: stationarity with the reported multipliers, and feasibility.
fn residuals(
    problem: &Lq,
    start: &[f64; NX],
    stages: &[Stage<f64, [f64; NX], NX, NU, NI>],
) -> (f64, f64) {
    let (mut dual, mut primal) = (0.0f64, 0.0f64);
    let nx = problem.nx;
    for (k, (stage, node)) in stages.iter().zip(&problem.nodes).enumerate() {
        let next = stages.get(k + 1);
        let z = problem.z(k, &stage.state, &stage.control);
        let y = DVector::from_row_slice(&stage.row_multipliers()[..node.right.len()]);
        let mut gradient = &node.h * &z + &node.g + node.rows.transpose() * y;
        if let Some(next) = next {
            let costate = DVector::from_row_slice(&next.costate()[..nx]);
            gradient += node.a.transpose() * costate;
            let gap = &node.a * &z + &node.offset - DVector::from_row_slice(&next.state[..nx]);
            primal = primal.max(gap.amax());
        }
        for (i, value) in gradient.iter().enumerate() {
            if i >= nx {
                dual = dual.max(value.abs());
            } else if k > 0 {
                dual = dual.max((value - stage.costate()[i]).abs());
            } else if problem.free[i] {
                dual = dual.max(value.abs());
            } else {
                primal = primal.max((stage.state[i] - start[i]).abs());
            }
        }
        if !node.right.is_empty() {
            primal = primal.max((&node.rows * &z - &node.right).amax());
        }
    }
    (primal, dual)
}

/// The states and controls of the dense solution, all nodes in a row: SVD of the whole KKT matrix.
fn dense(problem: &Lq, start: &[f64; NX]) -> DVector<f64> {
    let nx = problem.nx;
    let sizes: Vec<usize> = problem.nodes.iter().map(|node| node.g.len()).collect();
    let at: Vec<usize> = (0..sizes.len()).map(|k| sizes[..k].iter().sum()).collect();
    let variables: usize = sizes.iter().sum();
    let mut rows: Vec<(DVector<f64>, f64)> = Vec::new();
    for i in (0..nx).filter(|i| !problem.free[*i]) {
        let mut row = DVector::zeros(variables);
        row[i] = 1.0;
        rows.push((row, start[i]));
    }
    for (k, node) in problem.nodes.iter().enumerate() {
        for (own, right) in node.rows.row_iter().zip(&node.right) {
            let mut row = DVector::zeros(variables);
            row.rows_mut(at[k], sizes[k]).copy_from(&own.transpose());
            rows.push((row, *right));
        }
        if k + 1 < sizes.len() {
            for i in 0..nx {
                let mut row = DVector::zeros(variables);
                row.rows_mut(at[k], sizes[k])
                    .copy_from(&node.a.row(i).transpose());
                row[at[k + 1] + i] -= 1.0;
                rows.push((row, -node.offset[i]));
            }
        }
    }
    let total = variables + rows.len();
    let (mut kkt, mut right) = (DMatrix::zeros(total, total), DVector::zeros(total));
    for (k, node) in problem.nodes.iter().enumerate() {
        kkt.view_mut((at[k], at[k]), (sizes[k], sizes[k]))
            .copy_from(&node.h);
        right.rows_mut(at[k], sizes[k]).copy_from(&-&node.g);
    }
    for (i, (row, value)) in rows.iter().enumerate() {
        kkt.view_mut((variables + i, 0), (1, variables))
            .copy_from(&row.transpose());
        kkt.view_mut((0, variables + i), (variables, 1))
            .copy_from(row);
        right[variables + i] = *value;
    }
    kkt.svd(true, true)
        .solve(&right, 1e-11)
        .unwrap()
        .rows(0, variables)
        .into_owned()
}

/// Solves and compares.
fn check(problem: &Lq, start: [f64; NX], what: &str) {
    let mut stages = vec![Stage::new([0.0; NX]); problem.nodes.len()];
    stages[0].state = start;
    let mut settings = Settings::new();
    settings.primal_tolerance = 1e-9;
    settings.dual_tolerance = 1e-9;
    let solution = Solver::new(settings)
        .solve(problem, &mut stages, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(solution.status, Status::Solved, "{what}: {solution:?}");
    // The second step, if any, only removes rounding.
    assert!(solution.iterations <= 2, "{what}: {solution:?}");
    let (primal, dual) = residuals(problem, &start, &stages);
    assert!(
        primal < 1e-9 && dual < 1e-9,
        "{what}: primal {primal:e} dual {dual:e}"
    );
    let wanted = dense(problem, &start);
    let ours: Vec<f64> = stages
        .iter()
        .enumerate()
        .flat_map(|(k, s)| {
            problem
                .z(k, &s.state, &s.control)
                .iter()
                .copied()
                .collect::<Vec<_>>()
        })
        .collect();
    let error = (DVector::from_vec(ours) - &wanted).amax();
    assert!(error < 1e-9 * (1.0 + wanted.amax()), "{what}: {error:e}");
}

/// Instead of row counts: a node without rows and controls.
const BALLISTIC: [usize; 3] = [usize::MAX; 3];

/// A problem of `n` intervals whose rows are met by some motion, with row counts `kinds(k)`.
fn problem(
    draw: &mut Draw,
    nx: usize,
    nu: usize,
    n: usize,
    free: [bool; NX],
    kinds: impl Fn(usize) -> [usize; 3],
) -> (Lq, [f64; NX]) {
    let mut start = [0.0; NX];
    for value in start.iter_mut().take(nx) {
        *value = draw.next();
    }
    let mut x = DVector::from_row_slice(&start[..nx]);
    for (i, value) in x.iter_mut().enumerate() {
        if free[i] {
            *value += draw.next();
        }
    }
    let mut nodes = Vec::new();
    for k in 0..=n {
        let nu = if k == n || kinds(k) == BALLISTIC {
            0
        } else {
            nu
        };
        let kinds = |k| {
            if kinds(k) == BALLISTIC {
                [0; 3]
            } else {
                kinds(k)
            }
        };
        let u = draw.vector(nu);
        let z = DVector::from_iterator(nx + nu, x.iter().chain(&u).copied());
        let kinds = if nu == 0 {
            [kinds(k).iter().sum(), 0, 0]
        } else {
            kinds(k)
        };
        let mut rows = draw.matrix(kinds.iter().sum(), nx + nu);
        for i in 0..rows.nrows() {
            if i < kinds[0] {
                rows.view_mut((i, nx), (1, nu)).fill(0.0);
            } else if i < kinds[0] + kinds[1] {
                rows.view_mut((i, 0), (1, nx)).fill(0.0);
            }
        }
        // Contracting, so that multipliers stay near one.
        let a = draw.matrix(nx, nx + nu) / so3::math::sqrt(nx as f64);
        let offset = draw.vector(nx);
        x = &a * &z + &offset;
        let right = &rows * &z;
        nodes.push(Node {
            h: draw.positive(nx + nu),
            g: draw.vector(nx + nu),
            a,
            offset,
            kinds,
            rows,
            right,
        });
    }
    (Lq { nx, nodes, free }, start)
}

proptest! {
    #![proptest_config(config(60, 1))]
    #[test]
    fn mixed_control_and_state_rows_agree_with_the_dense_solution(mut draw in draw(), (nx, nu, n) in (3..8_usize, 1..5_usize, 1..8_usize)) {
        // Rows that the controls of the next node or two can always meet.
        let (lq, start) = problem(&mut draw, nx, nu, n, [false; NX], |k| match k % 3 {
            0 => [0, usize::from(nu > 2), usize::from(nu > 1)],
            1 => [usize::from(k > 0), 0, 0],
            _ => [0, 0, usize::from(nu > 1)],
        });
        check(&lq, start, &format!("{nx} {nu} {n}"));
    }
}

proptest! {
    #![proptest_config(config(10, 2))]
    #[test]
    fn a_fixed_end_is_handed_back_over_several_stages(mut draw in draw(), (nx, nu) in prop::sample::select(vec![(4, 1), (5, 2), (6, 2), (7, 2), (8, 3)])) {
    // All states of the last node are given: one control per stage meets them over as many stages.
        let (lq, start) = problem(&mut draw, nx, nu, 9, [false; NX], |k| {
            [if k == 9 { nx } else { 0 }, 0, 0]
        });
        check(&lq, start, &format!("{nx} {nu}"));
    }
}

proptest! {
    #![proptest_config(config(10, 7))]
    #[test]
    fn rows_pass_through_stages_without_controls(mut draw in draw(), (nx, nu) in prop::sample::select(vec![(4, 2), (6, 3), (8, 4)])) {
        let (lq, start) = problem(&mut draw, nx, nu, 9, [false; NX], |k| match k {
            9 => [nx / 2, 0, 0],
            5..9 => BALLISTIC,
            _ => [0; 3],
        });
        check(&lq, start, &format!("{nx} {nu}"));
    }
}

proptest! {
    #![proptest_config(config(12, 3))]
    #[test]
    fn rows_that_no_control_meets_are_left_to_the_free_start(mut draw in draw(), (nx, nu, n) in prop::sample::select(vec![(4, 1, 1), (6, 2, 2), (8, 4, 3), (8, 1, 2)])) {
        let mut free = [false; NX];
        for (i, free) in free.iter_mut().enumerate().take(nx) {
            *free = i % 3 != 1;
        }
        let rows = nx / 2;
        let (lq, start) = problem(&mut draw, nx, nu, n, free, |k| {
            [
                if k == n {
                    nu * n
                } else if k == 0 {
                    rows
                } else {
                    0
                },
                0,
                0,
            ]
        });
        check(&lq, start, &format!("{nx} {nu} {n}"));
    }
}

proptest! {
    #![proptest_config(config(20, 4))]
    #[test]
    fn duplicated_and_dependent_rows_do_no_harm(mut draw in draw(), scale in prop::sample::select(vec![1e-3, 0.01, 0.1, 1.0, 10.0, 100.0, 1e3])) {
        let (mut lq, start) = problem(&mut draw, 6, 3, 5, [false; NX], |k| {
            if k == 5 { [4, 0, 0] } else { [0, 0, 3] }
        });
        for node in &mut lq.nodes {
            // The last row becomes a combination of the others, scaled badly.
            let n = node.rows.nrows() - 1;
            let sum = (node.rows.row(0) * 2.0 - node.rows.row(1)) * scale;
            node.rows.row_mut(n).copy_from(&sum);
            node.right[n] = (2.0 * node.right[0] - node.right[1]) * scale;
        }
        check(&lq, start, &format!("{scale}"));
    }
}

proptest! {
    #![proptest_config(config(20, 5))]
    #[test]
    fn controls_that_act_alike_are_told_apart_from_independent_ones(mut draw in draw()) {
    // Rank-deficient control columns, in rows and dynamics: the control Hessian decides between them.
        let (mut lq, start) = problem(&mut draw, 6, 4, 6, [false; NX], |k| {
            if k == 6 { [5, 0, 0] } else { [0, 0, 2] }
        });
        let mut x = DVector::from_row_slice(&start[..6]);
        for (k, node) in lq.nodes.iter_mut().enumerate() {
            if k < 6 {
                for i in 0..6 {
                    node.a[(i, 7)] = 2.0 * node.a[(i, 6)];
                    node.a[(i, 9)] = node.a[(i, 6)] - node.a[(i, 8)];
                }
                for i in 0..2 {
                    node.rows[(i, 7)] = 2.0 * node.rows[(i, 6)];
                    node.rows[(i, 9)] = node.rows[(i, 6)] - node.rows[(i, 8)];
                }
            }
            // Attainable again.
            let u = draw.vector(node.g.len() - 6);
            let z = DVector::from_iterator(node.g.len(), x.iter().chain(&u).copied());
            node.right = &node.rows * &z;
            x = &node.a * &z + &node.offset;
        }
        check(&lq, start, "alike");
    }
}

proptest! {
    #![proptest_config(config(10, 6))]
    #[test]
    fn contradicting_rows_are_never_called_solved(mut draw in draw()) {
    let (mut lq, start) = problem(&mut draw, 5, 2, 4, [false; NX], |k| {
        if k == 2 { [0, 0, 2] } else { [0; 3] }
    });
    let first = lq.nodes[2].rows.row(0).into_owned();
    lq.nodes[2].rows.row_mut(1).copy_from(&first);
    lq.nodes[2].right[1] = lq.nodes[2].right[0] + 0.5;
    let mut stages = vec![Stage::new([0.0; NX]); 5];
    stages[0].state = start;
    let solution = Solver::new(Settings::new())
        .solve(&lq, &mut stages, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(solution.status, Status::LocallyInfeasible, "{solution:?}");
    // Least squares shares the contradiction between the two rows.
    assert!((solution.violation - 0.25).abs() < 1e-4, "{solution:?}");
    let rows = blocking_rows::<3, _, _, _, _, _, _>(&stages).map(|b| b.map(|b| (b.stage, b.row)));
    assert!(
        rows[..2].contains(&Some((2, 0))) && rows[..2].contains(&Some((2, 1))),
        "{rows:?}"
    );
    let signs = [stages[2].violation(0), stages[2].violation(1)];
    assert!(signs[0] > 0.249 && signs[1] < -0.249, "{signs:?}");
    }
}
