//! Every limit, at one instant.

use super::clearance::Clearance;
use super::interval::{Held, Watched};
use super::{Limit, Margin};
use crate::robot::{JOINTS, LEGS, Quadruped, State};
use crate::stored::joint_name;
use jump_control::container::{GroundStep, Header};
use nalgebra::Vector3;
use rbd_core::{Link, Model, Motor};

use super::forward::Velocity;

/// Share of its torque below its limit at which a joint counts as saturated.
const SATURATED: f64 = 1e-3;

/// The limits of a robot. Ranges: of a joint's position, its limits; of its speed and torque, the largest; of forces, the
/// largest planned normal force of a foot (times friction); of heights and gaps, the leg. In the last interval feet come down, so that their
/// height is no limit there.
pub(crate) struct Limits<'a> {
    robot: &'a Quadruped,
    motors: Option<&'a [Motor<f64>; JOINTS]>,
    ground: Option<GroundStep>,
    clearance: Clearance,
    friction: f64,
    force_range: f64,
    /// Kinds and names.
    limits: Vec<(Limit, String)>,
}

impl<'a> Limits<'a> {
    pub(crate) fn new(robot: &'a Quadruped, header: &Header<'_, JOINTS>, start: &State) -> Self {
        let clearance = Clearance::new(robot, header.ground, start);
        let names = (0..JOINTS).map(|i| joint_name(robot, i));
        let names = names.flat_map(|joint| {
            let of_joint = [
                (Limit::Position, "position"),
                (Limit::Speed, "speed"),
                (Limit::Torque, "torque"),
            ];
            of_joint.map(|(limit, name)| (limit, format!("{joint} {name}")))
        });
        let feet = (0..LEGS).flat_map(|leg| {
            let of_leg = [
                (Limit::Friction, "friction"),
                (Limit::NormalForce, "normal force"),
                (Limit::Height, "foot height"),
                (Limit::Height, "knee height"),
            ];
            of_leg.map(|(limit, name)| (limit, format!("{} {name}", robot.place(leg))))
        });
        Self {
            robot,
            motors: Model::motors(robot),
            ground: header.ground,
            friction: f64::from(header.margins.friction),
            force_range: f64::from(header.margins.max_force),
            limits: names
                .chain(feet)
                .chain([(Limit::Height, "trunk height".to_owned())])
                .chain(clearance.names())
                .collect(),
            clearance,
        }
    }

    /// How many there are.
    pub(super) const fn count(&self) -> usize {
        self.limits.len()
    }

    /// The distances from all limits that were seen.
    pub(super) fn margins(&self, seen: &Watched) -> Vec<Margin> {
        let of = |((limit, name), (value, time)): (&(Limit, String), &(f64, f64))| Margin {
            limit: *limit,
            name: name.clone(),
            value: *value,
            time: *time,
        };
        self.limits.iter().zip(&seen.smallest).map(of).collect()
    }

    /// Looks at a state and the forces then. It stands for the time before it, s, in which torques may have been at their limits.
    pub(super) fn check(
        &self,
        (time, span): (f64, f64),
        (q, v): &(State, Velocity),
        held: &Held,
        forces_w: &[Vector3<f64>; LEGS],
        found: &mut Watched,
    ) {
        let mut values = Vec::with_capacity(self.limits.len());
        let mut saturated = false;
        for (i, limit) in Model::limits(self.robot).iter().enumerate() {
            let inside = f64::min(q.joints[i] - limit.lower, limit.upper - q.joints[i]);
            values.push(inside / (limit.upper - limit.lower));
            let speed = v.joints[i];
            values.push(1.0 - speed.abs() / limit.speed);
            let range = self.motors.map_or([-limit.effort, limit.effort], |motors| {
                motors[i].torque_range(speed)
            });
            let torque = held.torques[i];
            let spare = f64::min(torque - range[0], range[1] - torque) / limit.effort;
            values.push(spare);
            if spare <= SATURATED {
                found.saturation[i] += span;
                saturated = true;
            }
        }
        if saturated {
            found.any_saturation += span;
        }
        let kinematics = self.robot.poses(q);
        for (leg, f) in forces_w.iter().enumerate() {
            if held.contacts[leg] {
                let side = f.xy().norm();
                values.push((self.friction * f.z - side) / (self.friction * self.force_range));
                values.push(f.z / self.force_range);
                values.push(f64::NAN);
            } else {
                values.extend([f64::NAN; 2]);
                let foot = kinematics.frame(&self.robot.feet[leg]).translation;
                let height = self.height(&foot) - self.robot.foot_radius / self.robot.leg_length;
                values.push(if held.last { f64::NAN } else { height });
            }
            values.push(self.height(&kinematics.link(Link::Joint(3 * leg + 2)).translation));
        }
        let corners = self
            .robot
            .corners
            .iter()
            .map(|c| self.height(&q.base.point(c)));
        values.push(corners.fold(f64::INFINITY, f64::min));
        let overlap = |overlap| found.overlap(overlap);
        let gaps = self.clearance.gaps(&kinematics, held, overlap);
        values.extend(gaps.map(|gap| gap / self.robot.leg_length));
        found.remember(time, &values);
    }

    /// Height of a point over the ground in legs.
    fn height(&self, point: &Vector3<f64>) -> f64 {
        let ground = self.ground.map_or(0.0, |step| {
            let across = if step.axis == 0 { point.x } else { point.y };
            if f64::from(step.side) * across > f64::from(step.distance) {
                -f64::from(step.drop)
            } else {
                0.0
            }
        });
        (point.z - ground) / self.robot.leg_length
    }
}
