//! The joint controller, paper A eq. (7), inside what the motor can do.

use rbd_core::Motor;
use so3::{Scalar, math};

/// Gains of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointGains<T> {
    /// `K_p,joint`, N m/rad.
    pub stiffness: T,
    /// `K_d,joint`, N m s/rad.
    pub damping: T,
}

/// What the 1 kHz loop asks of the 10 kHz loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointCommand<T, const N: usize> {
    /// q_d, rad.
    pub position: [T; N],
    /// q̇_d, rad/s.
    pub velocity: [T; N],
    /// τ_ff, N m.
    pub feed_forward: [T; N],
    /// Gains.
    pub gains: [JointGains<T>; N],
}

impl<T: Scalar, const N: usize> JointCommand<T, N> {
    /// The safe command: resist motion with `damping`, N m s/rad, and nothing else.
    #[must_use]
    pub const fn damp(damping: T) -> Self {
        Self {
            position: [T::ZERO; N],
            velocity: [T::ZERO; N],
            feed_forward: [T::ZERO; N],
            gains: [JointGains {
                stiffness: T::ZERO,
                damping,
            }; N],
        }
    }

    /// Whether every number is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let numbers = self.position.iter().chain(&self.velocity);
        let gains = self.gains.iter().flat_map(|g| [g.stiffness, g.damping]);
        numbers
            .chain(&self.feed_forward)
            .copied()
            .chain(gains)
            .all(Scalar::is_finite_number)
    }

    /// Eq. (7): τ = τ_ff + K_p(q_d − q) + K_d(q̇_d − q̇), inside the motors' limits; zero at joints whose
    /// measurement or command is not a number.
    #[inline]
    #[must_use]
    pub fn torques(&self, q: &[T; N], qd: &[T; N], motors: &[Motor<T>; N]) -> [T; N] {
        let mut torques = self.feed_forward;
        let wanted = self.position.iter().zip(&self.velocity).zip(&self.gains);
        let measured = q.iter().zip(qd).zip(motors);
        for ((tau, ((q_d, qd_d), gains)), ((q, qd), motor)) in
            torques.iter_mut().zip(wanted).zip(measured)
        {
            // A damping command must not depend on the position sensor.
            let spring = if gains.stiffness == T::ZERO {
                T::ZERO
            } else {
                gains.stiffness * (*q_d - *q)
            };
            let wanted = *tau + spring + gains.damping * (*qd_d - *qd);
            let [low, high] = motor.torque_range(*qd);
            *tau = if wanted.is_finite_number() {
                math::clamp(wanted, low, high)
            } else {
                T::ZERO
            };
        }
        torques
    }
}

#[cfg(test)]
mod tests {
    use super::{JointCommand, JointGains};
    use rbd_core::Motor;

    const MOTOR: Motor<f64> = Motor {
        gear: 9.0,
        torque: 30.0,
        corner_speed: 10.0,
        no_load_speed: 20.0,
        rotor_inertia: 0.0,
    };

    #[test]
    fn limits_hold_for_every_input() {
        let numbers = [0.0, 5.0, -15.0, 1e300, -1e300, f64::NAN, f64::INFINITY];
        for x in numbers {
            for y in numbers {
                for z in numbers {
                    let command = JointCommand {
                        position: [x],
                        velocity: [y],
                        feed_forward: [z],
                        gains: [JointGains {
                            stiffness: 50.0,
                            damping: 1.0,
                        }],
                    };
                    assert!(command.torques(&[y], &[z], &[MOTOR])[0].abs() <= 30.0);
                    assert!(command.torques(&[z], &[x], &[MOTOR])[0].abs() <= 30.0);
                }
            }
        }
    }

    #[test]
    fn damping_needs_no_position() {
        let command = JointCommand::<f64, 1>::damp(2.0);
        assert_eq!(command.torques(&[f64::NAN], &[3.0], &[MOTOR]), [-6.0]);
        assert_eq!(command.torques(&[0.0], &[f64::NAN], &[MOTOR]), [0.0]);
    }

    /// A command is finite as long as all its numbers are, however large, and no longer when any one of them is not.
    #[test]
    fn one_number_that_is_not_finite_is_enough() {
        let finite = JointCommand {
            position: [1.0, -f64::MAX],
            velocity: [0.0, 2.0],
            feed_forward: [f64::MAX, -3.0],
            gains: [JointGains {
                stiffness: 50.0,
                damping: f64::MIN_POSITIVE,
            }; 2],
        };
        assert!(finite.is_finite());
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for joint in 0..2 {
                let mut spoilt = [finite; 5];
                spoilt[0].position[joint] = bad;
                spoilt[1].velocity[joint] = bad;
                spoilt[2].feed_forward[joint] = bad;
                spoilt[3].gains[joint].stiffness = bad;
                spoilt[4].gains[joint].damping = bad;
                let found = spoilt.map(|command| command.is_finite());
                assert_eq!(found, [false; 5], "{bad} at joint {joint}");
            }
        }
    }

    #[test]
    fn equation_seven() {
        let command = JointCommand {
            position: [1.0],
            velocity: [2.0],
            feed_forward: [3.0],
            gains: [JointGains {
                stiffness: 10.0,
                damping: 0.5,
            }],
        };
        let tau = command.torques(&[0.9], &[1.0], &[MOTOR]);
        assert!((tau[0] - (3.0 + 1.0 + 0.5)).abs() < 1e-12);
    }
}
