//! The simulated robot: which simulator, and how it differs from the robot that was planned for.

use super::task::Task;
use super::{JOINTS, ROBOT, SPHERES, spheres};
use crate::noise::Noise;
use a1_model::{MOTORS, a1};
use contact_sim::{Block, NativeSimulator, Settings, Simulator, Terrain};
use nalgebra::Vector3;
use rbd_core::{BaseBody, BaseKind, Body, TableModel, Tangent, Tree};

/// How far a box reaches from the middle of a robot on it, m.
const AROUND: f64 = 0.6;

/// A simulator of A1.
pub(crate) type Plant = Box<dyn Simulator<f64, JOINTS, SPHERES, Error = contact_sim::Error>>;

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

/// How the plant and its sensors differ from what the planner knew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Disturbance {
    /// Friction of the ground.
    pub(crate) friction: f64,
    /// Every mass and moment of mass, relative.
    pub(crate) mass: f64,
    /// Rotor inertias, relative.
    pub(crate) rotors: f64,
    /// Viscous and Coulomb friction of the joints, relative.
    pub(crate) joint_friction: f64,
    /// Age of every measurement at 1 kHz, ms.
    pub(crate) latency_ms: usize,
    /// Standard deviations of encoder position and speed noise, rad and rad/s.
    pub(crate) encoder: (f64, f64),
    /// The IMU's noise; without it the controller is told the truth about the base.
    pub(crate) imu: Option<Imu>,
}

/// Standard deviations of an IMU's samples at 1 kHz and of its biases: rad/s and m/s².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Imu {
    pub(crate) gyroscope: f64,
    pub(crate) gyroscope_bias: f64,
    pub(crate) accelerometer: f64,
    pub(crate) accelerometer_bias: f64,
}

impl Disturbance {
    /// None: the nominal run.
    pub(crate) const NOMINAL: Self = Self {
        friction: 0.6,
        mass: 1.0,
        rotors: 1.0,
        joint_friction: 1.0,
        latency_ms: 0,
        encoder: (0.0, 0.0),
        imu: None,
    };

    /// Seed 0: none. Others: friction ± 20 %, mass ± 5 %, rotors and joint friction ± 30 %, 2 ms of latency, noisy
    /// encoders, and an IMU of which `state-est` makes the base.
    pub(crate) fn draw(seed: u64) -> Self {
        if seed == 0 {
            return Self::NOMINAL;
        }
        let mut noise = Noise::new(seed, 0.0);
        let mut around = |share: f64| 1.0 + share * (2.0 * noise.uniform() - 1.0);
        Self {
            friction: Self::NOMINAL.friction * around(0.2),
            mass: around(0.05),
            rotors: around(0.3),
            joint_friction: around(0.3),
            latency_ms: 2,
            encoder: (1e-3, 0.05),
            imu: Some(Imu {
                gyroscope: 0.01,
                gyroscope_bias: 0.01,
                accelerometer: 0.1,
                accelerometer_bias: 0.05,
            }),
        }
    }

    /// Joint positions and speeds as encoders tell them.
    pub(crate) fn encode<const N: usize>(
        &self,
        mut q: [f64; N],
        mut v: [f64; N],
        noise: &mut Noise,
    ) -> ([f64; N], [f64; N]) {
        let (dq, dv) = self.encoder;
        if dq > 0.0 || dv > 0.0 {
            for (q, v) in q.iter_mut().zip(&mut v) {
                *q += dq * noise.sample();
                *v += dv * noise.sample();
            }
        }
        (q, v)
    }

    /// The disturbed robot.
    pub(crate) fn robot<M: Tree<f64, N>, const N: usize>(
        &self,
        planned: &M,
    ) -> Result<TableModel<f64, N>, String> {
        let mut base: BaseBody<f64> = *planned.base();
        let mut bodies: [Body<f64>; N] = *planned.bodies();
        base.mass *= self.mass;
        base.first = base.first.map(|x| x * self.mass);
        base.second = base.second.map(|x| x * self.mass);
        for body in &mut bodies {
            body.mass *= self.mass;
            body.first = body.first.map(|x| x * self.mass);
            body.second = body.second.map(|x| x * self.mass);
            body.rotor_inertia *= self.rotors;
        }
        TableModel::new(BaseKind::Floating, base, &bodies).map_err(|error| error.to_string())
    }

    fn settings(&self) -> Settings<f64, JOINTS> {
        let limits = a1::LIMITS.map(|mut limits| {
            limits.damping *= self.joint_friction;
            limits.friction *= self.joint_friction;
            limits
        });
        let mut settings = Settings::new(&limits, &MOTORS);
        settings.contact.friction = self.friction;
        settings
    }
}

/// The plant at the start of a task.
pub(crate) fn plant(sim: Sim, task: &Task, disturbance: &Disturbance) -> Result<Plant, String> {
    let mut plant = match sim {
        Sim::Native => Box::new(NativeSimulator::new(
            disturbance.robot(&ROBOT)?,
            spheres(),
            terrain(task),
            disturbance.settings(),
        )),
        Sim::Mujoco => mujoco(task, disturbance)?,
    };
    plant.reset(&task.start, &Tangent::ZERO);
    Ok(plant)
}

/// MuJoCo: feet and knees as the native simulator has them, the trunk as the published box.
#[cfg(feature = "mujoco")]
fn mujoco(task: &Task, disturbance: &Disturbance) -> Result<Plant, String> {
    use contact_sim::{Geom, GeomShape, MujocoSimulator};
    use rbd_core::Frame;

    let balls = spheres();
    let mut geoms: Vec<Geom> = balls[..super::TRUNK]
        .iter()
        .enumerate()
        .map(|(i, sphere)| Geom::sphere(sphere, i))
        .collect();
    geoms.push(Geom {
        frame: Frame::IDENTITY,
        shape: GeomShape::Box(super::TRUNK_SIZE.map(|x| 0.5 * x)),
        contact: super::TRUNK,
    });
    let mut settings = disturbance.settings();
    settings.substeps = 1;
    let robot = disturbance.robot(&ROBOT)?;
    let sim = MujocoSimulator::new(&robot, &geoms, &terrain(task), settings);
    Ok(Box::new(sim.map_err(|error| error.to_string())?))
}

#[cfg(not(feature = "mujoco"))]
fn mujoco(_: &Task, _: &Disturbance) -> Result<Plant, String> {
    Err(NO_MUJOCO.into())
}

/// What a build without MuJoCo says.
#[cfg(not(feature = "mujoco"))]
pub(crate) const NO_MUJOCO: &str = "this build has no MuJoCo: use `cargo xtask mujoco run --release -p saltus --features mujoco -- run ...`";

/// The world of a task. The robot starts at height zero: on the floor, with or without a box to jump onto, or on a box with the floor below.
pub(crate) fn terrain(task: &Task) -> Terrain<f64> {
    let Some(edge) = task.edge.filter(|edge| edge.drop != 0.0) else {
        return Terrain::FLAT;
    };
    let onto = edge.drop < 0.0;
    let floor = f64::min(-edge.drop, 0.0);
    // Around where the robot stands, or lands, cut at the edge.
    let middle = if onto { task.goal } else { Vector3::zeros() };
    let mut lower = [middle.x - AROUND, middle.y - AROUND, floor];
    let mut upper = [
        middle.x + AROUND,
        middle.y + AROUND,
        f64::max(-edge.drop, 0.0),
    ];
    let cut = edge.sign * edge.distance;
    if onto == (edge.sign > 0.0) {
        lower[edge.axis] = cut;
    } else {
        upper[edge.axis] = cut;
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
                let terrain = terrain(&task);
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
        assert_eq!(terrain(&task), Terrain::FLAT);
    }
}
