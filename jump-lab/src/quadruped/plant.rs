//! The simulated robot: which simulator, in which world.

use super::{JOINTS, OWNERS, State, World};
use crate::Sim;
use crate::lab::{self, Disturbance, Key};
use contact_sim::{NativeSimulator, Settings, Terrain};
use jump_planner::robot::{Quadruped, SHAPE_COUNT, Shapes};
use jump_planner::task::Task;
use jump_planner::terrain::terrain;
use rbd_core::{Model, TableModel, Tangent};

/// A simulator of a quadruped.
pub type Plant = lab::Plant<JOINTS, OWNERS>;

/// Ground, motors and joint losses of the plant.
fn settings(robot: &Quadruped, disturbance: &Disturbance) -> Settings<f64, JOINTS> {
    let limits = Model::limits(robot).map(|mut limits| {
        limits.friction = disturbance
            .set_to(Key::JointFriction)
            .unwrap_or(limits.friction);
        limits
    });
    let mut settings = Settings::new(&limits, &robot.drives());
    settings.contact.friction = disturbance.get(Key::Friction);
    settings.contact.time_constant = disturbance.seconds(Key::Ground);
    settings
}

/// The ground at the start of a task: a box is as high as it is, a floor where it is known until it moves.
#[must_use]
pub fn ground(task: &Task, disturbance: &Disturbance) -> Terrain<f64> {
    terrain(task, height_error(disturbance))
}

/// The plant at the start of a task.
///
/// # Errors
/// What stands against the disturbed robot or the simulator.
pub fn plant(sim: Sim, task: &Task, disturbance: &Disturbance) -> Result<World, String> {
    let terrain = ground(task, disturbance);
    let mut plant = simulator(sim, &task.robot, (&terrain, &task.start), disturbance)?;
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

/// A robot over a ground, all of whose links collide: with the ground, and with each other but for those that touch in the posture
/// `free`, in which the robot is known to stand free.
///
/// # Errors
/// What stands against the disturbed robot or the simulator.
pub fn simulator(
    sim: Sim,
    robot: &Quadruped,
    (terrain, free): (&Terrain<f64>, &State),
    disturbance: &Disturbance,
) -> Result<Plant, String> {
    let settings = settings(robot, disturbance);
    let pairs = contact_sim::self_contacts(robot, &robot.shapes, free);
    let disturbed = lab::robot(disturbance, robot)?;
    match sim {
        Sim::Native => {
            let native = NativeSimulator::new(disturbed, robot.shapes, *terrain, settings);
            Ok(Box::new(native.colliding(pairs)))
        }
        Sim::Mujoco => mujoco(&disturbed, (&robot.shapes, &pairs), terrain, settings),
    }
}

/// MuJoCo, with the same shapes.
#[cfg(feature = "mujoco")]
fn mujoco(
    robot: &TableModel<f64, JOINTS>,
    (shapes, pairs): (&Shapes, &[u64; SHAPE_COUNT]),
    terrain: &Terrain<f64>,
    mut settings: Settings<f64, JOINTS>,
) -> Result<Plant, String> {
    use contact_sim::{Geom, MujocoSimulator};

    settings.substeps = 1;
    let geoms = shapes.map(Geom::Swept);
    let sim = MujocoSimulator::new(robot, (&geoms, pairs), terrain, settings);
    Ok(Box::new(sim.map_err(|error| error.to_string())?))
}

#[cfg(not(feature = "mujoco"))]
fn mujoco(
    _: &TableModel<f64, JOINTS>,
    _: (&Shapes, &[u64; SHAPE_COUNT]),
    _: &Terrain<f64>,
    _: Settings<f64, JOINTS>,
) -> Result<Plant, String> {
    Err(crate::sim::NO_MUJOCO.into())
}

/// By how much the landing's ground is higher than known, m.
fn height_error(disturbance: &Disturbance) -> f64 {
    disturbance.get(Key::GroundHeight)
}
