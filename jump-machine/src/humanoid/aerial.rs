//! Joints in the air (paper B, III-C).

use jump_control::MinimumJerk;
use so3::{Scalar, math};

/// The way from the take-off to the landing posture: a minimum jerk from rest, and what is left of the push-off's velocity v:
/// v (1 − x)³ after a share x of the duration T, a way of v T/4.
///
/// A minimum jerk that starts with v alone brakes from nothing: the feet would go on to push. This brakes with 3 v/T at once, harder
/// than the body falls for all T < 3 v/g, and at no time harder than that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aerial<T, const N: usize> {
    /// From rest to rest.
    pub(super) rest: MinimumJerk<T, N>,
    /// Velocities of the joints at the take-off, rad/s.
    pub(super) pushed: [T; N],
}

/// Joints at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointMotion<T, const N: usize> {
    /// rad.
    pub(super) position: [T; N],
    /// rad/s.
    pub(super) velocity: [T; N],
    /// rad/s².
    pub(super) acceleration: [T; N],
}

impl<T: Scalar, const N: usize> Aerial<T, N> {
    /// At rest in a posture for ever.
    pub(super) const fn resting(joints: &[T; N]) -> Self {
        Self {
            rest: MinimumJerk {
                from: *joints,
                velocity: [T::ZERO; N],
                to: *joints,
                duration: T::ONE,
            },
            pushed: [T::ZERO; N],
        }
    }

    /// A time after the take-off, s.
    pub(super) fn at(&self, time: T) -> JointMotion<T, N> {
        let all = self.rest.duration;
        let x = math::clamp(time / all, T::ZERO, T::ONE);
        let left = T::ONE - x;
        let quarter = T::of(0.25);
        let mut rest = self.rest;
        for (to, v) in rest.to.iter_mut().zip(&self.pushed) {
            *to -= quarter * *v * all;
        }
        let (mut position, mut velocity) = rest.at(time);
        let mut acceleration = [T::ZERO; N];
        let joints = position
            .iter_mut()
            .zip(&mut velocity)
            .zip(&mut acceleration);
        let ends = self.pushed.iter().zip(rest.from.iter().zip(&rest.to));
        for (((q, qd), qdd), (v, (from, to))) in joints.zip(ends) {
            *q += quarter * *v * all * (T::ONE - left * left * left * left);
            *qd += *v * left * left * left;
            let way = *to - *from;
            *qdd = T::of(60.0) * way * x * left * (T::ONE - T::TWO * x) / (all * all)
                - T::of(3.0) * *v * left * left / all;
        }
        JointMotion {
            position,
            velocity,
            acceleration,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Aerial, MinimumJerk};

    #[test]
    fn velocity_and_acceleration_are_derivatives_and_the_ends_are_as_wanted() {
        let aerial = Aerial::<f64, 1> {
            rest: MinimumJerk {
                from: [0.3],
                velocity: [0.0],
                to: [-0.7],
                duration: 0.2,
            },
            pushed: [5.0],
        };
        let start = aerial.at(0.0);
        assert_eq!((start.position, start.velocity), ([0.3], [5.0]));
        assert!((start.acceleration[0] + 3.0 * 5.0 / 0.2).abs() < 1e-9);
        let end = aerial.at(0.3);
        assert!((end.position[0] + 0.7).abs() < 1e-12 && end.velocity[0].abs() < 1e-12);
        for i in 0..20 {
            let (t, h) = (0.01 * f64::from(i) + 1e-3, 1e-6);
            let (a, b, c) = (aerial.at(t - h), aerial.at(t), aerial.at(t + h));
            let slope = |a: f64, c: f64| (c - a) / (2.0 * h);
            assert!((slope(a.position[0], c.position[0]) - b.velocity[0]).abs() < 1e-6);
            assert!((slope(a.velocity[0], c.velocity[0]) - b.acceleration[0]).abs() < 1e-4);
        }
    }
}
