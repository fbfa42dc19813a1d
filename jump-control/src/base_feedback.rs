//! The base kept on its plan through the push-off, by the feet that push.
//!
//! Joint control does not see how the whole robot leans: with every joint on its target, ground that yields by a
//! millimetre lets it lean a little, and on two feet what leans topples, e-fold in a tenth of a second. Forces can hold it:
//! m (k e + d ė) along the ground, e how far the base is from its plan, and a couple c (ω_d − ω) against turning too fast
//! or too slowly.
//!
//! The plan's own forces are joint torques, so they lean with the body: a lean δ is a push f δ that nobody planned, and with
//! it an exponential. Turned back by (R_wbᵀ − R_dᵀ) f they keep the direction that they have in the world, and what is
//! left of the exponential are errors that grow no faster than time squared.
//!
//! With w_i the planned normal forces on the feet, r̄ the feet's weighted mean, and λ from
//! Σ (r_i − r̄) × w_i (λ × (r_i − r̄)) = c (ω_d − ω): Δf_i = w_i λ × (r_i − r̄) + (w_i / Σ w) m (k e + d ė).

use nalgebra::{Matrix3, Vector3};
use rbd_core::Build;
use so3::Scalar;
use so3::math;

use crate::Measurement;
use crate::container::parts;
use crate::plan::{Plan, PlannedBase};

/// Gains of the base in the push-off; all zero switch it off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseFeedback<T> {
    /// k, along the ground, 1/s².
    pub stiffness: T,
    /// d, along the ground, 1/s.
    pub damping: T,
    /// c, about all axes, N m s/rad.
    pub turning: T,
    /// Share of the body's lean by which the plan's forces are turned back: 1 keeps their direction in the world.
    pub direction: T,
    /// Share of the body's lean by which the feet's places are turned back while fewer than all feet push.
    pub compensation: T,
    /// Largest share of its planned normal force by which the force on a foot is changed: what friction leaves.
    pub share: T,
}

impl<T: Scalar> BaseFeedback<T> {
    /// Gains for a robot of this size whose base is estimated: its turning rate alone, which gyroscopes know. Centimetres per second, by
    /// which the estimate of its speed is off, would be amplified: of 20 disturbed double backflips of A1 three fell.
    ///
    /// 5 N m s/rad are those of a robot of 13.741 kg with legs of 0.4 m, scaled by [dynamic similarity](rbd_core::similarity): a turn
    /// too fast by 0.1 rad/s is answered by 0.5 N m.
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        Self {
            stiffness: T::ZERO,
            damping: T::ZERO,
            turning: build.joint_damping(5.0),
            direction: T::ONE,
            compensation: T::of(0.25),
            share: T::of(0.3),
        }
    }

    /// The share of the lean by which feet's places are turned back after `node`: on all feet the legs hold the attitude instead.
    #[must_use]
    pub fn compensation<const N: usize, const F: usize>(
        &self,
        plan: &Plan<'_, T, N, F>,
        node: usize,
    ) -> T {
        let pushes = |force: &Vector3<T>| force.z > T::ZERO;
        plan.following::<{ parts::FORCES }, _>(node, |nodes| match nodes.first() {
            Some(node) if !node.forces_w.iter().all(pushes) => self.compensation,
            _ => T::ZERO,
        })
    }

    /// Forces of the ground on the feet, base axes, N, that are wanted besides the plan's at `time`; they are zero on feet
    /// that the plan does not push with, before its first node and after its last.
    ///
    /// `node` is the one before `time`, `mass` that of the robot, kg, `feet_b` the positions of the feet, base axes, m.
    #[must_use]
    pub fn forces<const N: usize, const F: usize>(
        &self,
        plan: &Plan<'_, T, N, F>,
        (node, time): (usize, T),
        mass: T,
        measured: &Measurement<T, N, F>,
        feet_b: &[Vector3<T>; F],
    ) -> [Vector3<T>; F] {
        let Some(planned) = plan.base((node, time)) else {
            return [Vector3::zeros(); F];
        };
        plan.following::<{ parts::FORCES }, _>(node, |nodes| match nodes.first() {
            Some(node) => self.forces_beside(&node.forces_w, &planned, mass, measured, feet_b),
            None => [Vector3::zeros(); F],
        })
    }

    /// [`Self::forces`], beside the plan's own.
    fn forces_beside<const N: usize, const F: usize>(
        &self,
        forces_w: &[Vector3<T>; F],
        planned: &PlannedBase<T>,
        mass: T,
        measured: &Measurement<T, N, F>,
        feet_b: &[Vector3<T>; F],
    ) -> [Vector3<T>; F] {
        let mut forces = [Vector3::zeros(); F];
        let weights = forces_w.map(|force| math::max(force.z, T::ZERO));
        let sum = weights.iter().fold(T::ZERO, |sum, &w| sum + w);
        // Also false for NaN.
        let pushing = sum > T::ZERO;
        if !pushing {
            return forces;
        }
        let Measurement {
            base,
            base_velocity,
            ..
        } = measured;
        let rot_bw = base.rotation.inverse();
        let away = planned.pos_w - base.translation;
        let slow = planned.vel_w - base.rotation * base_velocity.linear;
        let mut push_w = (away * self.stiffness + slow * self.damping) * (mass / sum);
        push_w.z = T::ZERO;
        let push_b = rot_bw * push_w;
        let moment = (planned.omega_b - base_velocity.angular) * self.turning;
        let planned_bw = planned.rot_wb.inverse();
        let (middle, turn) = couple(&weights, feet_b, &moment);

        let mut scale = T::ONE;
        let feet = weights.iter().zip(feet_b).zip(forces_w);
        for (force, ((&w, foot), force_w)) in forces.iter_mut().zip(feet) {
            let lean = rot_bw * force_w - planned_bw * force_w;
            *force = (turn.cross(&(foot - middle)) + push_b) * w + lean * self.direction;
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

/// r̄ and λ.
fn couple<T: Scalar, const F: usize>(
    weights: &[T; F],
    feet_b: &[Vector3<T>; F],
    moment: &Vector3<T>,
) -> (Vector3<T>, Vector3<T>) {
    let (mut sum, mut middle) = (T::ZERO, Vector3::zeros());
    for (&w, foot) in weights.iter().zip(feet_b) {
        sum += w;
        middle += foot * w;
    }
    middle /= sum;
    let mut spread = Matrix3::zeros();
    for (&w, foot) in weights.iter().zip(feet_b) {
        let r = foot - middle;
        spread += (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * w;
    }
    // Forces on two feet turn nothing about the line between them: wanting it fades out rather than grows.
    spread += Matrix3::identity() * (spread.trace() * T::of(1e-3));
    let inverse = spread.try_inverse().unwrap_or_else(Matrix3::zeros);
    (middle, inverse * moment)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use nalgebra::{Rotation3, Vector3};
    use rbd_core::{Motion, Transform};

    use super::BaseFeedback;
    use crate::{Measurement, Node, Plan, Torques};

    const FEET: [Vector3<f64>; 4] = [
        Vector3::new(0.2, 0.15, -0.3),
        Vector3::new(0.2, -0.15, -0.3),
        Vector3::new(-0.2, 0.15, -0.3),
        Vector3::new(-0.2, -0.15, -0.3),
    ];
    const GAINS: BaseFeedback<f64> = BaseFeedback {
        stiffness: 40.0,
        damping: 10.0,
        turning: 5.0,
        direction: 0.0,
        compensation: 0.0,
        share: 0.3,
    };

    fn node(time: f64, weights: [f64; 4]) -> Node<f64, 1, 4> {
        Node {
            time,
            base: Transform::new(
                Rotation3::from_euler_angles(0.1, 0.2 + 0.5 * time, -0.3),
                Vector3::new(0.3 * time, 0.0, 0.3),
            ),
            base_velocity: Motion::new(Vector3::new(0.3, 0.1, 0.2), Vector3::new(0.0, 0.5, 0.1)),
            forces_w: weights.map(|w| Vector3::new(0.0, 0.0, w)),
            ..Node::ZERO
        }
    }

    /// Measured as the first node has it, but for what the test changes.
    fn measured(of: &Node<f64, 1, 4>) -> Measurement<f64, 1, 4> {
        Measurement {
            base: of.base,
            base_velocity: of.base_velocity,
            joints: [0.0],
            joint_velocities: [0.0],
            foot_forces: [30.0; 4],
            age: 0.0,
        }
    }

    fn wanted(
        weights: [f64; 4],
        change: impl Fn(&mut Measurement<f64, 1, 4>),
    ) -> [Vector3<f64>; 4] {
        let nodes = [node(0.0, weights), node(0.01, weights)];
        let plan = Plan::new(&nodes, 0.01, 0.01, 0.01, Torques::Hold).unwrap();
        let mut measured = measured(&nodes[0]);
        change(&mut measured);
        GAINS.forces(&plan, (0, 0.0), 13.0, &measured, &FEET)
    }

    #[test]
    fn nothing_is_wanted_on_the_plan_without_pushing_feet_or_beyond_its_ends() {
        let on_plan = wanted([30.0; 4], |_| ());
        assert!(on_plan.iter().all(|force| force.norm() < 1e-12));
        let off = |m: &mut Measurement<f64, 1, 4>| m.base.translation.x += 0.01;
        assert_eq!(wanted([0.0; 4], off), [Vector3::zeros(); 4]);
        let nodes = [node(0.0, [30.0; 4]), node(0.01, [30.0; 4])];
        let plan = Plan::new(&nodes, 0.01, 0.01, 0.01, Torques::Hold).unwrap();
        let mut measured = measured(&nodes[0]);
        off(&mut measured);
        for outside in [(0, -0.1), (1, 0.02), (7, 0.02), (0, f64::NAN)] {
            let forces = GAINS.forces(&plan, outside, 13.0, &measured, &FEET);
            assert_eq!(forces, [Vector3::zeros(); 4], "{outside:?}");
        }
    }

    #[test]
    fn forces_sum_to_the_push_and_turn_about_the_feet_by_the_couple() {
        let shift = Vector3::new(0.004, -0.002, 0.05);
        let spin = Vector3::new(0.03, -0.05, 0.02);
        for weights in [[30.0; 4], [50.0, 40.0, 30.0, 20.0]] {
            let forces = wanted(weights, |m| {
                m.base.translation += shift;
                m.base_velocity.angular += spin;
            });
            let rot_wb = node(0.0, weights).base.rotation;
            let sum_w = rot_wb * forces.iter().sum::<Vector3<f64>>();
            let push_w = -13.0 * 40.0 * Vector3::new(shift.x, shift.y, 0.0);
            assert!((sum_w - push_w).norm() < 1e-9, "{sum_w}");
            let total: f64 = weights.iter().sum();
            let middle = FEET
                .iter()
                .zip(weights)
                .map(|(r, w)| r * w)
                .sum::<Vector3<f64>>()
                / total;
            let moment: Vector3<f64> = FEET
                .iter()
                .zip(&forces)
                .map(|(r, f)| (r - middle).cross(f))
                .sum();
            // The thousandth that fades couples out about a line of feet.
            assert!(
                (moment + spin * 5.0).norm() < 5e-3 * spin.norm() * 5.0,
                "{moment}"
            );
        }
    }

    #[test]
    fn the_plans_forces_keep_their_direction_in_the_world_however_the_body_leans() {
        let gains = BaseFeedback {
            stiffness: 0.0,
            damping: 0.0,
            turning: 0.0,
            direction: 1.0,
            ..GAINS
        };
        let force_w = Vector3::new(-12.0, 7.0, 60.0);
        let mut nodes = [node(0.0, [60.0; 4]), node(0.01, [60.0; 4])];
        for node in &mut nodes {
            node.forces_w = [force_w; 4];
        }
        let plan = Plan::new(&nodes, 0.01, 0.01, 0.01, Torques::Hold).unwrap();
        let mut measured = measured(&nodes[0]);
        let planned_b = measured.base.rotation.inverse() * force_w;
        measured.base.rotation *= Rotation3::from_euler_angles(0.1, -0.15, 0.05);
        for force in gains.forces(&plan, (0, 0.0), 13.0, &measured, &FEET) {
            let sum_w = measured.base.rotation * (planned_b + force);
            assert!((sum_w - force_w).norm() < 1e-9, "{sum_w}");
        }
        // Halfway to the next node the plan itself has turned by half of its rate.
        let halfway = plan.base((0, 0.005)).unwrap();
        measured.base.rotation = halfway.rot_wb;
        let forces = gains.forces(&plan, (0, 0.005), 13.0, &measured, &FEET);
        assert!(forces.iter().all(|force| force.norm() < 1e-9), "{forces:?}");
        let turned = nodes[0].base.rotation.inverse() * halfway.rot_wb;
        let expected = nodes[0].base_velocity.angular * 0.005;
        assert!((so3::log(&turned) - expected).norm() < 1e-12);
    }

    #[test]
    fn feet_are_turned_back_while_fewer_than_all_push() {
        for (weights, compensation) in [([30.0; 4], 0.0), ([0.0, 0.0, 60.0, 60.0], 0.25)] {
            let nodes = [node(0.0, weights), node(0.01, weights)];
            let plan = Plan::new(&nodes, 0.01, 0.01, 0.01, Torques::Hold).unwrap();
            assert_eq!(
                BaseFeedback::new(&a1_model::BUILD).compensation(&plan, 0),
                compensation
            );
            assert_eq!(
                BaseFeedback::new(&a1_model::BUILD).compensation(&plan, 2),
                0.0
            );
        }
    }

    #[test]
    fn no_foot_is_asked_for_more_than_its_share_and_two_feet_not_to_turn_about_their_line() {
        let far = |m: &mut Measurement<f64, 1, 4>| m.base.translation.x += 0.5;
        for (force, w) in wanted([90.0, 60.0, 30.0, 0.0], far)
            .iter()
            .zip([90.0, 60.0, 30.0, 0.0])
        {
            assert!(force.norm() <= 0.3 * w + 1e-9);
        }
        let rolls = wanted([0.0, 0.0, 60.0, 60.0], |m| m.base_velocity.angular.y += 1.0);
        assert!(rolls.iter().all(|force| force.norm() < 1e-9), "{rolls:?}");
    }
}
