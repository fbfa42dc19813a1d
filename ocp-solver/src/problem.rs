//! What a user states: dynamics, costs and constraint rows of every node, with their derivatives.

use so3::Scalar;

/// Sizes of one node.
///
/// Rows come in three groups, in this order: rows of the state only, rows of the control only, rows of both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dims {
    /// Controls in use, at most `NU`; 0 where the motion is ballistic.
    pub controls: usize,
    /// Rows that depend on the state only.
    pub state_rows: usize,
    /// Rows that depend on the control only.
    pub control_rows: usize,
    /// Rows that depend on both.
    pub mixed_rows: usize,
}

impl Dims {
    /// Number of rows of all groups.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.state_rows
            .saturating_add(self.control_rows)
            .saturating_add(self.mixed_rows)
    }
}

/// Values of a node at one point.
#[derive(Clone, Copy, Debug)]
pub struct Values<T, const NX: usize, const NI: usize> {
    /// Stage cost.
    pub cost: T,
    /// Where the dynamics lead, seen from the next node: `F(x, u) ⊖ x_next`, in the tangent space there.
    pub gap: [T; NX],
    /// Constraint rows `c(x, u)`.
    pub rows: [T; NI],
}

impl<T: Scalar, const NX: usize, const NI: usize> Values<T, NX, NI> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            cost: T::ZERO,
            gap: [T::ZERO; NX],
            rows: [T::ZERO; NI],
        }
    }
}

impl<T: Scalar, const NX: usize, const NI: usize> Default for Values<T, NX, NI> {
    fn default() -> Self {
        Self::new()
    }
}

/// Derivatives of a node at one point; matrices are column-major.
///
/// The arrays are zero before the first call, and later ones hold zeros or what the problem wrote last at the same
/// node, so a problem with a fixed pattern writes only that pattern. Rows beyond those of the node are to be left alone.
#[derive(Clone, Copy, Debug)]
pub struct Derivatives<T, const NX: usize, const NU: usize, const NI: usize> {
    /// Gradient of the cost in the state.
    pub cost_x: [T; NX],
    /// Gradient of the cost in the control.
    pub cost_u: [T; NU],
    /// ∂gap/∂x: `dynamics_x[j]` is the column of state coordinate `j`.
    pub dynamics_x: [[T; NX]; NX],
    /// ∂gap/∂u: `dynamics_u[j]` is the column of control `j`.
    pub dynamics_u: [[T; NX]; NU],
    /// ∂c/∂x: `rows_x[i]` is the gradient of row `i`.
    pub rows_x: [[T; NX]; NI],
    /// ∂c/∂u: `rows_u[i]` is the gradient of row `i`.
    pub rows_u: [[T; NU]; NI],
    /// ∂²L/∂x², symmetric, of `L = cost + λ_nextᵀ gap + yᵀ c`.
    pub hessian_xx: [[T; NX]; NX],
    /// ∂²L/∂x∂u: `hessian_xu[j]` is the column of control `j`.
    pub hessian_xu: [[T; NX]; NU],
    /// ∂²L/∂u², symmetric.
    pub hessian_uu: [[T; NU]; NU],
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Derivatives<T, NX, NU, NI> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            cost_x: [T::ZERO; NX],
            cost_u: [T::ZERO; NU],
            dynamics_x: [[T::ZERO; NX]; NX],
            dynamics_u: [[T::ZERO; NX]; NU],
            rows_x: [[T::ZERO; NX]; NI],
            rows_u: [[T::ZERO; NU]; NI],
            hessian_xx: [[T::ZERO; NX]; NX],
            hessian_xu: [[T::ZERO; NX]; NU],
            hessian_uu: [[T::ZERO; NU]; NU],
        }
    }

    /// Zero again, in place; of the rows the first ones, since nobody reads more than a node has.
    pub(crate) fn clear(&mut self, rows: usize) {
        let rows = rows.min(NI);
        let rows_x = self.rows_x.get_mut(..rows).unwrap_or_default();
        let rows_u = self.rows_u.get_mut(..rows).unwrap_or_default();
        for vector in [
            &mut self.cost_x[..],
            &mut self.cost_u,
            self.dynamics_x.as_flattened_mut(),
            self.dynamics_u.as_flattened_mut(),
            rows_x.as_flattened_mut(),
            rows_u.as_flattened_mut(),
            self.hessian_xx.as_flattened_mut(),
            self.hessian_xu.as_flattened_mut(),
            self.hessian_uu.as_flattened_mut(),
        ] {
            vector.fill(T::ZERO);
        }
    }
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Default
    for Derivatives<T, NX, NU, NI>
{
    fn default() -> Self {
        Self::new()
    }
}

/// What is already known at the point where derivatives are asked for.
#[derive(Clone, Copy, Debug)]
pub struct Evaluated<'a, T, const NX: usize, const NI: usize> {
    /// Cost, gap and rows.
    pub values: &'a Values<T, NX, NI>,
    /// Multiplier λ of the dynamics that leave this node; zero at the last node.
    pub dynamics_multiplier: &'a [T; NX],
    /// Multipliers y of the constraint rows; positive where the upper bound pushes.
    pub row_multipliers: &'a [T; NI],
}

/// An optimal-control problem on nodes `0 ..= intervals()`:
///
/// ```text
/// min  Σ cost_k(x_k, u_k)
/// s.t. x_{k+1} = F_k(x_k, u_k),   lower_k ≤ c_k(x_k, u_k) ≤ upper_k
/// ```
///
/// Rows with `lower == upper` are equalities; terminal constraints are rows of the last node. Phase
/// durations are state coordinates that stay constant, free at node 0 ([`Problem::is_free_at_start`])
/// and bounded by rows of node 0, once per phase. Sizes: `NX` tangent coordinates of the state, `NU`
/// controls, `NI` rows, each an upper bound that may be padded to the machine's vector width.
///
/// Threads may ask for several nodes at once (`Settings::threads`), hence `Sync`; an answer depends on nothing but what is asked.
pub trait Problem<T: Scalar, const NX: usize, const NU: usize, const NI: usize>: Sync {
    /// A point of the state manifold.
    type State: Copy + Send + Sync;

    /// Number of intervals `N`; the problem has `N + 1` nodes.
    fn intervals(&self) -> usize;

    /// Sizes of node `k`; the last node has no controls.
    fn dims(&self, k: usize) -> Dims;

    /// Writes the bounds of the rows of node `k`; infinities mean "no bound".
    fn bounds(&self, k: usize, lower: &mut [T; NI], upper: &mut [T; NI]);

    /// Whether tangent coordinate `i` of the first state may be changed.
    fn is_free_at_start(&self, i: usize) -> bool;

    /// The state of node `k` moved by the tangent step: `x ⊕ step`.
    ///
    /// `before` holds the already moved state and control of node `k − 1`, for states that are
    /// represented relative to their predecessor.
    fn retract(
        &self,
        k: usize,
        state: &Self::State,
        step: &[T; NX],
        before: Option<(&Self::State, &[T; NU])>,
    ) -> Self::State;

    /// Cost, gap and rows of node `k`; `next` is `None` at the last node, where the gap is ignored.
    fn evaluate(
        &self,
        k: usize,
        state: &Self::State,
        control: &[T; NU],
        next: Option<&Self::State>,
        values: &mut Values<T, NX, NI>,
    );

    /// Derivatives of node `k`; `at.values` are its values at the same point.
    fn differentiate(
        &self,
        k: usize,
        state: &Self::State,
        control: &[T; NU],
        next: Option<&Self::State>,
        at: Evaluated<'_, T, NX, NI>,
        derivatives: &mut Derivatives<T, NX, NU, NI>,
    );
}
