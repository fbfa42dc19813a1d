//! A quadruped's jump in the closed loop, and what is kept of it.

use super::log::Sample;
use super::measure::Measure;
use super::series::run_all;
use super::{FOOT_COUNT, JOINTS, OWNERS, Observed, Planned, World};
use crate::Sim;
use crate::closed_loop::{ClosedLoop, Drive, Feet, Recorder, Sensors, Setting, Step, stage};
use crate::lab::{Disturbance, Interface};
use crate::verdict::{Hardware, Tick as HardwareTick};
use jump_control::{Fault, Phase, Plan, sample};
use jump_machine::{Machine, Tick, Work};
use jump_planner::reference::Reference;
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use landing::Outcome;
use nalgebra::Vector3;
use rbd_core::{Model, Transform};
use state_est::Foot;

/// Time of standing still before the jump, s.
pub const HOLD: f64 = 1.2;
/// Time after touchdown at which the robot must stand, s.
pub const SETTLE: f64 = 2.0;
/// Force at which a foot is certainly loaded, N.
const LOADED: f64 = 15.0;
/// Force on a foot that counts as its touchdown, N.
const TOUCHDOWN: f64 = 15.0;

/// Which run of a plan.
#[derive(Clone, Copy, Debug)]
pub struct Trial<'a> {
    /// The simulator.
    pub sim: Sim,
    /// How the lab differs from the plan.
    pub disturbance: Disturbance,
    /// Of the noise.
    pub seed: u64,
    /// How the motors are commanded.
    pub interface: Interface,
    /// Measures that the controller does without.
    pub without: &'a [Measure],
}

impl Trial<'_> {
    /// The nominal run.
    #[must_use]
    pub const fn nominal(sim: Sim) -> Self {
        Self {
            sim,
            disturbance: Disturbance::NOMINAL,
            seed: 0,
            interface: Interface::Torque,
            without: &[],
        }
    }

    /// Nothing differs from the plan.
    #[must_use]
    pub fn is_nominal(&self) -> bool {
        self.disturbance == Disturbance::NOMINAL
    }
}

/// Everything a run leaves behind.
pub struct Run {
    robot: Quadruped,
    /// Of the container whose bytes the machine followed.
    pub plan_checksum: u32,
    /// By how much the landing's ground was higher than known, m.
    pub ground_height: f64,
    /// One per millisecond.
    pub samples: Vec<Sample>,
    /// Of the robot that was planned for, N.
    pub weight: f64,
    /// Of the machine, in the end.
    pub final_phase: Phase,
    /// Why the machine gave up, where it did.
    pub fault: Option<Fault>,
    /// Whether no foot has touched the ground after the push-off, for a moment at least.
    pub took_off: bool,
    /// When a foot touched the ground after that, s.
    pub first_contact: Option<f64>,
    /// What the run asked of motors, joints and supply.
    pub hardware: Hardware<JOINTS>,
    /// Largest torque of a joint, N m.
    pub peak_torque: f64,
    /// Largest force on a foot, N.
    pub peak_foot_force: f64,
    /// Ticks of the plant, of the machine in the push-off by Cartesian feedback, and in the landing.
    pub ticks: [u64; 3],
    /// Programs of the landing that were solved.
    pub qp_solves: u64,
    /// Those without an answer.
    pub qp_failures: u64,
    /// Most iterations of one.
    pub qp_max_iterations: u32,
    /// Largest errors of the estimated base: m, rad.
    pub estimate_errors: [f64; 2],
}

impl Run {
    pub(super) fn new(task: &Task, plan_checksum: u32, tick: f64) -> Self {
        let robot = &task.robot;
        let weight = task.problem.mass * task.problem.gravity;
        Self {
            robot: *robot,
            plan_checksum,
            ground_height: 0.0,
            samples: Vec::new(),
            weight,
            final_phase: Phase::Hold,
            fault: None,
            took_off: false,
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

    /// Extremes and events of one tick of the plant.
    pub(super) fn observe(&mut self, world: &World, step: &Step<JOINTS>, phase: Phase) {
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
        self.took_off |= (looking || phase == Phase::Flight) && foot <= TOUCHDOWN;
        let looking = looking && self.took_off;
        if self.first_contact.is_none() && looking && foot > TOUCHDOWN {
            self.first_contact = Some(step.time);
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
            time: step.time,
            dt: step.dt,
            stage: stage(phase),
            asked: &step.asked,
            given: delivered,
            speeds: &step.speeds,
            stops: plant.stop_torques(),
            ground: forces.iter().sum::<Vector3<f64>>().norm(),
            power: step.power,
            touches: &touches,
        });
    }
}

/// Runs the jump nominally; `progress` hears the plan time and the phase once per simulated 10 ms.
///
/// # Errors
/// A sentence: the machine refuses the jump, this build lacks the simulator, or that fails.
pub fn run(
    task: &Task,
    reference: &Reference,
    sim: Sim,
    progress: impl FnMut(f64, Phase),
) -> Result<Run, String> {
    let trial = Trial::nominal(sim);
    run_watched(task, reference, trial, |_, _| {}, progress, |_| {})
}

/// A quadruped's machine as a trial closes its loop.
pub type Closed<'m> = ClosedLoop<
    Quadruped,
    Machine<'m, f64, Quadruped, JOINTS, FOOT_COUNT>,
    JOINTS,
    FOOT_COUNT,
    OWNERS,
    { FOOT_COUNT + 2 },
>;

/// Closes the loop of a trial: the machine hears and moves the robot that is in this world, and knows where and how it begins.
#[must_use]
pub fn closed<'m>(
    (robot, feet): (Quadruped, Feet<JOINTS, FOOT_COUNT, OWNERS>),
    machine: Machine<'m, f64, Quadruped, JOINTS, FOOT_COUNT>,
    world: World,
    trial: &Trial<'_>,
) -> Closed<'m> {
    let disturbance = &trial.disturbance;
    let (start, moving) = (world.configuration(), *world.velocity());
    let setting = Setting {
        disturbance,
        interface: trial.interface,
        seed: trial.seed,
        start: &start,
        moving: &moving,
    };
    let limits = (Model::limits(&robot), robot.drives());
    let commanded = (trial.interface, trial.seed);
    ClosedLoop {
        machine,
        sensors: Sensors::new(robot, feet, &setting),
        drive: Drive::new(disturbance, commanded, limits, &robot.budgets),
        world,
        now: 0.0,
    }
}

/// Force of the ground on each foot, N.
fn foot_forces(world: &World) -> [f64; FOOT_COUNT] {
    let forces = world.plant().contact_forces_w();
    core::array::from_fn(|i| forces[i].norm())
}

/// The feet of a robot that stands before it jumps.
#[must_use]
pub fn feet(robot: &Quadruped) -> Feet<JOINTS, FOOT_COUNT, OWNERS> {
    Feet {
        feet: robot.feet.map(|frame| Foot {
            frame,
            radius: robot.foot_radius,
        }),
        loaded: LOADED,
        settling: 5,
        forces: foot_forces,
    }
}

/// May change what the controller is told in a millisecond.
pub(super) type Tamper<'a> = dyn FnMut(u64, &mut Observed) + 'a;
/// Sees the landing's memory.
pub(super) type Watch<'a> = dyn FnMut(&landing::Workspace<f64, 12, 4>) + 'a;

/// What is kept of a run.
pub(super) struct Keeper<'a, 'p> {
    pub(super) run: Run,
    pub(super) plan: &'a Plan<'p, f64, JOINTS, FOOT_COUNT>,
    /// Node of the plan's last sample.
    pub(super) node: usize,
    /// Pose of the simulator's world in that of the plan.
    pub(super) frame: Transform<f64>,
    pub(super) tamper: &'a mut Tamper<'a>,
    pub(super) watch: &'a mut Watch<'a>,
}

impl<'m> Recorder<Machine<'m, f64, Quadruped, JOINTS, FOOT_COUNT>, JOINTS, FOOT_COUNT, OWNERS>
    for Keeper<'_, '_>
{
    fn tell(&mut self, k: u64, told: &mut Observed) {
        (self.tamper)(k, told);
    }

    fn ticked(
        &mut self,
        t: f64,
        tick: &Tick,
        machine: &Machine<'m, f64, Quadruped, JOINTS, FOOT_COUNT>,
        world: &World,
    ) {
        self.run.count(tick);
        let mut commanded_forces_w = [Vector3::zeros(); FOOT_COUNT];
        if let Work::Landing(Outcome::Solved(_) | Outcome::Failed(_)) = tick.work {
            commanded_forces_w = machine.workspace().forces_w();
            (self.watch)(machine.workspace());
        }
        let planned = sample(self.plan, t, self.node);
        self.node = planned.node;
        let robot = &self.run.robot;
        let record = record(robot, world, tick.phase, self.plan, &planned, t);
        self.run.samples.push(Sample {
            commanded_forces_w,
            ..record.seen_in(&self.frame)
        });
    }

    fn stepped(
        &mut self,
        step: &Step<JOINTS>,
        machine: &Machine<'m, f64, Quadruped, JOINTS, FOOT_COUNT>,
        world: &World,
    ) {
        self.run.observe(world, step, machine.phase());
    }
}

/// As [`run`], for any trial; `tamper` may change what the controller is told at each millisecond since the start, `watch` sees the
/// landing's memory after every tick that solved a program.
///
/// # Errors
/// A sentence: the machine refuses the jump, this build lacks the simulator, or that fails.
pub fn run_watched(
    task: &Task,
    reference: &Reference,
    trial: Trial<'_>,
    mut tamper: impl FnMut(u64, &mut Observed),
    mut progress: impl FnMut(f64, Phase),
    mut watch: impl FnMut(&landing::Workspace<f64, 12, 4>),
) -> Result<Run, String> {
    let watched = (&mut tamper as &mut Tamper<'_>, &mut watch as &mut Watch<'_>);
    let planned = Planned {
        task: task.clone(),
        reference: reference.clone(),
    };
    let mut first = Some(planned);
    let mut next = |_: usize, _: Option<&[Vector3<f64>; FOOT_COUNT]>| Ok(first.take());
    let flown = run_all(&mut next, 1, &trial, watched, &mut progress)?;
    let run = flown.into_iter().next().map(|(_, run)| run);
    run.ok_or_else(|| "no jump".to_owned())
}

/// A sample of a world at time `t` of the plan.
pub(super) fn record(
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
        floor: world.moved(),
        planned_position: node.map_or_else(Vector3::zeros, |n| n.base.translation),
        planned_joints: planned.joints,
        planned_torques: planned.torques,
        planned_forces_w: node.map_or([Vector3::zeros(); FOOT_COUNT], |n| n.forces_w),
        commanded_forces_w: [Vector3::zeros(); FOOT_COUNT],
    }
}
