//! H on the null space of the equalities.

use super::Elimination;
use crate::access::{at, copy, head, head_mut, put, row, span, span_mut};
use crate::kernels::{ceil4, sub_rows};
use crate::tiles::{load, store, sub_products};
use so3::{Scalar, math};

impl<T: Scalar, const N: usize> Elimination<T, N> {
    /// Upper triangle of ZᵀHZ into `out` and the size of the terms of its diagonal into `magnitude`. `c` is scratch.
    pub(crate) fn reduce_hessian(
        &self,
        h: &[[T; N]; N],
        out: &mut [[T; N]; N],
        magnitude: &mut [T; N],
        c: &mut [[T; N]; N],
    ) {
        if self.rank == 0 {
            for (i, ((o, h), m)) in out.iter_mut().zip(h).zip(magnitude).enumerate() {
                copy(span_mut(o, i, N), span(h, i, N));
                *m = at(h, i);
            }
            return;
        }
        let (free, end) = (self.free(), ceil4(self.free(), N));
        // ZᵀHZ = H_FF − WᵀC − CᵀW with C = H_BF − ½ H_BB W.
        let mut shares = [T::ZERO; N];
        for (c, v) in c.iter_mut().zip(self.basic_variables()) {
            let hv = row(h, *v);
            for (c, f) in c.iter_mut().zip(self.free_variables()) {
                *c = at(hv, *f);
            }
            for (f, other) in shares.iter_mut().zip(self.basic_variables()) {
                *f = at(hv, *other) * T::HALF;
            }
            sub_rows(c, &shares, self.basic_rows(), 0, end);
        }
        let (w, c) = (self.basic_rows(), head(c, self.rank - self.fixed));
        for (i, (o, v)) in out.iter_mut().zip(self.free_variables()).enumerate() {
            let hv = row(h, *v);
            put(magnitude, i, at(hv, *v));
            let others = span(self.free_variables(), i, free);
            for (o, f) in span_mut(o, i, free).iter_mut().zip(others) {
                *o = at(hv, *f);
            }
        }
        for (w, c) in w.iter().zip(c) {
            for ((m, w), c) in magnitude.iter_mut().zip(w).zip(c).take(free) {
                *m += math::abs(*w * *c);
            }
        }
        let out = head_mut(out, free);
        for i in (0..free).step_by(4) {
            let own = span_mut(out, i, free);
            for j in (i..end).step_by(4) {
                let mut tile = load(own, j);
                sub_products(&mut tile, (w, i), (c, j));
                sub_products(&mut tile, (c, i), (w, j));
                store(own, j, &tile);
            }
            for o in own.iter_mut().take(4) {
                span_mut(o, free, end).fill(T::ZERO);
            }
        }
    }
}
