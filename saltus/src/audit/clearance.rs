//! Whether the robot, with the shapes of all its links, passes through the ground, a box or itself.

use super::Held;
use crate::jump::plant::over_edge;
use crate::robot::{JOINTS, LEGS, Quadruped, Shapes, State};
use a1_model::OWNERS;
use contact_sim::{Terrain, gaps, self_contacts};
use jump_control::container::GroundStep;
use nalgebra::Vector3;
use rbd_core::Kinematics;

/// How far a box reaches, m: beyond everything.
const FAR: f64 = 10.0;
/// What ends the names of these margins.
const KINDS: [&str; 2] = ["to the ground", "to the robot"];

/// The shapes of a robot in the world of a plan.
pub(super) struct Clearance {
    shapes: &'static Shapes,
    pairs: [u64; a1_model::SHAPES.len()],
    terrain: Terrain<f64>,
}

impl Clearance {
    /// Shapes that touch where the robot `start`s may touch always. `None` where the robot's shapes are not known.
    pub(super) fn new(
        robot: &Quadruped,
        ground: Option<GroundStep>,
        start: &State,
    ) -> Option<Self> {
        let shapes = robot.shapes?;
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
        Some(Self {
            shapes,
            pairs: self_contacts(robot, shapes, start),
            terrain,
        })
    }

    /// Names of the margins: of every link to the ground and to the rest of the robot.
    pub(super) fn names(&self) -> impl Iterator<Item = String> + use<> {
        OWNERS
            .iter()
            .flat_map(|owner| KINDS.map(|kind| format!("{owner} {kind}")))
    }

    /// The smallest gaps in the order of the names, m. Feet that stand touch the ground, and so may all in the last interval.
    pub(super) fn gaps(
        &self,
        kinematics: &Kinematics<f64, JOINTS>,
        held: &Held,
    ) -> impl Iterator<Item = f64> + use<> {
        let mut found = [[f64::INFINITY; 2]; OWNERS.len()];
        gaps(
            kinematics,
            self.shapes,
            &self.pairs,
            &self.terrain,
            |i, other, gap| {
                let owner = self.shapes[i].owner;
                match other {
                    None if owner < LEGS && (held.contacts[owner] || held.last) => {}
                    None => found[owner][0] = f64::min(found[owner][0], gap),
                    Some(j) => {
                        for owner in [owner, self.shapes[j].owner] {
                            found[owner][1] = f64::min(found[owner][1], gap);
                        }
                    }
                }
            },
        );
        found.into_iter().flatten()
    }
}

/// Whether a margin is one of these.
pub(super) fn is_clearance(name: &str) -> bool {
    KINDS.iter().any(|kind| name.ends_with(kind))
}
