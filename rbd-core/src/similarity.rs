//! How gains follow from the size of a robot: dynamic similarity, or Froude's law.
//!
//! Two robots that differ only in size move alike under the same gravity if their lengths are as L, their masses as M and their times
//! as √L, for then the Froude number v²/(g ℓ) is the same. Every other quantity follows from its unit; stiffnesses and dampings are
//! those of springs and dampers that do the same in the time of the robot.
//!
//! Gains in this workspace are therefore written down as numbers of one reference robot, of 13.741 kg with legs of 0.4 m, on which they
//! were measured, and a [`Build`] makes them those of another: L and M are its leg and its mass in those of the reference.
//!
//! What does not scale: shares and angles; the friction of the ground; and times that are not the body's, such as periods, the age of
//! measurements, and time constants of filters, drives and sensors.

use so3::{Scalar, math};

/// Mass of the reference robot, kg.
const MASS: f64 = 13.741;
/// Leg of the reference robot, m.
const LEG_LENGTH: f64 = 0.4;

/// The size of a robot, from which its gains follow.
///
/// All numbers must be positive and finite, as a robot's are; others give gains that are not.
///
/// ```
/// use rbd_core::Build;
///
/// // Twice as long and eight times as heavy as the robot that the numbers are of.
/// let large = Build { mass: 8.0 * 13.741, leg_length: 0.8, inertia_b: [4.5, 12.0, 13.0] };
/// assert_eq!(large.force(20.0), 160.0);
/// assert_eq!(large.torque(10.0), 160.0);
/// assert_eq!(large.stiffness(200.0), 800.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Build<T> {
    /// Mass of the whole robot, kg.
    pub mass: T,
    /// Length of a stretched leg from the joint that swings it to the foot, m.
    pub leg_length: T,
    /// Composite inertia about the centre of mass in the posture in which it lands, about x, y, z, base axes, kg m².
    pub inertia_b: [T; 3],
}

impl Build<f64> {
    /// The same build in single precision, for `static` items of model crates.
    #[must_use]
    pub const fn to_f32(&self) -> Build<f32> {
        let [x, y, z] = self.inertia_b;
        Build {
            mass: self.mass as f32,
            leg_length: self.leg_length as f32,
            inertia_b: [x as f32, y as f32, z as f32],
        }
    }

    /// The same build in either precision, for code that is generic over it.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> Build<T> {
        Build {
            mass: T::of(self.mass),
            leg_length: T::of(self.leg_length),
            inertia_b: self.inertia_b.map(T::of),
        }
    }
}

impl<T: Scalar> Build<T> {
    /// A length, m: ∝ L.
    #[must_use]
    pub fn length(&self, reference: f64) -> T {
        T::of(reference) * self.lengths()
    }

    /// The square of a length, m²: ∝ L².
    #[must_use]
    pub fn area(&self, reference: f64) -> T {
        T::of(reference) * (self.lengths() * self.lengths())
    }

    /// A time of the body, s: ∝ √L, as of a pendulum or a fall.
    #[must_use]
    pub fn time(&self, reference: f64) -> T {
        T::of(reference) * self.times()
    }

    /// A rate, 1/s or rad/s: ∝ 1/√L.
    #[must_use]
    pub fn rate(&self, reference: f64) -> T {
        T::of(reference) / self.times()
    }

    /// An acceleration per way, 1/s²: ∝ 1/L.
    #[must_use]
    pub fn rate_squared(&self, reference: f64) -> T {
        T::of(reference) / self.lengths()
    }

    /// A speed, m/s: ∝ √L.
    #[must_use]
    pub fn speed(&self, reference: f64) -> T {
        T::of(reference) * self.times()
    }

    /// A force, N: ∝ M, as a weight.
    #[must_use]
    pub fn force(&self, reference: f64) -> T {
        T::of(reference) * self.masses()
    }

    /// A torque, N m: ∝ M L.
    #[must_use]
    pub fn torque(&self, reference: f64) -> T {
        T::of(reference) * (self.masses() * self.lengths())
    }

    /// A force per way, N/m: ∝ M/L.
    #[must_use]
    pub fn stiffness(&self, reference: f64) -> T {
        T::of(reference) * (self.masses() / self.lengths())
    }

    /// A force per speed, N s/m: ∝ M/√L.
    #[must_use]
    pub fn damping(&self, reference: f64) -> T {
        T::of(reference) * (self.masses() / self.times())
    }

    /// A torque per angle, N m/rad: ∝ M L.
    #[must_use]
    pub fn joint_stiffness(&self, reference: f64) -> T {
        self.torque(reference)
    }

    /// A torque per angular velocity, N m s/rad: ∝ M L √L.
    #[must_use]
    pub fn joint_damping(&self, reference: f64) -> T {
        self.torque(reference) * self.times()
    }

    /// A weight on the square of a force, N⁻²: ∝ M⁻².
    #[must_use]
    pub fn per_force_squared(&self, reference: f64) -> T {
        T::of(reference) / (self.masses() * self.masses())
    }

    /// A weight on the square of a torque, (N m)⁻²: ∝ (M L)⁻².
    #[must_use]
    pub fn per_torque_squared(&self, reference: f64) -> T {
        self.per_force_squared(reference) / (self.lengths() * self.lengths())
    }

    /// M; exactly 1 for the reference robot, whose numbers are then left as they are, to the bit.
    fn masses(&self) -> T {
        self.mass / T::of(MASS)
    }

    /// L; exactly 1 for the reference robot.
    fn lengths(&self) -> T {
        self.leg_length / T::of(LEG_LENGTH)
    }

    /// √L; exactly 1 for the reference robot.
    fn times(&self) -> T {
        math::sqrt(self.lengths())
    }
}

#[cfg(test)]
mod tests {
    use super::{Build, LEG_LENGTH, MASS};

    /// A robot so many times as heavy and so many times as long as the reference.
    fn build(masses: f64, lengths: f64) -> Build<f64> {
        Build {
            mass: masses * MASS,
            leg_length: lengths * LEG_LENGTH,
            inertia_b: [1.0; 3],
        }
    }

    /// Every way to scale a number: what it does to the number, and the powers of mass, length and time in its unit.
    fn all(b: &Build<f64>, x: f64) -> [(f64, [i32; 3]); 14] {
        [
            (b.length(x), [0, 1, 0]),
            (b.area(x), [0, 2, 0]),
            (b.time(x), [0, 0, 1]),
            (b.rate(x), [0, 0, -1]),
            (b.rate_squared(x), [0, 0, -2]),
            (b.speed(x), [0, 1, -1]),
            (b.force(x), [1, 1, -2]),
            (b.torque(x), [1, 2, -2]),
            (b.stiffness(x), [1, 0, -2]),
            (b.damping(x), [1, 0, -1]),
            (b.joint_stiffness(x), [1, 2, -2]),
            (b.joint_damping(x), [1, 2, -1]),
            (b.per_force_squared(x), [-2, -2, 4]),
            (b.per_torque_squared(x), [-2, -4, 4]),
        ]
    }

    fn power(x: f64, n: i32) -> f64 {
        let whole = so3::math::powi(x, n.unsigned_abs());
        if n < 0 { 1.0 / whole } else { whole }
    }

    #[test]
    fn every_quantity_scales_as_its_unit_says() {
        for (masses, lengths) in [(8.0, 2.0), (0.3, 0.6), (1.0, 3.0), (5.0, 1.0)] {
            // Gravity is the same for all: times are as the roots of lengths.
            let units = [masses, lengths, so3::math::sqrt(lengths)];
            for (k, (scaled, powers)) in all(&build(masses, lengths), 7.0).into_iter().enumerate() {
                let factors = units.into_iter().zip(powers);
                let factor: f64 = factors.map(|(unit, n)| power(unit, n)).product();
                let off = scaled / (7.0 * factor) - 1.0;
                assert!(off.abs() < 1e-12, "{k}: {scaled}");
            }
        }
    }

    #[test]
    fn the_reference_robot_keeps_its_numbers_to_the_bit() {
        let reference = build(1.0, 1.0);
        for x in [0.1, 15.0, 1e-4, 28.0] {
            assert!(all(&reference, x).iter().all(|(scaled, _)| *scaled == x));
            let single = reference.to_f32();
            assert_eq!(single, reference.cast());
            assert_eq!(single.joint_damping(x), x as f32);
            assert_eq!(single.per_torque_squared(x), x as f32);
        }
    }

    /// A body on a spring and a damper: the same frequency and the same damping in its own time.
    #[test]
    fn similar_robots_swing_alike() {
        let number = |b: &Build<f64>| {
            let frequency = so3::math::sqrt(b.stiffness(200.0) / b.mass) * b.time(1.0);
            let decay = b.damping(5.0) / b.mass * b.time(1.0);
            let sag = b.mass * 9.81 / b.stiffness(200.0) / b.leg_length;
            [frequency, decay, sag]
        };
        let (small, large) = (number(&build(1.0, 1.0)), number(&build(12.0, 2.5)));
        for (small, large) in small.into_iter().zip(large) {
            assert!((large / small - 1.0).abs() < 1e-12);
        }
    }
}
