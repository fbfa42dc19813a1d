//! The height of the centre of mass from the touchdown to standing.

use so3::{Scalar, math};
use wbc_qp::jump::Absorption;

/// A fall that ends, and a rise from there: since when, and from which height over the feet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recovery<T> {
    /// When it began, s.
    pub(super) start: T,
    /// Height of the centre of mass over the feet then, m.
    pub(super) first: T,
    /// How the fall ends.
    pub(super) absorption: Absorption<T>,
    /// Height to end at, m.
    pub(super) last: T,
    /// Time of the rise, s.
    pub(super) rise_time: T,
}

/// Where the centre of mass shall be, vertically.
#[derive(Clone, Copy, Debug)]
pub(super) struct Height<T> {
    /// Over the feet, m.
    pub(super) height: T,
    /// m/s.
    pub(super) speed: T,
    /// m/s².
    pub(super) acceleration: T,
}

impl<T: Scalar> Recovery<T> {
    /// At the time `t`, s, on the clock of `start`.
    pub(super) fn at(&self, t: T) -> Height<T> {
        let [way, speed, acceleration] = self.absorption.at(t - self.start);
        let left = t - self.start - self.absorption.duration;
        if left < T::ZERO {
            return Height {
                height: self.first + way,
                speed,
                acceleration,
            };
        }
        let of = T::of;
        let x = math::min(left / self.rise_time, T::ONE);
        let rise = self.last - self.first - way;
        let time = self.rise_time;
        Height {
            height: self.first + way + rise * x * x * x * (of(10.0) - x * (of(15.0) - of(6.0) * x)),
            speed: rise * of(30.0) * x * x * (T::ONE - x) * (T::ONE - x) / time,
            acceleration: rise * of(60.0) * x * (T::ONE - x) * (T::ONE - T::TWO * x)
                / (time * time),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Absorption, Recovery};

    #[test]
    fn a_fall_ends_and_the_robot_rises_without_a_jolt() {
        let recovery = Recovery {
            start: 1.0,
            first: 0.45,
            absorption: Absorption::new(-0.9_f64, 0.08, 0.4),
            last: 0.47,
            rise_time: 0.8,
        };
        let begin = recovery.at(1.0);
        assert_eq!((begin.height, begin.speed), (0.45, -0.9));
        let low = recovery.at(1.0 + recovery.absorption.duration);
        assert!((low.height - 0.37).abs() < 1e-12 && low.speed.abs() < 1e-12);
        let end = recovery.at(3.0);
        assert!((end.height - 0.47).abs() < 1e-12);
        assert_eq!((end.speed, end.acceleration.abs()), (0.0, 0.0));
        for i in 0..120 {
            let (t, h) = (1.0 + 0.01 * f64::from(i) + 1.3e-3, 1e-6);
            let (a, b, c) = (recovery.at(t - h), recovery.at(t), recovery.at(t + h));
            assert!(((c.height - a.height) / (2.0 * h) - b.speed).abs() < 1e-6);
            assert!(((c.speed - a.speed) / (2.0 * h) - b.acceleration).abs() < 1e-4);
        }
    }
}
