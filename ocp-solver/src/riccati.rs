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
//! after the equalities of the stage are eliminated (see [`crate::eliminate`] and [`crate::project`]), so
//! `u` above are the controls they leave free. The reduced Hessian is positive definite exactly if every
//! `Q_uu` is, and `P_0` in the free coordinates of the start; otherwise the caller adds a multiple of the
//! identity to `H` and repeats. With `H_k dx + h_k = 0` the rows a node hands back and `ν` their
//! multipliers, the costate of a node is `P dx + p + H_kᵀ ν`.

use crate::kernel::{
    add_outer, add_product, add_scaled, add_transposed_product, dot, mirror_lower, transpose,
};
use crate::project::Work;
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
    let mut work = Work::new();
    let mut k = stages.len();
    while let Some((head, tail)) = stages.split_at_mut_checked(k) {
        let Some(stage) = head.last_mut() else { break };
        stage.condense_rows(barrier.mu);
        let next = tail.first().map(|next| &next.riccati);
        if !stage.factorise(&mut work, next, barrier.rank_tolerance, shift) {
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
    fn factorise(
        &mut self,
        work: &mut Work<T, NX, NU>,
        next: Option<&Riccati<T, NX, NU>>,
        rank_tolerance: T,
        shift: T,
    ) -> bool {
        let n = self.dims.controls.min(NU);
        let d = &self.derivatives;
        let (q_xx, q_x) = (&mut self.riccati.hessian, &mut self.riccati.gradient);
        (*q_xx, *q_x) = (d.hessian_xx, d.cost_x);
        for (i, column) in q_xx.iter_mut().enumerate() {
            column[i] += shift;
        }
        if n > 0 {
            (work.xu, work.uu, work.u) = (d.hessian_xu, d.hessian_uu, d.cost_u.map(|g| [g]));
            for (i, column) in work.uu.iter_mut().enumerate() {
                column[i] += shift;
            }
        }
        self.add_rows(work);

        let d = &self.derivatives;
        let (q_xx, q_x) = (&mut self.riccati.hessian, &mut self.riccati.gradient);
        if let Some(next) = next {
            // v = p + P gap;  W = P A and V = P B as columns; their transposes make Aᵀ P and Bᵀ P.
            let mut v = next.gradient;
            add_product(&mut v, &next.hessian, &self.values.gap);
            add_transposed_product(q_x, &d.dynamics_x, &v);
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
                    .zip(&mut work.xu)
                    .zip(&mut work.u)
                    .zip(&d.dynamics_u)
                    .zip(0..n)
                {
                    add_product(v_u, &next.hessian, b);
                    add_product(q_xu, &w, b);
                    q_u[0] += dot(b, &v);
                }
                let v_u = transpose(&v_u);
                for (q, b) in work.uu.iter_mut().zip(&d.dynamics_u).take(n) {
                    add_product(q, &v_u, b);
                }
            }
        }
        let carried = next.map(|next| &next.carried);
        if !self.minimise(work, carried, rank_tolerance) {
            return false;
        }
        // Rounding makes the two triangles differ, and an unstable motion would amplify that.
        mirror_lower(&mut self.riccati.hessian);
        true
    }

    /// Adds the condensed rows to the stage Hessian and gradient.
    #[inline(never)]
    fn add_rows(&mut self, q: &mut Work<T, NX, NU>) {
        let d = &self.derivatives;
        let (q_xx, q_x) = (&mut self.riccati.hessian, &mut self.riccati.gradient);
        let state_rows = self.dims.state_rows;
        let before_mixed = state_rows.saturating_add(self.dims.control_rows);
        let rows = d
            .rows_x
            .iter()
            .zip(&d.rows_u)
            .zip(self.step.weight.iter().zip(&self.step.target));
        for (i, ((row_x, row_u), (weight, target))) in
            rows.enumerate().take(self.dims.rows().min(NI))
        {
            if self.bounds.0[i] == self.bounds.1[i] && self.elastic == T::ZERO {
                continue;
            }
            let (in_state, in_control) = (i < state_rows || i >= before_mixed, i >= state_rows);
            if in_state {
                add_outer(q_xx, *weight, row_x);
                add_scaled(q_x, *target, row_x);
            }
            if in_control {
                add_outer(&mut q.uu, *weight, row_u);
                for (q, entry) in q.u.iter_mut().zip(row_u) {
                    q[0] += *target * *entry;
                }
            }
            if in_state && in_control {
                for (column, entry) in q.xu.iter_mut().zip(row_u) {
                    if *entry != T::ZERO {
                        add_scaled(column, *weight * *entry, row_x);
                    }
                }
            }
        }
    }
}

/// Forward substitution from the step of the first state: states, controls, slacks, bound multipliers, and
/// the full-step costates and multipliers of equalities.
///
/// Returns the largest primal and dual step lengths that keep `1 − fraction` of every distance to a
/// bound and of every bound multiplier.
#[inline(never)]
pub(crate) fn substitute<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize>(
    stages: &mut [Stage<T, X, NX, NU, NI>],
    start: [T; NX],
    shift: T,
    mu: T,
    fraction: T,
) -> (T, T) {
    let mut lengths = (T::ONE, T::ONE);
    if let Some(first) = stages.first_mut() {
        first.step.state = start;
        first.step.costate = first.riccati.costate(&start);
    }
    let mut rest = stages;
    while let Some((stage, tail)) = rest.split_first_mut() {
        let step = stage.step.state;
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
            *control = feedforward[0] + dot(gain, &step);
        }
        let (primal, dual) = stage.step_rows(mu, fraction);
        lengths = (min(lengths.0, primal), min(lengths.1, dual));

        // The costate of this node lacks its rows until here.
        let carried = &stage.riccati.carried;
        let own_rows = carried.rows.iter().zip(&carried.multiplier);
        for (row, y) in own_rows.take(carried.count) {
            add_scaled(&mut stage.step.costate, *y, row);
        }
        let mut costate = [T::ZERO; NX];
        let mut carried = None;
        if let Some(next) = tail.first_mut() {
            let mut step_next = stage.values.gap;
            add_product(&mut step_next, &stage.derivatives.dynamics_x, &step);
            add_product(
                &mut step_next,
                &stage.derivatives.dynamics_u,
                &stage.step.control,
            );
            next.step.state = step_next;
            costate = next.riccati.costate(&step_next);
            next.step.costate = costate;
            carried = Some(&mut next.riccati.carried);
        }
        if stage.has_equalities(carried.as_deref()) {
            stage.recover_multipliers(&costate, carried, shift);
        }
        rest = tail;
    }
    lengths
}

impl<T: Scalar, const NX: usize, const NU: usize> Riccati<T, NX, NU> {
    /// Gradient `P dx + p` of the cost-to-go.
    #[inline(always)]
    fn costate(&self, step: &[T; NX]) -> [T; NX] {
        let mut costate = self.gradient;
        add_product(&mut costate, &self.hessian, step);
        costate
    }
}
