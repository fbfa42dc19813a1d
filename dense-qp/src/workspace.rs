//! All memory of a solve, and the solution left in it.

use crate::Residual;
use crate::access::at;
use crate::basis::{Basis, Candidate};
use crate::elimination::Elimination;
use crate::factor::Factor;
use so3::Scalar;

/// Most entries of the list of violated rows.
pub(crate) const POOL: usize = 8;

/// So many of the most violated rows must be those of the last solve for a start to look like it.
pub(crate) const ALIKE: usize = 3;

/// Scratch of a solve: about 4N² + 26N + 3M scalars. `new` is const and all zero, so a
/// `static` of it lives in `.bss`. It remembers the last active set for [`crate::solve_warm`].
#[derive(Clone, Debug)]
pub struct Workspace<T, const N: usize, const M: usize> {
    pub(crate) x: [T; N],
    pub(crate) row_multipliers: [T; M],
    pub(crate) bound_multipliers: [T; N],
    pub(crate) elimination: Elimination<T, N>,
    pub(crate) factor: Factor<T, N>,
    pub(crate) basis: Basis<T, N>,
    pub(crate) candidate: Candidate<T, N>,
    /// Active inequalities in the order of the basis, with side (±1), multiplier ≥ 0.
    pub(crate) id: [usize; N],
    pub(crate) side: [i8; N],
    pub(crate) lambda: [T; N],
    /// Side on which each row and bound is active; 2 for an equality.
    pub(crate) row_state: [i8; M],
    pub(crate) bound_state: [i8; N],
    /// 1 / max |aᵢ| of the rows that needed it (1 for a zero row), else 0.
    pub(crate) row_scale_inverse: [T; M],
    /// 1 / |aᵢ|₂ of the same, by which violations of rows are compared.
    pub(crate) row_length_inverse: [T; M],
    /// Rows that the last look at all of them found most violated, worst first.
    pub(crate) pool: [(usize, i8); POOL],
    pub(crate) pool_len: usize,
    /// The most violated rows at the point without active rows and by how much they are, of this solve and, until then, of the last; the
    /// side 0 stands for none.
    pub(crate) first: [(usize, i8, T); ALIKE],
    pub(crate) gradient: [T; N],
    pub(crate) step: [T; N],
    pub(crate) vec_a: [T; N],
    pub(crate) vec_b: [T; N],
    pub(crate) previous: [T; N],
    /// Whether elimination, factor and basis are those of the last solve.
    pub(crate) is_factorised: bool,
}

impl<T: Scalar, const N: usize, const M: usize> Workspace<T, N, M> {
    /// An all-zero workspace without a remembered active set.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            x: [T::ZERO; N],
            row_multipliers: [T::ZERO; M],
            bound_multipliers: [T::ZERO; N],
            elimination: Elimination::new(),
            factor: Factor::new(),
            basis: Basis::new(),
            candidate: Candidate::new(),
            id: [0; N],
            side: [0; N],
            lambda: [T::ZERO; N],
            row_state: [0; M],
            bound_state: [0; N],
            row_scale_inverse: [T::ZERO; M],
            row_length_inverse: [T::ZERO; M],
            pool: [(0, 0); POOL],
            pool_len: 0,
            first: [(0, 0, T::ZERO); ALIKE],
            gradient: [T::ZERO; N],
            step: [T::ZERO; N],
            vec_a: [T::ZERO; N],
            vec_b: [T::ZERO; N],
            previous: [T::ZERO; N],
            is_factorised: false,
        }
    }

    /// Most steps that a solve takes whatever [`crate::Settings::max_steps`] says: 200 + 20 (N + M). Programs of controllers take about
    /// as many as rows are active at the end, and at most 3 (N + M) were seen; degenerate public ones of 300 variables, with proximal
    /// steps, 7 (N + M).
    pub const STEPS: u32 = 200 + 20 * (N + M) as u32;

    /// Entries of the list of violated rows. It saves looks at all rows, but rows entered by an old list leave again: where a look
    /// is cheap, the list is short.
    pub(crate) const LISTED: usize = match (M + N) / 10 {
        0..=2 => 2,
        many @ 3..POOL => many,
        _ => POOL,
    };

    /// Forgets the active set: the next [`crate::solve_warm`] starts cold.
    pub fn forget(&mut self) {
        self.basis.len = 0;
        self.is_factorised = false;
    }

    /// The inequalities that are active at the solution, in no particular order.
    pub fn active(&self) -> impl Iterator<Item = (Constraint, Side)> + '_ {
        self.id
            .iter()
            .zip(&self.side)
            .take(self.basis.len)
            .map(|(id, side)| {
                (
                    Constraint::of::<M>(*id),
                    if *side > 0 { Side::Upper } else { Side::Lower },
                )
            })
    }

    pub(crate) fn state(&self, i: usize) -> i8 {
        if i < M {
            at(&self.row_state, i)
        } else {
            at(&self.bound_state, i - M)
        }
    }

    pub(crate) fn set_state(&mut self, i: usize, state: i8) {
        if i < M {
            crate::access::put(&mut self.row_state, i, state);
        } else {
            crate::access::put(&mut self.bound_state, i - M, state);
        }
    }
}

impl<T: Scalar, const N: usize, const M: usize> Default for Workspace<T, N, M> {
    fn default() -> Self {
        Self::new()
    }
}

/// A constraint of a [`crate::Problem`] by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constraint {
    /// Row of A.
    Row(usize),
    /// Bounds of a variable.
    Bound(usize),
}

impl Constraint {
    pub(crate) fn of<const M: usize>(i: usize) -> Self {
        if i < M {
            Self::Row(i)
        } else {
            Self::Bound(i - M)
        }
    }
}

/// Which limit of a constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The lower limit; its multiplier is ≤ 0.
    Lower,
    /// The upper limit; its multiplier is ≥ 0.
    Upper,
}

/// What a solve came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Optimal: the KKT residual is within the tolerances of [`crate::Settings`].
    Solved,
    /// The iteration cap was reached; `x` minimises the cost over the rows active so far and the
    /// residual says how far it is from the rest.
    Limit,
    /// No point satisfies the constraints. The multipliers hold the proof: y ≠ 0 on the rows and
    /// bounds that contradict each other, with Aᵀy + μ = 0 and a negative support
    /// Σ max(y,0) u + min(y,0) l (see [`crate::infeasibility`]).
    Infeasible,
    /// The cost falls without end along a direction that stays feasible; `x` is a feasible point and
    /// [`Solution::ray`] the direction.
    Unbounded,
    /// Round-off prevents an answer within the tolerances; `x` is the best point found and the
    /// residual says how good it is.
    Numerical,
}

/// The outcome of a solve; borrows the workspace.
#[derive(Clone, Copy, Debug)]
pub struct Solution<'w, T, const N: usize, const M: usize> {
    /// What the rest means.
    pub status: Status,
    /// The minimiser, or the best iterate.
    pub x: &'w [T; N],
    /// λ of the rows: ≥ 0 at the upper limit, ≤ 0 at the lower, Hx + g + Aᵀλ + μ = 0.
    pub row_multipliers: &'w [T; M],
    /// μ of the bounds, same signs.
    pub bound_multipliers: &'w [T; N],
    /// Rows that entered or left the active set, plus corrections of the point.
    pub iterations: u32,
    /// These, and remembered rows that entered or left: what [`crate::Settings::max_steps`] caps.
    pub steps: u32,
    /// KKT residual at `x` and the multipliers found (not those of a proof of infeasibility).
    pub residual: Residual<T>,
    pub(crate) ray: &'w [T; N],
}

impl<'w, T: Scalar, const N: usize, const M: usize> Solution<'w, T, N, M> {
    /// For [`Status::Unbounded`] a direction d with Hd = 0, gᵀd < 0 that no limit stops, max |d| = 1.
    #[must_use]
    pub fn ray(&self) -> Option<&'w [T; N]> {
        (self.status == Status::Unbounded).then_some(self.ray)
    }

    /// For [`Status::Infeasible`] the rows and bounds that contradict each other, and on which side.
    pub fn conflict(&self) -> impl Iterator<Item = (Constraint, Side)> + 'w {
        let infeasible = self.status == Status::Infeasible;
        let side = |y: T| {
            if y > T::ZERO {
                Side::Upper
            } else {
                Side::Lower
            }
        };
        let rows = self.row_multipliers.iter().enumerate();
        let rows = rows.map(move |(i, y)| (Constraint::Row(i), *y));
        let bounds = self.bound_multipliers.iter().enumerate();
        let bounds = bounds.map(move |(i, y)| (Constraint::Bound(i), *y));
        rows.chain(bounds)
            .filter(move |(_, y)| infeasible && *y != T::ZERO)
            .map(move |(c, y)| (c, side(y)))
    }
}
