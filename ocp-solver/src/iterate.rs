//! Passes over all nodes: evaluate, differentiate, residuals, trial points.

use crate::filter::{LogSum, Point};
use crate::keep::Keep;
use crate::kernel::{add_scaled, larger};
use crate::linearised::Linearised;
use crate::problem::{Derivatives, Problem, Values};
use crate::riccati::Direction;
use crate::rows::Complementarity;
use crate::settings::Residual;
use crate::stage::{Node, Pass, Stage};
use crate::sweep::{At, Next, each};
use so3::Scalar;
use so3::math::{abs, max};

/// Cost and infeasibility of a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Merit<T> {
    pub(crate) cost: T,
    /// Largest violation.
    pub(crate) worst: T,
    /// Sum of violations.
    pub(crate) sum: T,
    /// Logarithms of the distances of all slacks from their bounds.
    pub(crate) logs: LogSum<T>,
}

impl<T: Scalar> Merit<T> {
    const fn new() -> Self {
        Self {
            cost: T::ZERO,
            worst: T::ZERO,
            sum: T::ZERO,
            logs: LogSum::new(),
        }
    }

    /// Violation and barrier function.
    pub(crate) fn point(&self, mu: T) -> Point<T> {
        Point {
            theta: self.sum,
            phi: self.cost - mu * self.logs.total(),
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.cost.is_finite_number() && self.sum.is_finite_number()
    }
}

/// Values of every node at the current iterate; the node of the first value that is not finite, if any.
pub(crate) fn evaluate<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    K: Keep<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
    workers: usize,
) -> Option<usize> {
    evaluate_at(problem, stages, At::Iterate, workers);
    stages.iter().position(|stage| {
        let values = &stage.node.values;
        let entries = values.gap.iter().chain(&values.rows);
        let total: T = entries.fold(T::ZERO, |a, b| a + *b);
        !(total + values.cost).is_finite_number()
    })
}

/// Values of every node at one of its points.
#[inline(always)]
fn evaluate_at<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    K: Keep<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
    at: At,
    workers: usize,
) {
    let work = |(): &mut (),
                k,
                stage: &mut Stage<T, P::State, NX, NU, NI, K>,
                next: Option<Next<'_, T, P::State, NX>>| {
        let next = next.map(|next| next.state);
        let (state, control) = match at {
            At::Iterate => (&stage.state, &stage.control),
            At::Trial => (&stage.trial.0, &stage.trial.1),
        };
        let values = &mut stage.node.values;
        problem.evaluate(k, state, control, next, values);
        if next.is_none() {
            values.gap = [T::ZERO; NX];
        }
    };
    each(workers, stages, at, || (), work, |()| ());
}

/// Derivatives of every node at the current iterate, and the residuals of the optimality conditions there.
///
/// Not inlined: its scratch is not to lie on the stack while the other passes have theirs.
#[inline(never)]
pub(crate) fn differentiate<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    K: Keep<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
    free: &[bool; NX],
    primal: T,
    workers: usize,
) -> (Residual<T>, Complementarity<T>) {
    let mut dual = T::ZERO;
    each(
        workers,
        stages,
        At::Iterate,
        || (Derivatives::new(), T::ZERO),
        |(scratch, dual), k, stage: &mut Stage<T, P::State, NX, NU, NI, K>, next| {
            let costate = next.map_or([T::ZERO; NX], |next| *next.costate);
            let (node, d) = stage.linearise(problem, k, next, scratch, Pass::New);
            *dual = larger(
                *dual,
                node.stationarity(d, &costate, (k == 0).then_some(free)),
            );
        },
        |(_, found)| dual = larger(dual, found),
    );
    let mut complementarity = Complementarity::new();
    let (mut sum, mut count) = (T::ZERO, T::ONE);
    for (k, stage) in stages.iter().enumerate() {
        stage.node.add_complementarity(&mut complementarity);
        let multipliers = stage.node.rows.multipliers();
        let of_rows = multipliers.iter().take(stage.node.row_count());
        let of_dynamics = stage.node.costate.iter().filter(|_| k > 0);
        for y in of_rows.chain(of_dynamics) {
            sum += abs(*y);
            count += T::ONE;
        }
    }
    let hundred = T::of(100.0);
    let scale = hundred / max(hundred, sum / count);
    let residual = Residual {
        primal,
        dual: dual * scale,
        complementarity: complementarity.largest * scale,
    };
    (residual, complementarity)
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Node<T, NX, NU, NI> {
    /// Largest entry of the gradient of the Lagrangian; `free` marks the coordinates of the state that count if it is otherwise fixed.
    #[inline(always)]
    fn stationarity(
        &self,
        d: &impl Linearised<T, NX, NU>,
        next_costate: &[T; NX],
        free: Option<&[bool; NX]>,
    ) -> T {
        let (mut in_x, mut in_u) = (*d.cost_x(), *d.cost_u());
        d.pull_back_x(next_costate, &mut in_x);
        d.pull_back_u(next_costate, &mut in_u);
        let multipliers = self.rows.multipliers();
        for (i, y) in multipliers.iter().enumerate().take(self.row_count()) {
            let parts = self.dims.parts(i);
            if parts.state {
                d.add_row_x(i, *y, &mut in_x);
            }
            if parts.control {
                d.add_row_u(i, *y, &mut in_u);
            }
        }
        let mut most = T::ZERO;
        match free {
            Some(free) => {
                for (value, _) in in_x.iter().zip(free).filter(|(_, free)| **free) {
                    most = larger(most, *value);
                }
            }
            None => {
                for (value, costate) in in_x.iter().zip(&self.costate) {
                    most = larger(most, *value - *costate);
                }
            }
        }
        let of_controls = in_u.iter().take(self.dims.controls);
        of_controls.fold(most, |most, value| larger(most, *value))
    }
}

/// Infeasibility and cost of the current iterate.
pub(crate) fn merit<T: Scalar, X: Copy, K, const NX: usize, const NU: usize, const NI: usize>(
    stages: &[Stage<T, X, NX, NU, NI, K>],
) -> Merit<T> {
    let mut merit = Merit::new();
    for stage in stages {
        merit.add(&stage.node, None);
    }
    merit
}

impl<T: Scalar> Merit<T> {
    /// Adds a node, after a step of its slacks if one is given.
    #[inline(always)]
    fn add<const NX: usize, const NU: usize, const NI: usize>(
        &mut self,
        node: &Node<T, NX, NU, NI>,
        step: Option<&Direction<T>>,
    ) {
        self.cost += node.values.cost;
        for gap in &node.values.gap {
            self.worst = larger(self.worst, *gap);
            self.sum += abs(*gap);
        }
        node.add_merit(step, self);
    }
}

/// Trial point after a step and its merit; the values of the stages are those of the trial point.
pub(crate) fn try_step<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    K: Keep<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
    step: &Direction<T>,
    workers: usize,
) -> Merit<T> {
    let mut rest = &mut *stages;
    let (mut before, mut k) = (None, 0usize);
    while let Some((stage, tail)) = rest.split_first_mut() {
        stage.move_to_trial(problem, k, step.primal, before);
        before = Some((&stage.trial.0, &stage.trial.1));
        rest = tail;
        k = k.wrapping_add(1);
    }
    evaluate_at(problem, stages, At::Trial, workers);
    let mut merit = Merit::new();
    for stage in stages.iter() {
        merit.add(&stage.node, Some(step));
    }
    merit
}

/// Turns the values of the trial point after a step into those that a second-order correction aims at:
/// what the step was to take away, and what the curvature put in its place.
#[inline(never)]
pub(crate) fn correct<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    K: Keep<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
    step: &Direction<T>,
    workers: usize,
) {
    let work = |(): &mut (),
                k,
                stage: &mut Stage<T, P::State, NX, NU, NI, K>,
                next: Option<Next<'_, T, P::State, NX>>| {
        let next = next.map(|next| next.state);
        let mut before = Values::new();
        problem.evaluate(k, &stage.state, &stage.control, next, &mut before);
        if next.is_some() {
            add_scaled(&mut stage.node.values.gap, step.primal, &before.gap);
        }
        stage.node.correct_rows(&before.rows, step);
    };
    each(workers, stages, At::Iterate, || (), work, |()| ());
}

impl<T: Scalar, X: Copy, K: Copy, const NX: usize, const NU: usize, const NI: usize>
    Stage<T, X, NX, NU, NI, K>
{
    /// Moves state and control by `alpha` of their steps into the trial point.
    #[inline(always)]
    fn move_to_trial<P: Problem<T, NX, NU, NI, State = X>>(
        &mut self,
        problem: &P,
        k: usize,
        alpha: T,
        before: Option<(&X, &[T; NU])>,
    ) {
        let mut step = [T::ZERO; NX];
        add_scaled(&mut step, alpha, &self.node.step.state);
        self.trial.0 = problem.retract(k, &self.state, &step, before);
        self.trial.1 = self.control;
        add_scaled(&mut self.trial.1, alpha, &self.node.step.control);
    }
}

/// Makes the trial point the iterate and moves all multipliers.
pub(crate) fn accept<T: Scalar, X: Copy, K, const NX: usize, const NU: usize, const NI: usize>(
    stages: &mut [Stage<T, X, NX, NU, NI, K>],
    step: &Direction<T>,
    mu: T,
    floor: T,
) {
    for stage in stages.iter_mut() {
        (stage.state, stage.control) = stage.trial;
        let node = &mut stage.node;
        for (costate, full) in node.costate.iter_mut().zip(&node.step.costate) {
            *costate += step.primal * (*full - *costate);
        }
        node.accept_rows(step, mu, floor);
    }
}
