//! The closed loop: plant and servos at 10 kHz, controller at 1 kHz.

use super::control::{self, QpLog};
use super::log::Sample;
use super::sensors::{Sensors, sole_forces};
use super::{GRAVITY, JOINTS, OWNERS, ROBOT, SPHERES, Task, World, com, known};
use super::{on_the_floor, plant, poses, spheres, squat};
use crate::jump::plant::Sim;
use crate::lab::{Disturbance, Motors};
use crate::verdict::{Hardware, Stage, Tick};
use icub_model::profile::{Jump, Machine, Workspace};
use icub_model::{BUDGETS, LIMITS, shapes};
use jump_control::{JointCommand, Phase};
use nalgebra::Vector3;
use rbd_core::{CentroidalMap, Motor, Posture, centroidal_map, centroidal_state};

/// Length of a tick, s.
const TICK: f64 = 1e-3;
/// Time of standing in the squat before the push-off, s.
pub(crate) const HOLD: f64 = 0.5;
/// Time after touchdown at which the robot must stand, s.
pub(crate) const SETTLE: f64 = 2.0;
/// Force on a sole below which it counts as off the ground, N.
const LIFTED: f64 = 1.0;

/// How close the push-off came to the joints' limits: 1 is the limit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Usage {
    /// Position: share of the half range, from its middle.
    pub(crate) position: f64,
    pub(crate) speed: f64,
    pub(crate) torque: f64,
}

/// Everything a run leaves behind.
pub(crate) struct Run {
    pub(crate) samples: Vec<Sample>,
    pub(crate) final_phase: Phase,
    pub(crate) takeoff: f64,
    pub(crate) wanted_speed: f64,
    pub(crate) contact_loss: Option<f64>,
    pub(crate) touchdown: Option<f64>,
    pub(crate) hardware: Hardware<JOINTS>,
    pub(crate) launch: Usage,
    /// The same after touchdown: largest torque delivered, and asked for, over the limit.
    pub(crate) landing_torque: f64,
    pub(crate) landing_demand: f64,
    /// Time after touchdown in which a joint asked for more than its limit, s.
    pub(crate) landing_saturation: f64,
    pub(crate) peak_torque: f64,
    pub(crate) peak_force: f64,
    /// Largest error of the estimated base: m, rad.
    pub(crate) estimate_error: [f64; 2],
    pub(crate) qp: QpLog,
}

impl Run {
    fn new(task: &Task, jump: &Jump, weight: f64, tick: f64) -> Self {
        Self {
            samples: Vec::new(),
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

/// The path from the controller's commands to the plant's torques.
struct Drive {
    motors: Motors<JOINTS>,
    limits: [Motor<f64>; JOINTS],
    /// Torques that the joints' loop has computed and that act from the next tick on.
    computed: [f64; JOINTS],
}

impl Drive {
    fn new(task: &Task, disturbance: &Disturbance) -> Self {
        let limits = task.motors();
        Self {
            motors: Motors::new(disturbance, limits, &BUDGETS),
            limits,
            computed: [0.0; JOINTS],
        }
    }

    /// One tick of the plant that ends at `time`, and began `since` after the command came: reads the encoders, lets the joints' loop compute, and applies what it computed a
    /// tick ago.
    fn step(
        &mut self,
        (command, phase): (&JointCommand<f64, JOINTS>, Phase),
        (world, sensors): (&mut World, &mut Sensors),
        run: &mut Run,
        (time, since): (f64, f64),
    ) -> Result<(), String> {
        let dt = world.plant().tick();
        let (q, v) = sensors.encoders(world);
        let asked = self.computed;
        let moved = ahead(command, since);
        self.computed = moved.torques(&q, &v, &self.limits);
        if run.touchdown.is_some() {
            let over = demand(&moved, &q, &v, &self.limits);
            run.landing_demand = run.landing_demand.max(over);
            if over > 1.0 {
                run.landing_saturation += dt;
            }
        }
        let speeds = world.velocity().joints;
        let given = self.motors.give(&asked, &speeds, dt);
        let flies = matches!(phase, Phase::Flight | Phase::PreLanding);
        world.step(&given, flies)?;
        let plant = world.plant();
        let ground: Vector3<f64> = plant.contact_forces_w().iter().sum();
        run.hardware.add(&Tick {
            time,
            dt,
            stage: stage(phase),
            asked: &asked,
            given: plant.delivered(),
            speeds: &speeds,
            stops: plant.stop_torques(),
            ground: ground.norm(),
            power: self.motors.power(),
            touches: &touches(plant.contact_forces_w(), plant.link_forces()),
        });
        Ok(())
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

const fn stage(phase: Phase) -> Stage {
    match phase {
        Phase::Hold | Phase::Stance => Stage::PushOff,
        Phase::Flight | Phase::PreLanding => Stage::Flight,
        Phase::Landing | Phase::Stand | Phase::Abort => Stage::Landing,
    }
}

/// Runs the jump; `progress` hears time and phase once per simulated 10 ms.
pub(crate) fn run(
    task: &Task,
    sim: Sim,
    disturbance: &Disturbance,
    seed: u64,
    mut progress: impl FnMut(f64, Phase),
) -> Result<Run, String> {
    let start = on_the_floor(squat());
    let mut world = plant(task, sim, disturbance, &start)?;
    let mut sensors = Sensors::new(disturbance, seed, &start);
    let robot = known(task)?;
    let settings = control::settings(task);
    let mut workspace = Box::new(Workspace::new(&settings));
    let mut machine = Machine::new(&robot, settings, &mut workspace);
    let jump = control::jump(task, &start)?;
    machine
        .arm(&jump, 0.0)
        .map_err(|refusal| refusal.to_string())?;
    let lift = com(&start).z;
    let mut drive = Drive::new(task, disturbance);
    let tick = world.plant().tick();
    let weight = control::mass(&robot) * GRAVITY;
    let mut run = Run::new(task, &jump, weight, tick);
    let substeps = (TICK / tick).round() as u32;
    for k in 0_u64.. {
        let t = k as f64 * TICK - HOLD;
        if t > run.takeoff + SETTLE + 0.7 {
            break;
        }
        let told = sensors.measure(t, &world);
        run.qp.count(task, &machine.tick(t, told.as_ref()));
        let wanted_height = lift + jump.profile.at(t).rise;
        let sample = record(&world, machine.phase(), wanted_height, t);
        observe(&mut run, &sample, &drive.limits);
        run.samples.push(sample);
        for i in 0..substeps {
            let what = (machine.command(), machine.phase());
            let since = f64::from(i) * tick;
            let times = (t + since + tick, since);
            drive.step(what, (&mut world, &mut sensors), &mut run, times)?;
        }
        if k.is_multiple_of(10) {
            progress(t, machine.phase());
        }
    }
    run.final_phase = machine.phase();
    run.estimate_error = sensors.worst;
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
