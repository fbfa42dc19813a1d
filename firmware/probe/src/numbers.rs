//! How the numbers of a result are listed.

mod dynamics;
mod rotations;
mod second_order;

use nalgebra::{Quaternion, Rotation3, SMatrix, Unit};
use so3::Scalar;

/// A result made of numbers, which it lists in a fixed order. `f32` widens to `f64` exactly.
pub trait Numbers {
    /// Hands every number to `take`.
    fn visit(&self, take: &mut dyn FnMut(f64));
}

impl Numbers for f32 {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        take(f64::from(*self));
    }
}

impl Numbers for f64 {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        take(*self);
    }
}

impl Numbers for bool {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        take(f64::from(u8::from(*self)));
    }
}

impl<N: Numbers + ?Sized> Numbers for &N {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        (**self).visit(take);
    }
}

impl<N: Numbers> Numbers for [N] {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.iter().for_each(|n| n.visit(take));
    }
}

impl<N: Numbers, const K: usize> Numbers for [N; K] {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.as_slice().visit(take);
    }
}

impl<A: Numbers, B: Numbers> Numbers for (A, B) {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.0.visit(take);
        self.1.visit(take);
    }
}

impl<A: Numbers, B: Numbers, C: Numbers> Numbers for (A, B, C) {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.0.visit(take);
        self.1.visit(take);
        self.2.visit(take);
    }
}

impl<N: Numbers> Numbers for Option<N> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.is_some().visit(take);
        self.iter().for_each(|n| n.visit(take));
    }
}

impl<N: Numbers, E: Numbers> Numbers for Result<N, E> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.is_ok().visit(take);
        match self {
            Ok(result) => result.visit(take),
            Err(error) => error.visit(take),
        }
    }
}

impl Numbers for () {
    fn visit(&self, _: &mut dyn FnMut(f64)) {}
}

impl<T: Scalar + Numbers, const R: usize, const C: usize> Numbers for SMatrix<T, R, C> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.as_slice().visit(take);
    }
}

impl<T: Scalar + Numbers> Numbers for Rotation3<T> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.matrix().visit(take);
    }
}

impl<T: Scalar + Numbers> Numbers for Unit<Quaternion<T>> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.as_ref().coords.visit(take);
    }
}
