//! Caller-owned storage of one node.

use crate::eliminate::{Carried, Pivots};
use crate::kernel::{factor, solve_lower, solve_upper};
use crate::problem::{Derivatives, Dims, Values};
use so3::Scalar;

/// One side of the rows of a node: distance to the bound and its multiplier.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side<T, const NI: usize> {
    /// Slack minus lower bound, or upper bound minus slack; +∞ where there is no bound.
    pub(crate) distance: [T; NI],
    /// Multiplier of the bound, ≥ 0; 0 where there is no bound.
    pub(crate) multiplier: [T; NI],
}

impl<T: Scalar, const NI: usize> Side<T, NI> {
    const fn new() -> Self {
        Self {
            distance: [T::ZERO; NI],
            multiplier: [T::ZERO; NI],
        }
    }
}

/// Everything the solver keeps for one node: the iterate, its derivatives and the factorisation.
///
/// The caller fills `state` and `control` with the initial guess and reads the solution from the same
/// fields; all other content is scratch that [`Solver::solve`](crate::Solver::solve) owns.
#[derive(Clone, Copy, Debug)]
pub struct Stage<T, X, const NX: usize, const NU: usize, const NI: usize> {
    /// State of the node: the guess before, the solution after a solve.
    pub state: X,
    /// Control of the interval that starts here: the guess before, the solution after a solve.
    pub control: [T; NU],
    pub(crate) dims: Dims,
    /// Give of every row per unit of its multiplier; 0 outside elastic mode.
    pub(crate) elastic: T,
    /// Multiplier of the dynamics that lead into this node.
    pub(crate) costate: [T; NX],
    pub(crate) slack: [T; NI],
    pub(crate) lower: Side<T, NI>,
    pub(crate) upper: Side<T, NI>,
    /// Bounds as the problem stated them.
    pub(crate) bounds: ([T; NI], [T; NI]),
    /// Multipliers of the rows: upper minus lower side, or that of an equality.
    pub(crate) row_multiplier: [T; NI],
    pub(crate) values: Values<T, NX, NI>,
    pub(crate) derivatives: Derivatives<T, NX, NU, NI>,
    /// Trial point of the line search.
    pub(crate) trial: Trial<T, X, NU>,
    /// Newton step.
    pub(crate) step: Step<T, NX, NU, NI>,
    pub(crate) riccati: Riccati<T, NX, NU>,
    /// The guess, kept for a restart.
    pub(crate) guess: (X, [T; NU]),
    /// The best iterate so far.
    pub(crate) best: (X, [T; NU]),
}

/// A trial point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trial<T, X, const NU: usize> {
    pub(crate) state: X,
    pub(crate) control: [T; NU],
}

/// The Newton step of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step<T, const NX: usize, const NU: usize, const NI: usize> {
    pub(crate) state: [T; NX],
    pub(crate) control: [T; NU],
    pub(crate) slack: [T; NI],
    /// Full-step multiplier of the dynamics into this node.
    pub(crate) costate: [T; NX],
    /// Condensed weight of each row.
    pub(crate) weight: [T; NI],
    /// Condensed multiplier target of each row before the step; the full-step multiplier of an equality.
    pub(crate) target: [T; NI],
}

/// What the backward recursion leaves at a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Riccati<T, const NX: usize, const NU: usize> {
    /// Row `i`: change of control `i` per state coordinate.
    pub(crate) gain: [[T; NX]; NU],
    pub(crate) feedforward: [[T; 1]; NU],
    /// Cost-to-go Hessian.
    pub(crate) hessian: [[T; NX]; NX],
    /// Cost-to-go gradient.
    pub(crate) gradient: [T; NX],
    /// Rows that the controls from here on cannot meet.
    pub(crate) carried: Carried<T, NX>,
    pub(crate) pivots: Pivots<T, NU>,
}

impl<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>
    Stage<T, X, NX, NU, NI>
{
    /// Zeroed storage around a state.
    #[must_use]
    pub const fn new(state: X) -> Self {
        Self {
            state,
            control: [T::ZERO; NU],
            dims: Dims {
                controls: 0,
                state_rows: 0,
                control_rows: 0,
                mixed_rows: 0,
            },
            elastic: T::ZERO,
            costate: [T::ZERO; NX],
            slack: [T::ZERO; NI],
            lower: Side::new(),
            upper: Side::new(),
            bounds: ([T::ZERO; NI], [T::ZERO; NI]),
            row_multiplier: [T::ZERO; NI],
            values: Values::new(),
            derivatives: Derivatives::new(),
            trial: Trial {
                state,
                control: [T::ZERO; NU],
            },
            step: Step {
                state: [T::ZERO; NX],
                control: [T::ZERO; NU],
                slack: [T::ZERO; NI],
                costate: [T::ZERO; NX],
                weight: [T::ZERO; NI],
                target: [T::ZERO; NI],
            },
            riccati: Riccati {
                gain: [[T::ZERO; NX]; NU],
                feedforward: [[T::ZERO; 1]; NU],
                hessian: [[T::ZERO; NX]; NX],
                gradient: [T::ZERO; NX],
                carried: Carried::new(),
                pivots: Pivots::new(),
            },
            guess: (state, [T::ZERO; NU]),
            best: (state, [T::ZERO; NU]),
        }
    }

    /// Puts the guess of the last solve back, for another solve from the same start.
    pub fn restore_guess(&mut self) {
        (self.state, self.control) = self.guess;
    }

    /// Feedback gain of the last recursion: entry `[i][j]` is the change of control `i` that the optimum
    /// asks for per unit of tangent deviation `j` of this node's state.
    #[must_use]
    pub const fn gain(&self) -> &[[T; NX]; NU] {
        &self.riccati.gain
    }

    /// Feedback gain of free state coordinates, such as phase durations, on the others.
    ///
    /// With the cost-to-go Hessian `P` split into free and given coordinates the optimum moves by
    /// `d_free = −P_ff⁻¹ P_fg d_given`; row `i` of the result is the row of coordinate `i`, zero where it
    /// is not free. `None` if `P_ff` is not positive definite.
    #[must_use]
    pub fn free_gain(&self, free: &[bool; NX]) -> Option<[[T; NX]; NX]> {
        let mut block = self.riccati.hessian;
        let mut rows = [[T::ZERO; NX]; NX];
        for (i, (column, row)) in block.iter_mut().zip(&mut rows).enumerate() {
            for (j, ((entry, out), is_free)) in column.iter_mut().zip(row).zip(free).enumerate() {
                let both = free.get(i).copied().unwrap_or(false) && *is_free;
                if free.get(i).copied().unwrap_or(false) && !*is_free {
                    *out = -*entry;
                }
                if !both {
                    *entry = if i == j { T::ONE } else { T::ZERO };
                }
            }
        }
        let mut inverse = [T::ZERO; NX];
        if !factor(&mut block, &mut inverse, NX, T::ZERO) {
            return None;
        }
        solve_lower(&block, &mut rows, NX);
        for (row, inverse) in rows.iter_mut().zip(&inverse) {
            for value in row {
                *value *= *inverse;
            }
        }
        solve_upper(&block, &mut rows, NX);
        Some(rows)
    }

    /// Hessian of the cost-to-go at this node, in the tangent space.
    #[must_use]
    pub const fn cost_to_go(&self) -> &[[T; NX]; NX] {
        &self.riccati.hessian
    }

    /// Multiplier of the dynamics that lead into this node: the gradient of the cost-to-go.
    #[must_use]
    pub const fn costate(&self) -> &[T; NX] {
        &self.costate
    }

    /// Constraint rows at the solution.
    #[must_use]
    pub const fn rows(&self) -> &[T; NI] {
        &self.values.rows
    }

    /// Multipliers of the rows; positive where the upper bound pushes.
    #[must_use]
    pub const fn row_multipliers(&self) -> &[T; NI] {
        &self.row_multiplier
    }
}
