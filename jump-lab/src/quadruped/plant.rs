//! The simulated robot: which simulator, in which world.

use super::{JOINTS, OWNERS, World};
use crate::Sim;
use crate::lab::{self, Disturbance, Key};
use contact_sim::{NativeSimulator, Settings};
use jump_planner::robot::{Quadruped, SHAPE_COUNT};
use jump_planner::task::Task;
use jump_planner::terrain::terrain;
use rbd_core::{Model, Tangent};

/// A simulator of a quadruped.
type Plant = lab::Plant<JOINTS, OWNERS>;

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

/// The plant at the start of a task.
///
/// # Errors
/// What stands against the disturbed robot or the simulator.
pub fn plant(sim: Sim, task: &Task, disturbance: &Disturbance) -> Result<World, String> {
    let mut plant: Plant = match sim {
        Sim::Native => {
            let terrain = terrain(task, height_error(disturbance));
            let robot = lab::robot(disturbance, &task.robot)?;
            let native = NativeSimulator::new(
                robot,
                task.robot.shapes,
                terrain,
                settings(&task.robot, disturbance),
            );
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
fn pairs(task: &Task) -> [u64; SHAPE_COUNT] {
    contact_sim::self_contacts(&task.robot, &task.robot.shapes, &task.start)
}

/// MuJoCo, with the same shapes.
#[cfg(feature = "mujoco")]
fn mujoco(task: &Task, disturbance: &Disturbance) -> Result<Plant, String> {
    use contact_sim::{Geom, MujocoSimulator};

    let geoms = task.robot.shapes.map(Geom::Swept);
    let mut settings = settings(&task.robot, disturbance);
    settings.substeps = 1;
    let robot = lab::robot(disturbance, &task.robot)?;
    let terrain = terrain(task, height_error(disturbance));
    let sim = MujocoSimulator::new(&robot, (&geoms, &pairs(task)), &terrain, settings);
    Ok(Box::new(sim.map_err(|error| error.to_string())?))
}

#[cfg(not(feature = "mujoco"))]
fn mujoco(_: &Task, _: &Disturbance) -> Result<Plant, String> {
    Err(crate::sim::NO_MUJOCO.into())
}

/// By how much the landing's ground is higher than known, m.
fn height_error(disturbance: &Disturbance) -> f64 {
    disturbance.get(Key::GroundHeight)
}
