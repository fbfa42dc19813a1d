//! Why there is no solution: rows that contradict each other, and rays along which the cost falls without end.

use so3::{Scalar, math};

use super::outcome::set_multiplier;
use super::{EQUALITY, Search, scale_inverse};
use crate::Status;
use crate::kernels::{at, dot, max_abs};
use crate::residual::{infeasibility, worse};

impl<T: Scalar, const N: usize, const M: usize> Search<'_, '_, '_, T, N, M> {
    /// The entering row depends on the active ones and nothing blocks: y = 1 on it, −r on them.
    pub(super) fn conflict(&mut self, id: usize, side: i8) -> Status {
        let w = &mut *self.w;
        w.row_multipliers.fill(T::ZERO);
        w.bound_multipliers.fill(T::ZERO);
        for k in 0..w.basis.len {
            let y = math::max(-at(&w.vec_b, k), T::ZERO);
            let (row, side) = (at(&w.id, k), at(&w.side, k));
            set_multiplier(w, row, if side > 0 { y } else { -y });
        }
        set_multiplier(w, id, if side > 0 { T::ONE } else { -T::ONE });
        self.prove()
    }

    /// A dependent equality that the earlier ones contradict.
    pub(super) fn contradiction(&mut self, id: usize, positive: bool) -> Status {
        let w = &mut *self.w;
        w.row_multipliers.fill(T::ZERO);
        w.bound_multipliers.fill(T::ZERO);
        w.x.fill(T::ZERO);
        w.factor.dim = 0;
        w.basis.clear();
        set_multiplier(w, id, if positive { T::ONE } else { -T::ONE });
        self.prove()
    }

    /// Completes a proof with the equalities, scales it to max 1, and believes it only if the
    /// numbers of the problem themselves confirm it.
    fn prove(&mut self) -> Status {
        let w = &mut *self.w;
        let mut sum = w.bound_multipliers;
        for (i, y) in w.row_multipliers.iter().enumerate() {
            if *y != T::ZERO {
                self.p.add_row(i, *y, &mut sum);
            }
        }
        w.elimination.multipliers(&sum, &mut w.vec_a);
        for k in 0..w.elimination.rank {
            let (id, mu) = (at(&w.elimination.id, k), at(&w.vec_a, k));
            set_multiplier(w, id, mu);
        }
        let largest = math::max(max_abs(&w.row_multipliers), max_abs(&w.bound_multipliers));
        let noise = T::of(4.0) * T::EPSILON * largest;
        let inverse = T::ONE / largest;
        for y in w.row_multipliers.iter_mut().chain(&mut w.bound_multipliers) {
            *y = if math::abs(*y) <= noise {
                T::ZERO
            } else {
                *y * inverse
            };
        }
        let proof = infeasibility(self.p, &w.row_multipliers, &w.bound_multipliers);
        let reach = math::max(T::ONE, max_abs(&w.x)) * T::of(10.0);
        if proof.support < T::ZERO && proof.combination * reach <= -proof.support {
            Status::Infeasible
        } else {
            Status::Numerical
        }
    }

    /// Without curvature along the last proximal step, goes on to the first limit; if there is none
    /// the cost has no minimum.
    pub(super) fn ray_step(&mut self) -> Option<Status> {
        let w = &mut *self.w;
        for ((s, x), before) in w.step.iter_mut().zip(&w.x).zip(&w.previous) {
            *s = *x - *before;
        }
        let length = max_abs(&w.step);
        if !(length > T::ZERO && length.is_finite_number()) {
            return None;
        }
        let mut slope = T::ZERO;
        let (mut curvature, mut size) = (T::ZERO, T::ZERO);
        for s in &mut w.step {
            *s /= length;
        }
        for (h, (g, s)) in self
            .p
            .hessian
            .iter()
            .zip(self.p.gradient.iter().zip(&w.step))
        {
            curvature = worse(curvature, math::abs(dot(h, &w.step)));
            size = worse(size, max_abs(h));
            slope += *g * *s;
        }
        let small = T::of(1e5) * T::EPSILON;
        if !(curvature <= small * size && slope < -(small * max_abs(self.p.gradient))) {
            return None;
        }
        let mut reach = T::INFINITY;
        for i in 0..M + N {
            if self.w.state(i) == EQUALITY {
                continue;
            }
            let (l, u) = self.p.limits(i);
            let rate = self.p.value(i, &self.w.step);
            let scale = T::ONE / scale_inverse::<T, N, M>(self.p, self.w, i);
            let value = self.p.value(i, &self.w.x);
            let room = if rate > small * scale {
                (u - value) / rate
            } else if rate < -(small * scale) {
                (l - value) / rate
            } else {
                continue;
            };
            reach = math::min(reach, math::max(room, T::ZERO));
        }
        if reach == T::INFINITY {
            self.w.previous = self.w.step;
            return Some(Status::Unbounded);
        }
        let w = &mut *self.w;
        crate::kernels::sub_scaled(&mut w.x, -reach, &w.step);
        self.evaluate_gradient();
        None
    }
}
