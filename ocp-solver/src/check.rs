//! Finite-difference check of a problem's derivatives, for tests.

use crate::problem::{Derivatives, Evaluated, Problem, Values};
use so3::Scalar;
use so3::math::{abs, max};

/// Largest differences between analytic derivatives and central differences at one node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DerivativeErrors<T> {
    /// Gradient of the cost.
    pub cost: T,
    /// Jacobians of the gap.
    pub dynamics: T,
    /// Gradients of the rows.
    pub rows: T,
}

/// Compares the first derivatives of node `k` with central differences of width `h`, each difference
/// relative to `1 + |value|`.
///
/// The next state is re-attached (`retract` by a zero step) after every perturbation, so states that are
/// represented relative to their predecessor are differentiated correctly.
pub fn derivative_errors<
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    const NX: usize,
    const NU: usize,
    const NI: usize,
>(
    problem: &P,
    k: usize,
    state: &P::State,
    control: &[T; NU],
    next: Option<&P::State>,
    h: T,
) -> DerivativeErrors<T> {
    let values_at = |state: &P::State, control: &[T; NU]| {
        let next = next.map(|next| {
            let zero = [T::ZERO; NX];
            problem.retract(k.saturating_add(1), next, &zero, Some((state, control)))
        });
        let mut values = Values::<T, NX, NI>::new();
        problem.evaluate(k, state, control, next.as_ref(), &mut values);
        values
    };
    let dims = problem.dims(k);
    let base = values_at(state, control);
    let mut d = Derivatives::<T, NX, NU, NI>::new();
    let at = Evaluated {
        values: &base,
        dynamics_multiplier: &[T::ZERO; NX],
        row_multipliers: &[T::ZERO; NI],
    };
    problem.differentiate(k, state, control, next, at, &mut d);

    let mut errors = DerivativeErrors::default();
    let compare = |worst: &mut T, plus: T, minus: T, exact: T| {
        let difference = (plus - minus) / (T::TWO * h) - exact;
        *worst = crate::kernel::larger(*worst, abs(difference) / (T::ONE + abs(exact)));
    };
    let mut column = |plus: &Values<T, NX, NI>,
                      minus: &Values<T, NX, NI>,
                      cost: T,
                      dynamics: &[T; NX],
                      row: &dyn Fn(usize) -> T| {
        compare(&mut errors.cost, plus.cost, minus.cost, cost);
        if next.is_some() {
            for ((p, m), exact) in plus.gap.iter().zip(&minus.gap).zip(dynamics) {
                compare(&mut errors.dynamics, *p, *m, *exact);
            }
        }
        for (i, (p, m)) in plus
            .rows
            .iter()
            .zip(&minus.rows)
            .enumerate()
            .take(dims.rows())
        {
            compare(&mut errors.rows, *p, *m, row(i));
        }
    };
    for j in 0..NX {
        let mut step = [T::ZERO; NX];
        step[j] = h;
        let plus = values_at(&problem.retract(k, state, &step, None), control);
        step[j] = -h;
        let minus = values_at(&problem.retract(k, state, &step, None), control);
        column(&plus, &minus, d.cost_x[j], &d.dynamics_x[j], &|i| {
            d.rows_x.get(i).map_or(T::ZERO, |row| row[j])
        });
    }
    for j in 0..dims.controls.min(NU) {
        let mut moved = *control;
        moved[j] += h;
        let plus = values_at(state, &moved);
        moved[j] = control[j] - h;
        let minus = values_at(state, &moved);
        column(&plus, &minus, d.cost_u[j], &d.dynamics_u[j], &|i| {
            d.rows_u.get(i).map_or(T::ZERO, |row| row[j])
        });
    }
    errors
}

impl<T: Scalar> DerivativeErrors<T> {
    /// The largest of the three.
    #[must_use]
    pub fn worst(&self) -> T {
        max(self.cost, max(self.dynamics, self.rows))
    }
}
