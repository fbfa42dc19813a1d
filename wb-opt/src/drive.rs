//! What a joint's drive loses and what it can give.

use rbd_core::Motor;
use rbd_core::model::JointLimits;
use so3::Scalar;

/// Friction that the motor overcomes, τ_f = d q̇ + f tanh(q̇/v_s), and its two derivatives in q̇.
#[inline(always)]
pub(crate) fn friction<T: Scalar>(limit: &JointLimits<T>, speed: T, smoothing: T) -> [T; 3] {
    let viscous = [limit.damping * speed, limit.damping, T::ZERO];
    if limit.friction == T::ZERO {
        return viscous;
    }
    let t = so3::math::tanh(speed / smoothing);
    let steep = limit.friction * (T::ONE - t * t) / smoothing;
    [
        viscous[0] + limit.friction * t,
        viscous[1] + steep,
        -T::TWO * t * steep / smoothing,
    ]
}

/// The falling part of a motor's torque-speed line as one two-sided row: |τ + c q̇| ≤ c q̇_0, with c the
/// torque over the difference of no-load and corner speed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line<T> {
    pub(crate) slope: T,
    pub(crate) bound: T,
}

impl<T: Scalar> Line<T> {
    /// Of a motor; a joint without one has no bound.
    #[inline(always)]
    pub(crate) fn of(motor: Option<&Motor<T>>) -> Self {
        match motor {
            Some(motor) => {
                let slope = motor.torque / (motor.no_load_speed - motor.corner_speed);
                Self {
                    slope,
                    bound: slope * motor.no_load_speed,
                }
            }
            None => Self {
                slope: T::ZERO,
                bound: T::INFINITY,
            },
        }
    }
}
