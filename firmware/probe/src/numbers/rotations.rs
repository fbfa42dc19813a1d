//! The results of `so3`.

use so3::small_angle::Coefficients;
use so3::{Error, Geodesic, Scalar};

use super::Numbers;

impl<T: Scalar + Numbers> Numbers for Coefficients<T> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        [&self.a, &self.b, &self.c].visit(take);
    }
}

/// A geodesic shows where it starts and ends.
impl<T: Scalar + Numbers> Numbers for Geodesic<T> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.at(T::ZERO).visit(take);
        self.at(T::ONE).visit(take);
    }
}

impl Numbers for Error {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        take(match self {
            Self::NotFinite { .. } => 1.0,
            Self::ZeroQuaternion => 2.0,
            Self::NotNearRotation => 3.0,
            Self::GimbalLock => 4.0,
            _ => 0.0,
        });
    }
}
