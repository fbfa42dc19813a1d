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

    /// One step of Heun's midpoint rule; the forces on the feet in the middle, world axes.
    pub(crate) fn step(
        &mut self,
        q: &mut State,
        v: &mut Velocity,
        torques: &[f64; JOINTS],
        contacts: &[bool; LEGS],
        h: f64,
    ) -> [Vector3<f64>; LEGS] {
        let (first, _) = self.acceleration(q, v, torques, contacts);
        let half = *v + first * (0.5 * h);
        let middle = integrate(q, &(*v * (0.5 * h)));
        let (rate, forces_w) = self.acceleration(&middle, &half, torques, contacts);
        *q = integrate(q, &(half * h));
        *v = *v + rate * h;
        forces_w
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
