//! Random problems and the Clarabel oracle.
#![allow(dead_code, unreachable_pub, reason = "each test file uses a part")]
#![allow(clippy::expect_used, clippy::needless_range_loop, reason = "tests")]

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};
use dense_qp::Problem;

/// SplitMix64: the same problems on every machine.
pub struct Rng(pub u64);

impl Rng {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
    /// In [−1, 1).
    pub fn sym(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
    pub fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }
}

#[derive(Clone)]
pub struct Qp<const N: usize, const M: usize> {
    pub h: [[f64; N]; N],
    pub g: [f64; N],
    pub a: [[f64; N]; M],
    pub l: [f64; M],
    pub u: [f64; M],
    pub lb: [f64; N],
    pub ub: [f64; N],
}

const INF: f64 = f64::INFINITY;

impl<const N: usize, const M: usize> Qp<N, M> {
    pub fn zero() -> Box<Self> {
        Box::new(Self {
            h: [[0.0; N]; N],
            g: [0.0; N],
            a: [[0.0; N]; M],
            l: [-INF; M],
            u: [INF; M],
            lb: [-INF; N],
            ub: [INF; N],
        })
    }

    pub fn problem(&self) -> Problem<'_, f64, N, M> {
        Problem::new(&self.h, &self.g, &self.a, &self.l, &self.u).with_bounds(&self.lb, &self.ub)
    }

    /// H = Σ of `rank` outer products + `shift`·I.
    pub fn set_hessian(&mut self, r: &mut Rng, rank: usize, shift: f64) {
        self.h = [[0.0; N]; N];
        for _ in 0..rank {
            let v: [f64; N] = core::array::from_fn(|_| r.sym());
            for i in 0..N {
                for j in 0..N {
                    self.h[i][j] += v[i] * v[j];
                }
            }
        }
        for i in 0..N {
            self.h[i][i] += shift;
        }
    }

    /// Rows around a feasible point, a share of them equalities, duplicated or tight at the point.
    pub fn set_rows(&mut self, r: &mut Rng, equalities: usize, degenerate: bool) {
        let x0: [f64; N] = core::array::from_fn(|_| 2.0 * r.sym());
        for i in 0..M {
            let sparse = r.chance(0.3);
            for j in 0..N {
                self.a[i][j] = if sparse && !r.chance(0.3) {
                    0.0
                } else {
                    r.sym()
                };
            }
            if degenerate && i > 0 && r.chance(0.3) {
                // A copy, a multiple or a combination of earlier rows.
                let (p, q) = (r.below(i), r.below(i));
                let (f, g) = match r.below(3) {
                    0 => (1.0, 0.0),
                    1 => (-2.0, 0.0),
                    _ => (r.sym(), r.sym()),
                };
                for j in 0..N {
                    self.a[i][j] = f * self.a[p][j] + g * self.a[q][j];
                }
            }
            let v: f64 = (0..N).map(|j| self.a[i][j] * x0[j]).sum();
            let gap = |r: &mut Rng| {
                if degenerate && r.chance(0.5) {
                    0.0
                } else {
                    r.unit()
                }
            };
            if i < equalities {
                (self.l[i], self.u[i]) = (v, v);
            } else {
                self.u[i] = if r.chance(0.7) { v + gap(r) } else { INF };
                self.l[i] = if r.chance(0.5) {
                    v - gap(r) - 1e-3
                } else {
                    -INF
                };
            }
        }
        for j in 0..N {
            if r.chance(0.4) {
                let fixed = degenerate && r.chance(0.2);
                self.lb[j] = x0[j] - if fixed { 0.0 } else { r.unit() };
                self.ub[j] = x0[j] + if fixed { 0.0 } else { r.unit() };
            }
        }
        for g in &mut self.g {
            *g = 5.0 * r.sym();
        }
    }
}

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
