//! No step of the torque is larger than the motors and the gears like it.
//!
//! Between two controllers, on a fault, at the edge of a plan's interval: whatever is asked, |τ_k − τ_{k−1}| ≤ rate · dt. It
//! stands last, after the motor limits, so that every hand-over is bounded without anybody having to know of it.

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
            let wanted = if wanted.is_finite_number() {
                *wanted
            } else {
                T::ZERO
            };
            *last = math::clamp(wanted, *last - step, *last + step);
        }
        self.last
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
}
