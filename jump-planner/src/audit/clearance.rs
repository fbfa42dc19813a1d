//! Whether the robot, with the shapes of all its links, passes through the ground, a box or itself.

use super::Limit;
use super::interval::Held;
use crate::robot::{JOINTS, LEGS, OWNER_COUNT, Quadruped, SHAPE_COUNT, State};
use crate::terrain::over_edge;
use contact_sim::{Terrain, gaps, self_contacts};
use jump_control::container::GroundStep;
use nalgebra::Vector3;
use rbd_core::Kinematics;

/// How far a box reaches, m: beyond everything.
const FAR: f64 = 10.0;
/// The kinds of these margins, and what ends their names.
const KINDS: [(Limit, &str); 2] = [
    (Limit::Ground, "to the ground"),
    (Limit::Robot, "to the robot"),
];

/// Two shapes of a robot that pass through each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Overlap {
    /// The shapes.
    pub(crate) shapes: [usize; 2],
    /// The gap between them where they are deepest in each other, negative, m.
    pub(crate) gap: f64,
}

/// The shapes of a robot in the world of a plan.
pub(crate) struct Clearance {
    robot: Quadruped,
    pairs: [u64; SHAPE_COUNT],
    terrain: Terrain<f64>,
}

impl Clearance {
    /// Shapes that touch where the robot `start`s may touch always.
    pub(crate) fn new(robot: &Quadruped, ground: Option<GroundStep>, start: &State) -> Self {
        let terrain = ground.map_or(Terrain::FLAT, |step| {
            let edge = (
                usize::from(step.axis),
                f64::from(step.side),
                f64::from(step.distance),
            );
            over_edge(
                step.drop < 0.0,
                edge,
                f64::from(step.drop),
                &Vector3::zeros(),
                FAR,
            )
        });
        Self {
            robot: *robot,
            pairs: self_contacts(robot, &robot.shapes, start),
            terrain,
        }
    }

    /// Kinds and names of the margins: of every link to the ground and to the rest of the robot.
    pub(crate) fn names(&self) -> impl Iterator<Item = (Limit, String)> + use<> {
        self.robot
            .owners
            .into_iter()
            .flat_map(|owner| KINDS.map(|(kind, name)| (kind, format!("{owner} {name}"))))
    }

    /// The smallest gaps in the order of the names, m, and shapes that pass through each other. Feet that stand touch the ground, and so may
    /// all in the last interval.
    pub(crate) fn gaps(
        &self,
        kinematics: &Kinematics<f64, JOINTS>,
        held: &Held,
        mut overlaps: impl FnMut(Overlap),
    ) -> [f64; 2 * OWNER_COUNT] {
        let mut found = [[f64::INFINITY; 2]; OWNER_COUNT];
        gaps(
            kinematics,
            &self.robot.shapes,
            &self.pairs,
            &self.terrain,
            |i, other, gap| {
                let owner = self.robot.shapes[i].owner;
                match other {
                    None if owner < LEGS && (held.contacts[owner] || held.last) => {}
                    None => found[owner][0] = f64::min(found[owner][0], gap),
                    Some(j) => {
                        for owner in [owner, self.robot.shapes[j].owner] {
                            found[owner][1] = f64::min(found[owner][1], gap);
                        }
                        if gap < 0.0 {
                            overlaps(Overlap {
                                shapes: [i, j],
                                gap,
                            });
                        }
                    }
                }
            },
        );
        core::array::from_fn(|i| found[i / 2][i % 2])
    }
}
