//! H = UᵀDU of the reduced Hessian, U unit upper triangular; no square roots.

use crate::kernels::{at, ceil4, dot_in, floor4, head, put, scale_from, span, span_mut};
use crate::kernels::{sub_block, sub_rows};
use crate::settings::{pivot_tolerance, proximal_weight};
use core::slice::from_ref;
use so3::Scalar;

/// Factor of the leading `dim`×`dim` block.
#[derive(Clone, Debug)]
pub(crate) struct Factor<T, const N: usize> {
    /// On entry to [`Factor::factorise`] the upper triangle of H, then U without its diagonal. Up to
    /// the next multiple of the kernels' width zeros stand beside the entries.
    pub(crate) u: [[T; N]; N],
    /// On entry to [`Factor::factorise`] the size of the terms that each diagonal entry was summed
    /// from, then 1/D.
    pub(crate) weight: [T; N],
    /// Order of the block.
    pub(crate) dim: usize,
    /// Whether a pivot without curvature got a proximal weight.
    pub(crate) proximal: bool,
}

impl<T: Scalar, const N: usize> Factor<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            u: [[T::ZERO; N]; N],
            weight: [T::ZERO; N],
            dim: 0,
            proximal: false,
        }
    }

    /// Factorises in place. A pivot that is zero to round-off gets a proximal weight, a share of its own variable's curvature
    /// so that units do not matter: the factor is then that of H + P with P ≥ 0 diagonal, and the caller iterates (see
    /// [`crate`], proximal steps). A variable without any takes the largest curvature, and `reference` where H is zero.
    ///
    /// Returns the first pivot that is below zero by more than it should be: [`Factor::concave`] is a direction to look along.
    pub(crate) fn factorise(&mut self, reference: T) -> Option<usize> {
        let n = self.dim;
        let end = ceil4(n, N);
        let mut largest = T::ZERO;
        for h in self.weight.iter().take(n) {
            if *h > largest {
                largest = *h;
            }
        }
        let scale = if largest > T::ZERO {
            largest
        } else if reference > T::ZERO {
            reference
        } else {
            T::ONE
        };
        self.proximal = false;
        span_mut(&mut self.weight, n, end).fill(T::ZERO);
        let tolerance = pivot_tolerance::<T>();
        let mut below = None;
        let mut shares = [T::ZERO; N];
        for k in 0..n {
            let Some((above, [row, ..])) = self.u.split_at_mut_checked(k) else {
                break;
            };
            // Of the pivot rows above, unscaled as they still are.
            for ((f, a), w) in shares.iter_mut().zip(&*above).zip(&self.weight) {
                *f = at(a, k) * *w;
            }
            sub_rows(row, &shares, above, floor4(k), end);
            let mut d = at(row.as_slice(), k);
            let diagonal = at(&self.weight, k);
            if !(d > tolerance * diagonal && diagonal > T::EPSILON * T::EPSILON * scale) {
                if d < -(T::of(4.0) * tolerance * (diagonal + T::EPSILON * scale)) {
                    below = below.or(Some(k));
                }
                let own = if diagonal > T::EPSILON * T::EPSILON * scale {
                    diagonal
                } else {
                    scale
                };
                // Below zero it shows how large round-off is in its row, which the weight must outdo.
                let weight = so3::math::max(proximal_weight::<T>() * own, -(T::of(8.0) * d));
                d = so3::math::max(d, T::ZERO) + weight;
                self.proximal = true;
            }
            put(&mut self.weight, k, T::ONE / d);
        }
        for k in 0..n {
            let Some(row) = self.u.get_mut(k) else { break };
            scale_from(row, at(&self.weight, k), k + 1, end);
        }
        below
    }

    /// v ← U⁻¹eₖ, along which the curvature is the pivot `k` before its proximal weight, less what earlier ones got.
    pub(crate) fn concave(&mut self, k: usize, v: &mut [T; N]) {
        v.fill(T::ZERO);
        put(v, k, T::ONE);
        let dim = core::mem::replace(&mut self.dim, k + 1);
        self.solve(v);
        self.dim = dim;
    }

    /// v ← U⁻ᵀ v, block by block of columns.
    #[inline]
    pub(crate) fn solve_transposed(&self, v: &mut [T; N]) {
        let mut column = 0;
        while column < self.dim.min(N) {
            let Some((known, open)) = v.split_at_mut_checked(column) else {
                return;
            };
            let (above, own) = (head(&self.u, column), span(&self.u, column, self.dim));
            column += if let Some(s) = open.first_chunk_mut::<4>() {
                *s = sub_block(*s, known, above, column);
                for (i, row) in own.iter().take(3).enumerate() {
                    let f = at(s.as_slice(), i);
                    *s = sub_block(*s, &[f], from_ref(row), column);
                }
                4
            } else if let Some(s) = open.first_chunk_mut::<1>() {
                *s = sub_block(*s, known, above, column);
                1
            } else {
                1
            };
        }
    }

    /// v ← U⁻¹ v.
    #[inline]
    pub(crate) fn solve(&self, v: &mut [T; N]) {
        let end = ceil4(self.dim, N);
        // By index: over an iterator of the rows, reversed, the same loop takes 1.6 times the instructions.
        for k in (0..self.dim.min(N)).rev() {
            let Some(r) = self.u.get(k) else { break };
            let from = floor4(k + 1);
            let s = dot_in(r, v, from, end);
            if let Some(e) = v.get_mut(k) {
                *e -= s;
            }
        }
    }

    /// v ← D⁻¹ v.
    #[inline]
    pub(crate) fn weigh(&self, v: &mut [T; N]) {
        for (v, w) in v.iter_mut().zip(&self.weight).take(self.dim) {
            *v *= *w;
        }
    }
}
