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

use crate::keep::Keep;
use crate::kernel::{add_product, add_scaled, dot, mirror_lower, set_column};
use crate::linearised::Linearised;
use crate::problem::{Derivatives, Problem};
use crate::project::{OfControls, Work};
use crate::rows::RowBarrier;
use crate::stage::{Node, Pass, Riccati, Stage};
use crate::sweep::At;
use so3::Scalar;

/// A Newton step of all nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direction<T> {
    /// Shift of the Hessian it was computed with.
    pub(crate) shift: T,
    /// Largest lengths that keep a share of every distance to a bound, and of every bound multiplier.
    pub(crate) primal: T,
    pub(crate) dual: T,
    /// Derivative of the barrier function along it.
    pub(crate) slope: T,
    /// See [`RowBarrier::reach`].
    pub(crate) reach: T,
}

impl<T: Scalar> Direction<T> {
    /// Length of the longest trial step: all of it where rows stop for themselves, else as much as every row has room for.
    pub(crate) fn longest(&self) -> T {
        if self.reach < T::INFINITY {
            T::ONE
        } else {
            self.primal
        }
    }
}

/// Backward recursion with `shift` added to the diagonal of every stage Hessian.
///
/// Returns false if the reduced Hessian is not positive definite.
#[inline(never)]
#[must_use]
pub(crate) fn factorise<T, P, K, const NX: usize, const NU: usize, const NI: usize>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
    barrier: RowBarrier<T>,
    shift: T,
    pass: Pass,
    workers: usize,
) -> bool
where
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    K: Keep<T, NX, NU, NI>,
{
    #[cfg(feature = "std")]
    if workers > 1
        && let Some(is_definite) = crate::threads::factorise(stages, barrier, shift)
    {
        return is_definite;
    }
    let _ = workers;
    let mut work = Work::new();
    let mut scratch = Derivatives::new();
    let mut k = stages.len();
    while let Some((head, tail)) = stages.split_at_mut_checked(k) {
        let Some(stage) = head.last_mut() else { break };
        k = k.wrapping_sub(1);
        let next = tail.first();
        let seen = next.map(|next| At::Iterate.of(next));
        let (node, d) = stage.linearise(problem, k, seen, &mut scratch, pass);
        let next = next.map(|next| &next.node.riccati);
        node.condense(d, &mut work.q, barrier.mu, shift);
        if !node.recur(d, &mut work, next, barrier) {
            return false;
        }
    }
    true
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Node<T, NX, NU, NI> {
    /// The quadratic of the stage with its rows condensed, of whose diagonal blocks only the lower triangles count.
    #[inline(never)]
    pub(crate) fn condense(
        &mut self,
        d: &impl Linearised<T, NX, NU>,
        of_controls: &mut OfControls<T, NX, NU>,
        mu: T,
        shift: T,
    ) {
        let n = self.dims.controls.min(NU);
        let mut q = of_controls.with(&mut self.riccati);
        d.write(n, &mut q);
        for (i, column) in q.xx.iter_mut().enumerate() {
            column[i] += shift;
        }
        for (i, column) in q.uu.iter_mut().enumerate().take(n) {
            column[i] += shift;
        }
        for i in 0..self.row_count() {
            if self.rows.is_equality(i) && self.elastic == T::ZERO {
                continue;
            }
            let condensed = self.condensed(i, mu);
            let mut q = of_controls.with(&mut self.riccati);
            d.condense(i, self.dims.parts(i), condensed, &mut q);
        }
    }

    /// One step of the backward recursion, from the condensed quadratic.
    #[inline(always)]
    pub(crate) fn recur(
        &mut self,
        d: &impl Linearised<T, NX, NU>,
        work: &mut Work<T, NX, NU>,
        next: Option<&Riccati<T, NX, NU>>,
        barrier: RowBarrier<T>,
    ) -> bool {
        let n = self.dims.controls.min(NU);
        let (q_xx, q_x) = (&mut self.riccati.hessian, &mut self.riccati.gradient);
        if let Some(next) = next {
            // v = p + P gap;  W = P A and V = P B by rows, which are the columns that Aᵀ and Bᵀ are multiplied with.
            let mut v = next.gradient;
            add_product(&mut v, &next.hessian, &self.values.gap);
            d.pull_back_x(&v, q_x);
            let mut w = [[T::ZERO; NX]; NX];
            for j in 0..NX {
                let mut column = [T::ZERO; NX];
                d.combine_x(j, &next.hessian, &mut column);
                set_column(&mut w, j, &column);
            }
            for (j, q) in q_xx.iter_mut().enumerate() {
                d.combine_x(j, &w, q);
            }
            if n > 0 {
                let mut of_u = [T::ZERO; NU];
                d.pull_back_u(&v, &mut of_u);
                let mut v = [[T::ZERO; NU]; NX];
                let columns = work.q.xu.iter_mut().zip(&mut work.q.u).zip(&of_u);
                for (j, ((q_xu, q_u), of_u)) in columns.enumerate().take(n) {
                    let mut column = [T::ZERO; NX];
                    d.combine_u(j, &next.hessian, &mut column);
                    set_column(&mut v, j, &column);
                    d.combine_u(j, &w, q_xu);
                    q_u[0] += *of_u;
                }
                for (j, q) in work.q.uu.iter_mut().enumerate().take(n) {
                    d.combine_u(j, &v, q);
                }
            }
        }
        let carried = next.map(|next| &next.carried);
        if !self.minimise(d, work, carried, barrier.rank_tolerance) {
            return false;
        }
        // Rounding makes the two triangles differ, and an unstable motion would amplify that.
        mirror_lower(&mut self.riccati.hessian);
        true
    }
}

/// Forward substitution from the step of the first state: states, controls, slacks, bound multipliers, and
/// the full-step costates and multipliers of equalities.
#[inline(never)]
pub(crate) fn substitute<T, P, K, const NX: usize, const NU: usize, const NI: usize>(
    problem: &P,
    stages: &mut [Stage<T, P::State, NX, NU, NI, K>],
    start: [T; NX],
    (barrier, shift): (RowBarrier<T>, T),
    pass: Pass,
    workers: usize,
) -> Direction<T>
where
    T: Scalar,
    P: Problem<T, NX, NU, NI>,
    K: Keep<T, NX, NU, NI>,
{
    let mut direction = Direction {
        shift,
        primal: T::ONE,
        dual: T::ONE,
        slope: T::ZERO,
        reach: barrier.reach,
    };
    if let Some(first) = stages.first_mut() {
        first.node.step.state = start;
        first.node.step.costate = first.node.riccati.costate(&start);
    }
    #[cfg(feature = "std")]
    if workers > 1
        && let Some(direction) = crate::threads::substitute(stages, barrier, direction)
    {
        return direction;
    }
    let _ = workers;
    let (mut scratch, mut slope) = (Derivatives::new(), T::ZERO);
    let mut rest = stages;
    let mut k = 0usize;
    while let Some((stage, tail)) = rest.split_first_mut() {
        let seen = tail.first().map(|next| At::Iterate.of(next));
        let (node, d) = stage.linearise(problem, k, seen, &mut scratch, pass);
        let mut next = tail.first_mut().map(|next| &mut next.node);
        node.propagate(d, next.as_deref_mut(), &mut slope);
        node.complete(d, next, barrier, &mut direction);
        rest = tail;
        k = k.wrapping_add(1);
    }
    direction.slope += slope;
    direction
}

impl<T: Scalar, const NX: usize, const NU: usize, const NI: usize> Node<T, NX, NU, NI> {
    /// One step of the forward substitution: the controls, the cost's part of the slope, and the state of the next node with its costate,
    /// which lacks that node's rows until [`Node::complete`].
    #[inline(always)]
    pub(crate) fn propagate(
        &mut self,
        d: &impl Linearised<T, NX, NU>,
        next: Option<&mut Self>,
        slope: &mut T,
    ) {
        let step = self.step.state;
        let n = self.dims.controls.min(NU);
        self.step.control = [T::ZERO; NU];
        let r = &self.riccati;
        let law = r.gain.iter().zip(&r.feedforward).take(n);
        for (control, (gain, feedforward)) in self.step.control.iter_mut().zip(law) {
            *control = feedforward[0] + dot(gain, &step);
        }
        *slope += dot(d.cost_x(), &step) + dot(d.cost_u(), &self.step.control);
        if let Some(next) = next {
            next.step.state = self.values.gap;
            d.push_forward(&step, &self.step.control, &mut next.step.state);
            next.step.costate = next.riccati.costate(&next.step.state);
        }
    }

    /// What follows from the steps of a node's and the next one's state and from its controls: slacks, multipliers, what rows add to its costate.
    #[inline(always)]
    pub(crate) fn complete(
        &mut self,
        d: &impl Linearised<T, NX, NU>,
        next: Option<&mut Self>,
        barrier: RowBarrier<T>,
        direction: &mut Direction<T>,
    ) {
        self.step_rows(d, barrier, direction);
        let carried = &self.riccati.carried;
        let own_rows = carried.rows.iter().zip(&carried.multiplier);
        for (row, y) in own_rows.take(carried.count) {
            add_scaled(&mut self.step.costate, *y, row);
        }
        let costate = next
            .as_ref()
            .map_or([T::ZERO; NX], |next| next.step.costate);
        let carried = next.map(|next| &mut next.riccati.carried);
        if self.has_equalities(carried.as_deref()) {
            self.recover_multipliers(d, &costate, carried, direction.shift, barrier.mu);
        }
    }
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
