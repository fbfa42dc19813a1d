//! What a machine observes in one tick.

use jump_control::Measurement;
use so3::Scalar;

/// What the machine hears in one tick of 1 kHz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation<T: Scalar, const N: usize, const F: usize> {
    /// The robot; its base comes from an estimator such as `state-est`.
    pub measured: Measurement<T, N, F>,
    /// Mean torques of the joints over the period before the measurement, friction included, N m: evidence of contact for feet without a
    /// good sensor. A humanoid's soles have six axes, and its machine does not read them.
    pub joint_torques: [T; N],
}
