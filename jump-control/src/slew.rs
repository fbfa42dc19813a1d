//! No step of the torque is larger than the motors and the gears like it.
//!
//! Between two controllers, on a fault, at the edge of a plan's interval: whatever is asked, |τ_k − τ_{k−1}| ≤ rate · dt. It
//! stands last, after the motor limits, so that every hand-over is bounded without anybody having to know of it.
//!
//! Joints that are limited one by one reach their torques one after the other, and the forces of the feet on the way there are nobody's: a
//! knee that still pushes while its hip has let go turns the body. [`Slew::limit_together`] keeps the direction of the change.

use so3::{Scalar, math};

/// A limit on the rate of the torques of `N` joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slew<T, const N: usize> {
    /// Largest rate, N m/s.
    pub rate: T,
    last: [T; N],
}

impl<T: Scalar, const N: usize> Slew<T, N> {
    /// From zero torque; 10 kN m/s takes motors of 33.5 N m from zero to full in 3 ms.
    #[must_use]
    pub const fn new(rate: T) -> Self {
        Self {
            rate,
            last: [T::ZERO; N],
        }
    }

    /// The torques to apply for the next `dt` seconds. What is not a number counts as zero torque; a step of time that is not
    /// positive keeps the last torques.
    pub fn limit(&mut self, wanted: &[T; N], dt: T) -> [T; N] {
        let step = self.rate * dt;
        let step = if step > T::ZERO { step } else { T::ZERO };
        for (last, wanted) in self.last.iter_mut().zip(wanted) {
            let wanted = torque(*wanted);
            *last = math::clamp(wanted, *last - step, *last + step);
        }
        self.last
    }

    /// As [`Slew::limit`], but all joints go the same share of their way, the largest with which none exceeds the rate:
    /// τ_k = τ_{k−1} + s (τ − τ_{k−1}), s = min(1, rate · dt / max |τ − τ_{k−1}|).
    pub fn limit_together(&mut self, wanted: &[T; N], dt: T) -> [T; N] {
        let ways = self.last.iter().zip(wanted);
        let most = ways.fold(T::ZERO, |most, (last, wanted)| {
            math::max(most, math::abs(torque(*wanted) - *last))
        });
        let step = self.rate * dt;
        if most <= step || !most.is_finite_number() {
            return self.limit(wanted, dt);
        }
        let share = if step > T::ZERO { step / most } else { T::ZERO };
        for (last, wanted) in self.last.iter_mut().zip(wanted) {
            *last += (torque(*wanted) - *last) * share;
        }
        self.last
    }
}

/// What is not a number is no torque.
fn torque<T: Scalar>(wanted: T) -> T {
    if wanted.is_finite_number() {
        wanted
    } else {
        T::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::Slew;

    #[test]
    fn steps_are_bounded_and_the_target_is_reached() {
        let mut slew = Slew::<f64, 2>::new(1e4);
        let mut last = [0.0; 2];
        for wanted in [[33.5, -33.5], [-33.5, 0.0], [f64::NAN, f64::INFINITY]] {
            for _ in 0..70 {
                let now = slew.limit(&wanted, 1e-4);
                for (now, last) in now.iter().zip(&last) {
                    assert!((now - last).abs() <= 1.0 + 1e-12 && now.abs() <= 33.5);
                }
                last = now;
            }
            let settled = wanted.map(|x| if x.is_finite() { x } else { 0.0 });
            assert_eq!(last, settled);
        }
        for dt in [0.0, -1.0, f64::NAN] {
            assert_eq!(slew.limit(&[5.0, 5.0], dt), last);
        }
    }

    #[test]
    fn torques_that_are_limited_together_go_straight() {
        let mut slew = Slew::<f64, 3>::new(1e4);
        let wanted = [10.0, -4.0, 0.5];
        for k in 1..=10 {
            let now = slew.limit_together(&wanted, 1e-4);
            let share = f64::from(k) / 10.0;
            for (now, wanted) in now.iter().zip(wanted) {
                assert!((now - share * wanted).abs() < 1e-12, "{now}");
            }
        }
        assert_eq!(slew.limit_together(&wanted, 1e-4), wanted);
        // What is not a number is no torque, and the others do not wait for it for ever.
        for _ in 0..10 {
            let now = slew.limit_together(&[f64::NAN, 6.0, f64::INFINITY], 1e-4);
            assert!(now[0] <= 10.0 && now[2] <= 0.5);
        }
        assert_eq!(slew.limit_together(&[0.0, 6.0, 0.0], 1e-4), [0.0, 6.0, 0.0]);
        for dt in [0.0, -1.0, f64::NAN] {
            assert_eq!(slew.limit_together(&[5.0; 3], dt), [0.0, 6.0, 0.0]);
        }
        // Ways that are no numbers are those of each alone.
        let mut far = Slew::<f64, 2>::new(f64::MAX);
        far.limit_together(&[f64::MAX, 1.0], 1.0);
        let back = far.limit_together(&[-f64::MAX, 1.0], 1.0);
        assert!(back.iter().all(|tau| tau.is_finite()), "{back:?}");
    }
}
