//! The simulated robot: which simulator, in which world.

use super::sensors::World;
use super::task::Task;
use super::{JOINTS, OWNERS, ROBOT};
use crate::lab::{self, Disturbance, Key};
use a1_model::{MOTORS, SHAPES, a1};
use contact_sim::{Block, NativeSimulator, Settings, Terrain};
use nalgebra::Vector3;
use rbd_core::Tangent;

/// How far a box reaches from the middle of a robot on it, m.
const AROUND: f64 = 0.6;

/// A simulator of A1.
type Plant = lab::Plant<JOINTS, OWNERS>;

/// The simulators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Sim {
    /// Our own contact simulator.
    Native,
    /// MuJoCo, in builds with the feature `mujoco`.
    Mujoco,
}

impl Sim {
    /// Its name on the command line and in results.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Native => "native",
            Self::Mujoco => "mujoco",
        }
    }
}

/// Ground, motors and joint losses of the plant.
fn settings(disturbance: &Disturbance) -> Settings<f64, JOINTS> {
    let limits = a1::LIMITS.map(|mut limits| {
        limits.friction = disturbance
            .set_to(Key::JointFriction)
            .unwrap_or(limits.friction);
        limits
    });
    let mut settings = Settings::new(&limits, &MOTORS);
    settings.contact.friction = disturbance.get(Key::Friction);
    settings.contact.time_constant = disturbance.seconds(Key::Ground);
    settings
}

/// The plant at the start of a task.
pub(crate) fn plant(sim: Sim, task: &Task, disturbance: &Disturbance) -> Result<World, String> {
    let mut plant: Plant = match sim {
        Sim::Native => {
            let terrain = terrain(task, height_error(disturbance));
            let robot = lab::robot(disturbance, &ROBOT)?;
            let native = NativeSimulator::new(robot, SHAPES, terrain, settings(disturbance));
            Box::new(native.colliding(pairs(task)))
        }
        Sim::Mujoco => mujoco(task, disturbance)?,
    };
    plant.reset(&task.start, &Tangent::ZERO);
    // A box has its own height; a floor that is start and landing has to move.
    let boxed = task.edge.is_some_and(|edge| edge.drop != 0.0);
    let moves = if boxed {
        0.0
    } else {
        height_error(disturbance)
    };
    Ok(World::new(plant, moves))
}

/// Shapes that touch each other: those that do not where the robot stands.
fn pairs(task: &Task) -> [u64; SHAPES.len()] {
    contact_sim::self_contacts(&ROBOT, &SHAPES, &task.start)
}

/// MuJoCo, with the same shapes.
#[cfg(feature = "mujoco")]
fn mujoco(task: &Task, disturbance: &Disturbance) -> Result<Plant, String> {
    use contact_sim::{Geom, MujocoSimulator};

    let geoms = SHAPES.map(Geom::Swept);
    let mut settings = settings(disturbance);
    settings.substeps = 1;
    let robot = lab::robot(disturbance, &ROBOT)?;
    let terrain = terrain(task, height_error(disturbance));
    let sim = MujocoSimulator::new(&robot, (&geoms, &pairs(task)), &terrain, settings);
    Ok(Box::new(sim.map_err(|error| error.to_string())?))
}

#[cfg(not(feature = "mujoco"))]
fn mujoco(_: &Task, _: &Disturbance) -> Result<Plant, String> {
    Err(NO_MUJOCO.into())
}

/// What a build without MuJoCo says.
#[cfg(not(feature = "mujoco"))]
pub(crate) const NO_MUJOCO: &str = "this build has no MuJoCo: use `cargo xtask mujoco run --release -p saltus --features mujoco -- run ...`";

/// By how much the landing's ground is higher than known, m.
fn height_error(disturbance: &Disturbance) -> f64 {
    disturbance.get(Key::GroundHeight)
}

/// The world of a task, whose landing is `higher` than known, m. The robot starts at height zero: on the floor, with or without a box
/// to jump onto, or on a box with the floor below. Without a box start and landing are on one floor, which [`lab::Ground`] moves.
pub(crate) fn terrain(task: &Task, higher: f64) -> Terrain<f64> {
    let Some(mut edge) = task.edge.filter(|edge| edge.drop != 0.0) else {
        return Terrain::FLAT;
    };
    let onto = edge.drop < 0.0;
    edge.drop -= higher;
    // Around where the robot stands, or lands.
    let middle = if onto { task.goal } else { Vector3::zeros() };
    over_edge(
        onto,
        (edge.axis, edge.sign, edge.distance),
        edge.drop,
        &middle,
        AROUND,
    )
}

/// A floor, and a block that reaches so far `around` a middle and is cut at an edge: (axis across it, side of the landing, distance from the
/// origin). The robot stands at height zero and lands `drop` below; `onto` the block, or off it.
pub(crate) fn over_edge(
    onto: bool,
    (axis, side, distance): (usize, f64, f64),
    drop: f64,
    middle: &Vector3<f64>,
    around: f64,
) -> Terrain<f64> {
    let floor = f64::min(-drop, 0.0);
    let mut lower = [middle.x - around, middle.y - around, floor];
    let mut upper = [middle.x + around, middle.y + around, f64::max(-drop, 0.0)];
    let cut = side * distance;
    if onto == (side > 0.0) {
        lower[axis] = cut;
    } else {
        upper[axis] = cut;
    }
    Terrain {
        floor,
        block: Some(Block { lower, upper }),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::terrain;
    use crate::jump::task::Task;
    use contact_sim::Terrain;
    use nalgebra::Vector3;

    /// Height of the probes over the ground, m.
    const GAP: f64 = 5e-4;

    /// Off and onto boxes, over all four edges: the robot stands on the ground at zero and lands on ground at the height of its goal, and
    /// between them is the edge.
    #[test]
    fn the_robot_stands_and_lands_on_the_ground() {
        let mut task = Task::load("a1/lateral-down").unwrap();
        for drop in [0.3, -0.3] {
            for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
                let edge = task.problem.edge.as_mut().unwrap();
                (edge.drop, edge.axis, edge.sign) = (drop, axis, sign);
                let distance = edge.distance;
                task.edge = task.problem.edge;
                task.goal = Vector3::new(0.1, -0.1, -drop);
                task.goal[axis] = 0.7 * sign;
                let terrain = terrain(&task, 0.0);
                let mut beside = Vector3::zeros();
                beside[axis] = sign * (distance - 1e-3);
                let mut beyond = Vector3::zeros();
                beyond[axis] = sign * (distance + 1e-3);
                for (place, wanted) in [
                    (Vector3::zeros(), 0.0),
                    (beside, 0.0),
                    (beyond, -drop),
                    (task.goal, -drop),
                ] {
                    let probe = place.xy().push(wanted + GAP);
                    let found = terrain.touch(&probe, 0.0).depth;
                    assert!((found + GAP).abs() < 1e-12, "{drop} {axis} {sign} {place}");
                }
            }
        }
        task.edge.as_mut().unwrap().drop = 0.0;
        assert_eq!(terrain(&task, 0.0), Terrain::FLAT);
    }
}
