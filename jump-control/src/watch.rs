//! Whether a measurement may be acted on.

use core::fmt;

use rbd_core::{Configuration, Motion, Tangent, Transform};
use so3::Scalar;

/// What the controller is told about the robot, with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement<T: Scalar, const N: usize, const F: usize> {
    /// Pose of the base in the world.
    pub base: Transform<T>,
    /// Velocity of the base, base axes.
    pub base_velocity: Motion<T>,
    /// Joint positions, rad.
    pub joints: [T; N],
    /// Joint velocities, rad/s.
    pub joint_velocities: [T; N],
    /// Normal force on each foot's sensor, N.
    pub foot_forces: [T; F],
    /// Age of the oldest of these numbers, s.
    pub age: T,
}

impl<T: Scalar, const N: usize, const F: usize> Measurement<T, N, F> {
    /// Configuration as measured.
    #[must_use]
    pub const fn configuration(&self) -> Configuration<T, N> {
        Configuration {
            base: self.base,
            joints: self.joints,
        }
    }

    /// Velocity as measured, base part in base axes.
    #[must_use]
    pub const fn velocity(&self) -> Tangent<T, N> {
        Tangent {
            base: self.base_velocity,
            joints: self.joint_velocities,
        }
    }
}

/// Why a measurement may not be acted on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// Position or velocity of this joint is not finite.
    Joint(usize),
    /// Pose or velocity of the base is not finite.
    Base,
    /// Force of this foot is not finite.
    Foot(usize),
    /// The measurement is older than the watch allows, or its age is not a number.
    Stale,
    /// The clock stood still, went backwards, or is not a number.
    Clock,
    /// A control loop did not run for longer than allowed.
    Silent,
    /// A controller's command was not finite.
    Command,
    /// A controller's program had no answer for longer than allowed.
    Unsolved,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Joint(i) => write!(f, "joint {i}: encoder not finite"),
            Self::Base => f.write_str("base: pose or velocity not finite"),
            Self::Foot(i) => write!(f, "foot {i}: force not finite"),
            Self::Stale => f.write_str("measurement too old"),
            Self::Clock => f.write_str("clock not going forward"),
            Self::Silent => f.write_str("control loop not running"),
            Self::Command => f.write_str("command not finite"),
            Self::Unsolved => f.write_str("program without an answer for too long"),
        }
    }
}

/// The watch over measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch<T> {
    /// Oldest measurement to act on, s.
    pub max_age: T,
}

impl<T: Scalar> Watch<T> {
    /// The first fault of a measurement; `None` where it may be acted on. Numbers beyond 10⁶ in units of the SI are as little a
    /// robot's as infinite ones.
    #[must_use]
    pub fn fault<const N: usize, const F: usize>(
        &self,
        measured: &Measurement<T, N, F>,
    ) -> Option<Fault> {
        let fresh = measured.age >= T::ZERO && measured.age <= self.max_age;
        if !fresh {
            return Some(Fault::Stale);
        }
        let joints = Self::joints(&measured.joints, &measured.joint_velocities);
        if joints.is_some() {
            return joints;
        }
        let pose = measured
            .base
            .translation
            .iter()
            .chain(measured.base.rotation.matrix().iter());
        if !(pose.copied().all(|x| possible(&x))
            && measured.base_velocity.to_array().iter().all(possible))
        {
            return Some(Fault::Base);
        }
        measured
            .foot_forces
            .iter()
            .position(|x| !possible(x))
            .map(Fault::Foot)
    }

    /// The first joint whose position or velocity is not a robot's.
    #[must_use]
    pub fn joints<const N: usize>(q: &[T; N], qd: &[T; N]) -> Option<Fault> {
        let mut joints = q.iter().zip(qd);
        joints
            .position(|(q, qd)| !(possible(q) && possible(qd)))
            .map(Fault::Joint)
    }
}

/// Whether this may be a number of a robot, in units of the SI; false for NaN.
fn possible<T: Scalar>(x: &T) -> bool {
    so3::math::abs(*x) <= T::of(1e6)
}

#[cfg(test)]
mod tests {
    use super::{Fault, Measurement, Watch};
    use rbd_core::{Motion, Transform};

    #[test]
    fn every_number_is_watched() {
        let good = Measurement::<f64, 2, 2> {
            base: Transform::IDENTITY,
            base_velocity: Motion::ZERO,
            joints: [0.1, 0.2],
            joint_velocities: [0.0; 2],
            foot_forces: [0.0; 2],
            age: 0.001,
        };
        let watch = Watch { max_age: 0.005 };
        assert_eq!(watch.fault(&good), None);
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            let mut m = good;
            m.joint_velocities[1] = bad;
            assert_eq!(watch.fault(&m), Some(Fault::Joint(1)));
            let mut m = good;
            m.base.translation.y = bad;
            assert_eq!(watch.fault(&m), Some(Fault::Base));
            let mut m = good;
            m.base_velocity.angular.z = bad;
            assert_eq!(watch.fault(&m), Some(Fault::Base));
            let mut m = good;
            m.foot_forces[0] = bad;
            assert_eq!(watch.fault(&m), Some(Fault::Foot(0)));
            let mut m = good;
            m.age = bad;
            assert_eq!(watch.fault(&m), Some(Fault::Stale));
        }
        assert_eq!(
            watch.fault(&Measurement { age: 0.006, ..good }),
            Some(Fault::Stale)
        );
    }
}
