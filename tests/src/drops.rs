//! A1 dropped on its feet: a jump whose push-off is over, flown by the machine in the closed loop of every jump.
//!
//! The plan is the fall: it takes off where the robot is let go, and ends where its lowest foot meets the ground. The machine goes through
//! its phases as in any jump, and knows of the drop what it knows of a jump: where it begins, from sensors, and an estimate of its base.

use a1_model::{MOTORS, a1};
use contact_sim::Terrain;
use jump_control::{Fault, Node, Phase, Plan, Torques};
use jump_lab::Sim;
use jump_lab::closed_loop::{Feet, Recorder, Step};
use jump_lab::lab::{Disturbance, Ground, Key};
use jump_lab::noise::Noise;
use jump_lab::quadruped::execute::{Trial, closed, feet};
use jump_lab::quadruped::plant::simulator;
use jump_lab::quadruped::{FOOT_COUNT, JOINTS, OWNERS, Observed, State, World};
use jump_machine::{Jump, Machine, Settings, Tick, Work, Workspace};
use jump_planner::robot::Quadruped;
use landing::{Outcome, Status};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, GRAVITY, Motion, Tangent};

/// Time between two nodes of the plan, s.
const INTERVAL: f64 = 0.01;
/// Time after the release from which contact counts, s: the feet fold to the pre-landing posture until then in a jump.
const POSING: f64 = 0.06;
/// Time of a drop, s.
const END: f64 = 3.0;
/// What a sensor says that is stuck, N.
const STUCK: f64 = 100.0;

/// The fall of a robot from its release.
type Fall = Node<f64, JOINTS, FOOT_COUNT>;
/// Who lands.
type Lander<'m> = Machine<'m, f64, Quadruped, JOINTS, FOOT_COUNT>;

/// Legs under and 4 cm outside the hips, 0.29 m long.
pub const POSTURE: [f64; 12] = [
    0.14, 0.77, -1.54, -0.14, 0.77, -1.54, 0.14, 0.77, -1.54, -0.14, 0.77, -1.54,
];

/// What is wrong with a foot sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// Always zero.
    Dead,
    /// Always loaded.
    Stuck,
    /// Loaded or not at random, each millisecond.
    Chattering,
}

/// One drop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drop {
    /// Height of the lowest foot over the floor at the start, m.
    pub height: f64,
    /// Roll at the start, rad.
    pub roll: f64,
    /// Pitch at the start, rad.
    pub pitch: f64,
    /// Speed to the left at the start, m/s.
    pub sideways: f64,
    /// A foot with a bad sensor.
    pub fault: Option<(usize, Wrong)>,
    /// How robot, sensors and ground differ from what the machine knows.
    pub plant: Disturbance,
    /// Of the noise.
    pub seed: u64,
}

/// What a drop ended in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Tilt below 10° after three seconds.
    pub upright: bool,
    /// What touched the ground at any time, in the order of the `owners` of a [`Quadruped`].
    pub touched: [bool; OWNERS],
    /// Slower than 5 cm/s after three seconds.
    pub at_rest: bool,
    /// Ticks at which the force program had no answer.
    pub failures: u32,
    /// Ticks at which it was stopped at its cap of factorisations.
    pub capped: u32,
    /// Sensors that the detector did not believe at some time.
    pub faulty: [bool; FOOT_COUNT],
    /// Where the machine was after three seconds.
    pub phase: Phase,
    /// Why it gave up, where it did.
    pub fault: Option<Fault>,
}

impl End {
    /// Upright, at rest, trunk untouched.
    #[must_use]
    pub const fn good(&self) -> bool {
        let [.., trunk_touched] = self.touched;
        self.upright && !trunk_touched && self.at_rest
    }

    /// Links that touched the ground and are no feet.
    pub fn links(&self, robot: &Quadruped) -> impl Iterator<Item = &'static str> {
        let owners = robot.owners.into_iter().zip(self.touched);
        let links = owners.skip(FOOT_COUNT).filter(|(_, touched)| *touched);
        links.map(|(owner, _)| owner)
    }
}

/// Drop number `index` of a study, all sensors right: a height between two, tilted by up to 20° about any horizontal axis,
/// at up to 0.5 m/s sideways.
#[must_use]
pub fn drawn(seed: u64, index: u64, [low, high]: [f64; 2]) -> Drop {
    let seed = seed ^ index.wrapping_mul(0xd134_2543_de82_ef95);
    let mut noise = Noise::new(seed, 0.0);
    let mut between = |a: f64, b: f64| a + (b - a) * noise.uniform();
    let tilt = between(0.0, 20.0).to_radians();
    let about = between(0.0, core::f64::consts::TAU);
    Drop {
        height: between(low, high),
        roll: tilt * so3::math::cos(about),
        pitch: tilt * so3::math::sin(about),
        sideways: between(-0.5, 0.5),
        fault: None,
        plant: Disturbance::NOMINAL,
        seed,
    }
}

/// A drop with one sensor wrong: kinds and feet in turn.
#[must_use]
pub fn with_fault(drop: &Drop, index: u64) -> Drop {
    let kinds = [Wrong::Dead, Wrong::Stuck, Wrong::Chattering];
    let foot = (index / 3 % 4) as usize;
    Drop {
        fault: Some((foot, kinds[(index % 3) as usize])),
        ..*drop
    }
}

/// Height from which the knees alone can take up a level fall, m: at full torque from the landing posture to their stops,
/// feet under the hips. Beyond it a landing lives on what impacts and friction take.
///
/// 4 τ (q_stop − q) = m g (h + ΔL), with legs of length L = l cos(q/2), l when they are stretched.
#[must_use]
pub fn energy_bound(robot: &Quadruped) -> f64 {
    let (start, stop) = (-POSTURE[2], -a1::LIMITS[2].lower);
    let work = 4.0 * MOTORS[2].torque * (stop - start);
    let leg = |knee: f64| robot.leg_length * so3::math::cos(0.5 * knee);
    work / robot.weight() - (leg(start) - leg(stop))
}

/// Where a drop begins, and how it moves there.
fn release(robot: &Quadruped, drop: &Drop) -> (State, Tangent<f64, JOINTS>) {
    let mut q = Configuration {
        joints: POSTURE,
        ..Configuration::NEUTRAL
    };
    q.base.rotation = Rotation3::from_euler_angles(drop.roll, drop.pitch, 0.0);
    let poses = robot.poses(&q);
    let feet = robot
        .feet
        .map(|foot| poses.frame(&foot).translation.z - robot.foot_radius);
    let low = feet.into_iter().fold(f64::INFINITY, f64::min);
    q.base.translation.z = drop.height - low;
    let along = q.base.rotation.inverse() * Vector3::new(0.0, drop.sideways, 0.0);
    let moving = Tangent {
        base: Motion::new(along, Vector3::zeros()),
        joints: [0.0; JOINTS],
    };
    (q, moving)
}

/// The fall from this release until its lowest foot has fallen so deep: nobody turns, and the legs are still.
fn fall((q, moving): &(State, Tangent<f64, JOINTS>), depth: f64) -> Vec<Fall> {
    let gravity_w = Vector3::from(GRAVITY);
    let duration = so3::math::sqrt(-2.0 * depth / gravity_w.z);
    let count = (duration / INTERVAL).ceil();
    let node = |i: u32| {
        let time = duration * f64::from(i) / count;
        let mut node = Node {
            time,
            base: q.base,
            base_velocity: moving.base,
            joints: q.joints,
            ..Node::ZERO
        };
        let start_w = q.base.rotation * moving.base.linear;
        node.base.translation += (start_w + gravity_w * (0.5 * time)) * time;
        node.base_velocity.linear += q.base.rotation.inverse() * gravity_w * time;
        node
    };
    (0..=count as u32).map(node).collect()
}

/// Watches a drop, with what is wrong with its sensors.
struct Watcher {
    fault: Option<(usize, Wrong)>,
    noise: Noise,
    end: End,
}

impl Recorder<Lander<'_>, JOINTS, FOOT_COUNT, OWNERS> for Watcher {
    fn tell(&mut self, _: u64, told: &mut Observed) {
        if let Some((foot, wrong)) = self.fault {
            told.measured.foot_forces[foot] = match wrong {
                Wrong::Dead => 0.0,
                Wrong::Stuck => STUCK,
                Wrong::Chattering if self.noise.uniform() < 0.5 => STUCK,
                Wrong::Chattering => 0.0,
            };
        }
    }

    fn ticked(&mut self, _: f64, tick: &Tick, machine: &Lander<'_>, _: &World) {
        let end = &mut self.end;
        for (ever, now) in end.faulty.iter_mut().zip(machine.contacts().1) {
            *ever |= now;
        }
        match tick.work {
            Work::Landing(Outcome::Failed(Status::Limit)) => end.capped += 1,
            Work::Landing(Outcome::Failed(_) | Outcome::BadData) => end.failures += 1,
            _ => {}
        }
        (end.phase, end.fault) = (tick.phase, machine.fault());
    }

    fn stepped(&mut self, _: &Step<JOINTS>, _: &Lander<'_>, world: &World) {
        let forces_w = world.plant().contact_forces_w();
        for (ever, force_w) in self.end.touched.iter_mut().zip(forces_w) {
            *ever |= *force_w != Vector3::zeros();
        }
    }
}

/// Drops the robot in a simulator and lets it settle for three seconds. The machine has its estimator, and never the truth about the base; in the
/// air nobody weighs the robot, so that it knows of no payload. Contact counts from 60 ms after the release, as it counts from the pre-landing posture on in a
/// jump.
///
/// # Errors
/// This build lacks the simulator, or that fails.
pub fn run(robot: &Quadruped, sim: Sim, drop: &Drop) -> Result<End, String> {
    let start = release(robot, drop);
    let nodes = fall(&start, drop.height);
    let touchdown = nodes.last().map_or(0.0, |node| node.time);
    let plan = Plan::new(&nodes, 0.0, POSING, touchdown, Torques::Hold);
    let jump = Jump {
        plan: plan.map_err(|error| error.to_string())?,
        rot_goal: Rotation3::identity(),
        landing_joints: POSTURE,
    };
    let build = robot.build(&start.0);
    let settings = Settings::new(&build, robot.feet, robot.drives(), POSTURE);
    let mut workspace = Workspace::new();
    let mut machine = Machine::new(robot, settings, &mut workspace);
    let armed = machine.arm(jump, 0.0);
    armed.map_err(|refusal| refusal.to_string())?;

    let trial = Trial {
        disturbance: drop.plant,
        seed: drop.seed,
        ..Trial::nominal(sim)
    };
    let over = (&Terrain::FLAT, &start.0);
    let mut plant = simulator(sim, robot, over, &trial.disturbance)?;
    plant.reset(&start.0, &start.1);
    // Nothing has stood still before the release, so no samples of that have settled the estimator.
    let feet = Feet {
        settling: 0,
        ..feet(robot)
    };
    let mut closed = closed(
        (*robot, feet),
        machine,
        Ground::new(plant, drop.plant.get(Key::GroundHeight)),
        &trial,
    );
    let mut watcher = Watcher {
        fault: drop.fault,
        // Another chattering for every height, too.
        noise: Noise::new(drop.seed ^ drop.height.to_bits() ^ 7, 0.0),
        end: End {
            upright: false,
            touched: [false; OWNERS],
            at_rest: false,
            failures: 0,
            capped: 0,
            faulty: [false; FOOT_COUNT],
            phase: Phase::Stand,
            fault: None,
        },
    };
    closed.run((0.0, END), &mut watcher, |_, _| {})?;
    let (q, v) = (closed.world.configuration(), closed.world.velocity());
    let up = q.base.rotation * Vector3::z();
    Ok(End {
        upright: up.z > so3::math::cos(10_f64.to_radians()),
        at_rest: v.base.linear.norm() < 0.05,
        ..watcher.end
    })
}

/// The eighteen drops of one height: roll or pitch by 0, ±10 and ±20 degrees, at rest or at 0.5 m/s sideways.
pub fn eighteen(height: f64) -> impl Iterator<Item = Drop> {
    let tilts = [
        (0.0, 0.0),
        (10.0, 0.0),
        (-10.0, 0.0),
        (20.0, 0.0),
        (-20.0, 0.0),
        (0.0, 10.0),
        (0.0, -10.0),
        (0.0, 20.0),
        (0.0, -20.0),
    ];
    tilts
        .into_iter()
        .flat_map(move |(roll, pitch): (f64, f64)| {
            [0.0, 0.5].map(|sideways| Drop {
                height,
                roll: roll.to_radians(),
                pitch: pitch.to_radians(),
                sideways,
                fault: None,
                plant: Disturbance::NOMINAL,
                seed: 0,
            })
        })
}
