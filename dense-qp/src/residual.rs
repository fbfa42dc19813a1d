//! How far a point and multipliers are from optimal, and whether multipliers prove infeasibility.

use crate::Problem;
use crate::access::at;
use crate::kernels::{all_finite, dot, max_abs};
use so3::{Scalar, math};

/// Largest entries of the KKT conditions' violations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual<T> {
    /// |Hx + g + Aᵀλ + μ|.
    pub stationarity: T,
    /// Amount by which a row or bound is violated, in its own units.
    pub primal: T,
    /// Amount by which a multiplier has the sign of a limit that does not exist, and
    /// |multiplier × distance to its limit|.
    pub complementarity: T,
}

impl<T: Scalar> Residual<T> {
    /// The largest of the three.
    #[must_use]
    pub fn max(&self) -> T {
        let m = math::max(
            self.stationarity,
            math::max(self.primal, self.complementarity),
        );
        if self.stationarity.is_nan_number() || self.primal.is_nan_number() {
            T::NAN
        } else {
            m
        }
    }
}

/// KKT residual of any point x with multipliers λ of the rows and μ of the bounds (upper limit ≥ 0,
/// lower limit ≤ 0). A NaN anywhere gives NaN.
#[must_use]
pub fn kkt_residual<T: Scalar, const N: usize, const M: usize>(
    problem: &Problem<'_, T, N, M>,
    x: &[T; N],
    row_multipliers: &[T; M],
    bound_multipliers: &[T; N],
) -> Residual<T> {
    let mut r = Residual {
        stationarity: T::ZERO,
        primal: T::ZERO,
        complementarity: T::ZERO,
    };
    for (i, h) in problem.hessian.iter().enumerate() {
        let mut s = dot(h, x) + at(problem.gradient, i) + at(bound_multipliers, i);
        for (a, y) in problem.rows.iter().zip(row_multipliers) {
            if *y != T::ZERO {
                s += at(a, i) * *y;
            }
        }
        r.stationarity = worse(r.stationarity, math::abs(s));
    }
    for (i, y) in row_multipliers.iter().chain(bound_multipliers).enumerate() {
        let (value, (l, u)) = (problem.value(i, x), problem.limits(i));
        r.primal = worse(r.primal, worse(l - value, value - u));
        let c = if *y > T::ZERO && u < T::INFINITY {
            math::abs(*y * (u - value))
        } else if *y < T::ZERO && l > -T::INFINITY {
            math::abs(*y * (value - l))
        } else {
            math::abs(*y)
        };
        r.complementarity = worse(r.complementarity, c);
    }
    r
}

/// The larger, and NaN if either is.
#[inline(always)]
pub(crate) fn worse<T: Scalar>(a: T, b: T) -> T {
    if a.is_nan_number() || a > b { a } else { b }
}

/// A proof that no point satisfies the constraints, measured.
///
/// For every x with l ≤ Ax ≤ u, lb ≤ x ≤ ub: (Aᵀy + μ)ᵀx ≤ `support`. With `combination` = 0 the left side
/// is 0, so a negative `support` is a contradiction; otherwise no feasible point has
/// ‖x‖₁ < −`support` / `combination`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Infeasibility<T> {
    /// Largest entry of Aᵀy + μ.
    pub combination: T,
    /// Σ max(y,0)·u + min(y,0)·l over rows and bounds.
    pub support: T,
}

/// Measures multipliers y, μ as a proof of infeasibility.
#[must_use]
pub fn infeasibility<T: Scalar, const N: usize, const M: usize>(
    problem: &Problem<'_, T, N, M>,
    row_multipliers: &[T; M],
    bound_multipliers: &[T; N],
) -> Infeasibility<T> {
    let mut combination = T::ZERO;
    for (i, mu) in bound_multipliers.iter().enumerate() {
        let mut s = *mu;
        for (a, y) in problem.rows.iter().zip(row_multipliers) {
            if *y != T::ZERO {
                s += at(a, i) * *y;
            }
        }
        combination = worse(combination, math::abs(s));
    }
    let mut support = T::ZERO;
    for (i, y) in row_multipliers.iter().chain(bound_multipliers).enumerate() {
        let (l, u) = problem.limits(i);
        if *y > T::ZERO {
            support += *y * u;
        } else if *y < T::ZERO {
            support += *y * l;
        }
    }
    Infeasibility {
        combination,
        support,
    }
}

/// Largest magnitude, NaN if any entry is.
pub(crate) fn norm<T: Scalar>(a: &[T]) -> T {
    if all_finite(a) {
        max_abs(a)
    } else {
        a.iter().fold(T::ZERO, |m, v| worse(m, math::abs(*v)))
    }
}
