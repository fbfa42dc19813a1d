//! What a URDF does not say of a robot's hardware, by rules that it does say enough for.

use super::{Data, JOINTS, LEGS, OWNER_COUNT, Quadruped, SHAPE_COUNT, Shapes, State};
use crate::stored::joint_name;
use nalgebra::Vector3;
use rbd_core::{Body, Budgets, Build, Link, Model, Motor, Shape, TableError, TableModel, Tree};

/// Speed at which a motor without data has nothing left, over its speed limit.
const NO_LOAD: f64 = 1.25;
/// Half the thickness of a shank, as a share of its length.
const SHANK: f64 = 0.04;
/// Half the thickness of a thigh, as a share of its length.
const THIGH: f64 = 0.08;
/// Half the thickness of a hip, as a share of the leg.
const HIP: f64 = 0.06;
/// Rounding of the trunk's edges, as a share of its shortest side.
const ROUNDING: f64 = 0.25;
/// Torque of a joint that is no motor's, in weights of the robot times the length of its leg: one leg alone would throw the robot up
/// with more than ten times its weight.
const NO_MOTOR: f64 = 10.0;
/// Speed of a joint that is no motor's, rad/s.
const NO_GEAR: f64 = 100.0;

impl Quadruped {
    /// Its motors. Where only limits are known, a motor gives its torque up to the speed limit and nothing from a quarter more on; heat
    /// and supply then count for nothing.
    #[must_use]
    pub fn drives(&self) -> [Motor<f64>; JOINTS] {
        if let Some(motors) = Model::motors(self) {
            return *motors;
        }
        let limits: &[_; JOINTS] = Model::limits(self);
        let bodies = Tree::<f64, JOINTS>::bodies(self);
        core::array::from_fn(|i| Motor {
            gear: 1.0,
            torque: limits[i].effort,
            corner_speed: limits[i].speed,
            no_load_speed: NO_LOAD * limits[i].speed,
            rotor_inertia: bodies[i].rotor_inertia,
        })
    }

    /// Its size, from which the gains of its controllers follow; the inertia is that of the standing robot.
    #[must_use]
    pub fn build(&self, standing: &State) -> Build<f64> {
        let inertia = self.locked_inertia(standing);
        self.build.over(Build {
            mass: self.mass(),
            leg_length: self.leg_length,
            inertia_b: [inertia[(0, 0)], inertia[(1, 1)], inertia[(2, 2)]],
        })
    }

    /// Length, width and height of the trunk's box, m.
    #[must_use]
    pub fn trunk(&self) -> [f64; 3] {
        let [first, .., last] = self.corners;
        (first - last).abs().into()
    }

    /// Limits that no motor has: placeholders of the URDF, with which a plan may promise what the robot cannot do.
    #[must_use]
    pub fn placeholders(&self) -> Vec<String> {
        let scale = self.weight() * self.leg_length;
        let limits: &[_; JOINTS] = Model::limits(self);
        let named = |what: &str, unit: &str, of: &dyn Fn(usize) -> f64, most: f64| {
            let beyond: Vec<usize> = (0..JOINTS).filter(|i| of(*i) > most).collect();
            let first = *beyond.first()?;
            Some(format!(
                "{what} limits of {} joints ({}: {} {unit}) are placeholders: no motor of this robot gives more than {most:.0} {unit}",
                beyond.len(),
                joint_name(self, first),
                of(first),
            ))
        };
        let effort = named("effort", "N m", &|i| limits[i].effort, NO_MOTOR * scale);
        let speed = named("velocity", "rad/s", &|i| limits[i].speed, NO_GEAR);
        effort.into_iter().chain(speed).collect()
    }

    /// Links that are in each other where the robot stands, though neither hangs from the other: no plan, audit or simulator sees them
    /// collide. Each pair once.
    #[must_use]
    pub fn overlapping(&self, standing: &State) -> Vec<[&'static str; 2]> {
        let mut links: Vec<[&'static str; 2]> = Vec::new();
        let pairs = contact_sim::overlaps(self, &self.shapes, standing);
        for (i, others) in pairs.into_iter().enumerate() {
            for j in (0..self.shapes.len()).filter(|j| (others >> j) & 1 == 1) {
                let pair = [i, j].map(|shape| self.owners[self.shapes[shape].owner]);
                if !links.contains(&pair) {
                    links.push(pair);
                }
            }
        }
        links
    }
}

/// Budgets of a robot of which only the limits are known: times as for any legged robot, stops that bear what its strongest motor
/// gives, landings of ten weights, and nothing of heat and supply.
pub(crate) fn budgets(strongest: f64) -> Budgets {
    Budgets {
        saturation: [0.010, 0.010, 0.050],
        stop_time: 0.010,
        stop_torque: strongest,
        overspeed: 0.005,
        ground_force: 10.0,
        winding_heat: f64::INFINITY,
        torque_constant: 1.0,
        resistance: 0.0,
        supply_power: f64::INFINITY,
    }
}

/// The same robot, whose joints feel the rotors of these motors.
pub(crate) fn geared(
    table: &TableModel<f64, JOINTS>,
    motors: &[Motor<f64>; JOINTS],
) -> Result<TableModel<f64, JOINTS>, TableError> {
    let mut bodies: [Body<f64>; JOINTS] = *table.bodies();
    for (body, motor) in bodies.iter_mut().zip(motors) {
        body.rotor_inertia = motor.rotor_inertia;
    }
    TableModel::with_any_inertia(table.base_kind(), *table.base(), &bodies)
}

/// Corners of a box around the origin of half this size, in the order of `Data::corners`.
pub(crate) fn corners(half: &Vector3<f64>) -> [Vector3<f64>; 8] {
    core::array::from_fn(|i| {
        let side = |bit: usize| if (i >> bit) & 1 == 0 { 1.0 } else { -1.0 };
        half.component_mul(&Vector3::new(side(2), side(1), side(0)))
    })
}

/// Names of what the forces on the shapes count for.
pub(crate) fn owners(robot: &Quadruped) -> [&'static str; OWNER_COUNT] {
    core::array::from_fn(|i| {
        let (kind, leg) = (i / LEGS, i % LEGS);
        match ["foot", "shank", "thigh", "hip"].get(kind) {
            Some(kind) => super::urdf::leaked(&format!("{}_{kind}", robot.place(leg))),
            None => "trunk",
        }
    })
}

/// Shapes along the joints: shanks from the knee to the ball of the foot, thighs and hips from joint to joint, and the edges of the
/// trunk's box with the middles of its upper and lower sides.
pub(crate) fn shapes(data: &Data) -> Shapes {
    let bodies = data.table.bodies();
    let mut out = [Shape::ball(Link::Base, [0.0; 3], 0.0, 0); SHAPE_COUNT];
    for leg in 0..LEGS {
        let foot = &data.feet[leg];
        out[leg] = Shape::ball(foot.link, foot.offset, data.foot_radius, leg);
        let tip = Vector3::from(foot.offset);
        // Ends inside of the ball, so that the ball touches first.
        let thin = data.limbs.shank_radius_m.unwrap_or(SHANK * tip.norm());
        let end = tip * (1.0 - f64::max(data.foot_radius, 3.0 * thin) / tip.norm());
        out[LEGS + leg] = limb(3 * leg + 2, &end, thin, LEGS + leg);
        let knee = Vector3::from(bodies[3 * leg + 2].offset);
        let thick = data.limbs.thigh_radius_m;
        let thick = thick.unwrap_or(THIGH * knee.norm());
        out[2 * LEGS + leg] = limb(3 * leg + 1, &knee, thick, 2 * LEGS + leg);
        let beside = Vector3::from(bodies[3 * leg + 1].offset);
        let round = data.limbs.hip_radius_m;
        let round = round.unwrap_or(HIP * data.leg_length);
        out[3 * LEGS + leg] = limb(3 * leg, &beside, round, 3 * LEGS + leg);
    }
    for (slot, (from, to, radius)) in out[4 * LEGS..].iter_mut().zip(trunk(&data.corners)) {
        *slot = Shape {
            link: Link::Base,
            from: from.into(),
            to: to.into(),
            radius,
            owner: 4 * LEGS,
        };
    }
    out
}

/// A capsule from a joint to a place in its link.
fn limb(joint: usize, to: &Vector3<f64>, radius: f64, owner: usize) -> Shape<f64> {
    Shape {
        link: Link::Joint(joint),
        from: [0.0; 3],
        to: (*to).into(),
        radius,
        owner,
    }
}

/// Capsules of a box with these corners, in the order of `Data::corners`.
fn trunk(corners: &[Vector3<f64>; 8]) -> Vec<(Vector3<f64>, Vector3<f64>, f64)> {
    let middle = corners.iter().sum::<Vector3<f64>>() / 8.0;
    let side = |a: usize, b: usize| (corners[a] - corners[b]).norm();
    let shortest = side(0, 1).min(side(0, 2)).min(side(0, 4));
    let radius = ROUNDING * shortest;
    // Each corner is drawn in by the radius along all three sides.
    let inner = corners.map(|corner| {
        let out = corner - middle;
        middle + out - out.map(|x| radius * x.signum())
    });
    let at = |x: usize, y: usize, z: usize| inner[4 * x + 2 * y + z];
    let half = |x: usize, z: usize| 0.5 * (at(x, 0, z) + at(x, 1, z));
    let level = |z: usize| {
        [
            (at(1, 0, z), at(0, 0, z), radius),
            (at(1, 1, z), at(0, 1, z), radius),
            (half(1, z), half(0, z), radius),
            (at(0, 1, z), at(0, 0, z), radius),
            (at(1, 1, z), at(1, 0, z), radius),
        ]
    };
    [level(0), level(1)].concat()
}
