//! What happens at a joint: the motor's limits, friction and stops.

use rbd_core::JointLimits;
use so3::{Scalar, math};

/// What a motor with its gear can do at the joint.
///
/// Driving (torque along the motion) it gives the full torque up to the knee speed and then along a line
/// down to nothing at the speed limit; braking it always gives the full torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor<T> {
    /// Largest torque, N m.
    pub torque: T,
    /// Speed up to which it drives with the full torque, rad/s.
    pub knee_speed: T,
    /// Speed at which it no longer drives, rad/s.
    pub no_load_speed: T,
}

impl<T: Scalar> Motor<T> {
    /// Torque that the motor delivers when `command` is asked for at speed `qd`.
    #[inline]
    #[must_use]
    pub fn deliver(&self, command: T, qd: T) -> T {
        let speed = math::abs(qd);
        let mut driving = self.torque;
        if speed > self.knee_speed {
            let span = math::max(self.no_load_speed - self.knee_speed, T::EPSILON);
            driving *= math::clamp((self.no_load_speed - speed) / span, T::ZERO, T::ONE);
        }
        let (low, high) = if qd >= T::ZERO {
            (-self.torque, driving)
        } else {
            (-driving, self.torque)
        };
        math::clamp(command, low, high)
    }
}

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
    use super::{Motor, Stops};
    use rbd_core::JointLimits;

    #[test]
    fn a_motor_drives_along_its_line_and_brakes_fully() {
        let motor = Motor {
            torque: 30.0,
            knee_speed: 10.0,
            no_load_speed: 20.0,
        };
        assert_eq!(motor.deliver(50.0, 5.0), 30.0);
        assert_eq!(motor.deliver(50.0, 15.0), 15.0);
        assert_eq!(motor.deliver(50.0, 25.0), 0.0);
        assert_eq!(motor.deliver(-50.0, 15.0), -30.0);
        assert_eq!(motor.deliver(-50.0, -15.0), -15.0);
        assert_eq!(motor.deliver(7.0, 5.0), 7.0);
    }

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
