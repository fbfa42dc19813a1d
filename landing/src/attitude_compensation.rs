//! Feet held where they are in the world while the body leans.
//!
//! Joints on their targets hold the body to its feet, so a body that leans by δ is pushed along the ground until its joints agree
//! with the lean: on two feet that is how a small lean becomes a large error of speed. A foot that is wanted at Rᵀ R_d r instead
//! of r, with the velocity that goes with it, keeps the place under the body that it has in the plan, seen from the world.

use nalgebra::{Rotation3, Vector3};
use rbd_core::Limbs;
use so3::Scalar;

use crate::least_squares::solve_damped;

/// How the body leans beside its plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeCompensation<T: Scalar> {
    /// Rᵀ R_d.
    pub turn: Rotation3<T>,
    /// ω_d − ω, base axes, rad/s.
    pub rate_b: Vector3<T>,
    /// Tikhonov term on the way of a foot, m²: keeps stretched legs from large motions.
    pub damping: T,
}

impl<T: Scalar> AttitudeCompensation<T> {
    /// Joint displacements, rad, and speeds, rad/s, that turn the feet back by a share of the lean, to first order.
    #[must_use]
    pub fn joints<const N: usize, const F: usize>(
        &self,
        share: T,
        limbs: &Limbs<T, N, F>,
        speeds: &[T; N],
    ) -> ([T; N], [T; N]) {
        let (mut moved, mut rates) = ([T::ZERO; N], [T::ZERO; N]);
        for end in &limbs.ends {
            let foot = &end.position;
            let velocity = end.mul(speeds);
            let way = (self.turn * foot - foot) * share;
            let speed = (self.turn * velocity - velocity + self.rate_b.cross(foot)) * share;
            end.add_tr_mul(&solve_damped(end, self.damping, &way), &mut moved);
            end.add_tr_mul(&solve_damped(end, self.damping, &speed), &mut rates);
        }
        if moved.iter().chain(&rates).all(|x| x.is_finite_number()) {
            (moved, rates)
        } else {
            ([T::ZERO; N], [T::ZERO; N])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::AttitudeCompensation;
    use a1_model::{A1Geared, FEET};
    use nalgebra::{Rotation3, Vector3};
    use rbd_core::{Configuration, Limbs};

    fn limbs(joints: &[f64; 12]) -> Limbs<f64, 12, 4> {
        let q = Configuration {
            joints: *joints,
            ..Configuration::NEUTRAL
        };
        Limbs::new(&A1Geared, &q, &FEET.map(|foot| foot.frame))
    }

    #[test]
    fn feet_keep_place_and_speed_under_a_body_that_leans() {
        let joints: [f64; 12] = core::array::from_fn(|i| [0.1, 0.8, -1.6][i % 3]);
        let speeds: [f64; 12] = core::array::from_fn(|i| [0.4, -1.0, 2.0][i % 3]);
        let compensation = AttitudeCompensation {
            turn: Rotation3::from_euler_angles(0.02, -0.03, 0.01),
            rate_b: Vector3::new(0.2, -0.3, 0.1),
            damping: 1e-3,
        };
        let planned = limbs(&joints);
        for share in [0.0, 0.5, 1.0] {
            let (moved, rates) = compensation.joints(share, &planned, &speeds);
            let held = limbs(&core::array::from_fn(|i| joints[i] + moved[i]));
            for (held, planned) in held.ends.iter().zip(&planned.ends) {
                let foot = planned.position;
                let wanted = foot + (compensation.turn * foot - foot) * share;
                // What is left are the damping of the inverse and the second order.
                assert!((held.position - wanted).norm() < 1e-3 * share + 1e-12);
                let speed = planned.mul(&speeds);
                let wanted =
                    (compensation.turn * speed - speed + compensation.rate_b.cross(&foot)) * share;
                let found = planned.mul(&rates);
                assert!(
                    (found - wanted).norm() < 0.05 * wanted.norm() + 1e-12,
                    "{found} {wanted}"
                );
            }
        }
        let bad = AttitudeCompensation {
            rate_b: Vector3::new(f64::NAN, 0.0, 0.0),
            ..compensation
        };
        assert_eq!(bad.joints(1.0, &planned, &speeds), ([0.0; 12], [0.0; 12]));
    }
}
