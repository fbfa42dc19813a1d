//! The robot weighs itself while it waits for its jump.
//!
//! A payload of 5 % is 5 % of take-off speed when the plan's torques are applied as they are. Standing still, the normal forces
//! of the feet add up to the weight m g; their mean over the hold, relative to the weight that was planned with, is the
//! factor for the plan's torques.

use so3::Scalar;

/// Mean normal force of all feet over the hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PayloadEstimate<T> {
    sum: T,
    count: T,
}

impl<T: Scalar> PayloadEstimate<T> {
    /// Nothing weighed yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            sum: T::ZERO,
            count: T::ZERO,
        }
    }

    /// Adds one measurement of the normal forces, N. One that is not finite is left out.
    pub fn add<const F: usize>(&mut self, foot_forces: &[T; F]) {
        let total = foot_forces.iter().fold(T::ZERO, |sum, &f| sum + f);
        if total.is_finite_number() {
            self.sum += total;
            self.count += T::ONE;
        }
    }

    /// Weight measured over `planned_weight`, both N: the factor for the plan's torques in the push-off.
    ///
    /// 1 where nothing was weighed, or where the ratio differs from 1 by more than `most`: a foot sensor is dead then, or
    /// the robot does not stand freely, and neither is a reason to push differently.
    #[must_use]
    pub fn factor(&self, planned_weight: T, most: T) -> T {
        let ratio = self.sum / (self.count * planned_weight);
        if so3::math::abs(ratio - T::ONE) <= most {
            ratio
        } else {
            T::ONE
        }
    }
}

impl<T: Scalar> Default for PayloadEstimate<T> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::PayloadEstimate;

    #[test]
    fn the_mean_weight_scales_and_broken_sensors_do_not() {
        let mut estimate = PayloadEstimate::new();
        assert_eq!(estimate.factor(100.0, 0.15), 1.0);
        estimate.add(&[20.0, 30.0, 25.0, 27.0]);
        estimate.add(&[f64::NAN, 30.0, 25.0, 27.0]);
        estimate.add(&[26.0, 26.0, 26.0, 28.0]);
        assert!((estimate.factor(100.0, 0.15) - 1.04).abs() < 1e-12);
        // A dead sensor: a quarter of the weight is missing.
        let mut dead = PayloadEstimate::new();
        dead.add(&[0.0, 25.0, 25.0, 25.0]);
        assert_eq!(dead.factor(100.0, 0.15), 1.0);
        assert_eq!(estimate.factor(0.0, 0.15), 1.0);
    }
}
