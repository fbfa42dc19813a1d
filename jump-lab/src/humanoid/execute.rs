//! A humanoid's jump in the closed loop, and what is kept of it.

use super::control::{self, QpLog};
use super::log::Sample;
use super::{FEET, GRAVITY, JOINTS, Known, OWNERS, ROBOT, SPHERES, Task, World, com, known};
use super::{on_the_floor, plant, poses, spheres, squat};
use crate::Sim;
use crate::closed_loop::{ClosedLoop, Drive, Feet, Recorder, Sensors, Setting, Step, stage};
use crate::lab::{Disturbance, Interface, Key};
use crate::verdict::{Hardware, Tick};
use icub_model::profile::{Jump, Machine, Workspace};
use icub_model::{BUDGETS, LIMITS, SOLES, shapes};
use jump_control::{JointCommand, Phase};
use jump_machine::humanoid::Work;
use nalgebra::Vector3;
use rbd_core::{CentroidalMap, Motor, Posture, Tangent, centroidal_map, centroidal_state};
use state_est::Foot;

/// Time of standing in the squat before the push-off, s.
pub const HOLD: f64 = 0.5;
/// Time after touchdown at which the robot must stand, s.
pub const SETTLE: f64 = 2.0;
/// Force at which a sole is certainly loaded, N.
const LOADED: f64 = 40.0;
/// Force on a sole below which it counts as off the ground, N.
const LIFTED: f64 = 1.0;

/// How close the push-off came to the joints' limits: 1 is the limit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Usage {
    /// Position: share of the half range, from its middle.
    pub position: f64,
    /// Speed.
    pub speed: f64,
    /// Torque.
    pub torque: f64,
}

/// Everything a run leaves behind.
pub struct Run {
    /// One per millisecond.
    pub samples: Vec<Sample>,
    /// By how much the landing's ground was higher than known, m.
    pub ground_height: f64,
    /// Of the robot that was planned for, N.
    pub weight: f64,
    /// Of the machine, in the end.
    pub final_phase: Phase,
    /// Planned, s.
    pub takeoff: f64,
    /// Speed.
    pub wanted_speed: f64,
    /// When both soles had left the ground, s.
    pub contact_loss: Option<f64>,
    /// When one touched it again, s.
    pub touchdown: Option<f64>,
    /// What the run asked of motors, joints and supply.
    pub hardware: Hardware<JOINTS>,
    /// Up to the loss of contact.
    pub launch: Usage,
    /// The same after touchdown: largest torque delivered, and asked for, over the limit.
    pub landing_torque: f64,
    /// Largest torque asked for after touchdown, over the limit.
    pub landing_demand: f64,
    /// Time after touchdown in which a joint asked for more than its limit, s.
    pub landing_saturation: f64,
    /// Torque.
    pub peak_torque: f64,
    /// Largest force of the ground on both soles, N.
    pub peak_force: f64,
    /// Largest error of the estimated base: m, rad.
    pub estimate_error: [f64; 2],
    /// What the programs did.
    pub qp: QpLog,
}

impl Run {
    fn new(task: &Task, jump: &Jump, weight: f64, tick: f64) -> Self {
        Self {
            samples: Vec::new(),
            ground_height: 0.0,
            weight,
            final_phase: Phase::Hold,
            takeoff: jump.profile.duration,
            wanted_speed: jump.profile.speed,
            contact_loss: None,
            touchdown: None,
            hardware: Hardware::new(BUDGETS, task.motors(), &LIMITS, weight, tick),
            launch: Usage::default(),
            landing_torque: 0.0,
            landing_demand: 0.0,
            landing_saturation: 0.0,
            peak_torque: 0.0,
            peak_force: 0.0,
            estimate_error: [0.0; 2],
            qp: QpLog::default(),
        }
    }
}

/// Force of the ground on each sole, N.
#[must_use]
pub fn sole_forces(world: &World) -> [Vector3<f64>; FEET] {
    let f = world.plant().contact_forces_w();
    [f[..4].iter().sum(), f[4..SPHERES].iter().sum()]
}

/// What is kept of a run.
struct Keeper<'a> {
    task: &'a Task,
    jump: Jump,
    /// Height of the centre of mass at the start, m.
    lift: f64,
    motors: [Motor<f64>; JOINTS],
    run: Run,
}

impl<'m> Recorder<Machine<'m, Known>, JOINTS, FEET, OWNERS> for Keeper<'_> {
    fn ticked(
        &mut self,
        t: f64,
        tick: &jump_machine::Tick<Work<f64>>,
        _: &Machine<'m, Known>,
        world: &World,
    ) {
        self.run.qp.count(self.task, tick);
        let wanted_height = self.lift + self.jump.profile.at(t).rise;
        let sample = record(world, tick.phase, wanted_height, t);
        observe(&mut self.run, &sample, &self.motors);
        self.run.samples.push(sample);
    }

    fn stepped(&mut self, step: &Step<JOINTS>, machine: &Machine<'m, Known>, world: &World) {
        let run = &mut self.run;
        if run.touchdown.is_some() {
            let moved = ahead(machine.command(), step.since);
            let (q, v) = &step.encoders;
            let over = demand(&moved, q, v, &self.motors);
            run.landing_demand = run.landing_demand.max(over);
            if over > 1.0 {
                run.landing_saturation += step.dt;
            }
        }
        let plant = world.plant();
        let ground: Vector3<f64> = plant.contact_forces_w().iter().sum();
        run.hardware.add(&Tick {
            time: step.time,
            dt: step.dt,
            stage: stage(machine.phase()),
            asked: &step.asked,
            given: plant.delivered(),
            speeds: &step.speeds,
            stops: plant.stop_torques(),
            ground: ground.norm(),
            power: step.power,
            touches: &touches(plant.contact_forces_w(), plant.link_forces()),
        });
    }
}

/// Links that something presses on: feet may touch the ground by their soles, which are none of these.
pub(super) fn touches(
    ground: &[Vector3<f64>; OWNERS],
    links: &[f64; OWNERS],
) -> Vec<(&'static str, f64)> {
    let forces = ground.iter().zip(links).skip(SPHERES);
    shapes::OWNERS
        .iter()
        .zip(forces)
        .map(|(name, (ground, link))| (*name, ground.norm() + link))
        .filter(|(_, force)| *force > 0.0)
        .collect()
}

/// Runs the jump; `progress` hears time and phase once per simulated 10 ms.
///
/// # Errors
/// A sentence: there is no such jump, the machine refuses it, this build lacks the simulator, or that fails.
pub fn run(
    task: &Task,
    sim: Sim,
    disturbance: &Disturbance,
    seed: u64,
    mut progress: impl FnMut(f64, Phase),
) -> Result<Run, String> {
    run_told(task, sim, (disturbance, seed), &mut progress)
}

/// [`run`], compiled once and here: robot, simulators and controllers are large.
fn run_told(
    task: &Task,
    sim: Sim,
    (disturbance, seed): (&Disturbance, u64),
    progress: &mut dyn FnMut(f64, Phase),
) -> Result<Run, String> {
    task.check()?;
    let start = on_the_floor(squat());
    let (robot, motors) = (known(task)?, task.motors());
    let settings = control::settings(task);
    let mut workspace = Box::new(Workspace::new(&settings));
    let mut machine = Machine::new(&robot, settings, &mut workspace);
    let jump = control::jump(task, &start)?;
    let armed = machine.arm(&jump, 0.0);
    armed.map_err(|refusal| refusal.to_string())?;
    let feet = Feet {
        feet: SOLES.map(|sole| Foot::of(&sole)),
        loaded: LOADED,
        settling: 0,
        forces: |world| sole_forces(world).map(|f| f.norm()),
    };
    let interface = Interface::Torque;
    let setting = Setting {
        disturbance,
        interface,
        seed,
        start: &start,
        moving: &Tangent::ZERO,
    };
    let mut closed = ClosedLoop {
        machine,
        sensors: Sensors::<_, _, _, _, { FEET + 2 }>::new(ROBOT, feet, &setting),
        drive: Drive::new(disturbance, (interface, seed), (&LIMITS, motors), &BUDGETS),
        world: plant(task, sim, disturbance, &start)?,
        now: 0.0,
    };
    let weight = control::mass(&robot) * GRAVITY;
    let mut keeper = Keeper {
        task,
        jump,
        lift: com(&start).z,
        motors,
        run: Run::new(task, &jump, weight, closed.world.plant().tick()),
    };
    let end = jump.profile.duration + SETTLE + 0.7;
    closed.run((HOLD, end), &mut keeper, progress)?;
    let mut run = keeper.run;
    run.ground_height = disturbance.get(Key::GroundHeight);
    run.final_phase = closed.machine.phase();
    run.estimate_error = closed.sensors.worst;
    Ok(run)
}

/// A command a time after it came: drives go on with the velocity that was asked for, as iCub's boards do. A position held for a
/// millisecond at 7 rad/s is a sawtooth of 42 N m in a servo of 6000 N m/rad.
fn ahead(command: &JointCommand<f64, JOINTS>, time: f64) -> JointCommand<f64, JOINTS> {
    let mut out = *command;
    for (q, qd) in out.position.iter_mut().zip(&command.velocity) {
        *q += time * qd;
    }
    out
}

/// Largest torque that a command asks for, over the limit.
fn demand(
    command: &JointCommand<f64, JOINTS>,
    q: &[f64; JOINTS],
    v: &[f64; JOINTS],
    motors: &[Motor<f64>; JOINTS],
) -> f64 {
    let unlimited = motors.map(|motor| Motor {
        torque: f64::MAX,
        corner_speed: f64::MAX,
        no_load_speed: f64::MAX,
        ..motor
    });
    let wanted = command.torques(q, v, &unlimited);
    let shares = wanted.iter().zip(motors).map(|(t, m)| t.abs() / m.torque);
    shares.fold(0.0, f64::max)
}

fn record(world: &World, phase: Phase, wanted_height: f64, time: f64) -> Sample {
    let (q, v) = (world.configuration(), world.velocity());
    let posture = Posture::new(&ROBOT, &q);
    let state = centroidal_state(&ROBOT, &posture, v);
    let mut map = CentroidalMap::ZERO;
    centroidal_map(&ROBOT, &posture, &mut map);
    let poses = poses(&q);
    let heights = spheres()
        .map(|ball| poses.link(ball.link).point(&Vector3::from(ball.from)).z - ball.radius);
    Sample {
        time,
        phase,
        position: q.base.translation,
        orientation: so3::quat::from_rotation(&q.base.rotation),
        base_velocity: v.base,
        com: state.com_w,
        com_velocity: state.com_velocity_w,
        wanted_height,
        momentum: state.momentum_w.angular,
        locked: map.locked_angular_velocity(&state.momentum_w),
        joints: q.joints,
        joint_velocities: v.joints,
        torques: *world.plant().delivered(),
        forces_w: sole_forces(world),
        clearance: heights.into_iter().fold(f64::INFINITY, f64::min),
        floor: world.moved(),
    }
}

/// Events and extremes of one tick.
fn observe(run: &mut Run, s: &Sample, motors: &[Motor<f64>; JOINTS]) {
    let off = s.forces_w.iter().all(|f| f.norm() < LIFTED);
    let pushed = matches!(s.phase, Phase::Stance | Phase::Flight | Phase::PreLanding);
    if run.contact_loss.is_none() && pushed && s.time > 0.5 * run.takeoff && off {
        run.contact_loss = Some(s.time);
    }
    // The soles part a millimetre or two before they come back within the same push-off; that is no touchdown.
    let in_air = run.contact_loss.is_some_and(|t| s.time > t + 0.03);
    if run.touchdown.is_none() && in_air && !off {
        run.touchdown = Some(s.time);
    }
    let shares = s
        .torques
        .iter()
        .zip(motors)
        .map(|(tau, m)| tau.abs() / m.torque);
    let torque = shares.fold(0.0, f64::max);
    run.peak_torque = s
        .torques
        .iter()
        .fold(run.peak_torque, |m, x| m.max(x.abs()));
    let total = s.forces_w.iter().map(|f| f.norm()).sum::<f64>();
    run.peak_force = run.peak_force.max(total);
    if run.contact_loss.is_none() && s.phase == Phase::Stance {
        let joints = s.joints.iter().zip(&s.joint_velocities).zip(&LIMITS);
        for ((q, qd), l) in joints {
            let middle = 0.5 * (l.lower + l.upper);
            let position = (q - middle).abs() / (0.5 * (l.upper - l.lower));
            run.launch.position = run.launch.position.max(position);
            run.launch.speed = run.launch.speed.max(qd.abs() / l.speed);
        }
        run.launch.torque = run.launch.torque.max(torque);
    } else if run.touchdown.is_some() {
        run.landing_torque = run.landing_torque.max(torque);
    }
}
