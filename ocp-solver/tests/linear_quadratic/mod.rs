//! Equality-constrained linear-quadratic problems against a dense solution.

mod dense;
mod parts;
mod problem;
mod seeds;

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

/// What is wrong with a solution, relative to the terms: feasibility of every row, and stationarity with the reported multipliers. Of the
/// latter the largest sum of terms counts for all entries, since a multiplier that is large in one of them has its rounding in all.
fn residuals(
    problem: &Lq,
    start: &[f64; NX],
    stages: &[Stage<f64, [f64; NX], NX, NU, NI>],
) -> (f64, f64) {
    let (mut dual, mut primal, mut largest) = (0.0f64, 0.0f64, 0.0f64);
    let nx = problem.nx;
    for (k, (stage, node)) in stages.iter().zip(&problem.nodes).enumerate() {
        let next = stages.get(k + 1);
        let z = problem.z(k, &stage.state, &stage.control);
        let y = DVector::from_row_slice(&stage.row_multipliers()[..node.right.len()]);
        let mut gradient = &node.h * &z + &node.g + node.rows.transpose() * &y;
        let mut terms =
            node.h.abs() * z.abs() + node.g.abs() + node.rows.abs().transpose() * y.abs();
        if let Some(next) = next {
            let costate = DVector::from_row_slice(&next.costate()[..nx]);
            gradient += node.a.transpose() * &costate;
            terms += node.a.abs().transpose() * costate.abs();
            let reached = DVector::from_row_slice(&next.state[..nx]);
            let gap = &node.a * &z + &node.offset - &reached;
            let sizes = node.a.abs() * z.abs() + node.offset.abs() + reached.abs();
            primal = primal.max(gap.component_div(&sizes).amax());
        }
        largest = largest.max(terms.amax());
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
            let off = &node.rows * &z - &node.right;
            let sizes = node.rows.abs() * z.abs() + node.right.abs();
            primal = primal.max(off.component_div(&sizes).amax());
        }
    }
    (primal, dual / largest)
}

/// Solves, and compares with the [dense] solution.
fn check(problem: &Lq, start: [f64; NX], what: &str) -> Vec<Stage<f64, [f64; NX], NX, NU, NI>> {
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
        primal < 1e-10 && dual < 1e-10,
        "{what}: primal {primal:e} dual {dual:e}"
    );
    let wanted = dense::solve(problem, &start);
    let parts = stages.iter().enumerate();
    let ours = parts.flat_map(|(k, s)| problem.z(k, &s.state, &s.control).data.as_vec().clone());
    let error = (DVector::from_iterator(wanted.len(), ours) - &wanted).amax();
    assert!(error < 1e-9 * (1.0 + wanted.amax()), "{what}: {error:e}");
    stages
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
        contradict(&mut draw);
    }
}

/// The same row with two right-hand sides, d − ¼ and d + ¼. What is least violated in squares gives way by δ from the middle d to what the
/// cost would have: with the give e = 10⁻⁵ at which the search ends, and y the multiplier of the row alone at d, δ = e y/2 but for terms
/// in e².
fn contradict(draw: &mut Draw) {
    let (mut lq, start) = problem(draw, 5, 2, 4, [false; NX], |k| {
        if k == 2 { [0, 0, 2] } else { [0; 3] }
    });
    let node = &mut lq.nodes[2];
    let first = node.rows.row(0).into_owned();
    node.rows.row_mut(1).copy_from(&first);
    node.right[1] = node.right[0] + 0.5;
    let mut middle = lq.clone();
    let node = &mut middle.nodes[2];
    node.kinds = [0, 0, 1];
    node.rows = node.rows.rows(0, 1).into_owned();
    node.right = DVector::from_element(1, node.right[0] + 0.25);
    let give = 0.5e-5 * check(&middle, start, "middle")[2].row_multipliers()[0];
    let mut stages = vec![Stage::new([0.0; NX]); 5];
    stages[0].state = start;
    let solution = Solver::new(Settings::new())
        .solve(&lq, &mut stages, |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(solution.status, Status::LocallyInfeasible, "{solution:?}");
    let found = [stages[2].violation(0), stages[2].violation(1)];
    let near = |a: f64, b: f64| (a - b).abs() < 1e-2 * give.abs() + 1e-9;
    assert!(
        near(found[0], 0.25 + give) && near(found[1], give - 0.25),
        "{found:?} {give:e}"
    );
    assert!(
        near(solution.violation, 0.25 + give.abs()),
        "{solution:?} {give:e}"
    );
    let rows = blocking_rows::<3, _, _, _, _, _, _>(&stages).map(|b| b.map(|b| (b.stage, b.row)));
    assert!(
        rows[..2].contains(&Some((2, 0))) && rows[..2].contains(&Some((2, 1))),
        "{rows:?}"
    );
}
