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
    /// Forces on the feet at its start and in its middle, world axes, N.
    pub(crate) forces_w: [[Vector3<f64>; LEGS]; 2],
}

/// How a displacement `u` changes at this velocity: `u' = v + ½ u × v + ¹⁄₁₂ u × (u × v)`, and terms of the fourth order, which a step has no use for.
fn displacement_rate(u: &Velocity, v: &Velocity) -> Velocity {
    let once = u.base.cross(&v.base);
    Velocity {
        base: v.base + once * 0.5 + u.base.cross(&once) * (1.0 / 12.0),
        ..*v
    }
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
        let (v4, a4, _) = at(&(v3 * h), &(speed + a3 * h));
        *q = integrate(&from, &((v1 + (v2 + v3) * 2.0 + v4) * (h / 6.0)));
        *v = speed + (a1 + (a2 + a3) * 2.0 + a4) * (h / 6.0);
        // Each stage in the middle is of the first order there, their mean of the second.
        let between = forces2_w.iter().zip(&forces3_w).map(|(a, b)| (a + b) * 0.5);
        let mut middle_w = [Vector3::zeros(); LEGS];
        middle_w
            .iter_mut()
            .zip(between)
            .for_each(|(f, mean)| *f = mean);
        Passed {
            middle: (integrate(&from, &((u2 + u3) * 0.5)), (w2 + w3) * 0.5),
            forces_w: [start_w, middle_w],
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
