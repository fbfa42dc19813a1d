//! First and second derivatives of a scalar in (q, q̇, q̈) and in the contact forces.

use so3::Scalar;

/// A gradient.
#[derive(Clone, Copy, Debug)]
pub struct Gradient<T, const N: usize, const CONTACTS: usize> {
    /// In q.
    pub q: [T; N],
    /// In q̇.
    pub v: [T; N],
    /// In q̈.
    pub a: [T; N],
    /// In the force on each contact, world axes.
    pub force: [[T; 3]; CONTACTS],
}

impl<T: Scalar, const N: usize, const CONTACTS: usize> Gradient<T, N, CONTACTS> {
    /// All zero.
    pub const ZERO: Self = Self {
        q: [T::ZERO; N],
        v: [T::ZERO; N],
        a: [T::ZERO; N],
        force: [[T::ZERO; 3]; CONTACTS],
    };

    /// Adds `factor` times another.
    #[inline(always)]
    pub fn add(&mut self, factor: T, o: &Self) {
        add_scaled(&mut self.q, factor, &o.q);
        add_scaled(&mut self.v, factor, &o.v);
        add_scaled(&mut self.a, factor, &o.a);
        for (mine, other) in self.force.iter_mut().zip(&o.force) {
            add_scaled(mine, factor, other);
        }
    }
}

/// A Hessian by blocks and rows: `vq[i][j]` is ∂²φ/∂q̇_i∂q_j.
///
/// `qq`, `vv` and `aa` are whole; of what mixes two kinds one half is stored.
#[derive(Clone, Copy, Debug)]
pub struct Hessian<T, const N: usize, const CONTACTS: usize> {
    /// In q twice.
    pub qq: [[T; N]; N],
    /// Rows of q̇, columns of q.
    pub vq: [[T; N]; N],
    /// In q̇ twice.
    pub vv: [[T; N]; N],
    /// Rows of q̈, columns of q.
    pub aq: [[T; N]; N],
    /// Rows of q̈, columns of q̇.
    pub av: [[T; N]; N],
    /// In q̈ twice.
    pub aa: [[T; N]; N],
    /// Rows of the coordinates of each contact's force.
    pub force: [[Gradient<T, N, CONTACTS>; 3]; CONTACTS],
}

impl<T: Scalar, const N: usize, const CONTACTS: usize> Hessian<T, N, CONTACTS> {
    /// All zero.
    pub const ZERO: Self = Self {
        qq: [[T::ZERO; N]; N],
        vq: [[T::ZERO; N]; N],
        vv: [[T::ZERO; N]; N],
        aq: [[T::ZERO; N]; N],
        av: [[T::ZERO; N]; N],
        aa: [[T::ZERO; N]; N],
        force: [[Gradient::ZERO; 3]; CONTACTS],
    };

    /// Adds `weight` g gᵀ; `support` lists the coordinates, less than `N`, in which g is not zero, its forces apart.
    #[inline(always)]
    pub fn add_outer(
        &mut self,
        weight: T,
        g: &Gradient<T, N, CONTACTS>,
        support: impl Iterator<Item = usize>,
    ) {
        for i in support.take_while(|i| *i < N) {
            let (q, v, a) = (weight * g.q[i], weight * g.v[i], weight * g.a[i]);
            add_scaled(&mut self.qq[i], q, &g.q);
            add_scaled(&mut self.vq[i], v, &g.q);
            add_scaled(&mut self.vv[i], v, &g.v);
            add_scaled(&mut self.aq[i], a, &g.q);
            add_scaled(&mut self.av[i], a, &g.v);
            add_scaled(&mut self.aa[i], a, &g.a);
        }
        for (foot, rows) in g.force.iter().zip(&mut self.force) {
            if foot.iter().all(|x| *x == T::ZERO) {
                continue;
            }
            for (entry, row) in foot.iter().zip(rows) {
                let f = weight * *entry;
                add_scaled(&mut row.q, f, &g.q);
                add_scaled(&mut row.v, f, &g.v);
                add_scaled(&mut row.a, f, &g.a);
                for (out, other) in row.force.iter_mut().zip(&g.force) {
                    add_scaled(out, f, other);
                }
            }
        }
    }

    /// Adds what the product of q_i, `i` less than `N`, and of a function with gradient `weight` g bends.
    pub fn add_product(&mut self, i: usize, weight: T, g: &Gradient<T, N, CONTACTS>) {
        if i >= N {
            return;
        }
        add_scaled(&mut self.qq[i], weight, &g.q);
        let slots = self.qq.iter_mut().zip(&mut self.vq).zip(&mut self.aq);
        let parts = g.q.iter().zip(&g.v).zip(&g.a);
        for (((qq, vq), aq), ((q, v), a)) in slots.zip(parts) {
            qq[i] += weight * *q;
            vq[i] += weight * *v;
            aq[i] += weight * *a;
        }
        let forces = g.force.iter().flatten();
        for (row, force) in self.force.iter_mut().flatten().zip(forces) {
            row.q[i] += weight * *force;
        }
    }
}

/// y += factor x.
#[inline(always)]
fn add_scaled<T: Scalar, const K: usize>(y: &mut [T; K], factor: T, x: &[T; K]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * *x;
    }
}
