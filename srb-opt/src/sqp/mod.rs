//! A second way to solve problem (2): sequential quadratic programming with Clarabel, on a host.
//!
//! Slower and plainer than `ocp-solver`, and independent of it: every iteration is one sparse convex program over all
//! nodes ([`program`]), with a clipped Hessian of the Lagrangian at first and with the exact one near a solution
//! ([`convex`]); the step is cut by a line search on `cost + ν (Σ |gap| + Σ violation)` (Nocedal and Wright, *Numerical
//! Optimization*, chapter 18). Both agree on the optimum and its multipliers, or one of them is wrong.

extern crate std;

mod convex;
mod program;

use crate::error::Error;
use crate::problem::Problem;
use crate::state::State;
use convex::Hessian;
use ocp_solver::{Problem as Ocp, Values};
use program::Step;
use std::vec::Vec;

/// Largest entry of a step after which the exact Hessian is used.
const NEAR: f64 = 0.1;

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
            let exact = (out.step < NEAR).then(|| self.quadratic_step(nodes, Hessian::Exact));
            let step = match exact {
                Some(Ok(step)) => step,
                _ => self.quadratic_step(nodes, Hessian::Clipped)?,
            };
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
                is_solved: size < 1e-6 && violation < 1e-7,
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
}
