//! Caller-owned storage of one node.

use crate::eliminate::{Carried, Pivots};
use crate::keep::{Keep, Recomputed};
use crate::kernel::{factor, solve_lower, solve_upper};
use crate::packed::Packed;
use crate::problem::{Derivatives, Dims, Evaluated, Problem, Values};
use crate::sweep::Next;
use so3::Scalar;

/// Everything the solver keeps for one node: the iterate and its factorisation, and, unless `K` is
/// [`Recomputed`], its derivatives.
///
/// The caller fills `state` and `control` with the initial guess and reads the solution from the same
/// fields; all other content is scratch that [`Solver::solve`](crate::Solver::solve) owns.
#[derive(Copy, Debug)]
pub struct Stage<
    T,
    X,
    const NX: usize,
    const NU: usize,
    const NI: usize,
    K = Derivatives<T, NX, NU, NI>,
> {
    /// State of the node: the guess before, the solution after a solve.
    pub state: X,
    /// Control of the interval that starts here: the guess before, the solution after a solve.
    pub control: [T; NU],
    pub(crate) node: Node<T, NX, NU, NI>,
    pub(crate) kept: K,
    /// Trial point of the line search.
    pub(crate) trial: (X, [T; NU]),
    /// The guess, kept for a restart.
    pub(crate) guess: (X, [T; NU]),
    /// The best iterate so far.
    pub(crate) best: (X, [T; NU]),
    /// What [`Self::keep`] kept.
    spare: (X, [T; NU]),
}

/// A stage that keeps no derivatives: about half the size, see [`Recomputed`].
pub type LeanStage<T, X, const NX: usize, const NU: usize, const NI: usize> =
    Stage<T, X, NX, NU, NI, Recomputed>;

/// A stage that keeps the nonzero entries of its derivatives: on large problems that are mostly zeros the passes of an
/// iteration have less memory to go through, on small ones finding the zeros costs more than it saves.
pub type SparseStage<T, X, const NX: usize, const NU: usize, const NI: usize> =
    Stage<T, X, NX, NU, NI, Packed<T, NX, NU, NI>>;

// A derived clone would go through the fields and move each of these large parts several times.
impl<T: Copy, X: Copy, K: Copy, const NX: usize, const NU: usize, const NI: usize> Clone
    for Stage<T, X, NX, NU, NI, K>
{
    #[inline]
    fn clone(&self) -> Self {
        *self
    }
}

/// What the solver knows of a node besides where it is.
///
/// Nothing that costs little to recompute is kept: distances to bounds, weights of rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<T, const NX: usize, const NU: usize, const NI: usize> {
    pub(crate) dims: Dims,
    /// Give of every row per unit of its multiplier; 0 outside elastic mode.
    pub(crate) elastic: T,
    /// Multiplier of the dynamics that lead into this node.
    pub(crate) costate: [T; NX],
    pub(crate) rows: Rows<T, NI>,
    pub(crate) values: Values<T, NX, NI>,
    /// Newton step.
    pub(crate) step: Step<T, NX, NU, NI>,
    pub(crate) riccati: Riccati<T, NX, NU>,
}

/// What derivatives are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// The iterate is another one than before.
    New,
    /// It is the same.
    Same,
    /// It is the same, but the values of the nodes are those that a second-order correction aims at.
    Corrected,
}

/// Slacks, bounds and bound multipliers of the rows of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows<T, const NI: usize> {
    /// Strictly between the bounds; equal to them in an equality.
    pub(crate) slack: [T; NI],
    /// Bounds as the problem stated them.
    pub(crate) lower: [T; NI],
    pub(crate) upper: [T; NI],
    /// Multipliers of the bounds, ≥ 0; 0 where there is no bound. That of an equality is in `above`.
    pub(crate) below: [T; NI],
    pub(crate) above: [T; NI],
}

/// The Newton step of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step<T, const NX: usize, const NU: usize, const NI: usize> {
    pub(crate) state: [T; NX],
    pub(crate) control: [T; NU],
    /// Of the slack of each row; of an equality, the multiplier after the full step.
    pub(crate) rows: [T; NI],
    /// Full-step multiplier of the dynamics into this node.
    pub(crate) costate: [T; NX],
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

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Node<T, NX, NU, NI> {
    const fn new() -> Self {
        Self {
            dims: Dims {
                controls: 0,
                state_rows: 0,
                control_rows: 0,
                mixed_rows: 0,
            },
            elastic: T::ZERO,
            costate: [T::ZERO; NX],
            rows: Rows {
                slack: [T::ZERO; NI],
                lower: [T::ZERO; NI],
                upper: [T::ZERO; NI],
                below: [T::ZERO; NI],
                above: [T::ZERO; NI],
            },
            values: Values::new(),
            step: Step {
                state: [T::ZERO; NX],
                control: [T::ZERO; NU],
                rows: [T::ZERO; NI],
                costate: [T::ZERO; NX],
            },
            riccati: Riccati {
                gain: [[T::ZERO; NX]; NU],
                feedforward: [[T::ZERO; 1]; NU],
                hessian: [[T::ZERO; NX]; NX],
                gradient: [T::ZERO; NX],
                carried: Carried::new(),
                pivots: Pivots::new(),
            },
        }
    }
}

impl<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>
    Stage<T, X, NX, NU, NI>
{
    /// Zeroed storage around a state.
    #[must_use]
    pub const fn new(state: X) -> Self {
        Self::with(state, Derivatives::new())
    }
}

impl<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>
    SparseStage<T, X, NX, NU, NI>
{
    /// Zeroed storage around a state, for the nonzero entries of its derivatives.
    #[must_use]
    pub const fn sparse(state: X) -> Self {
        Self::with(state, Packed::new())
    }
}

impl<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>
    LeanStage<T, X, NX, NU, NI>
{
    /// Zeroed storage around a state, without room for derivatives.
    #[must_use]
    pub const fn lean(state: X) -> Self {
        Self::with(state, Recomputed)
    }
}

impl<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize, K: Copy>
    Stage<T, X, NX, NU, NI, K>
{
    const fn with(state: X, kept: K) -> Self {
        let point = (state, [T::ZERO; NU]);
        Self {
            state,
            control: [T::ZERO; NU],
            node: Node::new(),
            kept,
            trial: point,
            guess: point,
            best: point,
            spare: point,
        }
    }

    /// Derivatives at the iterate of node `k`, beside what the solver knows of it.
    #[inline(always)]
    pub(crate) fn linearise<'a, P: Problem<T, NX, NU, NI, State = X>>(
        &'a mut self,
        problem: &P,
        k: usize,
        next: Option<Next<'_, T, X, NX>>,
        scratch: &'a mut Derivatives<T, NX, NU, NI>,
        pass: Pass,
    ) -> (&'a mut Node<T, NX, NU, NI>, &'a K::Linearised)
    where
        K: Keep<T, NX, NU, NI>,
    {
        let node = &mut self.node;
        let (kept, dims, is_new) = (&mut self.kept, node.dims, pass == Pass::New);
        let derivatives = kept.at(scratch, dims, is_new, |derivatives| {
            let costate = next.map_or([T::ZERO; NX], |next| *next.costate);
            let next = next.map(|next| next.state);
            let mut values = Values::new();
            let values = if pass == Pass::Corrected {
                problem.evaluate(k, &self.state, &self.control, next, &mut values);
                &values
            } else {
                &node.values
            };
            let at = Evaluated {
                values,
                dynamics_multiplier: &costate,
                row_multipliers: &node.rows.multipliers(),
            };
            problem.differentiate(k, &self.state, &self.control, next, at, derivatives);
        });
        (node, derivatives)
    }

    /// Puts the guess of the last solve back, for another solve from the same start.
    pub fn restore_guess(&mut self) {
        (self.state, self.control) = self.guess;
    }

    /// Whether state and control are those that the last solve started from.
    #[must_use]
    pub fn is_at_guess(&self) -> bool
    where
        X: PartialEq,
    {
        (&self.state, &self.control) == (&self.guess.0, &self.guess.1)
    }

    /// Takes over the multipliers of a solved stage, for a warm start on an interval that is part number `part` of the `parts` equal ones of
    /// that stage's; `next` is the solved stage after it.
    ///
    /// Where each interval has its cost whatever its length, `parts` times as many costs add up on the parts: the multipliers of the
    /// dynamics and those of the rows of a state alone, which stand at the first part, are as many times as large, and those of the
    /// other rows stay. Rows are to be the same ones.
    pub fn resume_part(&mut self, long: &Self, next: Option<&Self>, part: usize, parts: usize)
    where
        T: Scalar,
    {
        let scale = T::of(parts as f64);
        let share = T::of(part as f64) / scale;
        let of_state = long.node.dims.state_rows;
        let after = next.map_or(&long.node.costate, |next| &next.node.costate);
        // Rows of the state make a step in the multipliers at their node.
        let before = if part > 0 && of_state > 0 {
            after
        } else {
            &long.node.costate
        };
        let ends = before.iter().zip(after);
        for (y, (from, to)) in self.node.costate.iter_mut().zip(ends) {
            *y = scale * (*from + share * (*to - *from));
        }
        let (rows, solved) = (&mut self.node.rows, &long.node.rows);
        for (to, from) in [
            (&mut rows.below, &solved.below),
            (&mut rows.above, &solved.above),
        ] {
            if part == 0 {
                *to = *from;
                to.iter_mut().take(of_state).for_each(|y| *y *= scale);
            } else {
                let rest = from.iter().skip(of_state);
                to.iter_mut().zip(rest).for_each(|(to, from)| *to = *from);
            }
        }
    }

    /// Keeps state and control beside, for a caller that tries another guess; solves leave them alone.
    pub const fn keep(&mut self) {
        self.spare = (self.state, self.control);
    }

    /// Puts back what [`Self::keep`] kept. Multipliers, gains and rows stay those of the last solve.
    pub const fn recall(&mut self) {
        (self.state, self.control) = self.spare;
    }

    /// Feedback gain of the last recursion: entry `[i][j]` is the change of control `i` that the optimum
    /// asks for per unit of tangent deviation `j` of this node's state.
    #[must_use]
    pub const fn gain(&self) -> &[[T; NX]; NU] {
        &self.node.riccati.gain
    }

    /// Feedback gain of free state coordinates, such as phase durations, on the others.
    ///
    /// With the cost-to-go Hessian `P` split into free and given coordinates the optimum moves by
    /// `d_free = −P_ff⁻¹ P_fg d_given`; row `i` of the result is the row of coordinate `i`, zero where it
    /// is not free. `None` if `P_ff` is not positive definite.
    #[must_use]
    pub fn free_gain(&self, free: &[bool; NX]) -> Option<[[T; NX]; NX]> {
        let mut block = self.node.riccati.hessian;
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
        &self.node.riccati.hessian
    }

    /// Multiplier of the dynamics that lead into this node: the gradient of the cost-to-go.
    #[must_use]
    pub const fn costate(&self) -> &[T; NX] {
        &self.node.costate
    }

    /// Constraint rows at the solution.
    #[must_use]
    pub const fn rows(&self) -> &[T; NI] {
        &self.node.values.rows
    }

    /// Multipliers of the rows; positive where the upper bound pushes.
    #[must_use]
    pub fn row_multipliers(&self) -> [T; NI] {
        self.node.rows.multipliers()
    }
}
