//! The jumps of paper B: iCub pushes off by the velocity program or the torque program, flies and lands.

pub mod control;
pub mod execute;
pub mod judge;
pub mod log;

use crate::Sim;
use crate::lab::{self, Disturbance, Key};
use contact_sim::{
    Compile, Geom, MujocoSimulator, NativeSimulator, Settings, Shape, Terrain, self_contacts,
};
use core::str::FromStr;
use icub_model::{Icub23GazeboGeared, LIMITS, MOTORS, SOLES, profile, shapes};
use jump_control::ComProfile;
use jump_machine::humanoid::{self, middle_of_feet};
use nalgebra::Vector3;
use rbd_core::{
    BaseKind, Configuration, Kinematics, Motor, Posture, TableModel, Tangent, Tree, center_of_mass,
    forward_kinematics,
};

/// Joints of the robot.
pub const JOINTS: usize = 23;
/// Its feet.
pub const FEET: usize = 2;
/// Balls in the corners of its two soles.
pub const SPHERES: usize = 8;
/// What forces count for: the corners of the soles, then all other links.
pub const OWNERS: usize = SPHERES + shapes::OWNERS.len();
/// Shapes of the native simulator.
const SHAPES: usize = SPHERES + shapes::SHAPES.len();
/// The robot, with the inertias of the Gazebo model that the paper simulated and the rotors behind its gears.
pub const ROBOT: Icub23GazeboGeared = Icub23GazeboGeared;
/// Radius of the balls in the corners of the soles, m.
const CORNER_RADIUS: f64 = 0.005;
/// Magnitude of gravity, m/s².
pub const GRAVITY: f64 = 9.81;

/// Where the robot is.
pub type State = Configuration<f64, JOINTS>;

/// What computes the joints' commands in the push-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Paper B, III-D.
    Velocity,
    /// Paper B, III-E.
    Torque,
}

/// What holds the robot after the push-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Landing {
    /// One torque program through flight and landing.
    Qp,
    /// Servos: minimum jerk in the air, then a compliant hold.
    Hold,
    /// The same with the stiff hold of paper B.
    Stiff,
}

impl Landing {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Qp, Self::Hold, Self::Stiff];

    /// Its name on the command line and in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Qp => "qp",
            Self::Hold => "hold",
            Self::Stiff => "stiff",
        }
    }

    /// What it is, in a line.
    #[must_use]
    pub const fn what(self) -> &'static str {
        match self {
            Self::Qp => "One torque program through flight and landing",
            Self::Hold => "Servos: minimum jerk in the air, then a compliant hold",
            Self::Stiff => "The same with the stiff hold of paper B",
        }
    }
}

impl FromStr for Landing {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|landing| landing.name() == name);
        found.ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("no landing `{name}`; there are {names}")
        })
    }
}

/// A humanoid task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Level of the push-off's program.
    pub level: Level,
    /// Height to gain in flight, m.
    pub height: f64,
    /// Whether the angular momentum is controlled.
    pub momentum: bool,
    /// Share of the joints' torque limits that there is, for motors and controller alike.
    pub torque_share: f64,
    /// Controller of flight and landing.
    pub landing: Landing,
    /// Whether the controller's model has the rotors, which are on the motors' data sheets.
    pub knows_rotors: bool,
}

impl Task {
    /// The task of this name, `None` if it is none of a humanoid.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let level = match name {
            "icub/velocity" => Level::Velocity,
            "icub/torque" => Level::Torque,
            _ => return None,
        };
        Some(Self {
            level,
            height: 0.04,
            momentum: true,
            torque_share: 1.0,
            landing: Landing::Qp,
            knows_rotors: true,
        })
    }

    /// As [`named`](Self::named), with variants behind the name: `+stiff`, paper B's own landing; `+blind`, a controller that does not
    /// know of the rotors; `+3cm`, another height.
    #[must_use]
    pub fn variant(name: &str) -> Option<Self> {
        let mut parts = name.split('+');
        let mut task = Self::named(parts.next()?)?;
        for part in parts {
            match part {
                "stiff" => task.landing = Landing::Stiff,
                "blind" => task.knows_rotors = false,
                height => {
                    let cm: f64 = height.strip_suffix("cm")?.parse().ok()?;
                    task.height = Some(0.01 * cm).filter(|h| *h > 0.0 && *h <= 1.0)?;
                }
            }
        }
        Some(task)
    }

    /// That there is such a jump: height and share of the torques above 0, and up to 1.
    ///
    /// # Errors
    /// What it is that cannot be, by the field's name.
    pub fn check(&self) -> Result<(), String> {
        for (name, x) in [("height", self.height), ("torque_share", self.torque_share)] {
            if !(x > 0.0 && x <= 1.0) {
                return Err(format!("{name}: {x} is not above 0 and up to 1"));
            }
        }
        Ok(())
    }

    /// The motors there are.
    #[must_use]
    pub fn motors(&self) -> [Motor<f64>; JOINTS] {
        MOTORS.map(|motor| Motor {
            torque: self.torque_share * motor.torque,
            ..motor
        })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self.level {
            Level::Velocity => "icub/velocity",
            Level::Torque => "icub/torque",
        }
    }

    /// The push-off of the paper: a displacement of 11 cm.
    ///
    /// # Errors
    /// A height that is not positive.
    pub fn profile(&self) -> Result<ComProfile<f64>, String> {
        profile::rise(self.height)
            .ok_or_else(|| format!("height {} m: a positive height is needed", self.height))
    }
}

/// The model of a controller.
pub type Known = TableModel<f64, JOINTS>;

/// The robot as its controller knows it.
///
/// # Errors
/// What stands against the model.
pub fn known(task: &Task) -> Result<Known, String> {
    let mut bodies = *ROBOT.bodies();
    if !task.knows_rotors {
        for body in &mut bodies {
            body.rotor_inertia = 0.0;
        }
    }
    TableModel::new(BaseKind::Floating, *ROBOT.base(), &bodies).map_err(|error| error.to_string())
}

/// Poses of all bodies.
#[must_use]
pub fn poses(q: &State) -> Kinematics<f64, JOINTS> {
    let mut kinematics = Kinematics::IDENTITY;
    forward_kinematics(&ROBOT, &Posture::new(&ROBOT, q), &mut kinematics);
    kinematics
}

/// Centre of mass in the world.
#[must_use]
pub fn com(q: &State) -> Vector3<f64> {
    center_of_mass(&ROBOT, &Posture::new(&ROBOT, q)).position_w
}

/// Middle of both soles' rectangles in the world.
#[must_use]
pub fn middle_of_soles(poses: &Kinematics<f64, JOINTS>) -> Vector3<f64> {
    middle_of_feet(poses, &profile::SOLE_CONTACTS)
}

/// The robot with these joints and its left sole flat on the floor, toes along x, the middle between the soles' frames at
/// the origin.
#[must_use]
pub fn on_the_floor(joints: [f64; JOINTS]) -> State {
    humanoid::on_the_floor(&ROBOT, &profile::SOLE_CONTACTS, &joints)
}

/// The squat that the jump starts from.
#[must_use]
pub const fn squat() -> [f64; JOINTS] {
    profile::SQUAT
}

/// The posture in which the robot lands: legs drawn up a little from the take-off, soles level.
#[must_use]
pub const fn landing_posture() -> [f64; JOINTS] {
    profile::LANDING_POSTURE
}

/// Time from the planned take-off to the planned touchdown, s, of a push-off that starts with the centre of mass at height `start`: the
/// throw ends where the legs of the landing posture reach the ground.
#[must_use]
pub fn flight_time(profile: &ComProfile<f64>, start: f64) -> f64 {
    let takeoff = start + profile.at(profile.duration).rise;
    let drop = takeoff - com(&on_the_floor(landing_posture())).z;
    let v = profile.speed;
    (v + so3::math::sqrt((v * v + 2.0 * GRAVITY * drop).max(0.0))) / GRAVITY
}

/// The corners of the soles.
#[must_use]
pub fn spheres() -> [Shape<f64>; SPHERES] {
    let corners: [_; 2] = core::array::from_fn(|i| Shape::corners(&SOLES[i], CORNER_RADIUS, 4 * i));
    core::array::from_fn(|i| match &corners[i / 4] {
        Some(balls) => balls[i % 4],
        None => unreachable!("the soles are rectangles"),
    })
}

/// All links, each with an owner of its own behind those of the soles.
#[must_use]
pub fn links() -> [Shape<f64>; shapes::SHAPES.len()] {
    shapes::shapes(SPHERES)
}

/// Links that touch each other: those that do not where the robot stands, before the push-off and after the landing.
fn pairs_of_links(links: &[Shape<f64>; shapes::SHAPES.len()]) -> [u64; shapes::SHAPES.len()] {
    let at = |joints| self_contacts(&ROBOT, links, &on_the_floor(joints));
    let (squatting, landed) = (at(squat()), at(landing_posture()));
    core::array::from_fn(|i| squatting[i] & landed[i])
}

/// A simulator of the robot.
type Plant = lab::Plant<JOINTS, OWNERS>;

/// The robot in its lab.
pub type World = lab::Ground<JOINTS, OWNERS>;

/// The robot in a simulator, at rest at `start`.
///
/// # Errors
/// What stands against the disturbed robot, or that this build lacks the simulator.
pub fn plant(
    task: &Task,
    sim: Sim,
    disturbance: &Disturbance,
    start: &State,
) -> Result<World, String> {
    let limits = LIMITS.map(|mut limits| {
        limits.friction = disturbance
            .set_to(Key::JointFriction)
            .unwrap_or(limits.friction);
        limits
    });
    let mut settings = Settings::new(&limits, &task.motors());
    settings.contact.friction = disturbance.get(Key::Friction);
    settings.contact.time_constant = disturbance.seconds(Key::Ground);
    let robot = lab::robot(disturbance, &ROBOT).map_err(|error| error.to_string())?;
    let mut plant: Plant = match sim {
        Sim::Native => {
            let (balls, links) = (spheres(), links());
            let all: [Shape<f64>; SHAPES] =
                core::array::from_fn(|i| match i.checked_sub(SPHERES) {
                    Some(i) => links[i],
                    None => balls[i],
                });
            // Of a foot its links collide with links, its sole with the ground.
            let mut pairs = [0; SHAPES];
            for (all, links) in pairs[SPHERES..].iter_mut().zip(pairs_of_links(&links)) {
                *all = links << SPHERES;
            }
            let native = NativeSimulator::new(robot, all, Terrain::FLAT, settings);
            Box::new(native.colliding(pairs))
        }
        Sim::Mujoco(compile) => mujoco(compile, &robot, settings)?,
    };
    plant.reset(start, &Tangent::ZERO);
    Ok(World::new(plant, disturbance.get(Key::GroundHeight)))
}

/// MuJoCo, with the soles as boxes and the same links.
fn mujoco(
    compile: Compile,
    robot: &TableModel<f64, JOINTS>,
    mut settings: Settings<f64, JOINTS>,
) -> Result<Plant, String> {
    // Each sole is one box; its force counts for the first of its corners.
    let soles = SOLES.iter().enumerate();
    let mut geoms: Vec<Geom> = soles.map(|(i, sole)| Geom::of(sole, 4 * i)).collect();
    let links = links();
    let mut pairs = vec![0; geoms.len()];
    pairs.extend(pairs_of_links(&links).map(|bits| bits << SOLES.len()));
    geoms.extend(links.map(Geom::Swept));
    settings.substeps = 1;
    let sim = MujocoSimulator::new(compile, robot, (&geoms, &pairs), &Terrain::FLAT, settings);
    Ok(Box::new(sim.map_err(|error| error.to_string())?))
}

// Jumps in both simulators take long to compile and to run: `cargo xtask suites`.
#[cfg(all(test, feature = "mujoco"))]
mod tests;
