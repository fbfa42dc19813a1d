//! What the passes of an iteration ask of a node's derivatives, and the answers of dense ones.

use crate::kernel::{add_outer, add_product, add_scaled, add_transposed_product, dot, largest};
use crate::problem::{Derivatives, Dims};
use so3::Scalar;
use so3::math::max;

/// Whether a row depends on the state and on the control.
#[derive(Clone, Copy, Debug)]
pub struct Parts {
    pub(crate) state: bool,
    pub(crate) control: bool,
}

impl Dims {
    /// What row `i` depends on.
    #[inline(always)]
    pub(crate) const fn parts(&self, i: usize) -> Parts {
        let before_mixed = self.state_rows.saturating_add(self.control_rows);
        Parts {
            state: i < self.state_rows || i >= before_mixed,
            control: i >= self.state_rows,
        }
    }
}

/// The quadratic of a stage: blocks of its Hessian, of whose diagonal ones only the lower triangles count, and its gradient.
pub struct Quadratic<'a, T, const NX: usize, const NU: usize> {
    pub(crate) xx: &'a mut [[T; NX]; NX],
    /// Columns per control.
    pub(crate) xu: &'a mut [[T; NX]; NU],
    pub(crate) uu: &'a mut [[T; NU]; NU],
    pub(crate) x: &'a mut [T; NX],
    pub(crate) u: &'a mut [[T; 1]; NU],
}

/// The derivatives of a node, with A and B those of the gap in state and control, and J those of the rows.
pub trait Linearised<T: Scalar, const NX: usize, const NU: usize> {
    /// Gradient of the cost in the state.
    fn cost_x(&self) -> &[T; NX];

    /// Gradient of the cost in the control.
    fn cost_u(&self) -> &[T; NU];

    /// The quadratic of the cost and the multipliers over the first `n` controls.
    fn write(&self, n: usize, q: &mut Quadratic<'_, T, NX, NU>);

    /// `out += A dx + B du`.
    fn push_forward(&self, dx: &[T; NX], du: &[T; NU], out: &mut [T; NX]);

    /// `out += Aᵀ y`.
    fn pull_back_x(&self, y: &[T; NX], out: &mut [T; NX]);

    /// `out += Bᵀ y`.
    fn pull_back_u(&self, y: &[T; NX], out: &mut [T; NU]);

    /// `out += M a`, with `a` column `j` of A.
    fn combine_x<const R: usize>(&self, j: usize, matrix: &[[T; R]; NX], out: &mut [T; R]);

    /// `out += M b`, with `b` column `j` of B.
    fn combine_u<const R: usize>(&self, j: usize, matrix: &[[T; R]; NX], out: &mut [T; R]);

    /// The largest magnitude in the first `n` columns of B.
    fn authority(&self, n: usize) -> T;

    /// Row `i` of J.
    fn row(&self, i: usize, parts: Parts) -> ([T; NX], [T; NU]);

    /// Row `i` of J times a step.
    fn row_change(&self, i: usize, parts: Parts, dx: &[T; NX], du: &[T; NU]) -> T;

    /// `out += y` times what row `i` of J has in the state.
    fn add_row_x(&self, i: usize, y: T, out: &mut [T; NX]);

    /// `out += y` times what row `i` of J has in the control.
    fn add_row_u(&self, i: usize, y: T, out: &mut [T; NU]);

    /// Adds `½ weight (J d)² + target J d` of row `i` to the quadratic.
    fn condense(&self, i: usize, parts: Parts, weights: (T, T), q: &mut Quadratic<'_, T, NX, NU>);

    /// `out += ∂²L/∂u∂x dx + ∂²L/∂u² du`.
    fn add_curvature(&self, dx: &[T; NX], du: &[T; NU], out: &mut [T; NU]);
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Linearised<T, NX, NU>
    for Derivatives<T, NX, NU, NI>
{
    #[inline(always)]
    fn cost_x(&self) -> &[T; NX] {
        &self.cost_x
    }

    #[inline(always)]
    fn cost_u(&self) -> &[T; NU] {
        &self.cost_u
    }

    #[inline(always)]
    fn write(&self, n: usize, q: &mut Quadratic<'_, T, NX, NU>) {
        (*q.xx, *q.x) = (self.hessian_xx, self.cost_x);
        if n > 0 {
            (*q.xu, *q.uu) = (self.hessian_xu, self.hessian_uu);
            *q.u = self.cost_u.map(|g| [g]);
        }
    }

    #[inline(always)]
    fn push_forward(&self, dx: &[T; NX], du: &[T; NU], out: &mut [T; NX]) {
        add_product(out, &self.dynamics_x, dx);
        add_product(out, &self.dynamics_u, du);
    }

    #[inline(always)]
    fn pull_back_x(&self, y: &[T; NX], out: &mut [T; NX]) {
        add_transposed_product(out, &self.dynamics_x, y);
    }

    #[inline(always)]
    fn pull_back_u(&self, y: &[T; NX], out: &mut [T; NU]) {
        add_transposed_product(out, &self.dynamics_u, y);
    }

    #[inline(always)]
    fn combine_x<const R: usize>(&self, j: usize, matrix: &[[T; R]; NX], out: &mut [T; R]) {
        if let Some(a) = self.dynamics_x.get(j) {
            add_product(out, matrix, a);
        }
    }

    #[inline(always)]
    fn combine_u<const R: usize>(&self, j: usize, matrix: &[[T; R]; NX], out: &mut [T; R]) {
        if let Some(b) = self.dynamics_u.get(j) {
            add_product(out, matrix, b);
        }
    }

    #[inline(always)]
    fn authority(&self, n: usize) -> T {
        let columns = self.dynamics_u.iter().take(n);
        columns.fold(T::ZERO, |most, b| max(most, largest(b)))
    }

    #[inline(always)]
    fn row(&self, i: usize, parts: Parts) -> ([T; NX], [T; NU]) {
        let (mut x, mut u) = ([T::ZERO; NX], [T::ZERO; NU]);
        if let (Some(of_x), Some(of_u)) = (self.rows_x.get(i), self.rows_u.get(i)) {
            if parts.state {
                x = *of_x;
            }
            if parts.control {
                u = *of_u;
            }
        }
        (x, u)
    }

    #[inline(always)]
    fn row_change(&self, i: usize, parts: Parts, dx: &[T; NX], du: &[T; NU]) -> T {
        let mut change = T::ZERO;
        if let (Some(x), Some(u)) = (self.rows_x.get(i), self.rows_u.get(i)) {
            if parts.state {
                change += dot(x, dx);
            }
            if parts.control {
                change += dot(u, du);
            }
        }
        change
    }

    #[inline(always)]
    fn add_row_x(&self, i: usize, y: T, out: &mut [T; NX]) {
        if let Some(row) = self.rows_x.get(i) {
            add_scaled(out, y, row);
        }
    }

    #[inline(always)]
    fn add_row_u(&self, i: usize, y: T, out: &mut [T; NU]) {
        if let Some(row) = self.rows_u.get(i) {
            add_scaled(out, y, row);
        }
    }

    #[inline(always)]
    fn condense(
        &self,
        i: usize,
        parts: Parts,
        (weight, target): (T, T),
        q: &mut Quadratic<'_, T, NX, NU>,
    ) {
        let (Some(x), Some(u)) = (self.rows_x.get(i), self.rows_u.get(i)) else {
            return;
        };
        if parts.state {
            add_outer(q.xx, weight, x);
            add_scaled(q.x, target, x);
        }
        if parts.control {
            add_outer(q.uu, weight, u);
            for (q, entry) in q.u.iter_mut().zip(u) {
                q[0] += target * *entry;
            }
        }
        if parts.state && parts.control {
            for (column, entry) in q.xu.iter_mut().zip(u) {
                if *entry != T::ZERO {
                    add_scaled(column, weight * *entry, x);
                }
            }
        }
    }

    #[inline(always)]
    fn add_curvature(&self, dx: &[T; NX], du: &[T; NU], out: &mut [T; NU]) {
        add_transposed_product(out, &self.hessian_xu, dx);
        add_product(out, &self.hessian_uu, du);
    }
}
