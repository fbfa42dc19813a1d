//! The closed loop: plant at 10 kHz, joint PD at 10 kHz, Cartesian PD, phases and landing at 1 kHz.

use super::log::Sample;
use super::plant::{Disturbance, Plant, Sim, plant};
use super::reference::{Reference, heading_matrix};
use super::sensors::{Sensors, Told};
use super::task::Task;
use super::{FOOT_COUNT, JOINTS, ROBOT, TRUNK, feet, kinematics};
use a1_model::{MOTORS, a1};
use jump_control::{
    CartesianGains, CartesianPd, Event, Fault, JointCommand, JointGains, Measurement, Phase, Plan,
    Scales, Slew, Torques, Watch, next_phase, sample,
};
use landing::{Detector, DetectorState, Landing, Outcome, PreLanding, Settings, Target, Workspace};
use nalgebra::Vector3;
use rbd_core::{Tangent, joint_friction};

/// Time of standing still before the jump, s.
pub(crate) const HOLD: f64 = 0.3;
/// Time after touchdown at which the robot must stand, s.
pub(crate) const SETTLE: f64 = 2.0;
/// Height of the centre of mass over the feet's centres when standing, m.
const STAND_HEIGHT: f64 = 0.25;
/// How far the body may lean from the middle of the feet towards the goal, m.
const LEAN: f64 = 0.03;
/// Damping of the safe command, N m s/rad.
const SAFE_DAMPING: f64 = 2.0;
/// Speed at which the joints' Coulomb friction fades, rad/s.
const FRICTION_SMOOTHING: f64 = 0.1;
/// Time before the planned touchdown from which the posture follows the tilt, s.
const LEVELLING: f64 = 0.12;
/// Largest share of the planned weight that counts as payload.
const MOST_PAYLOAD: f64 = 0.15;
/// Largest rate of a joint's torque, N m/s.
const SLEW: f64 = 1e4;
/// Ticks of the plant per tick of the controller.
const RATIO: usize = 10;

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

/// The controller's memory.
struct Controller<'a> {
    plan: Plan<'a, f64, JOINTS, FOOT_COUNT>,
    pd: CartesianPd<f64, JOINTS, FOOT_COUNT>,
    landing: Landing<f64, JOINTS, FOOT_COUNT, 12, 28>,
    workspace: Workspace<f64, 12, 28>,
    detector: Detector<f64, JOINTS, FOOT_COUNT>,
    contact: DetectorState<f64, JOINTS, FOOT_COUNT>,
    phase: Phase,
    hint: usize,
    goal_w: Vector3<f64>,
    target: Target<f64>,
    posture: PreLanding<f64, JOINTS, FOOT_COUNT>,
    scales: Scales<f64>,
    /// Weight that was planned with, N.
    weight: f64,
    calm: f64,
    fault: Option<Fault>,
}

impl Controller<'_> {
    /// What has happened, if anything, at plan time `t`.
    fn event(&mut self, t: f64, told: &Told) -> Option<Event> {
        let measured = &told.measured;
        self.fault = Watch { max_age: 0.005 }.fault(measured).or(self.fault);
        if self.fault.is_some() {
            return Some(Event::Fault);
        }
        let (q, v) = state(measured);
        self.detector.update(
            &ROBOT,
            &mut self.contact,
            &q,
            &v,
            &told.felt,
            &measured.foot_forces,
            1e-3,
        );
        let moving = measured.base_velocity.linear.norm() > 0.05
            || measured.base_velocity.angular.norm() > 0.2;
        self.calm = if moving { 0.0 } else { self.calm + 1e-3 };
        match self.phase {
            Phase::Hold => (t >= 0.0).then_some(Event::Start),
            Phase::Stance => (t >= self.plan.takeoff).then_some(Event::Takeoff),
            Phase::Flight => (t >= self.plan.posing).then_some(Event::Posing),
            Phase::PreLanding if self.contact.any() => Some(Event::Touchdown),
            Phase::PreLanding => (t > self.plan.touchdown + 0.5).then_some(Event::Overdue),
            Phase::Landing => (self.calm > 0.2).then_some(Event::Settled),
            Phase::Stand => (self.calm == 0.0).then_some(Event::Disturbed),
            Phase::Abort => None,
        }
    }

    /// One tick at 1 kHz.
    fn tick(&mut self, t: f64, told: &Told, run: &mut Run) -> JointCommand<f64, JOINTS> {
        if let Some(event) = self.event(t, told) {
            self.phase = next_phase(self.phase, event);
        }
        let measured = &told.measured;
        match self.phase {
            Phase::Hold | Phase::Stance | Phase::Flight | Phase::PreLanding => {
                run.ticks[1] += 1;
                let mut then = sample(&self.plan, t - measured.age, self.hint);
                let mut reference = sample(&self.plan, t, then.node);
                self.hint = then.node;
                if self.phase == Phase::PreLanding && t > self.plan.touchdown - LEVELLING {
                    then.joints = self.meeting(measured);
                    reference.joints = then.joints;
                }
                match self.phase {
                    // Its weight has settled on the feet by then.
                    Phase::Hold if t > -0.5 * HOLD => self.scales.add(&measured.foot_forces),
                    Phase::Stance => {
                        let factor = self.scales.factor(self.weight, MOST_PAYLOAD);
                        reference.torques = reference.torques.map(|torque| torque * factor);
                    }
                    _ => {}
                }
                self.pd.command(&ROBOT, measured, &reference, &then)
            }
            Phase::Landing | Phase::Stand => {
                run.ticks[2] += 1;
                self.land(measured, run)
            }
            Phase::Abort => JointCommand::damp(SAFE_DAMPING),
        }
    }

    /// Where legs meet the ground: the plan's landing posture, turned against the measured tilt.
    fn meeting(&self, measured: &Measurement<f64, JOINTS, FOOT_COUNT>) -> [f64; JOINTS] {
        let up_b = measured.base.rotation.inverse() * Vector3::z();
        self.posture
            .joints(&ROBOT, &up_b, &measured.base_velocity.linear)
    }

    fn land(
        &mut self,
        measured: &Measurement<f64, JOINTS, FOOT_COUNT>,
        run: &mut Run,
    ) -> JointCommand<f64, JOINTS> {
        let (q, v) = state(measured);
        let poses = kinematics::poses(&q);
        let middle: Vector3<f64> = feet()
            .iter()
            .map(|f| poses.frame(f).translation)
            .sum::<Vector3<f64>>()
            / 4.0;
        let lean = (self.goal_w - middle).map(|x| x.clamp(-LEAN, LEAN));
        self.target.offset_w = [lean.x, lean.y];
        let c = self.landing.step(
            &ROBOT,
            &q,
            &v,
            &self.contact.contacts,
            &self.target,
            &self.posture.joints,
            &mut self.workspace,
        );
        match c.outcome {
            Outcome::Airborne => {}
            Outcome::Solved(iterations) => {
                run.qp_solves += 1;
                run.qp_max_iterations = run.qp_max_iterations.max(iterations);
            }
            Outcome::Failed(_) | Outcome::BadData => {
                run.qp_solves += 1;
                run.qp_failures += 1;
            }
        }
        JointCommand {
            position: c.position,
            velocity: [0.0; JOINTS],
            feed_forward: c.feed_forward,
            gains: core::array::from_fn(|i| JointGains {
                stiffness: c.stiffness[i],
                damping: c.damping[i],
            }),
        }
    }
}

/// Configuration and velocity as measured.
fn state(measured: &Measurement<f64, JOINTS, FOOT_COUNT>) -> (super::State, Tangent<f64, JOINTS>) {
    let q = super::State {
        base: measured.base,
        joints: measured.joints,
    };
    let v = Tangent {
        base: measured.base_velocity,
        joints: measured.joint_velocities,
    };
    (q, v)
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
    mut tamper: impl FnMut(u64, &mut Told),
    mut progress: impl FnMut(f64, Phase),
) -> Result<Run, String> {
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
    let mut controller = Controller {
        plan,
        pd: CartesianPd {
            feet: feet(),
            gains: CartesianGains {
                stiffness: [200.0; 3],
                damping: [5.0; 3],
            },
            joint_gains: [JointGains {
                stiffness: 60.0,
                damping: 1.5,
            }; JOINTS],
        },
        landing: Landing::new(feet(), Settings::a1(), MOTORS.map(|motor| motor.torque)),
        workspace: Workspace::new(),
        detector: Detector::new(feet()),
        contact: DetectorState::new(),
        phase: Phase::Hold,
        hint: 0,
        goal_w: kinematics::com(&task.start) + task.goal,
        target: Target {
            height: STAND_HEIGHT,
            rot_wb: heading_matrix(task.heading),
            offset_w: [0.0; 2],
        },
        posture: PreLanding {
            // A third of what a body that only falls would need: more lands the backflip on its trunk, none lets the
            // forward jump tip over.
            lead: 0.04,
            ..PreLanding::new(feet(), reference.landing_joints)
        },
        scales: Scales::new(),
        weight: task.problem.mass * task.problem.gravity,
        calm: 0.0,
        fault: None,
    };
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
    let (mut slew, mut felt) = (Slew::new(SLEW), [0.0; JOINTS]);
    let mut k = 0_u64;
    loop {
        let t = k as f64 * 1e-3 - HOLD;
        if t > end {
            break;
        }
        let mut told = sensors.measure(&plant, &felt);
        tamper(k, &mut told);
        let command = controller.tick(t, &told, &mut run);
        felt = [0.0; JOINTS];
        run.samples.push(record(&plant, &controller, t));
        for _ in 0..RATIO {
            let (q, v) = sensors.encoders(&plant);
            let torques = slew.limit(&command.torques(&q, &v, &MOTORS), plant.tick());
            let speeds = plant.velocity().joints;
            plant.step(&torques).map_err(|error| error.to_string())?;
            let losses = joint_friction(&a1::LIMITS, &speeds, FRICTION_SMOOTHING);
            for ((felt, tau), loss) in felt.iter_mut().zip(plant.delivered()).zip(losses) {
                *felt += (tau + loss) / RATIO as f64;
            }
            observe(&mut run, &plant, &torques, &speeds, controller.phase, t);
        }
        if k.is_multiple_of(10) {
            progress(t, controller.phase);
        }
        k += 1;
    }
    run.final_phase = controller.phase;
    run.fault = controller.fault;
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

fn record(plant: &Plant, controller: &Controller<'_>, t: f64) -> Sample {
    let (q, v) = (plant.configuration(), plant.velocity());
    let planned = sample(&controller.plan, t, controller.hint);
    let node = controller.plan.nodes().get(planned.node);
    Sample {
        time: t,
        phase: controller.phase,
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
