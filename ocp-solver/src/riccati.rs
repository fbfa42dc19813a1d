//! The structured factorisation: one backward recursion over the nodes, one forward substitution.
//!
//! With the rows condensed into the stage (see [`crate::rows`]) the Newton step is the solution of
//!
//! ```text
//! min Σ ½ dᵀ H d + gᵀ d   s.t.  dx_{k+1} = A dx_k + B du_k + gap_k,    d = (dx, du)
//! ```
//!
//! solved backwards with the cost-to-go `½ dxᵀ P dx + pᵀ dx`:
//!
//! ```text
//! Q = H + [A B]ᵀ P [A B],   q = g + [A B]ᵀ (p + P gap)
//! L D Lᵀ = Q_uu,   Z = L⁻¹ Q_ux,   P⁻ = Q_xx − Zᵀ D⁻¹ Z,   K = −L⁻ᵀ D⁻¹ Z
//! ```
//!
//! The reduced Hessian is positive definite exactly if every `Q_uu` is, and the block of the free
//! coordinates of `P_0` is; otherwise the caller adds a multiple of the identity to `H` and repeats.

use crate::kernel::{
    add_outer, add_outer_products, add_product, add_scaled, add_transposed_product, factor,
    mirror_lower, solve_lower, solve_upper, transpose,
};
use crate::rows::RowBarrier;
use crate::stage::{Riccati, Stage};
use so3::Scalar;
use so3::math::min;

/// Backward recursion with `shift` added to the diagonal of every stage Hessian.
///
/// Returns false if the reduced Hessian is not positive definite.
#[must_use]
pub(crate) fn factorise<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>(
    stages: &mut [Stage<T, X, NX, NU, NI>],
    barrier: RowBarrier<T>,
    shift: T,
) -> bool {
    let mut k = stages.len();
    while let Some((head, tail)) = stages.split_at_mut_checked(k) {
        let Some(stage) = head.last_mut() else { break };
        stage.condense_rows(barrier);
        if !stage.factorise(tail.first().map(|next| &next.riccati), shift) {
            return false;
        }
        k = k.wrapping_sub(1);
    }
    true
}

impl<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>
    Stage<T, X, NX, NU, NI>
{
    /// One step of the backward recursion.
    #[inline(always)]
    fn factorise(&mut self, next: Option<&Riccati<T, NX, NU>>, shift: T) -> bool {
        let n = self.dims.controls.min(NU);
        let d = &self.derivatives;
        let (mut q_xx, mut q_x) = (d.hessian_xx, d.cost_x);
        let (mut q_xu, mut q_uu, mut q_u) = (d.hessian_xu, d.hessian_uu, [[T::ZERO; 1]; NU]);
        for (q, g) in q_u.iter_mut().zip(&d.cost_u) {
            q[0] = *g;
        }
        for (i, column) in q_xx.iter_mut().enumerate() {
            column[i] += shift;
        }
        for (i, column) in q_uu.iter_mut().enumerate() {
            column[i] += shift;
        }
        self.add_rows(&mut q_xx, &mut q_x, &mut q_xu, &mut q_uu, &mut q_u);

        if let Some(next) = next {
            // v = p + P gap;  W = P A and V = P B as columns; their transposes make Aᵀ P and Bᵀ P.
            let mut v = next.gradient;
            add_product(&mut v, &next.hessian, &self.values.gap);
            add_transposed_product(&mut q_x, &d.dynamics_x, &v);
            let mut w = [[T::ZERO; NX]; NX];
            for (w, a) in w.iter_mut().zip(&d.dynamics_x) {
                add_product(w, &next.hessian, a);
            }
            let w = transpose(&w);
            for (q, a) in q_xx.iter_mut().zip(&d.dynamics_x) {
                add_product(q, &w, a);
            }
            if n > 0 {
                let mut v_u = [[T::ZERO; NX]; NU];
                for ((((v_u, q_xu), q_u), b), _) in v_u
                    .iter_mut()
                    .zip(&mut q_xu)
                    .zip(&mut q_u)
                    .zip(&d.dynamics_u)
                    .zip(0..n)
                {
                    add_product(v_u, &next.hessian, b);
                    add_product(q_xu, &w, b);
                    q_u[0] += crate::kernel::dot(b, &v);
                }
                let v_u = transpose(&v_u);
                for (q, b) in q_uu.iter_mut().zip(&d.dynamics_u).take(n) {
                    add_product(q, &v_u, b);
                }
            }
        }

        if n > 0 {
            let mut inverse = [T::ZERO; NU];
            if !factor(&mut q_uu, &mut inverse, n, T::ZERO) {
                return false;
            }
            solve_lower(&q_uu, &mut q_xu, n);
            solve_lower(&q_uu, &mut q_u, n);
            let z = q_xu;
            let scaled = q_xu.iter_mut().zip(&mut q_u).zip(&inverse).zip(&z).take(n);
            for (((column, y), inverse), z) in scaled {
                for value in column.iter_mut() {
                    *value *= -*inverse;
                }
                y[0] *= -*inverse;
                add_scaled(&mut q_x, y[0], z);
            }
            add_outer_products(&mut q_xx, &q_xu, &z, n);
            solve_upper(&q_uu, &mut q_xu, n);
            solve_upper(&q_uu, &mut q_u, n);
            self.riccati.gain = q_xu;
            self.riccati.feedforward = q_u;
        }
        // Rounding makes the two triangles differ, and an unstable motion would amplify that.
        mirror_lower(&mut q_xx);
        self.riccati.hessian = q_xx;
        self.riccati.gradient = q_x;
        true
    }

    /// Adds the condensed rows to the stage Hessian and gradient.
    #[inline(never)]
    fn add_rows(
        &self,
        q_xx: &mut [[T; NX]; NX],
        q_x: &mut [T; NX],
        q_xu: &mut [[T; NX]; NU],
        q_uu: &mut [[T; NU]; NU],
        q_u: &mut [[T; 1]; NU],
    ) {
        let d = &self.derivatives;
        let state_rows = self.dims.state_rows;
        let before_mixed = state_rows.saturating_add(self.dims.control_rows);
        let rows = d
            .rows_x
            .iter()
            .zip(&d.rows_u)
            .zip(self.step.weight.iter().zip(&self.step.target));
        for (i, ((row_x, row_u), (weight, target))) in rows.enumerate().take(self.row_count()) {
            let (in_state, in_control) = (i < state_rows || i >= before_mixed, i >= state_rows);
            if in_state {
                add_outer(q_xx, *weight, row_x);
                add_scaled(q_x, *target, row_x);
            }
            if in_control {
                add_outer(q_uu, *weight, row_u);
                for (q, entry) in q_u.iter_mut().zip(row_u) {
                    q[0] += *target * *entry;
                }
            }
            if in_state && in_control {
                for (column, entry) in q_xu.iter_mut().zip(row_u) {
                    if *entry != T::ZERO {
                        add_scaled(column, *weight * *entry, row_x);
                    }
                }
            }
        }
    }
}

/// Solves for the free coordinates of the first state; `free[i]` marks them.
///
/// Returns false if the cost-to-go is not positive definite in them.
#[must_use]
pub(crate) fn solve_start<T: Scalar, const NX: usize>(
    hessian: &[[T; NX]; NX],
    gradient: &[T; NX],
    free: &[bool; NX],
    step: &mut [T; NX],
) -> bool {
    let mut block = [[T::ZERO; NX]; NX];
    let mut right = [[T::ZERO; 1]; NX];
    for i in 0..NX {
        for j in 0..NX {
            if free[i] && free[j] {
                block[i][j] = hessian[i][j];
            }
        }
        if free[i] {
            right[i][0] = -gradient[i];
        } else {
            block[i][i] = T::ONE;
        }
    }
    let mut inverse = [T::ZERO; NX];
    if !factor(&mut block, &mut inverse, NX, T::ZERO) {
        return false;
    }
    solve_lower(&block, &mut right, NX);
    for (right, inverse) in right.iter_mut().zip(&inverse) {
        right[0] *= *inverse;
    }
    solve_upper(&block, &mut right, NX);
    for (step, right) in step.iter_mut().zip(&right) {
        *step = right[0];
    }
    true
}

/// Forward substitution from the step of the first state: states, controls, full-step costates, slacks
/// and bound multipliers.
///
/// Returns the largest primal and dual step lengths that keep `1 − fraction` of every distance to a
/// bound and of every bound multiplier.
#[inline(never)]
pub(crate) fn substitute<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>(
    stages: &mut [Stage<T, X, NX, NU, NI>],
    start: [T; NX],
    mu: T,
    fraction: T,
) -> (T, T) {
    let mut step = start;
    let mut lengths = (T::ONE, T::ONE);
    for stage in stages.iter_mut() {
        stage.step.state = step;
        stage.step.costate = stage.riccati.gradient;
        add_product(&mut stage.step.costate, &stage.riccati.hessian, &step);
        let n = stage.dims.controls.min(NU);
        stage.step.control = [T::ZERO; NU];
        for (((control, gain), feedforward), _) in stage
            .step
            .control
            .iter_mut()
            .zip(&stage.riccati.gain)
            .zip(&stage.riccati.feedforward)
            .zip(0..n)
        {
            *control = feedforward[0] + crate::kernel::dot(gain, &step);
        }
        let mut next = stage.values.gap;
        add_product(&mut next, &stage.derivatives.dynamics_x, &step);
        add_product(
            &mut next,
            &stage.derivatives.dynamics_u,
            &stage.step.control,
        );
        step = next;
        let (primal, dual) = stage.step_rows(mu, fraction);
        lengths = (min(lengths.0, primal), min(lengths.1, dual));
    }
    lengths
}
