//! Limits of joints as bounds on the next velocity, acceleration or torque.
//!
//! # Horizons
//! A position limit must act before it is reached. At the level of velocities the bound is q̇ ≤ (q⁺ − q)/h_q: the
//! distance may be used up in a time h_q, not faster. At the level of accelerations the velocity allowed is
//! v⁺ = min(q̇⁺, (q⁺ − q)/h_q) and the bound q̈ ≤ (v⁺ − q̇)/h_v: a joint that rides on it obeys
//! q̈ = ((q⁺ − q)/h_q − q̇)/h_v, which does not overshoot for h_q ≥ 4 h_v.
//!
//! # What yields
//! Rest stays allowed at the level of velocities: a joint beyond its limit may stand still but not go further, so that
//! contacts and limits never contradict each other. At the level of accelerations the cap on |q̈| stays where position and
//! velocity ask for more.

use rbd_core::{JointLimits, Motor};
use so3::{Scalar, math};

/// Horizons and caps of joint limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon<T> {
    /// h_q, s: time in which the distance to a position limit may be used up.
    pub position: T,
    /// h_v, s: time in which the distance to a velocity limit may be used up.
    pub velocity: T,
    /// Largest |q̈|, rad/s² or m/s².
    pub acceleration: T,
}

impl Horizon<f64> {
    /// The same in either precision.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Horizon<T> {
        Horizon {
            position: T::of(self.position),
            velocity: T::of(self.velocity),
            acceleration: T::of(self.acceleration),
        }
    }
}

impl<T: Scalar> Horizon<T> {
    /// Lowest and highest velocity of a joint at position `q`, rad/s.
    #[must_use]
    pub fn velocity_range(&self, limits: &JointLimits<T>, q: T) -> [T; 2] {
        let low = math::max(-limits.speed, (limits.lower - q) / self.position);
        let high = math::min(limits.speed, (limits.upper - q) / self.position);
        [math::min(low, T::ZERO), math::max(high, T::ZERO)]
    }

    /// Least rate of a quantity that is to stay above zero and is `distance` above it: −d/h_q, m/s. Below zero it has to rise.
    #[must_use]
    pub fn least_rate(&self, distance: T) -> T {
        -distance / self.position
    }

    /// Least acceleration of a quantity that is to stay above zero, m/s²: ((−d/h_q) − ḋ)/h_v inside the cap.
    #[must_use]
    pub fn least_acceleration(&self, distance: T, rate: T) -> T {
        let wanted = (self.least_rate(distance) - rate) / self.velocity;
        math::clamp(wanted, -self.acceleration, self.acceleration)
    }

    /// Lowest and highest acceleration of a joint at position `q` and velocity `qd`, rad/s².
    #[must_use]
    pub fn acceleration_range(&self, limits: &JointLimits<T>, q: T, qd: T) -> [T; 2] {
        let low = math::max(-limits.speed, (limits.lower - q) / self.position);
        let high = math::min(limits.speed, (limits.upper - q) / self.position);
        let cap = |v: T| {
            math::clamp(
                (v - qd) / self.velocity,
                -self.acceleration,
                self.acceleration,
            )
        };
        [cap(math::min(low, high)), cap(math::max(low, high))]
    }
}

/// Torques that a motor can give at speed `qd`, its speed–torque line and a limit on |τ q̇|, W, included.
#[must_use]
pub fn torque_range<T: Scalar>(motor: &Motor<T>, qd: T, max_power: T) -> [T; 2] {
    let [low, high] = motor.torque_range(qd);
    let most = max_power / math::abs(qd);
    if most.is_nan_number() {
        return [low, high];
    }
    [math::max(low, -most), math::min(high, most)]
}

#[cfg(test)]
mod tests {
    use super::{Horizon, torque_range};
    use rbd_core::{JointLimits, Motor};

    const LIMITS: JointLimits<f64> = JointLimits {
        lower: -1.0,
        upper: 1.0,
        speed: 5.0,
        ..JointLimits::NONE
    };
    const HORIZON: Horizon<f64> = Horizon {
        position: 0.04,
        velocity: 0.01,
        acceleration: 1e3,
    };

    /// A joint that always takes the highest acceleration allowed stops at its limit and breaks no other.
    #[test]
    fn riding_on_the_bounds_overshoots_nothing() {
        for start in [-1.0, 0.0, 0.8] {
            let (mut q, mut qd) = (start, 0.0);
            for _ in 0..5000 {
                let [low, high] = HORIZON.acceleration_range(&LIMITS, q, qd);
                assert!(low <= high);
                q += 1e-3 * qd + 0.5e-6 * high;
                qd += 1e-3 * high;
                assert!(q <= 1.0 + 1e-9 && qd <= 5.0 + 1e-9, "{q} {qd}");
            }
            assert!((q - 1.0).abs() < 1e-6, "stopped at {q}");
        }
    }

    /// What always takes its least acceleration comes to zero and not below: on the way at the rate −d/h_q, reached within h_v, and by no
    /// more than the cap.
    #[test]
    fn riding_on_the_least_acceleration_ends_at_zero() {
        for start in [0.01, 0.1, 1.0] {
            let (mut d, mut rate) = (start, 0.0);
            for _ in 0..5000 {
                let wanted = HORIZON.least_acceleration(d, rate);
                assert!(wanted.abs() <= 1e3);
                d += 1e-4 * rate + 0.5e-8 * wanted;
                rate += 1e-4 * wanted;
                assert!(d > -1e-9, "{start}: {d}");
            }
            assert!(d < 1e-4 * start, "{start}: ended at {d}");
        }
        // −0.02 m / 0.04 s is 0.4 m/s faster than −0.1 m/s: in 0.01 s.
        assert!((HORIZON.least_acceleration(0.02, -0.1) + 40.0).abs() < 1e-12);
        assert_eq!(HORIZON.least_acceleration(0.02, 100.0), -1e3);
        assert_eq!(HORIZON.least_acceleration(0.02, -100.0), 1e3);
    }

    #[test]
    fn rest_is_always_allowed_at_the_level_of_velocities() {
        for q in [-3.0, -1.0, 0.0, 0.999, 1.0, 2.0] {
            let [low, high] = HORIZON.velocity_range(&LIMITS, q);
            assert!(low <= 0.0 && high >= 0.0);
            if q >= 1.0 {
                assert_eq!(high, 0.0);
            }
        }
    }

    #[test]
    fn power_cuts_torque() {
        let motor = Motor {
            gear: 100.0,
            torque: 30.0,
            corner_speed: 4.0,
            no_load_speed: 8.0,
            rotor_inertia: 0.0,
        };
        assert_eq!(torque_range(&motor, 2.0, 40.0), [-20.0, 20.0]);
        assert_eq!(torque_range(&motor, 6.0, 1e9), [-30.0, 15.0]);
        assert_eq!(torque_range(&motor, 0.0, 40.0), [-30.0, 30.0]);
    }
}
