//! What a caller may choose, and the numerical thresholds that follow from the scalar.

use crate::Error;
use so3::Scalar;

/// Tolerances and the iteration cap of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T> {
    /// Cap on iterations: rows entering or leaving the active set plus corrections of the point. One iteration costs O(N²+NM).
    pub max_iterations: u32,
    /// Cap on everything that takes time: iterations, and also rows remembered from the last solve that enter again or leave.
    /// With it the time of a solve has a bound; [`crate::Workspace::STEPS`], an estimate from the sizes, caps them in any case.
    pub max_steps: u32,
    /// How far outside a row the solution may lie, as a distance: violation / max|aᵢ|. The round-off
    /// of evaluating the row, 32·ε·Σ|aᵢⱼxⱼ|, is allowed in any case.
    pub feasibility: T,
    /// Largest entry of Hx + g + Aᵀλ + μ relative to the largest entry of its terms, and the cost that is left to gain relative to the
    /// terms of the cost, Σ|xᵢ|(|Hx|ᵢ + |g|ᵢ), which does not depend on units. An entry that is round-off of its own terms is
    /// allowed in any case.
    pub optimality: T,
}

impl<T: Scalar> Default for Settings<T> {
    /// No caps but the estimate [`crate::Workspace::STEPS`]; f64: feasibility 1e-9, optimality 1e-10; f32: 1e-4 and 3e-4.
    fn default() -> Self {
        let double = is_double::<T>();
        Self {
            max_iterations: u32::MAX,
            max_steps: u32::MAX,
            feasibility: T::of(if double { 1e-9 } else { 1e-4 }),
            optimality: T::of(if double { 1e-10 } else { 3e-4 }),
        }
    }
}

impl<T: Scalar> Settings<T> {
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let usable = |t: T| t >= T::ZERO && t.is_finite_number();
        if usable(self.feasibility) && usable(self.optimality) {
            Ok(())
        } else {
            Err(Error::SettingsTolerance)
        }
    }
}

fn is_double<T: Scalar>() -> bool {
    T::EPSILON < T::of(1e-12)
}

/// A pivot of the Hessian below this share of its diagonal entry counts as zero curvature: without
/// pivoting, round-off in a pivot after one of size τ is ε/√τ, so τ must exceed ε^⅔.
pub(crate) fn pivot_tolerance<T: Scalar>() -> T {
    T::of(if is_double::<T>() { 2e-10 } else { 1e-4 })
}

/// What is left of a row below this share of it is round-off of the elimination (≈ ε^¾).
pub(crate) fn row_tolerance<T: Scalar>() -> T {
    T::of(if is_double::<T>() { 1e-11 } else { 3e-5 })
}

/// A row whose squared distance from the span of the active rows is below this share of its squared
/// length counts as dependent (≈ ε^{4/3}: a ratio of lengths of 4e-11 or 2e-5).
pub(crate) fn dependence_tolerance<T: Scalar>() -> T {
    T::of(if is_double::<T>() { 1.4e-21 } else { 6e-10 })
}

/// The same beside the terms of active rows that make up the row: (8ε)², since each of them is held to its own round-off.
pub(crate) fn cancellation_tolerance<T: Scalar>() -> T {
    T::of(64.0) * T::EPSILON * T::EPSILON
}

/// Proximal weight put on a direction without curvature, relative to the largest curvature.
pub(crate) fn proximal_weight<T: Scalar>() -> T {
    T::of(if is_double::<T>() { 1e-6 } else { 1e-3 })
}
