//! The results of `rbd_core::second_order`, field by field.

use rbd_core::second_order::{EffortJacobian, Gradient, Hessian, PointMotion};
use so3::Scalar;

use super::Numbers;

impl<T: Scalar + Numbers> Numbers for PointMotion<T> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        (self.pos, self.velocity, self.lifted).visit(take);
    }
}

impl<T: Numbers, const N: usize, const C: usize> Numbers for Gradient<T, N, C> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        [&self.q, &self.v, &self.a].visit(take);
        self.force.visit(take);
    }
}

impl<T: Numbers, const N: usize, const C: usize> Numbers for EffortJacobian<T, N, C> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        [&self.by_q, &self.by_v, &self.by_a].visit(take);
        self.by_force.visit(take);
    }
}

impl<T: Numbers, const N: usize, const C: usize> Numbers for Hessian<T, N, C> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        [&self.qq, &self.vq, &self.vv].visit(take);
        [&self.aq, &self.av, &self.aa].visit(take);
        self.force.visit(take);
    }
}
