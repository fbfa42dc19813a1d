//! The joints' block of the mass matrix, factored, solved with, and inverted, along the branches of the tree.
//!
//! H = Lᵀ D L with a unit lower triangular L whose entry (i, j) is not zero only if joint j moves joint i: no
//! fill-in, work by pairs on one branch (Featherstone 2008, section 8.5). Columns of W = L⁻¹ are not zero only on the
//! joints that theirs moves, whose run is contiguous.

#![allow(
    clippy::needless_range_loop,
    reason = "one index walks several tables, and what lies before it is written too"
)]

use so3::Scalar;

use super::blocks::add_scaled;
use super::table::{set_window, window};
use super::{at, run};
use crate::model::{Body, Link};

/// Columns that the joints of a limb fit in, as a rule: three vector registers of four numbers.
const WINDOW: usize = 12;

/// L and D; all zero they are those of joints that do not answer.
///
/// Every sum collects rows in registers, over joints that another one moves (a contiguous run) or over its ancestors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointFactors<T, const N: usize> {
    /// One more than the index of the joint before, 0 for the base; never more than the own index.
    before: [usize; N],
    /// One more than the index of the last joint that this one moves.
    subtree_end: [usize; N],
    /// First joint of the limb; only where rows may be taken by windows.
    limb: [usize; N],
    /// Whether of every row only the [`WINDOW`] of its limb is taken: no limb has more joints.
    in_windows: bool,
    /// D L by rows. Only entries between a joint and its ancestors mean something; others are never read.
    rows: [[T; N]; N],
    /// D⁻¹; zero, an infinitely stiff pivot, for a joint without any inertia.
    pivots: [T; N],
}

impl<T: Scalar, const N: usize> JointFactors<T, N> {
    /// All zero.
    pub(crate) const ZERO: Self = Self {
        before: [0; N],
        subtree_end: [0; N],
        limb: [0; N],
        in_windows: false,
        rows: [[T::ZERO; N]; N],
        pivots: [T::ZERO; N],
    };

    /// Whether windows can save anything: of more columns, and on a processor with vectors of numbers; firmware's have none.
    const WINDOWED: bool = cfg!(target_arch = "x86_64") && N > WINDOW;

    /// D⁻¹.
    #[inline(always)]
    pub(crate) fn pivots(&self) -> &[T; N] {
        &self.pivots
    }

    /// One more than the index of the last joint that joint `i` moves, at least `i` + 1.
    #[inline(always)]
    pub(crate) fn subtree_end(&self, i: usize) -> usize {
        at(&self.subtree_end, i).max(i + 1)
    }

    /// The ancestors of joint `i`, from its parent to the root of its branch.
    #[inline(always)]
    fn ancestors(&self, i: usize) -> impl Iterator<Item = usize> {
        let mut joint = i;
        core::iter::from_fn(move || {
            joint = at(&self.before, joint).checked_sub(1)?;
            Some(joint)
        })
    }

    /// Factors `h`, of which entries on and below the diagonal are read between joints of one branch, and takes
    /// b ← L⁻ᵀ b along, which needs the same multipliers.
    #[inline(always)]
    pub(crate) fn factor<const K: usize>(
        &mut self,
        bodies: &[Body<T>; N],
        h: &[[T; N]; N],
        b: &mut [[T; K]; N],
    ) {
        self.in_windows = Self::WINDOWED;
        for (i, body) in bodies.iter().enumerate() {
            self.before[i] = match body.parent {
                Link::Base => 0,
                // Capped, so that walking up ends whatever the table says.
                Link::Joint(p) => (p + 1).min(i),
            };
            self.subtree_end[i] = body.subtree_end.min(N);
            if Self::WINDOWED {
                let parent = self.before[i].checked_sub(1);
                self.limb[i] = parent.map_or(i, |p| at(&self.limb, p));
                self.in_windows &= i < self.limb[i] + WINDOW;
            }
        }
        if Self::WINDOWED && self.in_windows {
            self.factor_in_windows::<K, WINDOW>(h, b);
        } else {
            self.factor_in_windows::<K, N>(h, b);
        }
    }

    /// First column of the window of joint `k`'s limb; a window of all `N` columns starts at 0.
    #[inline(always)]
    fn window_start<const W: usize>(&self, k: usize) -> usize {
        at(&self.limb, k).min(N - W)
    }

    /// [`JointFactors::factor`], of every row only the window of its limb.
    #[inline(always)]
    fn factor_in_windows<const K: usize, const W: usize>(
        &mut self,
        h: &[[T; N]; N],
        b: &mut [[T; K]; N],
    ) {
        // Row k of D L: h_k − Σ L_ik D_i L_i over the joints i that k moves; row k of L⁻ᵀ b: b_k − Σ L_ik (L⁻ᵀ b)_i.
        for k in (0..N).rev() {
            let start = self.window_start::<W>(k);
            let (mut row, mut inertia, mut side) = (window::<T, W, N>(&h[k], start), h[k][k], b[k]);
            for ((from, &pivot), from_b) in self.moved(k).zip(self.moved_rows(k, b)) {
                let x = at(from, k);
                let l = x * pivot;
                inertia -= l * x;
                add_scaled(&mut row, -l, &window(from, start));
                add_scaled(&mut side, -l, from_b);
            }
            let good = inertia > h[k][k] * T::EPSILON;
            self.pivots[k] = if good { T::ONE / inertia } else { T::ZERO };
            set_window(&mut self.rows[k], start, &row);
            b[k] = side;
        }
    }

    /// Rows of D L and D⁻¹ of the joints that joint `k` moves.
    #[inline(always)]
    fn moved(&self, k: usize) -> impl Iterator<Item = (&[T; N], &T)> {
        let (first, end) = (k + 1, self.subtree_end(k));
        let rows = run(&self.rows, first, end).iter();
        rows.zip(run(&self.pivots, first, end))
    }

    /// Of these joints, the rows of a table.
    #[inline(always)]
    fn moved_rows<'a, const K: usize>(&self, k: usize, b: &'a [[T; K]; N]) -> &'a [[T; K]] {
        run(b, k + 1, self.subtree_end(k))
    }

    /// b ← L⁻ᵀ b for every column of b, rows of length K.
    #[inline(always)]
    pub(crate) fn inward<const K: usize>(&self, b: &mut [[T; K]; N]) {
        for k in (0..N).rev() {
            let mut row = b[k];
            for ((d_l, &pivot), from) in self.moved(k).zip(self.moved_rows(k, b)) {
                add_scaled(&mut row, -at(d_l, k) * pivot, from);
            }
            b[k] = row;
        }
    }

    /// b ← L⁻¹ D⁻¹ b for every column of b.
    #[inline(always)]
    pub(crate) fn outward<const K: usize>(&self, b: &mut [[T; K]; N]) {
        for k in 0..N {
            // D⁻¹ b − L x = D⁻¹ (b − D L x).
            let (mut row, d_l, pivot) = (b[k], &self.rows[k], self.pivots[k]);
            for a in self.ancestors(k) {
                if let Some(from) = b.get(a) {
                    add_scaled(&mut row, -at(d_l, a), from);
                }
            }
            for x in &mut row {
                *x *= pivot;
            }
            b[k] = row;
        }
    }

    /// b ← H⁻¹ b for every column of b.
    #[inline(always)]
    pub(crate) fn solve<const K: usize>(&self, b: &mut [[T; K]; N]) {
        self.inward(b);
        self.outward(b);
    }

    /// H⁻¹ = W D⁻¹ Wᵀ; zero between joints of different branches.
    #[inline(always)]
    pub(crate) fn inverse(&self, out: &mut [[T; N]; N]) {
        if Self::WINDOWED && self.in_windows {
            self.inverse_in_windows::<WINDOW>(out);
        } else {
            self.inverse_in_windows::<N>(out);
        }
    }

    /// [`JointFactors::inverse`], of every row only the window of its limb: the others are zero.
    #[inline(always)]
    fn inverse_in_windows<const W: usize>(&self, out: &mut [[T; N]; N]) {
        // Columns of W, each as a row: w_k = e_k − Σ L_ak w_a over the joints a that k moves.
        for k in (0..N).rev() {
            let start = self.window_start::<W>(k);
            // Compared, not written: a number just stored cannot be loaded with its neighbours without a wait.
            let mut column: [T; W] =
                core::array::from_fn(|j| if start + j == k { T::ONE } else { T::ZERO });
            for ((d_l, &pivot), from) in self.moved(k).zip(self.moved_rows(k, out)) {
                add_scaled(&mut column, -at(d_l, k) * pivot, &window(from, start));
            }
            if W < N {
                out[k] = [T::ZERO; N];
            }
            set_window(&mut out[k], start, &column);
        }
        // Row i needs w_i and those of its ancestors, which come before it and are still there.
        for i in (0..N).rev() {
            let start = self.window_start::<W>(i);
            let mut row = [T::ZERO; W];
            add_scaled(&mut row, self.pivots[i], &window(&out[i], start));
            for k in self.ancestors(i) {
                if let Some(column) = out.get(k) {
                    let x = at(column, i) * at(&self.pivots, k);
                    add_scaled(&mut row, x, &window(column, start));
                }
            }
            set_window(&mut out[i], start, &row);
        }
    }
}
