//! What the search leaves: multipliers of all rows, and the residual.

use so3::{Scalar, math};

use super::{Search, signed};
use crate::access::{at, put};
use crate::residual::{kkt_residual, worse};
use crate::{Solution, Status, Workspace};

impl<'w, T: Scalar, const N: usize, const M: usize> Search<'_, '_, 'w, T, N, M> {
    /// Multipliers of all rows, residual, and the solution.
    pub(super) fn finish(mut self, status: Status) -> Solution<'w, T, N, M> {
        if status == Status::Solved {
            self.publish();
            let residual = self.residual();
            return self.solution(status, residual);
        }
        let proof = (self.w.row_multipliers, self.w.bound_multipliers);
        self.evaluate_gradient();
        self.publish();
        let (rows, bounds) = (&self.w.row_multipliers, &self.w.bound_multipliers);
        let residual = kkt_residual(self.p, &self.w.x, rows, bounds);
        if status == Status::Infeasible {
            (self.w.row_multipliers, self.w.bound_multipliers) = proof;
        }
        self.solution(status, residual)
    }

    /// Multipliers of all rows from those of the active ones and the gradient.
    fn publish(&mut self) {
        let w = &mut *self.w;
        w.row_multipliers.fill(T::ZERO);
        w.bound_multipliers.fill(T::ZERO);
        w.elimination.multipliers(&w.gradient, &mut w.vec_a);
        for k in 0..w.elimination.rank {
            let (id, mu) = (at(&w.elimination.id, k), at(&w.vec_a, k));
            set_multiplier(w, id, mu);
        }
        for k in 0..w.basis.len {
            let (id, side, y) = (at(&w.id, k), at(&w.side, k), at(&w.lambda, k));
            set_multiplier(w, id, signed(side, y));
        }
    }

    /// [`kkt_residual`] from what the last look and the last gradient left behind.
    fn residual(&mut self) -> crate::Residual<T> {
        let mut complementarity = self.complementarity;
        let w = &mut *self.w;
        for k in 0..w.elimination.rank {
            let (id, mu) = (at(&w.elimination.id, k), at(&w.vec_a, k));
            let off = self.p.value(id, &w.x) - self.p.limits(id).1;
            complementarity = worse(complementarity, math::abs(mu * off));
            self.p.add_row(id, mu, &mut w.gradient);
        }
        crate::Residual {
            stationarity: crate::residual::norm(&w.gradient),
            primal: self.primal,
            complementarity,
        }
    }

    fn solution(self, status: Status, residual: crate::Residual<T>) -> Solution<'w, T, N, M> {
        let (iterations, steps) = (self.iterations, self.steps);
        let w: &'w Workspace<T, N, M> = self.w;
        Solution {
            status,
            x: &w.x,
            row_multipliers: &w.row_multipliers,
            bound_multipliers: &w.bound_multipliers,
            iterations,
            steps,
            residual,
            ray: &w.previous,
        }
    }
}

pub(super) fn set_multiplier<T: Scalar, const N: usize, const M: usize>(
    w: &mut Workspace<T, N, M>,
    id: usize,
    y: T,
) {
    if id < M {
        put(&mut w.row_multipliers, id, y);
    } else {
        put(&mut w.bound_multipliers, id - M, y);
    }
}
