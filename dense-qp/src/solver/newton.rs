//! Newton corrections of (x, λ) for the active rows.

use so3::Scalar;

use super::Search;
use crate::Workspace;
use crate::access::{at, put};

impl<T: Scalar, const N: usize, const M: usize> Search<'_, '_, '_, T, N, M> {
    /// From `gradient` at (x, λ): the point that is stationary with all active rows met. Then drops
    /// rows until no multiplier is negative. `known` says that [`Search::newton`] has just been called.
    pub(super) fn correct(&mut self, known: bool) {
        let w = &mut *self.w;
        if w.basis.len == 0 {
            w.elimination.reduce(&w.gradient, &mut w.vec_a);
            w.factor.solve_transposed(&mut w.vec_a);
            w.factor.weigh(&mut w.vec_a);
            w.factor.solve(&mut w.vec_a);
            let free = w.elimination.free();
            w.elimination.expand(&w.vec_a, free, &mut w.step);
            self.move_along_step();
        } else {
            if !known {
                self.newton();
            }
            let w = &mut *self.w;
            for (l, change) in w.lambda.iter_mut().zip(&w.vec_b).take(w.basis.len) {
                *l += *change;
            }
            w.basis.direction(0, &w.candidate.d, &mut w.step);
            self.move_along_step();
            self.drop_negative();
        }
        // Far excursions (large proximal steps) leave round-off in the equalities.
        self.w.elimination.restore(&mut self.w.x, &mut self.w.vec_a);
    }

    /// The step towards the stationary point with all active rows met, as coordinates y of J in the candidate, and the change of the
    /// multipliers in `vec_b`; from `gradient`. y₁ meets the active rows, y₂ is the gradient's own, and the
    /// multipliers take the rest.
    fn newton(&mut self) {
        let w = &mut *self.w;
        w.gradient_coordinates();
        for k in 0..self.w.basis.len {
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            let e = self.excess(id, side);
            put(&mut self.w.vec_b, k, e);
        }
        self.aim();
    }

    /// The rest of [`Search::newton`], from the gradient in the candidate and the rows' excesses in `vec_b`.
    pub(super) fn aim(&mut self) {
        let w = &mut *self.w;
        w.basis.solve_transposed(&mut w.vec_b);
        let rows = w.candidate.d.iter_mut().zip(&mut w.vec_b);
        for (d, y) in rows.take(w.basis.len) {
            (*d, *y) = (*y, *y - *d);
        }
        let rest = w.vec_b;
        w.basis.solve(&rest, &mut w.vec_b);
    }

    /// The least step, in the metric of H, that meets all active rows and the equalities.
    pub(super) fn meet_active(&mut self) {
        self.w.candidate.d.fill(T::ZERO);
        for k in 0..self.w.basis.len {
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            let e = self.excess(id, side);
            put(&mut self.w.vec_b, k, e);
        }
        if self.w.basis.len > 0 {
            self.aim();
            let w = &mut *self.w;
            w.basis.direction(0, &w.candidate.d, &mut w.step);
            self.move_along_step();
        }
        self.w.elimination.restore(&mut self.w.x, &mut self.w.vec_a);
    }

    /// Remembered rows that would pull instead of push leave before the search, all at once: one by one, each would cost a step. Returns
    /// whether the Newton step of the rows that stay is there.
    pub(super) fn drop_unfit(&mut self) -> bool {
        for _ in 0..3 {
            if self.w.basis.len == 0 {
                return false;
            }
            self.newton();
            let before = self.w.basis.len;
            for k in (0..before).rev() {
                if at(&self.w.vec_b, k) < T::ZERO {
                    self.steps += 1;
                    self.leave(k);
                }
            }
            if self.w.basis.len == before {
                return true;
            }
        }
        false
    }

    /// x ← x − step.
    fn move_along_step(&mut self) {
        let w = &mut *self.w;
        crate::kernels::sub_scaled(&mut w.x, T::ONE, &w.step);
    }

    /// Whether a row pulls that there was no time to let go.
    pub(super) fn has_pulling(&self) -> bool {
        let mut multipliers = self.w.lambda.iter().take(self.w.basis.len);
        self.steps >= self.most && multipliers.any(|l| *l < T::ZERO)
    }

    /// Lets rows go until none pulls, always the one that pulls most: as a force, since multipliers depend on units of rows.
    pub(super) fn drop_negative(&mut self) {
        for _ in 0..N {
            if self.steps >= self.most {
                return;
            }
            let mut worst = None;
            let (mut force, mut value) = (T::ZERO, T::ZERO);
            for k in 0..self.w.basis.len {
                let l = at(&self.w.lambda, k);
                if l < T::ZERO {
                    let pull = l / self.active_scale(k);
                    if pull < force {
                        (worst, force, value) = (Some(k), pull, l);
                    }
                }
            }
            let Some(k) = worst else { break };
            let (id, side) = (at(&self.w.id, k), at(&self.w.side, k));
            self.steps += 1;
            self.leave(k);
            // The multiplier returns to zero along the direction that leaves the other rows met.
            self.prepare(id, side);
            self.answer();
            self.turn();
            self.advance(-value);
        }
    }
}

impl<T: Scalar, const N: usize, const M: usize> Workspace<T, N, M> {
    /// Coordinates of `gradient` in the basis, into the candidate. What equalities hold of it is taken out first: J, turned again and
    /// again, does not cancel that to the last digit. `step` is scratch.
    pub(super) fn gradient_coordinates(&mut self) {
        self.elimination.reduce(&self.gradient, &mut self.vec_a);
        self.elimination.scatter(&self.vec_a, &mut self.step);
        self.basis.coordinates(&self.step, &mut self.candidate.d);
    }
}
