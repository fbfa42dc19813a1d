//! Moving a configuration along a velocity.

use nalgebra::Matrix3;
use rbd_core::{Configuration, Tangent, Transform};
use so3::{Scalar, exp, left_jacobian};

/// q ⊕ ν dt with ν constant in base axes: R⁺ = R Exp(ω dt), p⁺ = p + R J_l(ω dt) v dt, joints linear.
#[must_use]
pub fn integrate_configuration<T: Scalar, const N: usize>(
    configuration: &Configuration<T, N>,
    velocity: &Tangent<T, N>,
    dt: T,
) -> Configuration<T, N> {
    let base = &configuration.base;
    let turn = velocity.base.angular * dt;
    let jacobian: Matrix3<T> = left_jacobian(&turn);
    let moved = base.rotation * (jacobian * velocity.base.linear * dt);
    let mut joints = configuration.joints;
    for (q, qd) in joints.iter_mut().zip(&velocity.joints) {
        *q += *qd * dt;
    }
    Configuration {
        base: Transform::new(base.rotation * exp(&turn), base.translation + moved),
        joints,
    }
}
