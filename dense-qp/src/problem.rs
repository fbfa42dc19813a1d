//! The quadratic program as the caller states it.

use crate::Error;
use crate::access::{at, row, span, span_mut};
use crate::kernels::{all_finite, dot, dot_few, max_abs};
use so3::{Scalar, math};

/// A convex quadratic program with N variables and M two-sided rows:
///
/// minimise ½ xᵀHx + gᵀx  subject to  l ≤ A x ≤ u  and  lb ≤ x ≤ ub.
///
/// A row with equal limits is an equality and is eliminated before the active-set search; a variable
/// with equal bounds is fixed. Infinite limits are allowed on either side.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, T, const N: usize, const M: usize> {
    /// H, N×N, symmetric (both triangles filled), positive semidefinite on the null space of the equalities.
    pub hessian: &'a [[T; N]; N],
    /// g.
    pub gradient: &'a [T; N],
    /// A, one constraint per row.
    pub rows: &'a [[T; N]; M],
    /// l, −∞ for none.
    pub row_lower: &'a [T; M],
    /// u, +∞ for none; equal to l for an equality.
    pub row_upper: &'a [T; M],
    /// lb, −∞ for none; `None` when no variable has a lower bound.
    pub lower: Option<&'a [T; N]>,
    /// ub, +∞ for none; `None` when no variable has an upper bound.
    pub upper: Option<&'a [T; N]>,
    /// Per row the columns `from..to` outside of which it is zero; `None` when rows are full.
    pub spans: Option<&'a [[usize; 2]; M]>,
}

impl<'a, T: Scalar, const N: usize, const M: usize> Problem<'a, T, N, M> {
    /// A problem whose variables have no bounds.
    pub const fn new(
        hessian: &'a [[T; N]; N],
        gradient: &'a [T; N],
        rows: &'a [[T; N]; M],
        row_lower: &'a [T; M],
        row_upper: &'a [T; M],
    ) -> Self {
        Self {
            hessian,
            gradient,
            rows,
            row_lower,
            row_upper,
            lower: None,
            upper: None,
            spans: None,
        }
    }

    /// The same problem with rows that are zero outside of columns `from..to`, which saves looking there: the numbers outside are
    /// not read during the search.
    #[must_use]
    pub const fn with_spans(mut self, spans: &'a [[usize; 2]; M]) -> Self {
        self.spans = Some(spans);
        self
    }

    /// The same problem with lb ≤ x ≤ ub.
    #[must_use]
    pub const fn with_bounds(mut self, lower: &'a [T; N], upper: &'a [T; N]) -> Self {
        self.lower = Some(lower);
        self.upper = Some(upper);
        self
    }

    /// ½ xᵀHx + gᵀx.
    #[must_use]
    pub fn cost(&self, x: &[T; N]) -> T {
        let mut sum = T::ZERO;
        for ((h, g), xi) in self.hessian.iter().zip(self.gradient).zip(x) {
            sum += *xi * (T::HALF * crate::kernels::dot(h, x) + *g);
        }
        sum
    }

    /// Limits of row `i` (i < M) or of variable `i − M`.
    #[inline(always)]
    pub(crate) fn limits(&self, i: usize) -> (T, T) {
        if i < M {
            (at(self.row_lower, i), at(self.row_upper, i))
        } else {
            (
                self.lower.map_or(-T::INFINITY, |l| at(l, i - M)),
                self.upper.map_or(T::INFINITY, |u| at(u, i - M)),
            )
        }
    }

    /// First column and entries of row `i` < M that may not be zero.
    #[inline(always)]
    pub(crate) fn entries(&self, i: usize) -> (usize, &'a [T]) {
        let row = row(self.rows, i);
        match self.spans.and_then(|spans| spans.get(i)) {
            None => (0, row),
            Some([from, to]) => (*from, span(row, *from, *to)),
        }
    }

    /// aᵢᵀx of row `i` (i < M) or x of variable `i − M`.
    #[inline(always)]
    pub(crate) fn value(&self, i: usize, x: &[T; N]) -> T {
        if i < M {
            self.row_value(i, row(self.rows, i), x)
        } else {
            at(x, i - M)
        }
    }

    /// aᵀx of row `i`, whose entries `a` are.
    #[inline(always)]
    pub(crate) fn row_value(&self, i: usize, a: &[T], x: &[T; N]) -> T {
        match self.spans {
            None => dot(a, x),
            Some(spans) => {
                let [from, to] = at(spans, i);
                dot_few(a, x, from, to)
            }
        }
    }

    /// Σ |aᵢⱼxⱼ| of row `i` (i < M) or |x| of variable `i − M`: the size of the terms of [`Problem::value`].
    pub(crate) fn size_at(&self, i: usize, x: &[T; N]) -> T {
        if i < M {
            let (from, a) = self.entries(i);
            crate::kernels::dot_sizes(a, span(x, from, N))
        } else {
            math::abs(at(x, i - M))
        }
    }

    /// y ← y + f·aᵢ.
    #[inline(always)]
    pub(crate) fn add_row(&self, i: usize, f: T, y: &mut [T; N]) {
        if i < M {
            let (from, a) = self.entries(i);
            crate::kernels::sub_scaled(span_mut(y, from, N), -f, a);
        } else if let Some(e) = y.get_mut(i - M) {
            *e += f;
        }
    }

    /// Names the first number that no solver could use.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        for (i, h) in self.hessian.iter().enumerate() {
            if !all_finite(h) {
                return Err(Error::HessianNotFinite(i));
            }
        }
        let asymmetry = T::of(1024.0) * T::EPSILON;
        for (i, h) in self.hessian.iter().enumerate() {
            for (v, column) in h.iter().zip(self.hessian).take(i) {
                let mirror = at(column, i);
                if *v == mirror {
                    continue;
                }
                // Both triangles of JᵀWJ agree to round-off of its diagonal, not of the entry.
                let scale = math::abs(*v) + math::abs(at(h, i)) + max_abs(column);
                if math::abs(*v - mirror) > asymmetry * scale {
                    return Err(Error::HessianNotSymmetric(i));
                }
            }
        }
        for (i, a) in self.rows.iter().enumerate() {
            if !all_finite(a) {
                return Err(Error::RowNotFinite(i));
            }
        }
        for (i, g) in self.gradient.iter().enumerate() {
            if !g.is_finite_number() {
                return Err(Error::GradientNotFinite(i));
            }
        }
        for (i, (l, u)) in self.row_lower.iter().zip(self.row_upper).enumerate() {
            if !ordered(*l, *u) {
                return Err(Error::RowLimits(i));
            }
        }
        if self.lower.is_some() || self.upper.is_some() {
            for i in 0..N {
                let (l, u) = self.limits(M + i);
                if !ordered(l, u) {
                    return Err(Error::Bounds(i));
                }
            }
        }
        Ok(())
    }
}

#[inline(always)]
fn ordered<T: Scalar>(l: T, u: T) -> bool {
    l <= u && l < T::INFINITY && u > -T::INFINITY
}
