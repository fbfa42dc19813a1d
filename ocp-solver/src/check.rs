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
    let gaps = next.map_or(0, |_| NX);
    let mut column =
        |plus: &_, minus: &_, exact: &_| errors.add(plus, minus, exact, h, [gaps, dims.rows()]);
    for j in 0..NX {
        let mut step = [T::ZERO; NX];
        step[j] = h;
        let plus = values_at(&problem.retract(k, state, &step, None), control);
        step[j] = -h;
        let minus = values_at(&problem.retract(k, state, &step, None), control);
        let exact = Values {
            cost: d.cost_x[j],
            gap: d.dynamics_x[j],
            rows: d.rows_x.map(|row| row[j]),
        };
        column(&plus, &minus, &exact);
    }
    for j in 0..dims.controls.min(NU) {
        let mut moved = *control;
        moved[j] += h;
        let plus = values_at(state, &moved);
        moved[j] = control[j] - h;
        let minus = values_at(state, &moved);
        let exact = Values {
            cost: d.cost_u[j],
            gap: d.dynamics_u[j],
            rows: d.rows_u.map(|row| row[j]),
        };
        column(&plus, &minus, &exact);
    }
    errors
}

impl<T: Scalar> DerivativeErrors<T> {
    /// Compares a column of the Jacobians with the values a width `h` to either side, over so many entries of the gap and so many rows.
    fn add<const NX: usize, const NI: usize>(
        &mut self,
        plus: &Values<T, NX, NI>,
        minus: &Values<T, NX, NI>,
        exact: &Values<T, NX, NI>,
        h: T,
        [gaps, rows]: [usize; 2],
    ) {
        let compare = |worst: &mut T, plus: T, minus: T, exact: T| {
            let difference = (plus - minus) / (T::TWO * h) - exact;
            *worst = crate::kernel::larger(*worst, abs(difference) / (T::ONE + abs(exact)));
        };
        compare(&mut self.cost, plus.cost, minus.cost, exact.cost);
        let of_gap = plus.gap.iter().zip(&minus.gap).zip(&exact.gap);
        for ((p, m), exact) in of_gap.take(gaps) {
            compare(&mut self.dynamics, *p, *m, *exact);
        }
        let of_rows = plus.rows.iter().zip(&minus.rows).zip(&exact.rows);
        for ((p, m), exact) in of_rows.take(rows) {
            compare(&mut self.rows, *p, *m, *exact);
        }
    }

    /// The largest of the three.
    #[must_use]
    pub fn worst(&self) -> T {
        max(self.cost, max(self.dynamics, self.rows))
    }
}
