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

#![allow(
    clippy::needless_range_loop,
    reason = "one index walks several tables, and what lies before it is written too"
)]

use so3::Scalar;

use super::blocks::{BlockMatrix, add_scaled};
use super::crba::MassMatrix;
use super::{at, put};
use crate::linear::spd_inverse_6;
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
    /// Number of joints between this one and the base.
    depth: [usize; N],
    /// L left of the diagonal, by rows: entry d of row i belongs to the ancestor of i at depth d.
    lower: [[T; N]; N],
    /// D⁻¹.
    pivots: [T; N],
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
            before: [0; N],
            depth: [0; N],
            lower: [[T::ZERO; N]; N],
            pivots: [T::ZERO; N],
            coupling: [[T::ZERO; 6]; N],
            base: [[T::ZERO; 6]; 6],
        }
    }

    /// The ancestors of joint `i` and their depths, from its parent to the root of its branch.
    #[inline(always)]
    fn ancestors(&self, i: usize) -> Ancestors<'_, N> {
        Ancestors::new(&self.before, &self.depth, i)
    }

    /// Factors the mass matrix of a robot in the posture it was computed for.
    ///
    /// Only the entries of `mass.joints` on and below the diagonal are read, and of those only pairs of
    /// joints of which one moves the other.
    #[inline]
    pub fn factor<M: Tree<T, N>>(&mut self, model: &M, mass: &MassMatrix<T, N>) {
        self.floating = model.base_kind() == BaseKind::Floating;
        for (i, body) in model.bodies().iter().enumerate() {
            let (before, depth) = match body.parent {
                Link::Base => (0, 0),
                // Capped, so that walking up ends whatever the table says.
                Link::Joint(p) => ((p + 1).min(i), at(&self.depth, p) + 1),
            };
            self.before[i] = before;
            self.depth[i] = if before == 0 { 0 } else { depth.min(i) };
        }
        self.factor_joints(mass);
        for (row, column) in self.coupling.iter_mut().zip(&mass.coupling) {
            *row = column.to_array();
        }
        if self.floating {
            self.factor_base(mass);
        }
    }

    /// H = Lᵀ D L, from the leaves inwards.
    ///
    /// By depths, the entries of an ancestor's row are a prefix of those of its descendants' rows, so the
    /// inner loop runs over contiguous numbers.
    #[inline(always)]
    fn factor_joints(&mut self, mass: &MassMatrix<T, N>) {
        // Entries are written where they are read: no copies of rows that were filled number by number.
        let mut diagonal = [T::ZERO; N];
        for ((i, from), slot) in mass.joints.iter().enumerate().zip(&mut diagonal) {
            *slot = at(from, i);
            let up = Ancestors::new(&self.before, &self.depth, i);
            if let Some(row) = self.lower.get_mut(i) {
                for (a, d) in up {
                    put(row, d, at(from, a));
                }
            }
        }
        for k in (0..N).rev() {
            let pivot = diagonal[k];
            let good = pivot > mass.joints[k][k] * T::EPSILON;
            let inverse = if good { T::ONE / pivot } else { T::ZERO };
            self.pivots[k] = inverse;
            let (above, rest) = self.lower.split_at_mut(k);
            let Some(row) = rest.first_mut() else { break };
            for (i, d) in Ancestors::new(&self.before, &self.depth, k) {
                let x = at(row, d);
                let l = x * inverse;
                if let Some(to) = above.get_mut(i) {
                    for (y, &z) in to.iter_mut().zip(row.iter()).take(d) {
                        *y -= l * z;
                    }
                }
                if let Some(y) = diagonal.get_mut(i) {
                    *y -= l * x;
                }
                put(row, d, l);
            }
        }
    }

    /// X and Ã⁻¹.
    #[inline(always)]
    fn factor_base(&mut self, mass: &MassMatrix<T, N>) {
        // Y = L⁻ᵀ Cᵀ, Ã = A − Yᵀ D⁻¹ Y, X = L⁻¹ D⁻¹ Y.
        let mut rows = self.coupling;
        self.inward(&mut rows);
        let mut scaled = rows;
        for (row, &pivot) in scaled.iter_mut().zip(&self.pivots) {
            for x in row {
                *x *= pivot;
            }
        }
        let mut base = ArticulatedInertia::from(mass.base).to_rows();
        for (k, to) in base.iter_mut().enumerate() {
            // The sum runs to its end in registers, a whole row at once.
            let mut sum = *to;
            for (row, scaled) in rows.iter().zip(&scaled) {
                add_scaled(&mut sum, -at(row, k), scaled);
            }
            *to = sum;
        }
        rows = scaled;
        self.outward(&mut rows);
        self.coupling = rows;
        self.base = spd_inverse_6(&base);
    }

    /// b ← L⁻ᵀ b for every column of b, rows of length K.
    #[inline(always)]
    fn inward<const K: usize>(&self, b: &mut [[T; K]; N]) {
        for k in (0..N).rev() {
            let (row, lower) = (b[k], &self.lower[k]);
            for (i, d) in self.ancestors(k) {
                if let Some(to) = b.get_mut(i) {
                    add_scaled(to, -at(lower, d), &row);
                }
            }
        }
    }

    /// b ← L⁻¹ b for every column of b.
    #[inline(always)]
    fn outward<const K: usize>(&self, b: &mut [[T; K]; N]) {
        for k in 0..N {
            let (mut row, lower) = (b[k], &self.lower[k]);
            for (i, d) in self.ancestors(k) {
                if let Some(from) = b.get(i) {
                    add_scaled(&mut row, -at(lower, d), from);
                }
            }
            b[k] = row;
        }
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
        self.solve_joints(&mut joints);
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
        self.solve_joints(&mut b.joints_base);
        self.solve_joints(&mut b.joints);
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
        self.inward(&mut b.joints);
        for (i, out) in w.iter_mut().enumerate() {
            let mut sum = [T::ZERO; K];
            for (row, answer) in b.base.iter().zip(&answers) {
                add_scaled(&mut sum, at(row, i), answer);
            }
            for (row, &pivot) in b.joints.iter().zip(&self.pivots) {
                let x = at(row, i);
                if x != T::ZERO {
                    add_scaled(&mut sum, x * pivot, row);
                }
            }
            *out = sum;
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

    /// M⁻¹ itself, symmetric. For a fixed base everything but the block of the joints is zero.
    ///
    /// Accuracy: M M⁻¹ = 1 to the condition number of M times the rounding unit.
    #[inline]
    pub fn inverse(&self, out: &mut BlockMatrix<T, N>) {
        self.joints_inverse(&mut out.joints);
        self.complete_inverse(out);
    }

    /// The other blocks of M⁻¹, and the block of the joints, which holds H⁻¹.
    #[inline(always)]
    pub(crate) fn complete_inverse(&self, out: &mut BlockMatrix<T, N>) {
        if !self.floating {
            out.base = [[T::ZERO; 6]; 6];
            out.base_joints = [[T::ZERO; N]; 6];
            out.joints_base = [[T::ZERO; 6]; N];
            return;
        }
        out.base = self.base;
        let transposed = columns_of(&self.coupling);
        out.base_joints = [[T::ZERO; N]; 6];
        subtract_product(&mut out.base_joints, &self.base, &transposed);
        out.joints_base = rows_of(&out.base_joints);
        subtract_product(&mut out.joints, &self.coupling, &out.base_joints);
    }

    /// H⁻¹ = W D⁻¹ Wᵀ with W = L⁻¹, stored by depths as L is; zero between joints of different branches.
    #[inline(always)]
    pub(crate) fn joints_inverse(&self, out: &mut [[T; N]; N]) {
        *out = [[T::ZERO; N]; N];
        let mut w = [[T::ZERO; N]; N];
        for i in 0..N {
            // w_i = e_i − Σ L_ia w_a over the ancestors a; `scaled` is w_i D⁻¹.
            let depth = at(&self.depth, i);
            let lower = &self.lower[i];
            let mut scaled = [T::ZERO; N];
            let (above, rest) = w.split_at_mut(i);
            let Some(row) = rest.first_mut() else { break };
            put(row, depth, T::ONE);
            for (a, d) in self.ancestors(i) {
                let l = at(lower, d);
                if let Some(from) = above.get(a) {
                    for (y, &x) in row.iter_mut().zip(from).take(d + 1) {
                        *y -= l * x;
                    }
                }
            }
            put(&mut scaled, depth, self.pivots[i]);
            for (a, d) in self.ancestors(i) {
                put(&mut scaled, d, at(row, d) * at(&self.pivots, a));
            }
            // Joint j ≤ i shares with i the ancestors down to the last one that stands before or at j.
            put(&mut out[i], i, dot(row, &scaled, depth + 1));
            let mut next = i;
            for (a, d) in self.ancestors(i) {
                for j in a..next {
                    let x = above.get(j).map_or(T::ZERO, |row| dot(row, &scaled, d + 1));
                    put(&mut out[i], j, x);
                    if let Some(row) = out.get_mut(j) {
                        put(row, i, x);
                    }
                }
                next = a;
            }
        }
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
            // A branch is the run of joints up to the next one that hangs from the base.
            let mut end = first + 1;
            while end < N && self.before[end] != 0 {
                end += 1;
            }
            let branch = d.joints_base.iter().zip(&d.joints).take(end).skip(first);
            let rows = out.joints_base.iter_mut().zip(&mut out.joints);
            let rows = rows.zip(joints_inverse.iter().zip(&self.coupling));
            for ((to_left, to_right), (inverse, coupling)) in rows.take(end).skip(first) {
                let (mut left, mut right) = ([T::ZERO; 6], [T::ZERO; N]);
                for ((from_left, from_right), &x) in
                    branch.clone().zip(inverse.iter().take(end).skip(first))
                {
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

/// The way from a joint to the base.
struct Ancestors<'a, const N: usize> {
    before: &'a [usize; N],
    joint: usize,
    depth: usize,
}

impl<'a, const N: usize> Ancestors<'a, N> {
    #[inline(always)]
    fn new(before: &'a [usize; N], depth: &[usize; N], joint: usize) -> Self {
        Self {
            before,
            joint,
            depth: at(depth, joint),
        }
    }
}

impl<const N: usize> Iterator for Ancestors<'_, N> {
    /// Index and depth.
    type Item = (usize, usize);

    #[inline(always)]
    fn next(&mut self) -> Option<(usize, usize)> {
        self.joint = at(self.before, self.joint).checked_sub(1)?;
        self.depth = self.depth.saturating_sub(1);
        Some((self.joint, self.depth))
    }
}

/// y ← y − x rows.
#[inline(always)]
fn subtract_product<T: Scalar, const R: usize, const K: usize>(
    y: &mut [[T; K]; R],
    x: &[[T; 6]; R],
    rows: &[[T; K]; 6],
) {
    for (y, x) in y.iter_mut().zip(x) {
        subtract_rows(y, x, rows);
    }
}

/// y ← y − Σ x_k row_k. Out of line: together with the loop around it, compilers would turn it into gathers and
/// scatters, which are slower.
#[inline(never)]
fn subtract_rows<T: Scalar, const K: usize>(y: &mut [T; K], x: &[T; 6], rows: &[[T; K]; 6]) {
    let [a, b, c, d, e, f] = rows;
    let [p, q, r, s, t, u] = *x;
    for i in 0..K {
        y[i] -= (p * a[i] + q * b[i] + r * c[i]) + (s * d[i] + t * e[i] + u * f[i]);
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

/// A matrix of six rows, transposed.
#[inline(never)]
fn rows_of<T: Scalar, const N: usize>(columns: &[[T; N]; 6]) -> [[T; 6]; N] {
    core::array::from_fn(|i| columns.each_ref().map(|column| at(column, i)))
}

/// Dot product of the first `length` entries.
#[inline(always)]
fn dot<T: Scalar, const K: usize>(a: &[T; K], b: &[T; K], length: usize) -> T {
    let mut sum = T::ZERO;
    for (&x, &y) in a.iter().zip(b).take(length) {
        sum += x * y;
    }
    sum
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
