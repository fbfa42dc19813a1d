//! A second way to solve problem (2): sequential quadratic programming with Clarabel, on a host.
//!
//! Slower and plainer than `ocp-solver`, and independent of it: every iteration is one sparse convex program over all
//! nodes, with the stage Hessians of the Lagrangian made positive definite by clipping their eigenvalues; the step is
//! cut by a line search on `cost + ν (Σ |gap| + Σ violation)` (Nocedal and Wright, *Numerical Optimization*, chapter 18).
//! Both agree on the optimum and its multipliers, or one of them is wrong.

extern crate std;

use crate::error::Error;
use crate::problem::Problem;
use crate::state::State;
use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::{NonnegativeConeT, ZeroConeT};
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus};
use nalgebra::{DMatrix, SymmetricEigen};
use ocp_solver::{Derivatives, Evaluated, Problem as Ocp, Values};
use std::boxed::Box;
use std::vec::Vec;

/// A node of the iterate, with the multipliers of the dynamics that leave it and of its rows.
#[derive(Clone, Debug)]
pub struct SqpNode<const PHASES: usize, const NX: usize, const NU: usize, const NI: usize> {
    /// State: the guess before, the solution after.
    pub state: State<f64, PHASES>,
    /// Control: the guess before, the solution after.
    pub control: [f64; NU],
    /// Multiplier of the gap to the next node.
    pub dynamics_multiplier: [f64; NX],
    /// Multipliers of the rows; positive where the upper bound pushes.
    pub row_multipliers: [f64; NI],
}

/// How a solve by quadratic programs ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SqpSolution {
    /// Whether steps and violation went below their tolerances.
    pub is_solved: bool,
    /// Quadratic programs solved.
    pub iterations: usize,
    /// Cost of the last iterate.
    pub cost: f64,
    /// Sum of its violations.
    pub violation: f64,
    /// Largest entry of the last step.
    pub step: f64,
}

/// Rows of the program in triplet form: `A d + s = b`.
#[derive(Default)]
struct Triplets {
    row: Vec<usize>,
    column: Vec<usize>,
    value: Vec<f64>,
}

impl Triplets {
    fn push(&mut self, row: usize, column: usize, value: f64) {
        if value != 0.0 {
            self.row.push(row);
            self.column.push(column);
            self.value.push(value);
        }
    }
}

/// Which multiplier a row of the program is.
#[derive(Clone, Copy)]
enum Owner {
    Start,
    Gap(usize, usize),
    Row(usize, usize, f64),
}

/// A quadratic program's step, and the multipliers it ends with.
struct Step<const NX: usize, const NU: usize, const NI: usize> {
    state: Vec<[f64; NX]>,
    control: Vec<[f64; NU]>,
    gap: Vec<[f64; NX]>,
    row: Vec<[f64; NI]>,
    slope: f64,
}

impl<const FEET: usize, const PHASES: usize> Problem<f64, FEET, PHASES> {
    /// Solves from the guess in the nodes and leaves the solution there.
    ///
    /// # Errors
    /// [`Error::Parameter`] for unusable data, [`Error::Program`] if Clarabel cannot solve a quadratic program.
    pub fn plan_by_sqp<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        nodes: &mut [SqpNode<PHASES, NX, NU, NI>],
        max_iterations: usize,
    ) -> Result<SqpSolution, Error> {
        self.check()?;
        let (mut recent, mut weight) = (Vec::new(), 1.0f64);
        let mut out = SqpSolution {
            is_solved: false,
            iterations: 0,
            cost: f64::INFINITY,
            violation: f64::INFINITY,
            step: f64::INFINITY,
        };
        for iteration in 1..=max_iterations {
            let step = self.quadratic_step(nodes)?;
            let multipliers = step.gap.iter().flatten().chain(step.row.iter().flatten());
            weight = multipliers.fold(weight, |most, y| most.max(1.2 * y.abs()));
            let (cost, violation) = self.merit(nodes);
            let merit = cost + weight * violation;
            recent.push((cost, violation));
            // Of the last eight iterates the worst is the measure, so that curvature does not stop the iteration.
            let last = recent.iter().rev().take(8);
            let worst = last.fold(merit, |most, (c, v)| most.max(c + weight * v));
            let slope = (step.slope - weight * violation).min(0.0);
            let mut length = 1.0;
            let mut trial = self.moved(nodes, &step, length);
            for _ in 0..12 {
                let (cost, violation) = self.merit(&trial);
                if cost + weight * violation <= worst + 1e-4 * length * slope + 1e-10 * worst.abs()
                {
                    break;
                }
                length *= 0.5;
                trial = self.moved(nodes, &step, length);
            }
            let entries = step
                .state
                .iter()
                .flatten()
                .chain(step.control.iter().flatten());
            let size = entries.fold(0.0f64, |most, d| most.max(d.abs()));
            nodes.clone_from_slice(&trial);
            let (cost, violation) = self.merit(nodes);
            out = SqpSolution {
                is_solved: size < 1e-5 && violation < 1e-7,
                iterations: iteration,
                cost,
                violation,
                step: size,
            };
            if out.is_solved {
                break;
            }
        }
        Ok(out)
    }

    /// Cost and summed violation.
    fn merit<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        nodes: &[SqpNode<PHASES, NX, NU, NI>],
    ) -> (f64, f64) {
        let (mut cost, mut sum) = (0.0, 0.0);
        for (k, node) in nodes.iter().enumerate() {
            let next = nodes.get(k + 1).map(|next| &next.state);
            let mut values = Values::<f64, NX, NI>::new();
            Ocp::<f64, NX, NU, NI>::evaluate(
                self,
                k,
                &node.state,
                &node.control,
                next,
                &mut values,
            );
            cost += values.cost;
            if next.is_some() {
                sum += values.gap.iter().map(|gap| gap.abs()).sum::<f64>();
            }
            let (mut lower, mut upper) = ([0.0; NI], [0.0; NI]);
            self.row_bounds(k, &mut lower, &mut upper);
            let bounds = lower.iter().zip(&upper).zip(&values.rows);
            for ((l, h), c) in bounds.take(self.row_dims(k).rows()) {
                sum += (l - c).max(c - h).max(0.0);
            }
        }
        (cost, sum)
    }

    /// The nodes moved by `length` of the step; multipliers move along.
    fn moved<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        nodes: &[SqpNode<PHASES, NX, NU, NI>],
        step: &Step<NX, NU, NI>,
        length: f64,
    ) -> Vec<SqpNode<PHASES, NX, NU, NI>> {
        let mut out: Vec<SqpNode<PHASES, NX, NU, NI>> = Vec::with_capacity(nodes.len());
        for (k, node) in nodes.iter().enumerate() {
            let part = step.state[k].map(|d| d * length);
            let before = out.last().map(|before| (&before.state, &before.control));
            let mut moved = node.clone();
            moved.state = Ocp::<f64, NX, NU, NI>::retract(self, k, &node.state, &part, before);
            let controls = moved.control.iter_mut().zip(&step.control[k]);
            controls.for_each(|(u, d)| *u += length * d);
            let gaps = moved.dynamics_multiplier.iter_mut().zip(&step.gap[k]);
            let rows = moved.row_multipliers.iter_mut().zip(&step.row[k]);
            gaps.chain(rows)
                .for_each(|(y, full)| *y += length * (full - *y));
            out.push(moved);
        }
        out
    }

    /// The quadratic program at the nodes.
    fn quadratic_step<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        nodes: &[SqpNode<PHASES, NX, NU, NI>],
    ) -> Result<Step<NX, NU, NI>, Error> {
        let width = NX + NU;
        let count = nodes.len() * width;
        let (mut hessian, mut equal, mut below) = (
            Triplets::default(),
            Triplets::default(),
            Triplets::default(),
        );
        let mut gradient = std::vec![0.0; count];
        let (mut equal_to, mut below_to) = (Vec::new(), Vec::new());
        let (mut equal_of, mut below_of) = (Vec::new(), Vec::new());
        for i in (0..NX).filter(|i| !Ocp::<f64, NX, NU, NI>::is_free_at_start(self, *i)) {
            equal.push(equal_to.len(), i, 1.0);
            equal_to.push(0.0);
            equal_of.push(Owner::Start);
        }
        for (k, node) in nodes.iter().enumerate() {
            let next = nodes.get(k + 1).map(|next| &next.state);
            let (state, control) = (&node.state, &node.control);
            let mut values = Values::<f64, NX, NI>::new();
            Ocp::<f64, NX, NU, NI>::evaluate(self, k, state, control, next, &mut values);
            let mut d = Box::new(Derivatives::<f64, NX, NU, NI>::new());
            let at = Evaluated {
                values: &values,
                dynamics_multiplier: &node.dynamics_multiplier,
                row_multipliers: &node.row_multipliers,
            };
            Ocp::<f64, NX, NU, NI>::differentiate(self, k, state, control, next, at, &mut d);
            let (x0, u0) = (k * width, k * width + NX);
            gradient[x0..u0].copy_from_slice(&d.cost_x);
            gradient[u0..u0 + NU].copy_from_slice(&d.cost_u);
            add_convex(&mut hessian, x0, &d);
            if next.is_some() {
                for i in 0..NX {
                    let row = equal_to.len();
                    (0..NX).for_each(|j| equal.push(row, x0 + j, d.dynamics_x[j][i]));
                    (0..NU).for_each(|j| equal.push(row, u0 + j, d.dynamics_u[j][i]));
                    equal.push(row, x0 + width + i, -1.0);
                    equal_to.push(-values.gap[i]);
                    equal_of.push(Owner::Gap(k, i));
                }
            }
            let (mut lower, mut upper) = ([0.0; NI], [0.0; NI]);
            self.row_bounds(k, &mut lower, &mut upper);
            for i in 0..self.row_dims(k).rows() {
                let (l, h, c) = (lower[i], upper[i], values.rows[i]);
                let add = |to: &mut Triplets, right: &mut Vec<f64>, sign: f64, bound: f64| {
                    let row = right.len();
                    (0..NX).for_each(|j| to.push(row, x0 + j, sign * d.rows_x[i][j]));
                    (0..NU).for_each(|j| to.push(row, u0 + j, sign * d.rows_u[i][j]));
                    right.push(sign * (bound - c));
                };
                if l == h {
                    add(&mut equal, &mut equal_to, 1.0, l);
                    equal_of.push(Owner::Row(k, i, 1.0));
                    continue;
                }
                for (sign, bound) in [(1.0, h), (-1.0, l)] {
                    if bound.is_finite() {
                        add(&mut below, &mut below_to, sign, bound);
                        below_of.push(Owner::Row(k, i, sign));
                    }
                }
            }
        }
        // Equalities first, then inequalities.
        let (first, total) = (equal_to.len(), equal_to.len() + below_to.len());
        below.row.iter_mut().for_each(|row| *row += first);
        equal.row.append(&mut below.row);
        equal.column.append(&mut below.column);
        equal.value.append(&mut below.value);
        equal_to.append(&mut below_to);
        equal_of.append(&mut below_of);
        let p =
            CscMatrix::new_from_triplets(count, count, hessian.row, hessian.column, hessian.value);
        let a = CscMatrix::new_from_triplets(total, count, equal.row, equal.column, equal.value);
        let cones = [ZeroConeT(first), NonnegativeConeT(total - first)];
        let settings = DefaultSettings {
            verbose: false,
            max_iter: 200,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&p, &gradient, &a, &equal_to, &cones, settings)
            .map_err(|_| Error::Program)?;
        solver.solve();
        let found = &solver.solution;
        if !matches!(
            found.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved
        ) {
            return Err(Error::Program);
        }
        let mut step = Step {
            state: std::vec![[0.0; NX]; nodes.len()],
            control: std::vec![[0.0; NU]; nodes.len()],
            gap: std::vec![[0.0; NX]; nodes.len()],
            row: std::vec![[0.0; NI]; nodes.len()],
            slope: found.x.iter().zip(&gradient).map(|(d, g)| d * g).sum(),
        };
        for (k, part) in found.x.chunks(width).enumerate() {
            step.state[k].copy_from_slice(&part[..NX]);
            step.control[k].copy_from_slice(&part[NX..]);
        }
        for (owner, z) in equal_of.iter().zip(&found.z) {
            match *owner {
                Owner::Start => {}
                Owner::Gap(k, i) => step.gap[k][i] = *z,
                Owner::Row(k, i, sign) => step.row[k][i] += sign * z,
            }
        }
        Ok(step)
    }
}

/// The Hessian of a stage with its eigenvalues clipped at a small positive number, upper triangle.
fn add_convex<const NX: usize, const NU: usize, const NI: usize>(
    to: &mut Triplets,
    at: usize,
    d: &Derivatives<f64, NX, NU, NI>,
) {
    let full = DMatrix::from_fn(NX + NU, NX + NU, |i, j| {
        let (i, j) = (i.min(j), i.max(j));
        if j < NX {
            d.hessian_xx[j][i]
        } else if i < NX {
            d.hessian_xu[j - NX][i]
        } else {
            d.hessian_uu[j - NX][i - NX]
        }
    });
    let mut eigen = SymmetricEigen::new(full);
    eigen
        .eigenvalues
        .iter_mut()
        .for_each(|value| *value = value.max(1e-6));
    let convex = eigen.recompose();
    for j in 0..NX + NU {
        for i in 0..=j {
            to.push(at + i, at + j, convex[(i, j)]);
        }
    }
}
