//! A linear-quadratic problem with rows, of any sizes up to a capacity.

use super::{NI, NU, NX};
use nalgebra::{DMatrix, DVector};
use ocp_solver::{Derivatives, Dims, Evaluated, Problem, Values};

/// One node: `½ zᵀ h z + gᵀ z`, `x⁺ = a z + offset`, `rows · z = right`, with `z = (x, u)`.
#[derive(Clone)]
pub(crate) struct Node {
    pub(crate) h: DMatrix<f64>,
    pub(crate) g: DVector<f64>,
    pub(crate) a: DMatrix<f64>,
    pub(crate) offset: DVector<f64>,
    /// Rows of the state, of the control, of both.
    pub(crate) kinds: [usize; 3],
    pub(crate) rows: DMatrix<f64>,
    pub(crate) right: DVector<f64>,
}

#[derive(Clone)]
pub(crate) struct Lq {
    pub(crate) nx: usize,
    pub(crate) nodes: Vec<Node>,
    pub(crate) free: [bool; NX],
}

impl Lq {
    /// State and control of node `k` in one vector.
    pub(crate) fn z(&self, k: usize, x: &[f64; NX], u: &[f64; NU]) -> DVector<f64> {
        let nu = self.nodes[k].g.len() - self.nx;
        DVector::from_iterator(self.nx + nu, x[..self.nx].iter().chain(&u[..nu]).copied())
    }
}

impl Problem<f64, NX, NU, NI> for Lq {
    type State = [f64; NX];

    fn intervals(&self) -> usize {
        self.nodes.len() - 1
    }

    fn dims(&self, k: usize) -> Dims {
        let [state_rows, control_rows, mixed_rows] = self.nodes[k].kinds;
        let controls = self.nodes[k].g.len() - self.nx;
        Dims {
            controls,
            state_rows,
            control_rows,
            mixed_rows,
        }
    }

    fn bounds(&self, k: usize, lower: &mut [f64; NI], upper: &mut [f64; NI]) {
        for (i, right) in self.nodes[k].right.iter().enumerate() {
            (lower[i], upper[i]) = (*right, *right);
        }
    }

    fn is_free_at_start(&self, i: usize) -> bool {
        self.free[i]
    }

    fn retract(
        &self,
        _: usize,
        x: &[f64; NX],
        dx: &[f64; NX],
        _: Option<(&[f64; NX], &[f64; NU])>,
    ) -> [f64; NX] {
        core::array::from_fn(|i| x[i] + dx[i])
    }

    fn evaluate(
        &self,
        k: usize,
        x: &[f64; NX],
        u: &[f64; NU],
        next: Option<&[f64; NX]>,
        v: &mut Values<f64, NX, NI>,
    ) {
        let node = &self.nodes[k];
        let z = self.z(k, x, u);
        v.cost = (0.5 * z.transpose() * &node.h * &z)[0] + node.g.dot(&z);
        let rows = &node.rows * &z;
        v.rows[..rows.len()].copy_from_slice(rows.as_slice());
        if let Some(next) = next {
            let reached = &node.a * &z + &node.offset;
            for i in 0..self.nx {
                v.gap[i] = reached[i] - next[i];
            }
        }
    }

    fn differentiate(
        &self,
        k: usize,
        x: &[f64; NX],
        u: &[f64; NU],
        next: Option<&[f64; NX]>,
        _: Evaluated<'_, f64, NX, NI>,
        d: &mut Derivatives<f64, NX, NU, NI>,
    ) {
        let node = &self.nodes[k];
        let z = self.z(k, x, u);
        let gradient = &node.h * &z + &node.g;
        let nu = z.len() - self.nx;
        for i in 0..self.nx {
            d.cost_x[i] = gradient[i];
            for j in 0..self.nx {
                d.hessian_xx[j][i] = node.h[(i, j)];
                d.dynamics_x[j][i] = if next.is_some() { node.a[(i, j)] } else { 0.0 };
            }
            for j in 0..nu {
                d.hessian_xu[j][i] = node.h[(i, self.nx + j)];
                d.dynamics_u[j][i] = node.a[(i, self.nx + j)];
            }
        }
        for i in 0..nu {
            d.cost_u[i] = gradient[self.nx + i];
            for j in 0..nu {
                d.hessian_uu[j][i] = node.h[(self.nx + i, self.nx + j)];
            }
        }
        for (i, row) in node.rows.row_iter().enumerate() {
            for j in 0..self.nx {
                d.rows_x[i][j] = row[j];
            }
            for j in 0..nu {
                d.rows_u[i][j] = row[self.nx + j];
            }
        }
    }
}
