//! The closed loop: plant and joint control at 10 kHz, the jump machine at 1 kHz.

use super::log::Sample;
use super::measure::Measure;
use super::plant::{Sim, plant};
use super::sensors::{Sensors, Told, World};
use super::{FOOT_COUNT, JOINTS};
use crate::lab::{Boards, Disturbance, Interface, Motors};
use crate::verdict::{Hardware, Stage, Tick as HardwareTick};
use jump_control::{Fault, Phase, Plan, Torques, sample};
use jump_machine::{Jump, Machine, Settings, Tick, Work};
use jump_planner::reference::{Reference, heading_matrix};
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use landing::Outcome;
use nalgebra::Vector3;
use rbd_core::{Model, Motor, joint_friction};

/// Time of standing still before the jump, s.
pub(crate) const HOLD: f64 = 0.3;
/// Time after touchdown at which the robot must stand, s.
pub(crate) const SETTLE: f64 = 2.0;
/// Speed at which the joints' Coulomb friction fades, rad/s.
const FRICTION_SMOOTHING: f64 = 0.1;
/// Ticks of the plant per tick of the controller.
const RATIO: u32 = 10;
/// Force on a foot that counts as its touchdown, N.
const TOUCHDOWN: f64 = 15.0;

/// Which run of a plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trial<'a> {
    pub(crate) sim: Sim,
    /// Into how many its usual integration steps are cut.
    pub(crate) finer: u32,
    /// How the lab differs from the plan.
    pub(crate) disturbance: Disturbance,
    /// Of the noise.
    pub(crate) seed: u64,
    /// How the motors are commanded.
    pub(crate) interface: Interface,
    /// Measures that the controller does without.
    pub(crate) without: &'a [Measure],
}

impl Trial<'_> {
    /// The nominal run.
    pub(crate) const fn nominal(sim: Sim) -> Self {
        Self {
            sim,
            finer: 1,
            disturbance: Disturbance::NOMINAL,
            seed: 0,
            interface: Interface::Torque,
            without: &[],
        }
    }

    /// Nothing differs from the plan.
    pub(crate) fn is_nominal(&self) -> bool {
        self.disturbance == Disturbance::NOMINAL
    }
}

/// Everything a run leaves behind.
pub(crate) struct Run {
    robot: Quadruped,
    pub(crate) samples: Vec<Sample>,
    pub(crate) final_phase: Phase,
    pub(crate) fault: Option<Fault>,
    pub(crate) first_contact: Option<f64>,
    pub(crate) hardware: Hardware<JOINTS>,
    pub(crate) peak_torque: f64,
    pub(crate) peak_foot_force: f64,
    pub(crate) ticks: [u64; 3],
    pub(crate) qp_solves: u64,
    pub(crate) qp_failures: u64,
    pub(crate) qp_max_iterations: u32,
    /// Largest errors of the estimated base: m, rad.
    pub(crate) estimate_errors: [f64; 2],
}

impl Run {
    pub(super) fn new(task: &Task, tick: f64) -> Self {
        let robot = &task.robot;
        let weight = task.problem.mass * task.problem.gravity;
        Self {
            robot: *robot,
            samples: Vec::new(),
            final_phase: Phase::Hold,
            fault: None,
            first_contact: None,
            hardware: Hardware::new(
                robot.budgets,
                robot.drives(),
                Model::limits(robot),
                weight,
                tick,
            ),
            peak_torque: 0.0,
            peak_foot_force: 0.0,
            ticks: [0; 3],
            qp_solves: 0,
            qp_failures: 0,
            qp_max_iterations: 0,
            estimate_errors: [0.0; 2],
        }
    }

    /// What one tick of the machine did.
    fn count(&mut self, tick: &Tick) {
        let Work::Landing(outcome) = tick.work else {
            self.ticks[1] += u64::from(tick.work == Work::Cartesian);
            return;
        };
        self.ticks[2] += 1;
        match outcome {
            Outcome::Airborne => {}
            Outcome::Solved(iterations) => {
                self.qp_solves += 1;
                self.qp_max_iterations = self.qp_max_iterations.max(iterations);
            }
            Outcome::Failed(_) | Outcome::BadData => {
                self.qp_solves += 1;
                self.qp_failures += 1;
            }
        }
    }

    /// Extremes and events of one tick of the plant that ended at `time`.
    fn observe(&mut self, world: &World, motors: &MotorTick<'_>, phase: Phase, time: f64) {
        let plant = world.plant();
        self.ticks[0] += 1;
        let delivered = plant.delivered();
        let most = delivered.iter().fold(0.0, |m, tau| f64::max(m, tau.abs()));
        self.peak_torque = self.peak_torque.max(most);
        let forces = plant.contact_forces_w();
        let feet = forces[..FOOT_COUNT].iter().map(Vector3::norm);
        let foot = feet.fold(0.0, f64::max);
        self.peak_foot_force = self.peak_foot_force.max(foot);
        let looking = matches!(phase, Phase::PreLanding | Phase::Landing);
        if self.first_contact.is_none() && looking && foot > TOUCHDOWN {
            self.first_contact = Some(time);
        }
        let owners = self
            .robot
            .owners
            .iter()
            .zip(forces)
            .zip(plant.link_forces());
        let touches: Vec<(&'static str, f64)> = owners
            .enumerate()
            // A foot may touch the ground, and no link.
            .map(|(i, ((name, ground), link))| {
                let ground = if i < FOOT_COUNT { 0.0 } else { ground.norm() };
                (*name, ground + link)
            })
            .filter(|(_, force)| *force > 0.0)
            .collect();
        self.hardware.add(&HardwareTick {
            time,
            dt: plant.tick(),
            stage: stage(phase),
            asked: motors.asked,
            given: delivered,
            speeds: motors.speeds,
            stops: plant.stop_torques(),
            ground: forces.iter().sum::<Vector3<f64>>().norm(),
            power: motors.power,
            touches: &touches,
        });
    }
}

/// What went through the motors in one tick of the plant.
struct MotorTick<'a> {
    asked: &'a [f64; JOINTS],
    speeds: &'a [f64; JOINTS],
    power: f64,
}

const fn stage(phase: Phase) -> Stage {
    match phase {
        Phase::Hold | Phase::Stance => Stage::PushOff,
        Phase::Flight | Phase::PreLanding => Stage::Flight,
        Phase::Landing | Phase::Stand | Phase::Abort => Stage::Landing,
    }
}

/// Runs the jump nominally; `progress` hears the plan time and the phase once per simulated 10 ms.
pub(crate) fn run(
    task: &Task,
    reference: &Reference,
    sim: Sim,
    progress: impl FnMut(f64, Phase),
) -> Result<Run, String> {
    let trial = Trial::nominal(sim);
    run_watched(task, reference, trial, |_, _| {}, progress, |_| {})
}

/// The path from the machine's commands to the plant's torques.
struct Drive {
    interface: Interface,
    boards: Boards<JOINTS>,
    motors: Motors<JOINTS>,
    /// Torques that the joint loop has computed and that act from the next tick on.
    computed: [f64; JOINTS],
    /// Mean of what the boards believe to have given, friction included, since the last tick of the machine.
    felt: [f64; JOINTS],
    robot: Quadruped,
    drives: [Motor<f64>; JOINTS],
}

impl Drive {
    fn new(trial: &Trial<'_>, robot: Quadruped) -> Self {
        let drives = robot.drives();
        Self {
            robot,
            drives,
            interface: trial.interface,
            boards: Boards::new(&trial.disturbance, trial.seed.wrapping_add(0xb0a2d)),
            motors: Motors::new(&trial.disturbance, drives, &robot.budgets),
            computed: [0.0; JOINTS],
            felt: [0.0; JOINTS],
        }
    }

    /// One tick of the plant: reads the encoders, lets the joint loop compute, and applies what it computed a tick ago.
    fn step<M: rbd_core::Tree<f64, JOINTS>>(
        &mut self,
        machine: &mut Machine<'_, f64, M, JOINTS, FOOT_COUNT>,
        (world, sensors): (&mut World, &mut Sensors),
        now: f64,
    ) -> Result<([f64; JOINTS], [f64; JOINTS]), String> {
        let dt = world.plant().tick();
        let (q, v) = sensors.encoders(world);
        let asked = self.computed;
        self.computed = match self.interface {
            Interface::Torque => machine.joint_tick(&q, &v, dt),
            Interface::JointPd { .. } => self.boards.torques(now, (&q, &v), &self.drives),
        };
        let speeds = world.velocity().joints;
        let given = self.motors.give(&asked, &speeds, dt);
        let flies = matches!(machine.phase(), Phase::Flight | Phase::PreLanding);
        world.step(&given, flies)?;
        let losses = joint_friction(Model::limits(&self.robot), &v, FRICTION_SMOOTHING);
        for ((felt, tau), loss) in self.felt.iter_mut().zip(self.motors.measured()).zip(losses) {
            *felt += (tau + loss) / f64::from(RATIO);
        }
        Ok((asked, speeds))
    }
}

/// The jump as the machine takes it, of a plan that borrows the reference.
fn jump<'a>(
    task: &Task,
    reference: &'a Reference,
) -> Result<Jump<'a, f64, JOINTS, FOOT_COUNT>, String> {
    let plan = Plan::new(
        &reference.nodes,
        reference.takeoff,
        reference.posing,
        reference.touchdown,
        Torques::Hold,
    );
    Ok(Jump {
        plan: plan.map_err(|error| error.to_string())?,
        weight: task.problem.mass * task.problem.gravity,
        rot_goal: heading_matrix(task.heading),
        landing_joints: reference.landing_joints,
    })
}

/// As [`run`], for any trial; `tamper` may change what the controller is told at each millisecond since the start, `watch` sees the
/// landing's memory after every tick that solved a program.
pub(crate) fn run_watched(
    task: &Task,
    reference: &Reference,
    trial: Trial<'_>,
    mut tamper: impl FnMut(u64, &mut Told),
    mut progress: impl FnMut(f64, Phase),
    mut watch: impl FnMut(&landing::Workspace<f64, 12, 4>),
) -> Result<Run, String> {
    let mut sensors = Sensors::new(&trial.disturbance, trial.interface, trial.seed, task);
    let mut world = plant((trial.sim, trial.finer), task, &trial.disturbance)?;
    let jump = jump(task, reference)?;
    let mut workspace = landing::Workspace::new();
    let robot = task.robot;
    let build = robot.build(&task.start);
    let mut settings = Settings::new(&build, robot.feet, robot.drives(), task.start.joints);
    for measure in trial.without {
        measure.leave(&mut settings);
    }
    let delayed = !trial.without.contains(&Measure::Delay);
    let mut machine = Machine::<_, _, JOINTS, FOOT_COUNT>::new(&robot, settings, &mut workspace);
    let armed = machine.arm(jump, 0.0);
    armed.map_err(|refusal| refusal.to_string())?;
    sensors.begin(-HOLD, &world);
    let mut drive = Drive::new(&trial, robot);
    let mut run = Run::new(task, world.plant().tick());
    let end = reference.touchdown + SETTLE + 0.5;
    let (mut k, mut node) = (0_u64, 0);
    loop {
        let t = k as f64 * 1e-3 - HOLD;
        if t > end {
            break;
        }
        let felt = core::mem::take(&mut drive.felt);
        let mut heard = sensors.measure(t, &world, &felt);
        if let Some(told) = &mut heard {
            if !delayed && told.measured.age.is_finite() {
                told.measured.age = 0.0;
            }
            tamper(k, told);
        }
        let tick = machine.tick(t, heard.as_ref());
        run.count(&tick);
        let mut commanded_forces_w = [Vector3::zeros(); FOOT_COUNT];
        if let Work::Landing(Outcome::Solved(_) | Outcome::Failed(_)) = tick.work {
            commanded_forces_w = machine.workspace().forces_w();
            watch(machine.workspace());
        }
        if k.is_multiple_of(trial.interface.period_ms()) {
            drive.boards.send(t, machine.command());
        }
        let planned = sample(&jump.plan, t, node);
        node = planned.node;
        run.samples.push(Sample {
            commanded_forces_w,
            ..record(&robot, &world, machine.phase(), &jump.plan, &planned, t)
        });
        for i in 0..RATIO {
            let now = t + f64::from(i) * world.plant().tick();
            let (asked, speeds) = drive.step(&mut machine, (&mut world, &mut sensors), now)?;
            let motors = MotorTick {
                asked: &asked,
                speeds: &speeds,
                power: drive.motors.power(),
            };
            run.observe(&world, &motors, machine.phase(), now + world.plant().tick());
        }
        if k.is_multiple_of(10) {
            progress(t, machine.phase());
        }
        k += 1;
    }
    run.final_phase = machine.phase();
    run.fault = machine.fault();
    run.estimate_errors = sensors.worst;
    Ok(run)
}

fn record(
    robot: &Quadruped,
    world: &World,
    phase: Phase,
    plan: &Plan<'_, f64, JOINTS, FOOT_COUNT>,
    planned: &jump_control::Reference<f64, JOINTS>,
    t: f64,
) -> Sample {
    let (q, v) = (world.configuration(), world.velocity());
    let node = plan.node(planned.node);
    Sample {
        time: t,
        phase,
        position: q.base.translation,
        orientation: so3::quat::from_rotation(&q.base.rotation),
        velocity_w: q.base.rotation * v.base.linear,
        omega_b: v.base.angular,
        com: robot.com(&q),
        joints: q.joints,
        joint_velocities: v.joints,
        torques: *world.plant().delivered(),
        forces_w: *world.plant().contact_forces_w(),
        planned_position: node.map_or_else(Vector3::zeros, |n| n.base.translation),
        planned_joints: planned.joints,
        planned_forces_w: node.map_or([Vector3::zeros(); FOOT_COUNT], |n| n.forces_w),
        commanded_forces_w: [Vector3::zeros(); FOOT_COUNT],
    }
}
