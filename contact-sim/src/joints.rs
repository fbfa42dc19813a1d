//! What happens at the ends of a joint's range.

use rbd_core::JointLimits;
use so3::{Scalar, math};

/// Springs with dampers at the ends of a joint's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops<T> {
    /// Stiffness, N m/rad.
    pub stiffness: T,
    /// Damping while pressed, N m s/rad.
    pub damping: T,
}

impl<T: Scalar> Stops<T> {
    /// Torque of the stop: zero inside the range, never pulling.
    #[inline]
    #[must_use]
    pub fn torque(&self, limits: &JointLimits<T>, q: T, qd: T) -> T {
        if q < limits.lower {
            math::max(
                self.stiffness * (limits.lower - q) - self.damping * qd,
                T::ZERO,
            )
        } else if q > limits.upper {
            math::min(
                self.stiffness * (limits.upper - q) - self.damping * qd,
                T::ZERO,
            )
        } else {
            T::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Stops;
    use rbd_core::JointLimits;

    #[test]
    fn a_stop_pushes_back_and_never_pulls() {
        let stops = Stops {
            stiffness: 100.0,
            damping: 1.0,
        };
        let limits = JointLimits {
            lower: -1.0,
            upper: 1.0,
            ..JointLimits::NONE
        };
        assert_eq!(stops.torque(&limits, 0.5, 100.0), 0.0);
        assert!(stops.torque(&limits, 1.1, 0.0) < 0.0);
        assert_eq!(stops.torque(&limits, 1.1, -50.0), 0.0);
        assert!(stops.torque(&limits, -1.1, 0.0) > 0.0);
    }
}
