//! Multipliers on parts of solved intervals.

use super::problem::{Lq, Node};
use super::{NI, NU, NX};
use core::ops::ControlFlow;
use nalgebra::{DMatrix, DVector};
use ocp_solver::{Settings, Solver, Stage};

type Stages = Vec<Stage<f64, [f64; NX], NX, NU, NI>>;

/// A metre from rest to rest in a second, with the force held over each of `n` intervals, of which each costs ½ (u² + x²); halfway
/// through the speed is given.
fn push(n: usize) -> Lq {
    let dt = 1.0 / n as f64;
    let node = |k: usize| {
        let nu = usize::from(k < n);
        let (rows, right) = if k == n {
            (
                DMatrix::identity(2, 2),
                DVector::from_row_slice(&[1.0, 0.0]),
            )
        } else if 2 * k == n {
            (
                DMatrix::from_row_slice(1, 3, &[0.0, 1.0, 0.0]),
                DVector::from_row_slice(&[1.2]),
            )
        } else {
            (DMatrix::zeros(0, 2 + nu), DVector::zeros(0))
        };
        let stays = [1.0, dt, 0.5 * dt * dt, 0.0, 1.0, dt];
        let held = DMatrix::from_row_slice(2, 3, &stays);
        Node {
            h: DMatrix::from_diagonal(&DVector::from_row_slice(&[1.0, 0.0, 1.0])).resize(
                2 + nu,
                2 + nu,
                0.0,
            ),
            g: DVector::zeros(2 + nu),
            a: held.resize(2, 2 + nu, 0.0),
            offset: DVector::zeros(2),
            kinds: [right.len(), 0, 0],
            rows,
            right,
        }
    };
    Lq {
        nx: 2,
        nodes: (0..=n).map(node).collect(),
        free: [false; NX],
    }
}

/// The dual residual that a warm start sets out from.
fn first_residual(problem: &Lq, stages: &mut Stages) -> f64 {
    let mut settings = Settings::new();
    settings.warm_start = true;
    let mut first = f64::INFINITY;
    let stop = |progress: &ocp_solver::Progress<f64>| {
        first = progress.residual.dual;
        ControlFlow::Break(())
    };
    Solver::new(settings).solve(problem, stages, stop).unwrap();
    first
}

#[test]
fn a_split_solution_is_nearly_stationary() {
    let n = 40;
    let long = push(n);
    let mut solved: Stages = vec![Stage::new([0.0; NX]); n + 1];
    Solver::new(Settings::new())
        .solve(&long, &mut solved, |_| ControlFlow::Continue(()))
        .unwrap();
    for parts in [1, 2, 4] {
        let fine = push(n * parts);
        let mut stages: Stages = vec![Stage::new([0.0; NX]); n * parts + 1];
        for (k, stage) in stages.iter_mut().enumerate() {
            let from = &solved[k / parts];
            let time = (k % parts) as f64 / (n * parts) as f64;
            let ([x, v, ..], u) = (from.state, from.control[0]);
            (stage.state[0], stage.state[1]) = (x + time * (v + 0.5 * time * u), v + time * u);
            stage.control[0] = u;
        }
        for (k, stage) in stages.iter_mut().enumerate() {
            stage.resume_part(
                &solved[k / parts],
                solved.get(k / parts + 1),
                k % parts,
                parts,
            );
        }
        let residual = first_residual(&fine, &mut stages);
        let costates = stages.iter().flat_map(|stage| *stage.costate());
        let largest = costates.fold(0.0, |a: f64, y| a.max(y.abs()));
        // After a row of the state the multipliers of the next node stand in for those that the step at the row leaves.
        let most = if parts == 1 { 1e-6 } else { 0.02 * largest };
        assert!(residual < most, "{parts}: {residual:e} of {largest:e}");
    }
}
