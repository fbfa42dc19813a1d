//! The closed loop: plant and joint control at 10 kHz, the jump machine at 1 kHz.

use super::log::Sample;
use super::measure::Measure;
use super::plant::{Disturbance, Plant, Sim, plant};
use super::reference::{Reference, heading_matrix};
use super::sensors::{Sensors, Told};
use super::task::Task;
use super::{FOOT_COUNT, JOINTS, ROBOT, TRUNK, feet, kinematics};
use a1_model::{MOTORS, a1};
use jump_control::{Fault, Phase, Plan, Steady, Torques, sample};
use jump_machine::{Jump, Machine, Settings, Tick, Work};
use landing::Outcome;
use nalgebra::Vector3;
use rbd_core::joint_friction;

/// Time of standing still before the jump, s.
pub(crate) const HOLD: f64 = 0.3;
/// Time after touchdown at which the robot must stand, s.
pub(crate) const SETTLE: f64 = 2.0;
/// Speed at which the joints' Coulomb friction fades, rad/s.
const FRICTION_SMOOTHING: f64 = 0.1;
/// Ticks of the plant per tick of the controller.
const RATIO: usize = 10;

/// Which run of a plan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trial<'a> {
    pub(crate) sim: Sim,
    /// Of the disturbances; 0 is the nominal run.
    pub(crate) seed: u64,
    /// Measures that the controller does without.
    pub(crate) without: &'a [Measure],
}

/// Everything a run leaves behind.
pub(crate) struct Run {
    pub(crate) samples: Vec<Sample>,
    pub(crate) final_phase: Phase,
    pub(crate) fault: Option<Fault>,
    pub(crate) first_contact: Option<f64>,
    pub(crate) peak_torque: f64,
    pub(crate) push_off_saturation: f64,
    pub(crate) landing_saturation: f64,
    pub(crate) peak_foot_force: f64,
    pub(crate) trunk_contact: bool,
    pub(crate) ticks: [u64; 3],
    pub(crate) qp_solves: u64,
    pub(crate) qp_failures: u64,
    pub(crate) qp_max_iterations: u32,
    /// Largest errors of the estimated base: m, rad; zero where the controller was told the truth.
    pub(crate) estimate_errors: [f64; 2],
}

impl Run {
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
}

/// Whether a motor gives no more than its limit at this speed.
fn saturated(torques: &[f64; JOINTS], speeds: &[f64; JOINTS]) -> bool {
    torques
        .iter()
        .zip(speeds)
        .zip(&MOTORS)
        .any(|((tau, qd), motor)| {
            let [low, high] = motor.torque_range(*qd);
            *tau <= low + 1e-9 || *tau >= high - 1e-9
        })
}

/// Runs the jump; `progress` hears the plan time and the phase once per simulated 10 ms.
pub(crate) fn run(
    task: &Task,
    reference: &Reference,
    sim: Sim,
    seed: u64,
    progress: impl FnMut(f64, Phase),
) -> Result<Run, String> {
    run_tampered(task, reference, sim, seed, |_, _| {}, progress)
}

/// As [`run`]; `tamper` may change what the controller is told at each millisecond since the start.
pub(super) fn run_tampered(
    task: &Task,
    reference: &Reference,
    sim: Sim,
    seed: u64,
    tamper: impl FnMut(u64, &mut Told),
    progress: impl FnMut(f64, Phase),
) -> Result<Run, String> {
    let trial = Trial {
        sim,
        seed,
        without: &[],
    };
    run_watched(task, reference, trial, tamper, progress, |_| {})
}

/// As [`run_tampered`]; `watch` sees the landing's memory after every tick that solved a program.
pub(crate) fn run_watched(
    task: &Task,
    reference: &Reference,
    trial: Trial<'_>,
    mut tamper: impl FnMut(u64, &mut Told),
    mut progress: impl FnMut(f64, Phase),
    mut watch: impl FnMut(&landing::Workspace<f64, 12, 4>),
) -> Result<Run, String> {
    let Trial { sim, seed, without } = trial;
    let disturbance = Disturbance::draw(seed);
    let mut sensors = Sensors::new(&disturbance, seed, &task.start);
    let mut plant = plant(sim, task, &disturbance)?;
    let plan = Plan::new(
        &reference.nodes,
        reference.takeoff,
        reference.posing,
        reference.touchdown,
        Torques::Hold,
    )
    .map_err(|error| error.to_string())?;
    let jump = Jump {
        plan,
        weight: task.problem.mass * task.problem.gravity,
        goal_w: kinematics::com(&task.start) + task.goal,
        rot_goal: heading_matrix(task.heading),
        landing_joints: reference.landing_joints,
    };
    let mut workspace = landing::Workspace::new();
    let mut settings = Settings::a1(feet(), MOTORS, task.start.joints);
    if disturbance.imu.is_none() {
        settings.steady = Steady::a1_known_base();
    }
    for measure in without {
        measure.leave(&mut settings);
    }
    let delayed = !without.contains(&Measure::Delay);
    let mut machine = Machine::<_, _, JOINTS, FOOT_COUNT>::new(&ROBOT, settings, &mut workspace);
    machine
        .arm(jump, 0.0)
        .map_err(|refusal| refusal.to_string())?;
    let mut run = Run {
        samples: Vec::new(),
        final_phase: Phase::Hold,
        fault: None,
        first_contact: None,
        peak_torque: 0.0,
        push_off_saturation: 0.0,
        landing_saturation: 0.0,
        peak_foot_force: 0.0,
        trunk_contact: false,
        ticks: [0; 3],
        qp_solves: 0,
        qp_failures: 0,
        qp_max_iterations: 0,
        estimate_errors: [0.0; 2],
    };
    let end = reference.touchdown + SETTLE + 0.5;
    let mut felt = [0.0; JOINTS];
    let (mut k, mut node) = (0_u64, 0);
    loop {
        let t = k as f64 * 1e-3 - HOLD;
        if t > end {
            break;
        }
        let mut told = sensors.measure(&plant, &felt);
        if !delayed && told.measured.age.is_finite() {
            told.measured.age = 0.0;
        }
        tamper(k, &mut told);
        let tick = machine.tick(t, Some(&told));
        run.count(&tick);
        if let Work::Landing(Outcome::Solved(_) | Outcome::Failed(_)) = tick.work {
            watch(machine.workspace());
        }
        felt = [0.0; JOINTS];
        let planned = sample(&plan, t, node);
        node = planned.node;
        run.samples
            .push(record(&plant, machine.phase(), &plan, &planned, t));
        for _ in 0..RATIO {
            let (q, v) = sensors.encoders(&plant);
            let torques = machine.joint_tick(&q, &v, plant.tick());
            let speeds = plant.velocity().joints;
            plant.step(&torques).map_err(|error| error.to_string())?;
            let losses = joint_friction(&a1::LIMITS, &speeds, FRICTION_SMOOTHING);
            for ((felt, tau), loss) in felt.iter_mut().zip(plant.delivered()).zip(losses) {
                *felt += (tau + loss) / RATIO as f64;
            }
            observe(&mut run, &plant, &torques, &speeds, machine.phase(), t);
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

/// Extremes of one plant tick.
fn observe(
    run: &mut Run,
    plant: &Plant,
    torques: &[f64; JOINTS],
    speeds: &[f64; JOINTS],
    phase: Phase,
    t: f64,
) {
    run.ticks[0] += 1;
    run.peak_torque = plant
        .delivered()
        .iter()
        .fold(run.peak_torque, |m, tau| m.max(tau.abs()));
    if saturated(torques, speeds) {
        match phase {
            Phase::Hold | Phase::Stance => run.push_off_saturation += plant.tick(),
            Phase::Landing | Phase::Stand => run.landing_saturation += plant.tick(),
            _ => {}
        }
    }
    let forces = plant.contact_forces_w();
    for force in &forces[..FOOT_COUNT] {
        run.peak_foot_force = run.peak_foot_force.max(force.norm());
    }
    run.trunk_contact |= forces[TRUNK..].iter().any(|f| f.norm() > 0.0);
    let looking = matches!(phase, Phase::PreLanding | Phase::Landing);
    if run.first_contact.is_none()
        && looking
        && forces[..FOOT_COUNT].iter().any(|f| f.norm() > 15.0)
    {
        run.first_contact = Some(t);
    }
}

fn record(
    plant: &Plant,
    phase: Phase,
    plan: &Plan<'_, f64, JOINTS, FOOT_COUNT>,
    planned: &jump_control::Reference<f64, JOINTS>,
    t: f64,
) -> Sample {
    let (q, v) = (plant.configuration(), plant.velocity());
    let node = plan.nodes().get(planned.node);
    Sample {
        time: t,
        phase,
        position: q.base.translation,
        orientation: so3::quat::from_rotation(&q.base.rotation),
        velocity_w: q.base.rotation * v.base.linear,
        omega_b: v.base.angular,
        com: kinematics::com(q),
        joints: q.joints,
        joint_velocities: v.joints,
        torques: *plant.delivered(),
        forces_w: *plant.contact_forces_w(),
        planned_position: node.map_or_else(Vector3::zeros, |n| n.base.translation),
        planned_joints: planned.joints,
        planned_forces_w: node.map_or([Vector3::zeros(); FOOT_COUNT], |n| n.forces_w),
    }
}
