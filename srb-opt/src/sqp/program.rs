//! One iteration's quadratic program, and its step by Clarabel.

use super::convex::{Held, Hessian, Stage, convexify};
use super::{SqpNode, std};
use crate::error::Error;
use crate::problem::Problem;
use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::{NonnegativeConeT, ZeroConeT};
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus};
use nalgebra::{DMatrix, DVector};
use ocp_solver::{Derivatives, Evaluated, Problem as Ocp, Values};
use std::boxed::Box;
use std::vec::Vec;

/// Curvature across rows that hold; less across those that hardly push.
const ACROSS: f64 = 1e3;

/// Which multiplier a row of the program is.
#[derive(Clone, Copy)]
enum Owner {
    Start,
    Gap(usize, usize),
    Row(usize, usize, f64),
}

/// Rows of the program: `A d + s = b`.
#[derive(Default)]
struct Rows {
    /// Row, column, value.
    entries: [Vec<usize>; 2],
    values: Vec<f64>,
    right: Vec<f64>,
    owners: Vec<Owner>,
}

impl Rows {
    /// A row over columns from `at` on.
    fn push(&mut self, at: usize, row: &[(usize, f64)], sign: f64, right: f64, owner: Owner) {
        for &(column, value) in row {
            self.entries[0].push(self.right.len());
            self.entries[1].push(at + column);
            self.values.push(sign * value);
        }
        self.right.push(sign * right);
        self.owners.push(owner);
    }

    /// Rows of another, below.
    fn append(&mut self, mut other: Self) {
        let first = self.right.len();
        self.entries[0].extend(other.entries[0].iter().map(|row| row + first));
        self.entries[1].append(&mut other.entries[1]);
        self.values.append(&mut other.values);
        self.right.append(&mut other.right);
        self.owners.append(&mut other.owners);
    }
}

/// One iteration's quadratic program.
#[derive(Default)]
struct Program {
    stages: Vec<Stage>,
    /// Gradient of the cost.
    cost: Vec<f64>,
    /// Rows with s = 0.
    equal: Rows,
    /// Rows with s ≥ 0.
    below: Rows,
}

/// Where a program's optimum is.
struct Solved {
    d: Vec<f64>,
    multipliers: Vec<(Owner, f64)>,
}

impl Program {
    fn solve(self) -> Result<Solved, Error> {
        let cones = [
            ZeroConeT(self.equal.right.len()),
            NonnegativeConeT(self.below.right.len()),
        ];
        let mut rows = self.equal;
        rows.append(self.below);
        let [row, column] = rows.entries;
        let gradient = self.stages.iter().flat_map(|stage| stage.gradient.iter());
        let gradient: Vec<f64> = gradient.copied().collect();
        let (height, width) = (rows.right.len(), gradient.len());
        let a = CscMatrix::new_from_triplets(height, width, row, column, rows.values);
        let p = upper_triangle(&self.stages);
        let settings = DefaultSettings {
            verbose: false,
            max_iter: 200,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&p, &gradient, &a, &rows.right, &cones, settings)
            .map_err(|_| Error::Program)?;
        solver.solve();
        let found = solver.solution;
        match found.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {
                let multipliers = rows.owners.into_iter().zip(found.z).collect();
                Ok(Solved {
                    d: found.x,
                    multipliers,
                })
            }
            _ => Err(Error::Program),
        }
    }
}

/// A quadratic program's step, and the multipliers it ends with.
pub(super) struct Step<const NX: usize, const NU: usize, const NI: usize> {
    pub(super) state: Vec<[f64; NX]>,
    pub(super) control: Vec<[f64; NU]>,
    pub(super) gap: Vec<[f64; NX]>,
    pub(super) row: Vec<[f64; NI]>,
    /// Change of the cost along the step, to first order.
    pub(super) slope: f64,
}

/// Entries that are not zero, by column.
fn sparse(x: &[f64], u: &[f64]) -> Vec<(usize, f64)> {
    let all = x.iter().chain(u).copied().enumerate();
    all.filter(|(_, value)| *value != 0.0).collect()
}

impl<const FEET: usize, const PHASES: usize> Problem<f64, FEET, PHASES> {
    /// The step of the quadratic program at the nodes.
    pub(super) fn quadratic_step<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        nodes: &[SqpNode<PHASES, NX, NU, NI>],
        kind: Hessian,
    ) -> Result<Step<NX, NU, NI>, Error> {
        let mut program = Program::default();
        let fixed: Vec<usize> = (0..NX)
            .filter(|i| !Ocp::<f64, NX, NU, NI>::is_free_at_start(self, *i))
            .collect();
        for i in &fixed {
            let row = &[(*i, 1.0)];
            program.equal.push(0, row, 1.0, 0.0, Owner::Start);
        }
        for (k, node) in nodes.iter().enumerate() {
            self.linearise(k, node, nodes.get(k + 1), &mut program);
        }
        let handed = convexify(&mut program.stages, kind, NX, &fixed);
        let cost = core::mem::take(&mut program.cost);
        let Solved { d, multipliers } = program.solve()?;
        let mut step = Step {
            state: std::vec![[0.0; NX]; nodes.len()],
            control: std::vec![[0.0; NU]; nodes.len()],
            gap: std::vec![[0.0; NX]; nodes.len()],
            row: std::vec![[0.0; NI]; nodes.len()],
            slope: d.iter().zip(&cost).map(|(d, g)| d * g).sum(),
        };
        for (k, part) in d.chunks(NX + NU).enumerate() {
            step.state[k].copy_from_slice(&part[..NX]);
            step.control[k].copy_from_slice(&part[NX..]);
        }
        for (owner, z) in multipliers {
            match owner {
                Owner::Start => {}
                Owner::Gap(k, i) => step.gap[k][i] = z,
                Owner::Row(k, i, sign) => step.row[k][i] += sign * z,
            }
        }
        for (k, gap) in step.gap.iter_mut().enumerate().take(nodes.len() - 1) {
            let change = &handed[k + 1] * DVector::from_column_slice(&step.state[k + 1]);
            gap.iter_mut()
                .zip(&change)
                .for_each(|(y, change)| *y += change);
        }
        Ok(step)
    }

    /// Adds node `k`: its cost, its dynamics and its rows.
    fn linearise<const NX: usize, const NU: usize, const NI: usize>(
        &self,
        k: usize,
        node: &SqpNode<PHASES, NX, NU, NI>,
        next: Option<&SqpNode<PHASES, NX, NU, NI>>,
        program: &mut Program,
    ) {
        let next = next.map(|next| &next.state);
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
        let (width, start) = (NX + NU, k * (NX + NU));
        let mut stage = stage(&d, next.is_some().then_some(&values.gap));
        program.cost.extend_from_slice(stage.gradient.as_slice());
        for unused in NX + self.row_dims(k).controls..width {
            stage.hessian[(unused, unused)] = 1.0;
        }
        if next.is_some() {
            for i in 0..NX {
                let mut row = sparse(
                    &d.dynamics_x.map(|column| column[i]),
                    &d.dynamics_u.map(|column| column[i]),
                );
                row.push((width + i, -1.0));
                program
                    .equal
                    .push(start, &row, 1.0, -values.gap[i], Owner::Gap(k, i));
            }
        }
        let (mut lower, mut upper) = ([0.0; NI], [0.0; NI]);
        self.row_bounds(k, &mut lower, &mut upper);
        for i in 0..self.row_dims(k).rows() {
            let (l, h, c) = (lower[i], upper[i], values.rows[i]);
            let row = sparse(&d.rows_x[i], &d.rows_u[i]);
            if l == h {
                program
                    .equal
                    .push(start, &row, 1.0, l - c, Owner::Row(k, i, 1.0));
                stage.held.push(Held {
                    weight: ACROSS,
                    row,
                    right: l - c,
                });
                continue;
            }
            for (sign, bound) in [(1.0, h), (-1.0, l)] {
                if bound.is_finite() {
                    program
                        .below
                        .push(start, &row, sign, bound - c, Owner::Row(k, i, sign));
                    let pushes = (sign * node.row_multipliers[i]).clamp(0.0, 1.0);
                    stage.held.push(Held {
                        weight: ACROSS * pushes,
                        row: row.clone(),
                        right: bound - c,
                    });
                }
            }
        }
        program.stages.push(stage);
    }
}

/// The Lagrangian of a stage to second order, and its dynamics to first.
fn stage<const NX: usize, const NU: usize, const NI: usize>(
    d: &Derivatives<f64, NX, NU, NI>,
    gap: Option<&[f64; NX]>,
) -> Stage {
    let width = NX + NU;
    let hessian = DMatrix::from_fn(width, width, |i, j| {
        let (i, j) = (i.min(j), i.max(j));
        if j < NX {
            d.hessian_xx[j][i]
        } else if i < NX {
            d.hessian_xu[j - NX][i]
        } else {
            d.hessian_uu[j - NX][i - NX]
        }
    });
    let columns = d.dynamics_x.iter().chain(&d.dynamics_u).flatten().copied();
    let gradient = d.cost_x.iter().chain(&d.cost_u).copied();
    Stage {
        hessian,
        gradient: DVector::from_iterator(width, gradient),
        held: Vec::new(),
        dynamics: gap.map(|gap| {
            let a = DMatrix::from_iterator(NX, width, columns);
            (a, DVector::from_column_slice(gap))
        }),
    }
}

/// The Hessian of all stages.
fn upper_triangle(stages: &[Stage]) -> CscMatrix<f64> {
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut at = 0;
    for stage in stages {
        let width = stage.hessian.nrows();
        for j in 0..width {
            for i in 0..=j {
                rows.push(at + i);
                columns.push(at + j);
                values.push(stage.hessian[(i, j)]);
            }
        }
        at += width;
    }
    CscMatrix::new_from_triplets(at, at, rows, columns, values)
}
