//! Passes over all nodes: evaluate, differentiate, residuals, trial points.

use crate::kernel::{add_scaled, add_transposed_product, larger};
use crate::problem::{Evaluated, Problem, Values};
use crate::rows::Complementarity;
use crate::settings::Residual;
use crate::stage::Stage;
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
}

impl<T: Scalar> Merit<T> {
    pub(crate) fn is_finite(&self) -> bool {
        self.cost.is_finite_number() && self.sum.is_finite_number()
    }
}

/// Values of every node at the current iterate; the node of the first value that is not finite, if any.
pub(crate) fn evaluate<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI>],
) -> Option<usize> {
    let mut rest = stages;
    let mut k = 0usize;
    let mut broken = None;
    while let Some((stage, tail)) = rest.split_first_mut() {
        let next = tail.first().map(|next| &next.state);
        problem.evaluate(k, &stage.state, &stage.control, next, &mut stage.values);
        if next.is_none() {
            stage.values.gap = [T::ZERO; NX];
        }
        let total: T = stage
            .values
            .gap
            .iter()
            .chain(&stage.values.rows)
            .fold(T::ZERO, |a, b| a + *b);
        if broken.is_none() && !(total + stage.values.cost).is_finite_number() {
            broken = Some(k);
        }
        rest = tail;
        k = k.wrapping_add(1);
    }
    broken
}

/// Derivatives of every node at the current iterate.
pub(crate) fn differentiate<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI>],
) {
    let mut rest = stages;
    let mut k = 0usize;
    while let Some((stage, tail)) = rest.split_first_mut() {
        let next = tail.first();
        let costate = next.map_or([T::ZERO; NX], |next| next.costate);
        let at = Evaluated {
            values: &stage.values,
            dynamics_multiplier: &costate,
            row_multipliers: &stage.row_multiplier,
        };
        problem.differentiate(
            k,
            &stage.state,
            &stage.control,
            next.map(|next| &next.state),
            at,
            &mut stage.derivatives,
        );
        rest = tail;
        k = k.wrapping_add(1);
    }
}

/// Infeasibility and cost of the current iterate.
pub(crate) fn merit<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>(
    stages: &[Stage<T, X, NX, NU, NI>],
) -> Merit<T> {
    sum_merit(stages.iter().map(|stage| (stage, &stage.values)), T::ZERO)
}

fn sum_merit<'a, T: Scalar, X: Copy + 'a, const NX: usize, const NU: usize, const NI: usize>(
    points: impl Iterator<Item = (&'a Stage<T, X, NX, NU, NI>, &'a Values<T, NX, NI>)>,
    slack_step: T,
) -> Merit<T> {
    let mut merit = Merit {
        cost: T::ZERO,
        worst: T::ZERO,
        sum: T::ZERO,
    };
    for (stage, values) in points {
        merit.cost += values.cost;
        for gap in &values.gap {
            merit.worst = larger(merit.worst, *gap);
            merit.sum += abs(*gap);
        }
        let (worst, sum) = stage.row_violation(&values.rows, slack_step);
        merit.worst = larger(merit.worst, worst);
        merit.sum += sum;
    }
    merit
}

/// Residuals of the optimality conditions at the current iterate; needs derivatives.
pub(crate) fn residual<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>(
    stages: &[Stage<T, X, NX, NU, NI>],
    free: &[bool; NX],
    primal: T,
    complementarity: &Complementarity<T>,
) -> Residual<T> {
    let (mut dual, mut sum, mut count) = (T::ZERO, T::ZERO, T::ONE);
    let mut rest = stages;
    let mut first = true;
    while let Some((stage, tail)) = rest.split_first() {
        let d = &stage.derivatives;
        let (mut in_x, mut in_u) = (d.cost_x, d.cost_u);
        add_scaled(&mut in_x, -T::ONE, &stage.costate);
        if let Some(next) = tail.first() {
            add_transposed_product(&mut in_x, &d.dynamics_x, &next.costate);
            add_transposed_product(&mut in_u, &d.dynamics_u, &next.costate);
        }
        let before_mixed = stage
            .dims
            .state_rows
            .saturating_add(stage.dims.control_rows);
        for (i, ((row_x, row_u), y)) in d
            .rows_x
            .iter()
            .zip(&d.rows_u)
            .zip(&stage.row_multiplier)
            .enumerate()
            .take(stage.row_count())
        {
            if i < stage.dims.state_rows || i >= before_mixed {
                add_scaled(&mut in_x, *y, row_x);
            }
            if i >= stage.dims.state_rows {
                add_scaled(&mut in_u, *y, row_u);
            }
            sum += abs(*y);
            count += T::ONE;
        }
        for ((value, costate), free) in in_x.iter().zip(&stage.costate).zip(free) {
            if !first {
                dual = larger(dual, *value);
                sum += abs(*costate);
                count += T::ONE;
            } else if *free {
                dual = larger(dual, *value);
            }
        }
        for value in in_u.iter().take(stage.dims.controls) {
            dual = larger(dual, *value);
        }
        first = false;
        rest = tail;
    }
    let hundred = T::of(100.0);
    let scale = hundred / max(hundred, sum / count);
    Residual {
        primal,
        dual: dual * scale,
        complementarity: complementarity.largest * scale,
    }
}

/// Trial point at step length `alpha` and its merit.
pub(crate) fn try_step<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI>],
    alpha: T,
) -> Merit<T> {
    let mut before: Option<(P::State, [T; NU])> = None;
    for (k, stage) in stages.iter_mut().enumerate() {
        let mut step = [T::ZERO; NX];
        add_scaled(&mut step, alpha, &stage.step.state);
        let previous = before.as_ref().map(|(state, control)| (state, control));
        stage.trial.state = problem.retract(k, &stage.state, &step, previous);
        stage.trial.control = stage.control;
        add_scaled(&mut stage.trial.control, alpha, &stage.step.control);
        before = Some((stage.trial.state, stage.trial.control));
    }
    let mut rest = &mut *stages;
    let mut k = 0usize;
    while let Some((stage, tail)) = rest.split_first_mut() {
        let trial = &mut stage.trial;
        let next = tail.first().map(|next| &next.trial.state);
        problem.evaluate(k, &trial.state, &trial.control, next, &mut trial.values);
        if next.is_none() {
            trial.values.gap = [T::ZERO; NX];
        }
        rest = tail;
        k = k.wrapping_add(1);
    }
    sum_merit(
        stages.iter().map(|stage| (stage, &stage.trial.values)),
        alpha,
    )
}

/// Makes the trial point the iterate and moves all multipliers.
pub(crate) fn accept<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>(
    stages: &mut [Stage<T, X, NX, NU, NI>],
    primal: T,
    dual: T,
    rho: T,
    mu: T,
) {
    for stage in stages.iter_mut() {
        stage.state = stage.trial.state;
        stage.control = stage.trial.control;
        stage.values = stage.trial.values;
        for (costate, full) in stage.costate.iter_mut().zip(&stage.step.costate) {
            *costate += primal * (*full - *costate);
        }
        stage.accept_rows(primal, dual, rho, mu);
    }
}
