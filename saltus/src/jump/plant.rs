//! The simulated robot: which simulator, in which world.

use super::{JOINTS, OWNERS, World};
use crate::lab::{self, Disturbance, Key};
use contact_sim::{NativeSimulator, Settings};
use jump_planner::robot::{Quadruped, SHAPE_COUNT};
use jump_planner::task::Task;
use jump_planner::terrain::terrain;
use rbd_core::{Model, Tangent};

/// A simulator of a quadruped.
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

    /// Fails where this build does not have it, before the work that needs it.
    pub(crate) fn check(self) -> Result<(), String> {
        match self {
            #[cfg(not(feature = "mujoco"))]
            Self::Mujoco => Err(NO_MUJOCO.to_owned()),
            _ => Ok(()),
        }
    }
}

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
pub(crate) fn plant(sim: Sim, task: &Task, disturbance: &Disturbance) -> Result<World, String> {
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
    Err(NO_MUJOCO.into())
}

/// What a build without MuJoCo says.
#[cfg(not(feature = "mujoco"))]
pub(crate) const NO_MUJOCO: &str = "this build has no MuJoCo: use `cargo xtask mujoco run --release -p saltus --features mujoco -- run ...`";

/// By how much the landing's ground is higher than known, m.
fn height_error(disturbance: &Disturbance) -> f64 {
    disturbance.get(Key::GroundHeight)
}
