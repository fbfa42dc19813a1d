//! The mass matrix factored, solved with, and inverted, along the branches of the tree.
//!
//! By blocks M = [A C; Cᵀ H] with the locked robot A, the coupling C and the joints' H:
//!
//! - H = Lᵀ D L with a unit lower triangular L whose entry (i, j) is not zero only if joint j moves
//!   joint i: no fill-in, work by pairs on one branch (Featherstone 2008, section 8.5).
//! - X = H⁻¹ Cᵀ, and the base feels the articulated inertia Ã = A − C X, 6 × 6.
//! - M⁻¹ = [Ã⁻¹, −Ã⁻¹ Xᵀ; −X Ã⁻¹, H⁻¹ + X Ã⁻¹ Xᵀ], and H⁻¹ alone for a fixed base.
//!
//! A joint or a base direction without any inertia has an infinitely stiff pivot: it does not answer.

use so3::Scalar;

use super::blocks::{BlockMatrix, add_scaled};
use super::crba::MassMatrix;
use super::{at, put};
use crate::linear::{ldl_back_substitute, ldl_factor};
use crate::model::{BaseKind, Link};
use crate::spatial::{ArticulatedInertia, Motion};
use crate::state::{Effort, Tangent};
use crate::tree::Tree;

/// Factors of a mass matrix; all zero, as after [`MassFactors::new`], they are those of a robot that
/// does not move at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassFactors<T, const N: usize> {
    /// Whether the base moves.
    floating: bool,
    /// One more than the index of the joint before, 0 for the base; never more than the own index.
    before: [usize; N],
    /// L below the diagonal, by rows.
    lower: [[T; N]; N],
    /// D⁻¹.
    pivots: [T; N],
    /// X, by rows.
    coupling: [[T; 6]; N],
    /// Ã = L D Lᵀ as `ldl_factor` leaves it.
    base: [[T; 6]; 6],
}

impl<T: Scalar, const N: usize> MassFactors<T, N> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            floating: false,
            before: [0; N],
            lower: [[T::ZERO; N]; N],
            pivots: [T::ZERO; N],
            coupling: [[T::ZERO; 6]; N],
            base: [[T::ZERO; 6]; 6],
        }
    }

    /// The joint that joint `i` hangs from.
    #[inline(always)]
    fn parent(&self, i: usize) -> Option<usize> {
        at(&self.before, i).checked_sub(1)
    }

    #[inline(always)]
    fn l(&self, i: usize, j: usize) -> T {
        self.lower.get(i).map_or(T::ZERO, |row| at(row, j))
    }

    /// Factors the mass matrix of a robot in the posture it was computed for.
    ///
    /// Only the entries of `mass.joints` on and below the diagonal are read, and of those only pairs of
    /// joints of which one moves the other.
    #[inline]
    pub fn factor<M: Tree<T, N>>(&mut self, model: &M, mass: &MassMatrix<T, N>) {
        self.floating = model.base_kind() == BaseKind::Floating;
        for (i, (slot, body)) in self.before.iter_mut().zip(model.bodies()).enumerate() {
            // Capped, so that walking up ends whatever the table says.
            *slot = match body.parent {
                Link::Base => 0,
                Link::Joint(p) => (p + 1).min(i),
            };
        }
        self.lower = mass.joints;
        self.factor_joints(mass);
        for (row, column) in self.coupling.iter_mut().zip(&mass.coupling) {
            *row = column.to_array();
        }
        if self.floating {
            self.factor_base(mass);
        }
    }

    /// H = Lᵀ D L, from the leaves inwards.
    #[inline(always)]
    fn factor_joints(&mut self, mass: &MassMatrix<T, N>) {
        for k in (0..N).rev() {
            let mut row = self.lower[k];
            let pivot = row[k];
            let good = pivot > mass.joints[k][k] * T::EPSILON;
            let inverse = if good { T::ONE / pivot } else { T::ZERO };
            self.pivots[k] = inverse;
            let mut up = self.parent(k);
            while let Some(i) = up {
                let x = at(&row, i);
                let l = x * inverse;
                // Row k left of i is still unscaled: H_ij −= L_ki H_kj.
                let mut left = Some(i);
                while let Some(j) = left {
                    if let Some(slot) = self.lower.get_mut(i).and_then(|r| r.get_mut(j)) {
                        *slot -= l * at(&row, j);
                    }
                    left = self.parent(j);
                }
                put(&mut row, i, l);
                up = self.parent(i);
            }
            self.lower[k] = row;
        }
    }

    /// X and the factors of Ã.
    #[inline(always)]
    fn factor_base(&mut self, mass: &MassMatrix<T, N>) {
        // Y = L⁻ᵀ Cᵀ, Ã = A − Yᵀ D⁻¹ Y, X = L⁻¹ D⁻¹ Y.
        let mut rows = self.coupling;
        self.inward(&mut rows);
        let mut base = ArticulatedInertia::from(mass.base).to_rows();
        for (row, &pivot) in rows.iter_mut().zip(&self.pivots) {
            let scaled = row.map(|x| x * pivot);
            for (to, &x) in base.iter_mut().zip(row.iter()) {
                add_scaled(to, -x, &scaled);
            }
            *row = scaled;
        }
        self.outward(&mut rows);
        self.coupling = rows;
        ldl_factor(&mut base);
        self.base = base;
    }

    /// b ← L⁻ᵀ b for every column of b, rows of length K.
    #[inline(always)]
    fn inward<const K: usize>(&self, b: &mut [[T; K]; N]) {
        for k in (0..N).rev() {
            let row = b[k];
            let mut up = self.parent(k);
            while let Some(i) = up {
                if let Some(to) = b.get_mut(i) {
                    add_scaled(to, -self.l(k, i), &row);
                }
                up = self.parent(i);
            }
        }
    }

    /// b ← L⁻¹ b for every column of b.
    #[inline(always)]
    fn outward<const K: usize>(&self, b: &mut [[T; K]; N]) {
        for k in 0..N {
            let mut row = b[k];
            let mut up = self.parent(k);
            while let Some(i) = up {
                if let Some(from) = b.get(i) {
                    add_scaled(&mut row, -self.l(k, i), from);
                }
                up = self.parent(i);
            }
            b[k] = row;
        }
    }

    /// b ← H⁻¹ b for every column of b.
    #[inline(always)]
    fn solve_joints<const K: usize>(&self, b: &mut [[T; K]; N]) {
        self.inward(b);
        for (row, &pivot) in b.iter_mut().zip(&self.pivots) {
            for x in row {
                *x *= pivot;
            }
        }
        self.outward(b);
    }

    /// M⁻¹ τ: the acceleration that an effort causes, velocity and gravity apart. A fixed base does
    /// not accelerate.
    #[inline]
    #[must_use]
    pub fn solve(&self, effort: &Effort<T, N>) -> Tangent<T, N> {
        let mut joints = effort.joints.map(|x| [x]);
        self.solve_joints(&mut joints);
        let mut out = Tangent {
            base: Motion::ZERO,
            joints: joints.map(|[x]| x),
        };
        if self.floating {
            let mut rest = effort.base.to_array();
            for (row, &x) in self.coupling.iter().zip(&effort.joints) {
                add_scaled(&mut rest, -x, row);
            }
            let base = ldl_back_substitute(&self.base, rest);
            for (y, row) in out.joints.iter_mut().zip(&self.coupling) {
                for (&x, &a) in row.iter().zip(&base) {
                    *y -= x * a;
                }
            }
            out.base = Motion::from_array(base);
        }
        out
    }

    /// M⁻¹ B in place, all columns of B at once: effort per something becomes acceleration per
    /// something. For a fixed base the rows of the base become zero.
    #[inline]
    pub fn solve_columns(&self, b: &mut BlockMatrix<T, N>) {
        if self.floating {
            // The base first, as it feels the joints: x_b = Ã⁻¹ (b_b − Xᵀ b_J).
            for ((x, left), right) in self.coupling.iter().zip(&b.joints_base).zip(&b.joints) {
                for (k, &x) in x.iter().enumerate() {
                    add_scaled(&mut b.base[k], -x, left);
                    add_scaled(&mut b.base_joints[k], -x, right);
                }
            }
            let inverse = self.base_inverse();
            b.base = times(&inverse, &b.base);
            b.base_joints = times(&inverse, &b.base_joints);
        } else {
            b.base = [[T::ZERO; 6]; 6];
            b.base_joints = [[T::ZERO; N]; 6];
        }
        self.solve_joints(&mut b.joints_base);
        self.solve_joints(&mut b.joints);
        if self.floating {
            let rows = b.joints_base.iter_mut().zip(&mut b.joints);
            for (x, (left, right)) in self.coupling.iter().zip(rows) {
                for (k, &x) in x.iter().enumerate() {
                    add_scaled(left, -x, &b.base[k]);
                    add_scaled(right, -x, &b.base_joints[k]);
                }
            }
        }
    }

    /// Ã⁻¹.
    #[inline(always)]
    fn base_inverse(&self) -> [[T; 6]; 6] {
        let mut inverse = [[T::ZERO; 6]; 6];
        for (k, row) in inverse.iter_mut().enumerate() {
            let mut unit = [T::ZERO; 6];
            put(&mut unit, k, T::ONE);
            *row = ldl_back_substitute(&self.base, unit);
        }
        inverse
    }

    /// M⁻¹ itself, symmetric. For a fixed base everything but the block of the joints is zero.
    ///
    /// Accuracy: M M⁻¹ = 1 to the condition number of M times the rounding unit.
    #[inline]
    pub fn inverse(&self, out: &mut BlockMatrix<T, N>) {
        self.invert_joints(&mut out.joints);
        if !self.floating {
            out.base = [[T::ZERO; 6]; 6];
            out.base_joints = [[T::ZERO; N]; 6];
            out.joints_base = [[T::ZERO; 6]; N];
            return;
        }
        out.base = self.base_inverse();
        for (row, x) in out.joints_base.iter_mut().zip(&self.coupling) {
            *row = [T::ZERO; 6];
            for (&x, from) in x.iter().zip(&out.base) {
                add_scaled(row, -x, from);
            }
        }
        for (i, row) in out.joints_base.iter().enumerate() {
            for (to, &x) in out.base_joints.iter_mut().zip(row) {
                put(to, i, x);
            }
        }
        for (x, row) in self.coupling.iter().zip(&mut out.joints) {
            for (&x, from) in x.iter().zip(&out.base_joints) {
                add_scaled(row, -x, from);
            }
        }
    }

    /// H⁻¹ = W D⁻¹ Wᵀ with W = L⁻¹.
    #[inline(always)]
    fn invert_joints(&self, out: &mut [[T; N]; N]) {
        // Row k of `w` is column k of W; joint j is in it if k moves j.
        let mut w = [[T::ZERO; N]; N];
        *out = [[T::ZERO; N]; N];
        for i in 0..N {
            w[i][i] = T::ONE;
            let mut up = self.parent(i);
            while let Some(k) = up {
                // W_ik = −Σ L_ij W_jk over j from k up to the parent of i.
                let mut sum = T::ZERO;
                let mut between = self.parent(i);
                while let Some(j) = between {
                    if j < k {
                        break;
                    }
                    sum -= self.l(i, j) * w.get(k).map_or(T::ZERO, |row| at(row, j));
                    between = self.parent(j);
                }
                if let Some(row) = w.get_mut(k) {
                    put(row, i, sum);
                }
                up = self.parent(k);
            }
            // Row i, left of the diagonal: joints that share an ancestor k with i stand from k on.
            let mut up = Some(i);
            while let Some(k) = up {
                let Some(column) = w.get(k) else { break };
                let x = at(column, i) * at(&self.pivots, k);
                let left = out[i].iter_mut().zip(column).take(i + 1).skip(k);
                for (y, &z) in left {
                    *y += x * z;
                }
                up = self.parent(k);
            }
            let (above, row) = out.split_at_mut(i);
            if let Some(row) = row.first() {
                for (to, &x) in above.iter_mut().zip(row) {
                    put(to, i, x);
                }
            }
        }
    }
}

impl<T: Scalar, const N: usize> Default for MassFactors<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A B for a 6 × 6 matrix A.
#[inline(always)]
fn times<T: Scalar, const K: usize>(a: &[[T; 6]; 6], b: &[[T; K]; 6]) -> [[T; K]; 6] {
    let mut out = [[T::ZERO; K]; 6];
    for (to, row) in out.iter_mut().zip(a) {
        for (&x, from) in row.iter().zip(b) {
            add_scaled(to, x, from);
        }
    }
    out
}

impl<T: Scalar> ArticulatedInertia<T> {
    /// As a dense matrix by rows.
    #[inline(always)]
    pub(crate) fn to_rows(self) -> [[T; 6]; 6] {
        let (l, c, a) = (&self.linear, &self.cross, &self.angular);
        [
            [l.xx, l.xy, l.xz, c.m11, c.m12, c.m13],
            [l.xy, l.yy, l.yz, c.m21, c.m22, c.m23],
            [l.xz, l.yz, l.zz, c.m31, c.m32, c.m33],
            [c.m11, c.m21, c.m31, a.xx, a.xy, a.xz],
            [c.m12, c.m22, c.m32, a.xy, a.yy, a.yz],
            [c.m13, c.m23, c.m33, a.xz, a.yz, a.zz],
        ]
    }
}

/// The inverse of the mass matrix of [`crba`](crate::crba); `factors` can solve with it afterwards.
#[inline]
pub fn mass_matrix_inverse<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    mass: &MassMatrix<T, N>,
    factors: &mut MassFactors<T, N>,
    out: &mut BlockMatrix<T, N>,
) {
    factors.factor(model, mass);
    factors.inverse(out);
}
