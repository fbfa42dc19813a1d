//! A wrong turning of the base damped through the push-off, by the feet that push.
//!
//! Joint control does not see how the whole robot leans: with every joint on its target, ground that yields by a
//! millimetre lets it lean a little, and on two feet what leans topples, e-fold in a tenth of a second. Forces of the feet can
//! damp it, by a couple c (ω_d − ω) against turning too fast or too slowly.
//!
//! With w_i the planned normal forces on the feet, r̄ the feet's weighted mean, and λ from
//! Σ (r_i − r̄) × w_i (λ × (r_i − r̄)) = c (ω_d − ω): Δf_i = w_i λ × (r_i − r̄). These forces sum to zero: they push nowhere.

use nalgebra::{Matrix3, Vector3};
use rbd_core::Build;
use so3::Scalar;
use so3::math;

use crate::container::parts;
use crate::plan::Plan;

/// Gains of the base in the push-off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseFeedback<T> {
    /// c, about all axes, N m s/rad; zero switches the feedback off.
    pub turning: T,
    /// Largest share of its planned normal force by which the force on a foot is changed: what friction leaves.
    pub share: T,
}

impl<T: Scalar> BaseFeedback<T> {
    /// Gains for a robot of this size whose base is estimated: its turning rate alone is fed back, which gyroscopes know.
    ///
    /// 5 N m s/rad are those of a robot of 13.741 kg with legs of 0.4 m, scaled by [dynamic similarity](rbd_core::similarity): a turn
    /// too fast by 0.1 rad/s is answered by 0.5 N m.
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        Self {
            turning: build.joint_damping(5.0),
            share: T::of(0.3),
        }
    }

    /// Forces of the ground on the feet, base axes, N, that are wanted besides the plan's at `time`; they are zero on feet
    /// that the plan does not push with, before its first node and after its last.
    ///
    /// `node` is the one before `time`, `omega_b` the measured turning rate, base axes, rad/s, `feet_b` the positions of the feet, base
    /// axes, m.
    #[must_use]
    pub fn forces<const N: usize, const F: usize>(
        &self,
        plan: &Plan<'_, T, N, F>,
        (node, time): (usize, T),
        omega_b: &Vector3<T>,
        feet_b: &[Vector3<T>; F],
    ) -> [Vector3<T>; F] {
        let none = [Vector3::zeros(); F];
        let Some(planned) = plan.base((node, time)) else {
            return none;
        };
        let moment = (planned.omega_b - omega_b) * self.turning;
        plan.following::<{ parts::FORCES }, _>(node, |nodes| {
            nodes.first().map_or(none, |node| {
                let weights = node.forces_w.map(|force| math::max(force.z, T::ZERO));
                self.couple(&weights, feet_b, &moment)
            })
        })
    }

    /// Forces that turn by the `moment`, shared as the `weights` of the feet are, all smaller by one factor where a foot would be asked
    /// for more than its share.
    fn couple<const F: usize>(
        &self,
        weights: &[T; F],
        feet_b: &[Vector3<T>; F],
        moment: &Vector3<T>,
    ) -> [Vector3<T>; F] {
        let mut forces = [Vector3::zeros(); F];
        let (mut sum, mut middle) = (T::ZERO, Vector3::zeros());
        for (&w, foot) in weights.iter().zip(feet_b) {
            sum += w;
            middle += foot * w;
        }
        // Also false for NaN.
        let pushing = sum > T::ZERO;
        if !pushing {
            return forces;
        }
        middle /= sum;
        let arms = feet_b.map(|foot| foot - middle);
        let turn = lambda(weights, &arms, moment);
        let mut scale = T::ONE;
        for (force, (&w, arm)) in forces.iter_mut().zip(weights.iter().zip(&arms)) {
            *force = turn.cross(arm) * w;
            let size = math::sqrt(force.norm_squared());
            if size * scale > w * self.share {
                scale = w * self.share / size;
            }
        }
        for force in &mut forces {
            *force *= scale;
        }
        forces
    }
}

/// λ, for feet at `arms` from their weighted mean.
fn lambda<T: Scalar, const F: usize>(
    weights: &[T; F],
    arms: &[Vector3<T>; F],
    moment: &Vector3<T>,
) -> Vector3<T> {
    let mut spread = Matrix3::zeros();
    for (&w, r) in weights.iter().zip(arms) {
        spread += (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * w;
    }
    // Forces on two feet turn nothing about the line between them: wanting it fades out rather than grows.
    spread += Matrix3::identity() * (spread.trace() * T::of(1e-3));
    spread.try_inverse().unwrap_or_else(Matrix3::zeros) * moment
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use nalgebra::{Rotation3, Vector3};
    use rbd_core::{Motion, Transform};

    use super::BaseFeedback;
    use crate::{Node, Plan, Torques};

    const FEET: [Vector3<f64>; 4] = [
        Vector3::new(0.2, 0.15, -0.3),
        Vector3::new(0.2, -0.15, -0.3),
        Vector3::new(-0.2, 0.15, -0.3),
        Vector3::new(-0.2, -0.15, -0.3),
    ];
    const GAINS: BaseFeedback<f64> = BaseFeedback {
        turning: 5.0,
        share: 0.3,
    };
    /// The planned turning rate at the first node.
    const OMEGA: Vector3<f64> = Vector3::new(0.0, 0.5, 0.1);

    fn node(time: f64, weights: [f64; 4]) -> Node<f64, 1, 4> {
        Node {
            time,
            base: Transform::new(
                Rotation3::from_euler_angles(0.1, 0.2 + 0.5 * time, -0.3),
                Vector3::new(0.3 * time, 0.0, 0.3),
            ),
            base_velocity: Motion::new(Vector3::new(0.3, 0.1, 0.2), OMEGA + Vector3::x() * time),
            forces_w: weights.map(|w| Vector3::new(0.0, 0.0, w)),
            ..Node::ZERO
        }
    }

    fn wanted(weights: [f64; 4], at: (usize, f64), omega_b: Vector3<f64>) -> [Vector3<f64>; 4] {
        let nodes = [node(0.0, weights), node(0.01, weights)];
        let plan = Plan::new(&nodes, 0.01, 0.01, 0.01, Torques::Hold).unwrap();
        GAINS.forces(&plan, at, &omega_b, &FEET)
    }

    #[test]
    fn nothing_is_wanted_on_the_plan_without_pushing_feet_or_beyond_its_ends() {
        let on_plan = wanted([30.0; 4], (0, 0.0), OMEGA);
        assert!(on_plan.iter().all(|force| force.norm() < 1e-12));
        // Halfway to the next node the plan turns by half of what it gains.
        let halfway = wanted([30.0; 4], (0, 0.005), OMEGA + Vector3::x() * 0.005);
        assert!(halfway.iter().all(|force| force.norm() < 1e-12));
        let off = OMEGA + Vector3::new(0.1, 0.0, 0.0);
        assert_eq!(wanted([0.0; 4], (0, 0.0), off), [Vector3::zeros(); 4]);
        for outside in [(0, -0.1), (1, 0.02), (7, 0.02), (0, f64::NAN)] {
            let forces = wanted([30.0; 4], outside, off);
            assert_eq!(forces, [Vector3::zeros(); 4], "{outside:?}");
        }
    }

    #[test]
    fn forces_push_nowhere_and_turn_about_the_feet_by_the_couple() {
        let spin = Vector3::new(0.03, -0.05, 0.02);
        for weights in [[30.0; 4], [50.0, 40.0, 30.0, 20.0]] {
            let forces = wanted(weights, (0, 0.0), OMEGA + spin);
            let sum: Vector3<f64> = forces.iter().sum();
            assert!(sum.norm() < 1e-9, "{sum}");
            let moments = FEET.iter().zip(&forces).map(|(r, f)| r.cross(f));
            let moment: Vector3<f64> = moments.sum();
            // The thousandth that fades couples out about a line of feet.
            assert!(
                (moment + spin * 5.0).norm() < 5e-3 * spin.norm() * 5.0,
                "{moment}"
            );
        }
    }

    #[test]
    fn no_foot_is_asked_for_more_than_its_share_and_two_feet_not_to_turn_about_their_line() {
        let weights = [90.0, 60.0, 30.0, 0.0];
        let fast = wanted(weights, (0, 0.0), OMEGA + Vector3::new(30.0, -20.0, 10.0));
        let used = |(force, w): (&Vector3<f64>, f64)| force.norm() - 0.3 * w;
        let over = fast.iter().zip(weights).map(used);
        // One foot is at its share and none beyond.
        let most = over.fold(f64::NEG_INFINITY, f64::max);
        assert!(most.abs() < 1e-9, "{most}");
        let rolls = wanted([0.0, 0.0, 60.0, 60.0], (0, 0.0), OMEGA + Vector3::y());
        assert!(rolls.iter().all(|force| force.norm() < 1e-9), "{rolls:?}");
    }
}
