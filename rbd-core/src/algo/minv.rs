//! The mass matrix factored, solved with, and inverted, along the branches of the tree.
//!
//! By blocks M = [A C; Cᵀ H] with the locked robot A, the coupling C and the joints' H:
//!
//! - H = Lᵀ D L along the branches of the tree (`joint_factors.rs`).
//! - X = H⁻¹ Cᵀ, and the base feels the articulated inertia Ã = A − C X, 6 × 6.
//! - M⁻¹ = [Ã⁻¹, −Ã⁻¹ Xᵀ; −X Ã⁻¹, H⁻¹ + X Ã⁻¹ Xᵀ], and H⁻¹ alone for a fixed base.
//!
//! A joint or a base direction without any inertia has an infinitely stiff pivot: it does not answer.

use so3::{Scalar, math};

use super::blocks::{BlockMatrix, add_scaled};
use super::crba::MassMatrix;
use super::joint_factors::JointFactors;
use super::{at, put, run};
use crate::linear::spd_inverse_6;
use crate::model::BaseKind;
use crate::spatial::{ArticulatedInertia, Motion};
use crate::state::{Effort, Tangent};
use crate::tree::Tree;

/// Factors of a mass matrix; all zero, as after [`MassFactors::new`], they are those of a robot that
/// does not move at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassFactors<T, const N: usize> {
    /// Whether the base moves.
    floating: bool,
    /// H.
    joints: JointFactors<T, N>,
    /// X, by rows.
    coupling: [[T; 6]; N],
    /// Ã⁻¹.
    base: [[T; 6]; 6],
}

impl<T: Scalar, const N: usize> MassFactors<T, N> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            floating: false,
            joints: JointFactors::ZERO,
            coupling: [[T::ZERO; 6]; N],
            base: [[T::ZERO; 6]; 6],
        }
    }

    /// The factors of H.
    #[inline(always)]
    pub(crate) const fn joints(&self) -> &JointFactors<T, N> {
        &self.joints
    }

    /// Factors the mass matrix of a robot in the posture it was computed for.
    ///
    /// Only the entries of `mass.joints` on and below the diagonal are read, and of those only pairs of
    /// joints of which one moves the other.
    #[inline]
    pub fn factor<M: Tree<T, N>>(&mut self, model: &M, mass: &MassMatrix<T, N>) {
        self.floating = model.base_kind() == BaseKind::Floating;
        for (row, column) in self.coupling.iter_mut().zip(&mass.coupling) {
            *row = column.to_array();
        }
        self.joints
            .factor(model.bodies(), &mass.joints, &mut self.coupling);
        if self.floating {
            self.factor_base(mass);
        }
    }

    /// X and Ã⁻¹.
    #[inline(always)]
    fn factor_base(&mut self, mass: &MassMatrix<T, N>) {
        // From Y = L⁻ᵀ Cᵀ: Ã = A − Yᵀ D⁻¹ Y, X = L⁻¹ D⁻¹ Y.
        let mut base = ArticulatedInertia::from(mass.base).to_rows();
        for (k, to) in base.iter_mut().enumerate() {
            // The sum runs to its end in registers, a whole row at once.
            let mut sum = *to;
            for (row, &pivot) in self.coupling.iter().zip(self.joints.pivots()) {
                add_scaled(&mut sum, -at(row, k) * pivot, row);
            }
            *to = sum;
        }
        self.joints.outward(&mut self.coupling);
        self.base = spd_inverse_6(&base);
    }

    /// M⁻¹ τ: the acceleration that an effort causes, velocity and gravity apart. A fixed base does
    /// not accelerate.
    #[inline]
    #[must_use]
    pub fn solve(&self, effort: &Effort<T, N>) -> Tangent<T, N> {
        let mut joints = [[T::ZERO; 1]; N];
        for ([y], &x) in joints.iter_mut().zip(&effort.joints) {
            *y = x;
        }
        self.joints.solve(&mut joints);
        let mut out = Tangent::ZERO;
        for (y, &[x]) in out.joints.iter_mut().zip(&joints) {
            *y = x;
        }
        if self.floating {
            let mut rest = effort.base.to_array();
            for (row, &x) in self.coupling.iter().zip(&effort.joints) {
                add_scaled(&mut rest, -x, row);
            }
            let mut base = [T::ZERO; 6];
            for (&x, row) in rest.iter().zip(&self.base) {
                add_scaled(&mut base, x, row);
            }
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
        // The base as it feels the joints: x_b = Ã⁻¹ (b_b − Xᵀ b_J); then x_J = H⁻¹ b_J − X x_b.
        let (mut left, mut right) = ([[T::ZERO; 6]; 6], [[T::ZERO; N]; 6]);
        if self.floating {
            for ((x, from_left), from_right) in
                self.coupling.iter().zip(&b.joints_base).zip(&b.joints)
            {
                for (k, &x) in x.iter().enumerate() {
                    add_scaled(&mut b.base[k], -x, from_left);
                    add_scaled(&mut b.base_joints[k], -x, from_right);
                }
            }
            for (c, row) in self.base.iter().enumerate() {
                for (k, &x) in row.iter().enumerate() {
                    add_scaled(&mut left[c], x, &b.base[k]);
                    add_scaled(&mut right[c], x, &b.base_joints[k]);
                }
            }
        }
        b.base = left;
        b.base_joints = right;
        self.joints.solve(&mut b.joints_base);
        self.joints.solve(&mut b.joints);
        if self.floating {
            subtract_product(&mut b.joints_base, &self.coupling, &b.base);
            subtract_product(&mut b.joints, &self.coupling, &b.base_joints);
        }
    }

    /// W = Bᵀ M⁻¹ B for efforts in columns, which are used up.
    ///
    /// With z = L⁻ᵀ b_J and r = b_b − Xᵀ b_J, W = zᵀ D⁻¹ z + rᵀ Ã⁻¹ r: half a solve. Contacts touch few joints each, so
    /// zeros are skipped.
    #[inline(always)]
    pub(crate) fn delassus<const K: usize>(&self, b: &mut Columns<T, N, K>, w: &mut [[T; K]; K]) {
        // Every sum runs to its end in registers, whole rows at once.
        let mut answers = [[T::ZERO; K]; 6];
        if self.floating {
            for (k, row) in b.base.iter_mut().enumerate() {
                for (x, from) in self.coupling.iter().zip(&b.joints) {
                    add_scaled(row, -at(x, k), from);
                }
            }
            for (answer, row) in answers.iter_mut().zip(&self.base) {
                for (&x, from) in row.iter().zip(&b.base) {
                    add_scaled(answer, x, from);
                }
            }
        }
        self.joints.inward(&mut b.joints);
        for (i, out) in w.iter_mut().enumerate() {
            let mut sum = [T::ZERO; K];
            for (row, answer) in b.base.iter().zip(&answers) {
                add_scaled(&mut sum, at(row, i), answer);
            }
            for (row, &pivot) in b.joints.iter().zip(self.joints.pivots()) {
                let x = at(row, i);
                if x != T::ZERO {
                    add_scaled(&mut sum, x * pivot, row);
                }
            }
            *out = sum;
        }
    }

    /// M⁻¹ itself, symmetric. For a fixed base everything but the block of the joints is zero.
    ///
    /// Accuracy: M M⁻¹ = 1 to the condition number of M times the rounding unit.
    #[inline]
    pub fn inverse(&self, out: &mut BlockMatrix<T, N>) {
        self.joints.inverse(&mut out.joints);
        self.complete_inverse(out);
    }

    /// The other blocks of M⁻¹, and the block of the joints, which holds H⁻¹.
    #[inline(always)]
    pub(crate) fn complete_inverse(&self, out: &mut BlockMatrix<T, N>) {
        if !self.floating {
            out.base = [[T::ZERO; 6]; 6];
            out.joints_base = [[T::ZERO; 6]; N];
            out.base_joints = [[T::ZERO; N]; 6];
            return;
        }
        out.base = self.base;
        for (to, x) in out.joints_base.iter_mut().zip(&self.coupling) {
            let mut row = [T::ZERO; 6];
            for (&x, base) in x.iter().zip(&self.base) {
                add_scaled(&mut row, -x, base);
            }
            *to = row;
        }
        out.base_joints = columns_of(&out.joints_base);
        subtract_product(&mut out.joints, &self.coupling, &out.base_joints);
    }

    /// −M⁻¹ D for the derivatives D of inverse dynamics, which between the joints have no entries across
    /// branches. `inverse` is M⁻¹, `joints_inverse` is H⁻¹; with S_b the rows of the base of the
    /// result, those of the joints are −H⁻¹ D_J − X S_b.
    #[inline(always)]
    pub(crate) fn solve_derivatives(
        &self,
        inverse: &BlockMatrix<T, N>,
        joints_inverse: &[[T; N]; N],
        d: &BlockMatrix<T, N>,
        out: &mut BlockMatrix<T, N>,
    ) {
        for c in 0..6 {
            let (mut left, mut right) = ([T::ZERO; 6], [T::ZERO; N]);
            for (k, &x) in inverse.base[c].iter().enumerate() {
                add_scaled(&mut left, -x, &d.base[k]);
                add_scaled(&mut right, -x, &d.base_joints[k]);
            }
            for (k, &x) in inverse.base_joints[c].iter().enumerate() {
                add_scaled(&mut left, -x, &d.joints_base[k]);
                add_scaled(&mut right, -x, &d.joints[k]);
            }
            out.base[c] = left;
            out.base_joints[c] = right;
        }
        let mut first = 0;
        while first < N {
            let end = self.joints.subtree_end(first).min(N);
            let d_left = run(&d.joints_base, first, end);
            let d_right = run(&d.joints, first, end);
            let rows = out.joints_base.iter_mut().zip(&mut out.joints);
            let rows = rows.zip(joints_inverse.iter().zip(&self.coupling));
            for ((to_left, to_right), (inverse, coupling)) in rows.take(end).skip(first) {
                let (mut left, mut right) = ([T::ZERO; 6], [T::ZERO; N]);
                let inverse = run(inverse, first, end);
                for ((&x, from_left), from_right) in inverse.iter().zip(d_left).zip(d_right) {
                    add_scaled(&mut left, -x, from_left);
                    add_scaled(&mut right, -x, from_right);
                }
                if self.floating {
                    for (k, &x) in coupling.iter().enumerate() {
                        add_scaled(&mut left, -x, &out.base[k]);
                        add_scaled(&mut right, -x, &out.base_joints[k]);
                    }
                }
                *to_left = left;
                *to_right = right;
            }
            first = end;
        }
    }
}

impl<T: Scalar, const N: usize> Default for MassFactors<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Efforts side by side: `K` columns, by rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Columns<T, const N: usize, const K: usize> {
    /// On the base, in base axes.
    pub(crate) base: [[T; K]; 6],
    /// On the joints.
    pub(crate) joints: [[T; K]; N],
}

impl<T: Scalar, const N: usize, const K: usize> Columns<T, N, K> {
    /// All zero.
    pub(crate) const ZERO: Self = Self {
        base: [[T::ZERO; K]; 6],
        joints: [[T::ZERO; K]; N],
    };

    /// Writes column `i`.
    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, effort: &Effort<T, N>) {
        for (row, x) in self.base.iter_mut().zip(effort.base.to_array()) {
            put(row, i, x);
        }
        for (row, &x) in self.joints.iter_mut().zip(&effort.joints) {
            put(row, i, x);
        }
    }
}

/// y ← y − x rows, two rows of y at a time.
#[inline(always)]
fn subtract_product<T: Scalar, const R: usize, const K: usize>(
    y: &mut [[T; K]; R],
    x: &[[T; 6]; R],
    rows: &[[T; K]; 6],
) {
    let (pairs, last) = y.as_chunks_mut::<2>();
    let (x_pairs, x_last) = x.as_chunks::<2>();
    for (y, x) in pairs.iter_mut().zip(x_pairs) {
        subtract_rows(y, x, rows);
    }
    for (y, x) in last.iter_mut().zip(x_last) {
        subtract_rows(core::array::from_mut(y), core::array::from_ref(x), rows);
    }
}

/// y_r ← y_r − Σ x_rk row_k for rows y_r that share what is read. Out of line: together with the loop around it,
/// compilers would turn it into gathers and scatters, which are slower.
#[inline(never)]
fn subtract_rows<T: Scalar, const R: usize, const K: usize>(
    y: &mut [[T; K]; R],
    x: &[[T; 6]; R],
    rows: &[[T; K]; 6],
) {
    let [a, b, c, d, e, f] = rows;
    for i in 0..K {
        for (y, x) in y.iter_mut().zip(x) {
            let [p, q, r, s, t, u] = *x;
            let left = math::mul_add(r, c[i], math::mul_add(q, b[i], p * a[i]));
            let right = math::mul_add(u, f[i], math::mul_add(t, e[i], s * d[i]));
            y[i] -= left + right;
        }
    }
}

/// A matrix of N rows of six, transposed.
#[inline(never)]
fn columns_of<T: Scalar, const N: usize>(rows: &[[T; 6]; N]) -> [[T; N]; 6] {
    let mut columns = [[T::ZERO; N]; 6];
    for (i, row) in rows.iter().enumerate() {
        for (column, &x) in columns.iter_mut().zip(row) {
            put(column, i, x);
        }
    }
    columns
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
