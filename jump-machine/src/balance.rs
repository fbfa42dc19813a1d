//! Where a standing robot's centre of mass is, beside where its model has it.
//!
//! Of a robot that stands still the centre of pressure is below the centre of mass. With u upwards, p_i the feet, and φ_i the parts along u of the
//! ground's forces on them,
//!
//! ```text
//! δ = (1 − u uᵀ) (Σ φ_i p_i / Σ φ_i − c)
//! ```
//!
//! is by how much the centre of mass is farther across u than c, that of the model; all in base axes, so the trunk may be tilted. Along u
//! nothing is known. Forces along the ground do not matter where the feet stand on one plane across u.
//!
//! Two witnesses tell the φ_i: the joints, by f_i = J_i⁻ᵀ r_i with r = g(q) − τ, and the foot sensors. A gain that all motors, or all
//! sensors, have in common drops out. What is left is Coulomb friction of the joints, which hides some of the offset, and biases of the
//! sensors. In A1's lab, where offsets are 11 and 5 mm (standard deviation, x and y), the joints are wrong by 3.6 and 2.3 mm, the sensors
//! by 2.9 and 2.1 mm and their mean by 2.4 and 2.0 mm (40 samples): they err apart and about as much, so the mean is the estimate. So it is of
//! Σ φ_i / m g − 1, by how much the robot is heavier, where a common gain does not drop out: those of motors and of sensors have nothing to do with each other.

use landing::solve_damped;
use nalgebra::Vector3;
use rbd_core::Limbs;
use so3::{Scalar, math};

use crate::Centring;

/// What a standing robot is beside its model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found<T: Scalar> {
    /// δ, base axes, m.
    pub(crate) offset_b: Vector3<T>,
    /// By what share it is heavier.
    pub(crate) heavier: T,
}

/// Sums of what joints and foot sensors of a standing robot feel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance<T, const N: usize, const F: usize> {
    /// Σ Jᵀ f, N m.
    felt: [T; N],
    /// Σ f·u, N.
    sensed: [T; F],
    count: T,
}

impl<T: Scalar, const N: usize, const F: usize> Balance<T, N, F> {
    /// Nothing felt yet.
    pub(crate) const fn new() -> Self {
        Self {
            felt: [T::ZERO; N],
            sensed: [T::ZERO; F],
            count: T::ZERO,
        }
    }

    /// Adds a moment: what the joints feel of the ground, Jᵀ f, N m, and what the foot sensors say, N. Where a number is not finite, the moment is left out.
    pub(crate) fn add(&mut self, felt: &[T; N], sensed: &[T; F]) {
        let mut numbers = felt.iter().chain(sensed);
        if !numbers.all(|x| x.is_finite_number()) {
            return;
        }
        let sums = self.felt.iter_mut().chain(&mut self.sensed);
        for (sum, x) in sums.zip(felt.iter().chain(sensed)) {
            *sum += *x;
        }
        self.count += T::ONE;
    }

    /// Where the centre of mass of a robot with these `limbs` is, and by how much it is heavier, whose model weighs `weight`, N, with its centre of mass at `com_b`.
    ///
    /// None where it is not believed: no witness carries about this weight on feet whose middle is within [`Centring::most`], or two that
    /// do contradict each other.
    pub(crate) fn found(
        &self,
        (limbs, up_b): (&Limbs<T, N, F>, &Vector3<T>),
        (weight, com_b): (T, &Vector3<T>),
        limits: &Centring<T>,
    ) -> Option<Found<T>> {
        let joints = limbs.ends.each_ref().map(|end| {
            let force_b = solve_damped(end, T::ZERO, &end.mul(&self.felt));
            force_b.dot(up_b)
        });
        let [felt, sensed] = [&joints, &self.sensed].map(|normal| {
            let (mut sum, mut total) = (Vector3::zeros(), T::ZERO);
            for (end, normal) in limbs.ends.iter().zip(normal) {
                sum += end.position * *normal;
                total += *normal;
            }
            let way: Vector3<T> = sum / total - com_b;
            let offset_b = way - up_b * way.dot(up_b);
            let heavier = total / (self.count * weight) - T::ONE;
            // Also false for NaN.
            let sound = math::abs(heavier) <= limits.heavier
                && offset_b.norm_squared() <= limits.most * limits.most;
            sound.then_some(Found { offset_b, heavier })
        });
        match (felt, sensed) {
            (Some(felt), Some(sensed)) => {
                let apart = (felt.offset_b - sensed.offset_b).norm_squared();
                let agree = apart <= limits.agreement * limits.agreement;
                agree.then_some(Found {
                    offset_b: (felt.offset_b + sensed.offset_b) * T::HALF,
                    heavier: (felt.heavier + sensed.heavier) * T::HALF,
                })
            }
            (felt, sensed) => felt.or(sensed),
        }
    }
}

#[cfg(test)]
mod tests;
