//! Random states of iCub.
#![allow(unreachable_pub, reason = "tests")]
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};
use icub_model::{Icub23, LIMITS};
use nalgebra::Vector3;
use rbd_core::{Configuration, Motion, Tangent, Transform};
use wbc_qp::Snapshot;

pub const N: usize = 23;

/// Numbers in [−1, 1), the same on every machine.
pub struct Rng(pub u64);

impl Rng {
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        2.0 * ((self.0 >> 11) as f64 / (1u64 << 53) as f64) - 1.0
    }

    pub fn state(&mut self) -> (Configuration<f64, N>, Tangent<f64, N>) {
        let turn = Vector3::new(self.next(), self.next(), self.next());
        let mut q = Configuration {
            base: Transform::new(so3::exp(&turn), Vector3::new(self.next(), self.next(), 0.5)),
            joints: [0.0; N],
        };
        for (x, limits) in q.joints.iter_mut().zip(&LIMITS) {
            let middle = 0.5 * (limits.lower + limits.upper);
            *x = middle + 0.4 * self.next() * (limits.upper - limits.lower);
        }
        let mut v = Tangent::ZERO;
        v.base = Motion::from_array(core::array::from_fn(|_| self.next()));
        v.joints = core::array::from_fn(|_| self.next());
        (q, v)
    }
}

pub fn snapshot(q: &Configuration<f64, N>, v: &Tangent<f64, N>) -> Snapshot<f64, N> {
    let mut s = Snapshot::ZERO;
    s.update(&Icub23, q, v);
    s
}

/// Optimal cost of the program as it stands, by Clarabel.
pub fn oracle<const V: usize, const M: usize>(
    problem: &dense_qp::Problem<'_, f64, V, M>,
) -> Option<f64> {
    let h: Vec<Vec<f64>> = problem.hessian.iter().map(|r| r.to_vec()).collect();
    let p = CscMatrix::from(&h).to_triu();
    // Equalities are a cone of their own: as two opposite inequalities they would leave an interior-point method no interior.
    let (mut equal, mut equal_to) = (Vec::new(), Vec::new());
    let (mut rows, mut b) = (Vec::new(), Vec::new());
    let mut add = |row: Vec<f64>, low: f64, high: f64| {
        if low == high {
            equal.push(row);
            equal_to.push(high);
            return;
        }
        if high < f64::INFINITY {
            rows.push(row.clone());
            b.push(high);
        }
        if low > f64::NEG_INFINITY {
            rows.push(row.iter().map(|x| -x).collect());
            b.push(-low);
        }
    };
    for i in 0..M {
        add(
            problem.rows[i].to_vec(),
            problem.row_lower[i],
            problem.row_upper[i],
        );
    }
    for i in 0..V {
        let mut row = vec![0.0; V];
        row[i] = 1.0;
        add(row, problem.lower.unwrap()[i], problem.upper.unwrap()[i]);
    }
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-10)
        .tol_gap_rel(1e-10)
        .tol_feas(1e-10)
        .build()
        .unwrap();
    let cones = [
        SupportedConeT::ZeroConeT(equal_to.len()),
        SupportedConeT::NonnegativeConeT(b.len()),
    ];
    equal.append(&mut rows);
    equal_to.append(&mut b);
    let a = CscMatrix::from(&equal);
    let mut solver =
        DefaultSolver::new(&p, problem.gradient, &a, &equal_to, &cones, settings).unwrap();
    solver.solve();
    match solver.solution.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved => {
            let x: [f64; V] = core::array::from_fn(|i| solver.solution.x[i]);
            Some(problem.cost(&x))
        }
        _ => None,
    }
}
