//! H = UᵀDU of the reduced Hessian, U unit upper triangular; no square roots.

use crate::access::{at, head, head_mut, put, span, span_mut};
use crate::kernels::sub_block;
use crate::kernels::{ceil4, dot_in, floor4, max_abs, scale_from};
use crate::settings::{pivot_tolerance, proximal_weight};
use crate::tiles::{Shares, block, less, load, store, sub_products};
use core::slice::from_ref;
use so3::{Scalar, math};

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
    /// Which of them have no curvature at all, not even one of their own that others take away: no units say what a step along them is.
    pub(crate) linear: [bool; N],
}

impl<T: Scalar, const N: usize> Factor<T, N> {
    pub(crate) const fn new() -> Self {
        Self {
            u: [[T::ZERO; N]; N],
            weight: [T::ZERO; N],
            dim: 0,
            proximal: false,
            linear: [false; N],
        }
    }

    /// Before [`Factor::factorise`]: the least curvature of a variable, infinite where there is none, and the scale beside which it counts, which is the
    /// largest, or where all are zero the largest slope, or one.
    pub(crate) fn curvatures(&self, gradient: &[T; N]) -> [T; 2] {
        let (mut least, mut largest) = (T::INFINITY, T::ZERO);
        for h in self.weight.iter().take(self.dim) {
            if *h < least {
                least = *h;
            }
            if *h > largest {
                largest = *h;
            }
        }
        if largest == T::ZERO {
            let slope = max_abs(gradient);
            largest = if slope > T::ZERO { slope } else { T::ONE };
        }
        [least, largest]
    }

    /// Factorises in place. A pivot that is zero to round-off gets a proximal weight, a share of its own variable's curvature
    /// so that units do not matter: the factor is then that of H + P with P ≥ 0 diagonal, and the caller iterates (see
    /// [`crate`], proximal steps). A variable without any beside `scale` takes what `linear` says for it.
    ///
    /// Returns the first pivot that is below zero by more than it should be: [`Factor::concave`] is a direction to look along.
    pub(crate) fn factorise(&mut self, scale: T, linear: &[T; N]) -> Option<usize> {
        let n = self.dim;
        let end = ceil4(n, N);
        if core::mem::take(&mut self.proximal) {
            self.linear.fill(false);
        }
        span_mut(&mut self.weight, n, end).fill(T::ZERO);
        let mut below = None;
        let mut panel = [[T::ZERO; 4]; N];
        // Four rows at a time: the tile on the diagonal has their pivots and what each takes from those after it.
        let mut first = 0;
        while first < n {
            // What the rows above share with these four; those are unscaled as yet.
            let above = head(&self.u, first).iter().zip(&self.weight);
            for (shares, (row, w)) in panel.iter_mut().zip(above) {
                *shares = block(row, first).map(|u| u * *w);
            }
            let panel = head(&panel, first);
            let shares = self.factorise_tile(first, panel, (scale, linear), &mut below);
            let mut column = first + 4;
            while column < end {
                let Some((above, own)) = self.u.split_at_mut_checked(first) else {
                    break;
                };
                let own = head_mut(own, n - first);
                let mut tile = load(own, column);
                sub_products(&mut tile, (panel, 0), (above, column));
                shares.take(&mut tile);
                store(own, column, &tile);
                column += 4;
            }
            first += 4;
        }
        for k in 0..n {
            let Some(row) = self.u.get_mut(k) else { break };
            scale_from(row, at(&self.weight, k), k + 1, end);
        }
        below
    }

    /// The tile on the diagonal in the rows from `first`: their pivots, and what each row takes from those of the tile before it.
    #[inline(always)]
    fn factorise_tile(
        &mut self,
        first: usize,
        panel: &[[T; 4]],
        scale: (T, &[T; N]),
        below: &mut Option<usize>,
    ) -> Shares<T> {
        let n = self.dim;
        let mut tile = load(span(&self.u, first, n), first);
        sub_products(&mut tile, (panel, 0), (head(&self.u, first), first));
        let mut pivot = |k: usize, d: T| {
            if first + k >= n {
                return T::ZERO;
            }
            let (weight, is_below) = self.pivot(first + k, d, scale);
            if is_below {
                *below = below.or(Some(first + k));
            }
            weight
        };
        let [r0, r1, r2, r3] = tile;
        let w0 = pivot(0, r0[0]);
        let of_second = [r0[1] * w0];
        let r1 = less(r1, of_second[0], r0);
        let w1 = pivot(1, r1[1]);
        let of_third = [r0[2] * w0, r1[2] * w1];
        let r2 = less(less(r2, of_third[0], r0), of_third[1], r1);
        let w2 = pivot(2, r2[2]);
        let of_fourth = [r0[3] * w0, r1[3] * w1, r2[3] * w2];
        let r3 = less(
            less(less(r3, of_fourth[0], r0), of_fourth[1], r1),
            of_fourth[2],
            r2,
        );
        pivot(3, r3[3]);
        tile = [r0, r1, r2, r3];
        if let Some(own) = self.u.get_mut(first..n) {
            store(own, first, &tile);
        }
        Shares(of_second, of_third, of_fourth)
    }

    /// The weight of pivot `k`, which is `d`, and whether it is below zero by more than it should be.
    #[inline(always)]
    fn pivot(&mut self, k: usize, d: T, (scale, linear): (T, &[T; N])) -> (T, bool) {
        let diagonal = at(&self.weight, k);
        let is_sound = d > pivot_tolerance::<T>() * diagonal && !is_linear(diagonal, scale);
        let (d, is_below) = if is_sound {
            (d, false)
        } else {
            self.with_proximal_weight(k, [d, diagonal], (scale, linear))
        };
        let weight = T::ONE / d;
        put(&mut self.weight, k, weight);
        (weight, is_below)
    }

    /// Pivot `k`, which is `d` without curvature, with its proximal weight, and whether it is below zero by more than it should be.
    #[cold]
    fn with_proximal_weight(
        &mut self,
        k: usize,
        [d, diagonal]: [T; 2],
        (scale, linear): (T, &[T; N]),
    ) -> (T, bool) {
        let is_linear = is_linear(diagonal, scale);
        self.proximal = true;
        put(&mut self.linear, k, is_linear);
        let least = T::of(4.0) * pivot_tolerance::<T>() * (diagonal + T::EPSILON * scale);
        let own = if is_linear { at(linear, k) } else { diagonal };
        // Below zero it shows how large round-off is in its row, which the weight must outdo.
        let weight = math::max(proximal_weight::<T>() * own, -(T::of(8.0) * d));
        (math::max(d, T::ZERO) + weight, d < -least)
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

/// Whether a curvature is none beside the largest.
#[inline(always)]
pub(crate) fn is_linear<T: Scalar>(diagonal: T, largest: T) -> bool {
    diagonal <= T::EPSILON * T::EPSILON * largest
}
