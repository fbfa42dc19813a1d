//! The robot weighs itself while it waits for its jump, with its motors.
//!
//! A payload of 5 %, or motors that are 5 % weaker than they believe, are 5 % of take-off speed when the plan's torques are applied as they
//! are. Standing still with torques τ where the plan has τ_p, the robot holds κ = Σ τ·τ_p / Σ τ_p·τ_p times as hard as planned, the least-squares
//! answer to τ = κ τ_p, and κ is the factor for the plan's torques: it has the weight and the motors' gain in it. Force sensors under the feet would
//! tell the weight alone, and their own gain.

use so3::Scalar;

/// How much harder than planned the robot holds its first posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PayloadEstimate<T> {
    /// Σ τ·τ_p, (N m)².
    along: T,
    /// Σ τ_p·τ_p, (N m)².
    planned: T,
}

impl<T: Scalar> PayloadEstimate<T> {
    /// Nothing weighed yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            along: T::ZERO,
            planned: T::ZERO,
        }
    }

    /// Adds the torques of one moment beside those that are planned for it, N m. Where one is not finite, the moment is left out.
    pub fn add<const N: usize>(&mut self, torques: &[T; N], planned: &[T; N]) {
        let pairs = torques.iter().zip(planned);
        let (along, square) = pairs.fold((T::ZERO, T::ZERO), |(along, square), (&tau, &p)| {
            (along + tau * p, square + p * p)
        });
        if along.is_finite_number() && square.is_finite_number() {
            self.along += along;
            self.planned += square;
        }
    }

    /// κ, the factor for the plan's torques in the push-off.
    ///
    /// 1 where nothing was weighed, or where κ differs from 1 by more than `most`: the robot does not stand freely then, or a motor lies, and
    /// neither is a reason to push differently.
    #[must_use]
    pub fn factor(&self, most: T) -> T {
        let ratio = self.along / self.planned;
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

    const PLANNED: [f64; 3] = [1.0, -2.0, 6.0];

    #[test]
    fn torques_of_a_heavier_robot_scale_and_broken_sensors_do_not() {
        let mut estimate = PayloadEstimate::new();
        assert_eq!(estimate.factor(0.3), 1.0);
        // 10 % more, and a torque of friction that has nothing to do with the weight.
        estimate.add(&[1.1 + 0.2, -2.2 + 0.1, 6.6], &PLANNED);
        estimate.add(&[f64::NAN, -2.0, 6.0], &PLANNED);
        assert!((estimate.factor(0.3) - 1.1).abs() < 1e-12);
        // The robot hangs: its motors hold half of what they should.
        let mut hanging = PayloadEstimate::new();
        hanging.add(&PLANNED.map(|p| 0.5 * p), &PLANNED);
        assert_eq!(hanging.factor(0.3), 1.0);
        // A plan that holds with nothing weighs nothing.
        let mut nothing = PayloadEstimate::new();
        nothing.add(&[1.0; 3], &[0.0; 3]);
        assert_eq!(nothing.factor(0.3), 1.0);
    }
}
