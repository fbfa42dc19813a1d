//! The robot under given torques, by forward dynamics.

use crate::robot::{JOINTS, LEGS, Quadruped, State};
use crate::whole_body::FRICTION_SMOOTHING;
use nalgebra::Vector3;
use rbd_core::{
    AbaWorkspace, BodyMotions, ContactRow, ContactWorkspace, Effort, MassFactors, MassMatrix,
    Model, Posture, Tangent, aba, bias_accelerations, contact_dynamics, crba, integrate,
    joint_friction,
};

pub(super) type Velocity = Tangent<f64, JOINTS>;

/// Rows of all feet.
const ROWS: usize = 3 * LEGS;

/// What a step passes through.
pub(crate) struct Passed {
    /// Configuration and velocity in its middle.
    pub(crate) middle: (State, Velocity),
    /// Forces on the feet at its start, in its middle and at its end, world axes, N.
    pub(crate) forces_w: [[Vector3<f64>; LEGS]; 3],
}

/// How a displacement `u` changes at this velocity: `u' = v + ½ u × v`, and what a step of the fourth order has no use for.
fn displacement_rate(u: &Velocity, v: &Velocity) -> Velocity {
    Velocity {
        base: v.base + u.base.cross(&v.base) * 0.5,
        ..*v
    }
}

/// The largest entry of a velocity or displacement.
pub(super) fn largest(x: &Velocity) -> f64 {
    let parts = x.base.to_array();
    let parts = parts.iter().chain(&x.joints);
    parts.fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// Scratch of the integration.
pub(crate) struct Forward<'a> {
    robot: &'a Quadruped,
    aba: AbaWorkspace<f64, JOINTS>,
    mass: MassMatrix<f64, JOINTS>,
    factors: MassFactors<f64, JOINTS>,
    motions: BodyMotions<f64, JOINTS>,
    contact: Box<ContactWorkspace<f64, JOINTS, ROWS>>,
}

impl<'a> Forward<'a> {
    pub(crate) fn new(robot: &'a Quadruped) -> Self {
        Self {
            robot,
            aba: AbaWorkspace::new(),
            mass: MassMatrix::ZERO,
            factors: MassFactors::new(),
            motions: BodyMotions::ZERO,
            contact: Box::new(ContactWorkspace::new()),
        }
    }

    /// One step of the fourth order, of length `h` (s): the rule of Runge and Kutta on the group of motions, as Munthe-Kaas ("High order
    /// Runge-Kutta methods on manifolds", 1999) has it.
    pub(crate) fn step(
        &mut self,
        q: &mut State,
        v: &mut Velocity,
        torques: &[f64; JOINTS],
        contacts: &[bool; LEGS],
        h: f64,
    ) -> Passed {
        let (from, speed) = (*q, *v);
        let mut at = |u: &Velocity, v: &Velocity| {
            let (a, forces_w) = self.acceleration(&integrate(&from, u), v, torques, contacts);
            (displacement_rate(u, v), a, forces_w)
        };
        let (v1, a1, start_w) = at(&Velocity::ZERO, &speed);
        let (u2, w2) = (v1 * (0.5 * h), speed + a1 * (0.5 * h));
        let (v2, a2, forces2_w) = at(&u2, &w2);
        let (u3, w3) = (v2 * (0.5 * h), speed + a2 * (0.5 * h));
        let (v3, a3, forces3_w) = at(&u3, &w3);
        let (v4, a4, end_w) = at(&(v3 * h), &(speed + a3 * h));
        *q = integrate(&from, &((v1 + (v2 + v3) * 2.0 + v4) * (h / 6.0)));
        *v = speed + (a1 + (a2 + a3) * 2.0 + a4) * (h / 6.0);
        // Each stage in the middle is of the first order there, their mean of the second.
        let middle_w = core::array::from_fn(|leg| (forces2_w[leg] + forces3_w[leg]) * 0.5);
        Passed {
            middle: (integrate(&from, &((u2 + u3) * 0.5)), (w2 + w3) * 0.5),
            forces_w: [start_w, middle_w, end_w],
        }
    }

    /// Acceleration and contact forces; balls that stand roll without slip.
    fn acceleration(
        &mut self,
        q: &State,
        v: &Velocity,
        torques: &[f64; JOINTS],
        contacts: &[bool; LEGS],
    ) -> (Velocity, [Vector3<f64>; LEGS]) {
        let robot = self.robot;
        let posture = Posture::new(robot, q);
        let lost = joint_friction(Model::limits(robot), &v.joints, FRICTION_SMOOTHING);
        let effort = Effort {
            joints: core::array::from_fn(|i| torques[i] + lost[i]),
            ..Effort::ZERO
        };
        let free = aba(robot, &posture, v, &effort, &mut self.aba);
        let mut forces_w = [Vector3::zeros(); LEGS];
        if !contacts.contains(&true) {
            return (free, forces_w);
        }
        crba(robot, &posture, &mut self.mass);
        self.factors.factor(robot, &self.mass);
        bias_accelerations(robot, &posture, v, &mut self.motions);
        let kinematics = robot.poses(q);
        let mut rows = Vec::with_capacity(ROWS);
        for leg in (0..LEGS).filter(|leg| contacts[*leg]) {
            let frame = robot.contact_frame(&kinematics, leg);
            let rot_wf = kinematics.frame(&frame).rotation;
            let omega_w = rot_wf * self.motions.frame_velocity(&frame).angular;
            let point = rot_wf * self.motions.frame_classical_acceleration(&frame).linear;
            // The ground touches ever new points of a rolling ball: the arm from its centre stays upright in the world.
            let arm = Vector3::new(0.0, 0.0, -robot.foot_radius);
            let rolling = point - omega_w.cross(&omega_w.cross(&arm));
            rows.extend(ContactRow::point(
                &robot.jacobian(&kinematics, &frame),
                &rolling,
            ));
        }
        let solved = contact_dynamics(&self.factors, &free, &rows, &mut self.contact);
        let (triples, _) = solved.forces.as_chunks::<3>();
        let standing = (0..LEGS).filter(|leg| contacts[*leg]);
        for (leg, f) in standing.zip(triples) {
            forces_w[leg] = Vector3::from(*f);
        }
        (solved.motion, forces_w)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use rbd_core::{Motion, Transform, difference};

    /// Where a tumbling robot whose legs move is after 8 ms in this many steps.
    fn after(steps: u32, contacts: [bool; LEGS]) -> (State, Velocity) {
        let robot = Quadruped::a1().unwrap();
        let mut q = State {
            base: Transform::new(
                so3::exp(&Vector3::new(0.3, -0.2, 0.5)),
                Vector3::new(0.1, 0.2, 0.5),
            ),
            joints: core::array::from_fn(|i| [0.1, 0.8, -1.6][i % 3] + 0.02 * i as f64),
        };
        let mut v = Velocity {
            base: Motion {
                linear: Vector3::new(1.0, -0.5, 2.0),
                angular: Vector3::new(6.0, -9.0, 4.0),
            },
            joints: core::array::from_fn(|i| 4.0 + 0.3 * i as f64),
        };
        let torques = core::array::from_fn(|i| 6.0 - i as f64);
        let mut forward = Forward::new(&robot);
        for _ in 0..steps {
            forward.step(&mut q, &mut v, &torques, &contacts, 8e-3 / f64::from(steps));
        }
        (q, v)
    }

    fn off((q, v): &(State, Velocity), (to, to_v): &(State, Velocity)) -> f64 {
        largest(&difference(q, to)).max(largest(&(*v - *to_v)))
    }

    #[test]
    fn a_step_is_of_the_fourth_order_in_the_air_and_on_the_ground() {
        for contacts in [[false; LEGS], [true, false, true, false]] {
            let exact = after(256, contacts);
            let [long, short] = [8, 16].map(|steps| off(&after(steps, contacts), &exact));
            let order = so3::math::log(long / short) / so3::math::log(2.0);
            assert!(
                (3.8..4.4).contains(&order),
                "{contacts:?} {long} {short} {order}"
            );
        }
    }

    #[test]
    fn the_middle_of_a_step_is_on_its_way() {
        let robot = Quadruped::a1().unwrap();
        let contacts = [false; LEGS];
        let (mut q, mut v) = after(16, contacts);
        let (mut half_q, mut half_v) = (q, v);
        let mut forward = Forward::new(&robot);
        let passed = forward.step(&mut q, &mut v, &[3.0; JOINTS], &contacts, 5e-4);
        forward.step(&mut half_q, &mut half_v, &[3.0; JOINTS], &contacts, 2.5e-4);
        let error = off(&passed.middle, &(half_q, half_v));
        assert!(error < 1e-6, "{error}");
    }
}
