//! Configurations as a manifold: integrate, difference, interpolate.
//!
//! A displacement d = (v, ω, Δs) moves the base by the exponential of SE(3) and the joints by addition:
//! R' = R Exp(ω), p' = p + R V(ω) v, s' = s + Δs, with V the left Jacobian of SO(3). This is the motion at
//! constant body velocity for unit time, and Pinocchio's free-flyer.

use so3::{Rotation3, Scalar};

use crate::spatial::{Motion, Transform, matrix_product, product};
use crate::state::{Configuration, Tangent};

/// q ⊕ d: where a constant velocity d leads in unit time. `d` may be a velocity times a time step.
#[inline]
#[must_use]
pub fn integrate<T: Scalar, const N: usize>(
    q: &Configuration<T, N>,
    d: &Tangent<T, N>,
) -> Configuration<T, N> {
    let (v, w) = (&d.base.linear, &d.base.angular);
    let mut joints = q.joints;
    for (x, &dx) in joints.iter_mut().zip(&d.joints) {
        *x += dx;
    }
    let (rotation, jacobian) = so3::exp_with_jacobian(w);
    let step = Transform::new(rotation, product(&jacobian, v));
    Configuration {
        base: q.base.compose(&step),
        joints,
    }
}

/// to ⊖ from: the displacement that leads from one configuration to the other, so that
/// `integrate(from, &difference(from, to))` is `to`.
///
/// The base takes the short way round: its angular part is at most π.
#[inline]
#[must_use]
pub fn difference<T: Scalar, const N: usize>(
    from: &Configuration<T, N>,
    to: &Configuration<T, N>,
) -> Tangent<T, N> {
    let rot_bw = from.base.rotation.matrix().transpose();
    let turn = matrix_product(&rot_bw, to.base.rotation.matrix());
    let (angular, jacobian) =
        so3::log_with_jacobian_inverse(&Rotation3::from_matrix_unchecked(turn));
    let shift_b = product(&rot_bw, &(to.base.translation - from.base.translation));
    let linear = product(&jacobian, &shift_b);
    let mut joints = to.joints;
    for (x, &x0) in joints.iter_mut().zip(&from.joints) {
        *x -= x0;
    }
    Tangent {
        base: Motion { linear, angular },
        joints,
    }
}

/// The configuration a fraction of the way from one to another, along the geodesic of
/// [`difference`]: `from` at 0, `to` at 1, extrapolated beyond.
#[inline]
#[must_use]
pub fn interpolate<T: Scalar, const N: usize>(
    from: &Configuration<T, N>,
    to: &Configuration<T, N>,
    fraction: T,
) -> Configuration<T, N> {
    integrate(from, &(difference(from, to) * fraction))
}
