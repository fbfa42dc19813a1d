//! Joint friction: viscous and Coulomb, the B_fric τ_fric(q̇) of paper A eq. (4).

use so3::{Scalar, math};

use crate::model::JointLimits;

/// Torque of friction against the motion, N m: τ_i = −d_i q̇_i − f_i tanh(q̇_i / v_s).
///
/// `smoothing` is the speed v_s in rad/s (m/s) below which Coulomb friction fades, so that the law is
/// differentiable at rest; zero or less stands for the sign function with sign(0) = 0.
#[must_use]
pub fn joint_friction<T: Scalar, const N: usize>(
    limits: &[JointLimits<T>; N],
    velocity: &[T; N],
    smoothing: T,
) -> [T; N] {
    let mut torque = [T::ZERO; N];
    for ((tau, joint), &qd) in torque.iter_mut().zip(limits).zip(velocity) {
        let direction = if smoothing > T::ZERO {
            math::tanh(qd / smoothing)
        } else if qd == T::ZERO {
            T::ZERO
        } else {
            math::copysign(T::ONE, qd)
        };
        *tau = -(joint.damping * qd + joint.friction * direction);
    }
    torque
}
