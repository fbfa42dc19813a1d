//! The simulated robot: which simulator, in which world.

use super::{JOINTS, OWNERS, State, World};
use crate::Sim;
use crate::lab::{self, Disturbance, Key};
use contact_sim::{Geom, MujocoSimulator, NativeSimulator, Settings, Terrain};
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use jump_planner::terrain::terrain;
use rbd_core::{Model, TableError, Tangent};

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

/// The plant at the start of a task, on ground as rough as the task says unless `disturbance` says otherwise.
///
/// # Errors
/// What stands against the disturbed robot or the simulator.
pub fn plant(sim: Sim, task: &Task, disturbance: &Disturbance) -> Result<World, String> {
    let terrain = ground(task, disturbance);
    let disturbance = &disturbance.on_ground(task.limits.friction);
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

/// What is wrong with a link whose inertia a plan does with, and a simulator does not.
fn impossible(robot: &Quadruped, body: usize) -> String {
    let moved = Model::joint_names(robot).get(body);
    let link = moved.map_or_else(
        || "the trunk".to_owned(),
        |joint| format!("the link that {joint} moves"),
    );
    format!(
        "{link} cannot be simulated: no body has its moments of inertia, of which each must be at most the sum of the two others; correct them in the URDF"
    )
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
    let mut settings = settings(robot, disturbance);
    let pairs = contact_sim::self_contacts(robot, &robot.shapes, free);
    let disturbed = lab::robot(disturbance, robot).map_err(|error| match error {
        TableError::BadInertia { body } => impossible(robot, body),
        error => error.to_string(),
    })?;
    match sim {
        Sim::Native => {
            let native = NativeSimulator::new(disturbed, robot.shapes, *terrain, settings);
            Ok(Box::new(native.colliding(pairs)))
        }
        Sim::Mujoco(compile) => {
            settings.substeps = 1;
            let geoms = (&robot.shapes.map(Geom::Swept)[..], &pairs[..]);
            let sim = MujocoSimulator::new(compile, &disturbed, geoms, terrain, settings);
            Ok(Box::new(sim.map_err(|error| error.to_string())?))
        }
    }
}

/// By how much the landing's ground is higher than known, m.
pub(super) fn height_error(disturbance: &Disturbance) -> f64 {
    disturbance.get(Key::GroundHeight)
}
