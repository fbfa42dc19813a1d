//! Clarabel's answer at tight tolerances.

use super::INF;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};
use dense_qp::Problem;

pub struct Oracle {
    pub status: SolverStatus,
    pub x: Vec<f64>,
    pub cost: f64,
}

/// Clarabel's answer at tight tolerances.
pub fn clarabel<const N: usize, const M: usize>(p: &Problem<'_, f64, N, M>) -> Oracle {
    let (mut eq, mut ineq) = (Vec::new(), Vec::new());
    let inf = [INF; N];
    let ninf = [-INF; N];
    let (lb, ub) = (p.lower.unwrap_or(&ninf), p.upper.unwrap_or(&inf));
    let unit = |j: usize| core::array::from_fn(|k| if k == j { 1.0 } else { 0.0 });
    let rows = (0..M).map(|i| (p.rows[i], p.row_lower[i], p.row_upper[i]));
    let bounds = (0..N).map(|j| (unit(j), lb[j], ub[j]));
    for (a, l, u) in rows.chain(bounds) {
        if l == u {
            eq.push((a, u));
        } else {
            if u < INF {
                ineq.push((a, u));
            }
            if l > -INF {
                ineq.push((a.map(|v| -v), -l));
            }
        }
    }
    let (ne, ni) = (eq.len(), ineq.len());
    let all: Vec<([f64; N], f64)> = eq.into_iter().chain(ineq).collect();
    let (mut colptr, mut rowval, mut nzval) = (vec![0], vec![], vec![]);
    for j in 0..N {
        for (i, (a, _)) in all.iter().enumerate() {
            if a[j] != 0.0 {
                rowval.push(i);
                nzval.push(a[j]);
            }
        }
        colptr.push(rowval.len());
    }
    let a = CscMatrix::new(all.len(), N, colptr, rowval, nzval);
    let (mut colptr, mut rowval, mut nzval) = (vec![0], vec![], vec![]);
    for j in 0..N {
        for i in 0..=j {
            rowval.push(i);
            nzval.push(p.hessian[i][j]);
        }
        colptr.push(rowval.len());
    }
    let h = CscMatrix::new(N, N, colptr, rowval, nzval);
    let b: Vec<f64> = all.iter().map(|(_, b)| *b).collect();
    let mut cones = Vec::new();
    if ne > 0 {
        cones.push(SupportedConeT::ZeroConeT(ne));
    }
    if ni > 0 {
        cones.push(SupportedConeT::NonnegativeConeT(ni));
    }
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-9)
        .tol_gap_rel(1e-9)
        .tol_feas(1e-9)
        .presolve_enable(false)
        .build()
        .expect("settings");
    let mut solver =
        DefaultSolver::new(&h, p.gradient.as_slice(), &a, &b, &cones, settings).expect("setup");
    solver.solve();
    Oracle {
        status: solver.solution.status,
        x: solver.solution.x.clone(),
        cost: solver.solution.obj_val,
    }
}
