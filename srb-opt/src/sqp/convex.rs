//! Hessians of stages that are convex without being wrong (Verschueren, Zanon, Quirynen, Diehl, "A sparsity preserving
//! convexification procedure for indefinite quadratic programs arising in direct optimal control", SIAM J. Optim. 2017).
//!
//! Where x₊ = A z + c holds, z = (x, u), a term ½ x₊ᵀ P x₊ may be taken from the next stage and given to this one as
//! ½ (A z + c)ᵀ P (A z + c): solution and active rows stay, and the multiplier of the dynamics changes by P x₊. From the last
//! stage on, every stage hands back all curvature of its state but what its controls leave positive. A program that is convex
//! where its equalities hold so becomes one that is convex everywhere, stage by stage. Rows that hold help where the controls alone leave
//! too little. Where the program is not even convex then, eigenvalues are clipped.

use super::std;
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};
use std::vec::Vec;

/// Least eigenvalue of a stage's Hessian.
const LEAST: f64 = 1e-6;
/// Least eigenvalue over the controls without the rows that hold: a row that is wrongly taken to hold misleads, so they are used where
/// they must be. Between 0.1 and 0.3 all reference problems are solved.
const SOUND: f64 = 0.2;

/// Which Hessian of the Lagrangian a program has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Hessian {
    /// Every stage for itself, its eigenvalues clipped: goes to a solution nearby, slowly.
    Clipped,
    /// The exact one on the equalities: Newton's method, which far from a solution goes to any.
    Exact,
}

/// A row that holds: r z = b.
pub(super) struct Held {
    /// σ.
    pub(super) weight: f64,
    /// r, by column.
    pub(super) row: Vec<(usize, f64)>,
    /// b.
    pub(super) right: f64,
}

/// ½ zᵀ H z + gᵀ z over state and control of a node, and where its dynamics lead.
pub(super) struct Stage {
    pub(super) hessian: DMatrix<f64>,
    pub(super) gradient: DVector<f64>,
    /// A and c; none at the last node.
    pub(super) dynamics: Option<(DMatrix<f64>, DVector<f64>)>,
    pub(super) held: Vec<Held>,
}

impl Stage {
    /// Adds ½ σ (r z − b)² for every row, which changes nothing where r z = b.
    fn add_held(&mut self) {
        for Held { weight, row, right } in &self.held {
            for &(i, x) in row {
                self.gradient[i] -= weight * right * x;
                for &(j, y) in row {
                    self.hessian[(i, j)] += weight * x * y;
                }
            }
        }
    }

    /// Takes a coordinate out that does not move.
    fn fix(&mut self, i: usize) {
        self.hessian.fill_row(i, 0.0);
        self.hessian.fill_column(i, 0.0);
        self.hessian[(i, i)] = 1.0;
    }
}

/// Makes every stage convex. Returns P of every node, by which the multiplier of the dynamics before it changed; `fixed` are the
/// coordinates of the first state that do not move, states have `nx` coordinates.
pub(super) fn convexify(
    stages: &mut [Stage],
    kind: Hessian,
    nx: usize,
    fixed: &[usize],
) -> Vec<DMatrix<f64>> {
    let mut handed = std::vec![DMatrix::zeros(nx, nx); stages.len()];
    if kind == Hessian::Clipped {
        for stage in stages {
            stage.hessian = clipped(stage.hessian.clone());
        }
        return handed;
    }
    for (k, stage) in stages.iter_mut().enumerate().rev() {
        if let Some((a, c)) = &stage.dynamics {
            let back = a.tr_mul(&handed[k + 1]);
            stage.hessian += &back * a;
            stage.gradient += &back * c;
        }
        if k == 0 {
            stage.add_held();
            fixed.iter().for_each(|i| stage.fix(*i));
            stage.hessian = clipped(stage.hessian.clone());
            return handed;
        }
        let nu = stage.hessian.nrows() - nx;
        let sound = stage.hessian.view((nx, nx), (nu, nu)) - DMatrix::identity(nu, nu) * SOUND;
        if Cholesky::new(sound).is_none() {
            stage.add_held();
        }
        let controls = clipped(stage.hessian.view((nx, nx), (nu, nu)).into_owned());
        let cross = stage.hessian.view((nx, 0), (nu, nx)).into_owned();
        let Some(factor) = Cholesky::new(controls.clone()) else {
            return handed; // not a number: the program says so
        };
        // What the controls leave of the state's curvature is handed back.
        let mut kept = cross.tr_mul(&factor.solve(&cross));
        for i in 0..nx {
            kept[(i, i)] += LEAST;
        }
        let left = stage.hessian.view((0, 0), (nx, nx)) - &kept;
        handed[k] = (&left + left.transpose()) * 0.5;
        stage.hessian.view_mut((0, 0), (nx, nx)).copy_from(&kept);
        let mut block = stage.hessian.view_mut((nx, nx), (nu, nu));
        block.copy_from(&controls);
    }
    handed
}

/// A symmetric matrix with its eigenvalues clipped from below.
fn clipped(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let mut eigen = SymmetricEigen::new(matrix);
    let values = eigen.eigenvalues.iter_mut();
    values.for_each(|value| *value = value.max(LEAST));
    eigen.recompose()
}
