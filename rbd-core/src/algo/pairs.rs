//! Two joints of one branch: what each does to the other's effort, S_i against what the subtrees of j answer ([`super::sweep`]).

#![allow(clippy::needless_range_loop, reason = "one index walks several tables")]

use so3::{Scalar, math};

use super::at;
use super::sweep::DerivativesWorkspace;
use super::table::{LANES, lanes};

/// What a joint i and joints j of its subtree do to each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pairs<T> {
    /// ∂τ_i/∂q_j.
    pub(crate) above_q: [T; LANES],
    /// ∂τ_i/∂q̇_j.
    pub(crate) above_v: [T; LANES],
    /// ∂τ_j/∂q_i.
    pub(crate) below_q: [T; LANES],
    /// ∂τ_j/∂q̇_i.
    pub(crate) below_v: [T; LANES],
    /// M_ij.
    pub(crate) mass: [T; LANES],
}

impl<T: Scalar> Pairs<T> {
    const ZERO: Self = Self {
        above_q: [T::ZERO; LANES],
        above_v: [T::ZERO; LANES],
        below_q: [T::ZERO; LANES],
        below_v: [T::ZERO; LANES],
        mass: [T::ZERO; LANES],
    };
}

impl<T: Scalar, const N: usize> DerivativesWorkspace<T, N> {
    /// Joint i against [`LANES`] joints from j on, those of its subtree being meant: the entries of M, the
    /// derivatives, or both.
    #[inline(always)]
    pub(crate) fn pairs<const MASS: bool, const GRADIENT: bool>(
        &self,
        i: usize,
        j: usize,
    ) -> Pairs<T> {
        let mut pairs = Pairs::ZERO;
        for k in 0..6 {
            let s = at(&self.axes[k], i);
            let f = lanes(&self.answers[12 + k], j);
            if MASS {
                for l in 0..LANES {
                    pairs.mass[l] = math::mul_add(s, f[l], pairs.mass[l]);
                }
            }
            if GRADIENT {
                let (r, t) = (at(&self.axes[6 + k], i), at(&self.axes[12 + k], i));
                let (p, q) = (lanes(&self.answers[k], j), lanes(&self.answers[6 + k], j));
                let r = r + r;
                for l in 0..LANES {
                    pairs.above_q[l] = math::mul_add(s, p[l], pairs.above_q[l]);
                    pairs.above_v[l] = math::mul_add(s, q[l], pairs.above_v[l]);
                    pairs.below_q[l] = math::mul_add(t, f[l], pairs.below_q[l]);
                    pairs.below_v[l] = math::mul_add(r, f[l], pairs.below_v[l]);
                }
            }
        }
        if GRADIENT {
            for k in 0..3 {
                let (s, r) = (at(&self.axes[3 + k], i), at(&self.axes[9 + k], i));
                let g = lanes(&self.answers[18 + k], j);
                for l in 0..LANES {
                    pairs.below_q[l] = math::mul_add(r, g[l], pairs.below_q[l]);
                    pairs.below_v[l] = math::mul_add(s, g[l], pairs.below_v[l]);
                }
            }
        }
        pairs
    }
}
