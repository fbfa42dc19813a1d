//! Minimum-jerk motion of joints to a posture at rest: the aerial phase of paper B, III-C (its reference \[10\]).
//!
//! q(t) = a + (b − a)(10 x³ − 15 x⁴ + 6 x⁵) + v T (x − 6 x³ + 8 x⁴ − 3 x⁵), x = t/T: of all motions from position a, velocity v
//! and no acceleration to rest at b the one of least ∫ |d³q/dt³|² dt. With the velocity of the push-off for v the soles leave
//! the ground without a jolt.

use so3::{Scalar, math};

/// A motion of N joints to rest at a posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimumJerk<T, const N: usize> {
    /// Posture at time 0.
    pub from: [T; N],
    /// Velocity at time 0, rad/s.
    pub velocity: [T; N],
    /// Posture at `duration` and after.
    pub to: [T; N],
    /// Duration T, s; zero or less is a step.
    pub duration: T,
}

impl<T: Scalar, const N: usize> MinimumJerk<T, N> {
    /// Positions and velocities at a time, held at the ends.
    #[must_use]
    pub fn at(&self, time: T) -> ([T; N], [T; N]) {
        let x = if self.duration > T::ZERO {
            math::clamp(time / self.duration, T::ZERO, T::ONE)
        } else {
            T::ONE
        };
        let share = x * x * x * (T::of(10.0) - x * (T::of(15.0) - x * T::of(6.0)));
        let left = T::ONE - x;
        let rate = if self.duration > T::ZERO {
            T::of(30.0) * x * x * left * left / self.duration
        } else {
            T::ZERO
        };
        let three = T::of(3.0);
        let coast = self.duration * x * left * left * left * (T::ONE + three * x);
        let coast_rate = left * left * (T::ONE + T::TWO * x - T::of(15.0) * x * x);
        let (mut q, mut qd) = (self.from, [T::ZERO; N]);
        let ends = self.velocity.iter().zip(&self.to);
        for ((q, qd), (v, b)) in q.iter_mut().zip(&mut qd).zip(ends) {
            let way = *b - *q;
            *q += way * share + *v * coast;
            *qd = way * rate + *v * coast_rate;
        }
        (q, qd)
    }
}

#[cfg(test)]
mod tests {
    use super::MinimumJerk;

    #[test]
    fn from_rest_to_rest_and_the_velocity_is_the_derivative() {
        let m = MinimumJerk::<f64, 2> {
            from: [0.3, -1.0],
            velocity: [0.0; 2],
            to: [1.3, -1.5],
            duration: 0.15,
        };
        assert_eq!(m.at(-1.0), ([0.3, -1.0], [0.0; 2]));
        let (q, qd) = m.at(0.2);
        assert!((q[0] - 1.3).abs() < 1e-15 && (q[1] + 1.5).abs() < 1e-15 && qd == [0.0; 2]);
        assert!((m.at(0.075).0[0] - 0.8).abs() < 1e-12);
        for i in 1..15 {
            let (t, h) = (0.01 * f64::from(i), 1e-6);
            let difference = (m.at(t + h).0[1] - m.at(t - h).0[1]) / (2.0 * h);
            assert!((difference - m.at(t).1[1]).abs() < 1e-6);
        }
        let moving = MinimumJerk {
            velocity: [4.0, -2.0],
            ..m
        };
        assert_eq!(moving.at(0.0), (m.from, [4.0, -2.0]));
        assert!((moving.at(0.15).0[0] - 1.3).abs() < 1e-15);
        for i in 0..15 {
            let (t, h) = (0.01 * f64::from(i) + 1e-5, 1e-6);
            let difference = (moving.at(t + h).0[0] - moving.at(t - h).0[0]) / (2.0 * h);
            assert!((difference - moving.at(t).1[0]).abs() < 1e-5, "at {t}");
        }
        assert!(
            (moving.at(1e-6).1[0] - 4.0).abs() < 1e-6,
            "no acceleration at the start"
        );
        let step = MinimumJerk { duration: 0.0, ..m };
        assert_eq!(step.at(0.0), (m.to, [0.0; 2]));
    }
}
