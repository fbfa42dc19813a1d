//! iCub pushes off by the torque program, paper B eqs. (6a) to (6f), in double precision, as `saltus run icub/torque`.

use contact_sim::{NativeSimulator, Settings, Shape, Simulator, Terrain};
use icub_model::gazebo::joint;
use icub_model::{Icub23, LIMITS, MOTORS, SOLES};
use jump_control::{ComProfile, Curve, JointCommand, takeoff_speed};
use nalgebra::Vector3;
use rbd_core::{
    Configuration, JointLimits, Kinematics, Motion, Posture, Tangent, Transform, center_of_mass,
    forward_kinematics,
};
use wbc_qp::jump::{ComReference, TorqueJump, TorqueJumpSettings};
use wbc_qp::{Contact, Snapshot};

use super::digested;
use crate::Recorder;
use crate::inputs::Stream;

const SUBJECT: &str = "icub-jump";
const N: usize = 23;
/// Time of standing in the squat, and of the push-off, ms.
const HOLD: usize = 100;
const PUSH: usize = 430;
/// Joint ticks per tick of the program.
const RATIO: usize = 10;
const GRAVITY: f64 = 9.81;
/// Most steps of the solver in a tick: with them a tick takes less than 720,000 instructions on a Cortex-M7. The push-off needs 7.
const STEPS: u32 = 11;
/// States that no jump visits.
const WILD: usize = 200;

type Program = TorqueJump<f64, N, 12, 35, 55>;
/// Configuration and velocity.
type State = (Configuration<f64, N>, Tangent<f64, N>);

/// Legs, torso and arms of a squat.
fn squat() -> [f64; N] {
    let mut q = [0.0; N];
    let mut set = |i: usize, x: f64| {
        if let Some(slot) = q.get_mut(i) {
            *slot = x;
        }
    };
    for (hip, knee, ankle) in [
        (joint::L_HIP_PITCH, joint::L_KNEE, joint::L_ANKLE_PITCH),
        (joint::R_HIP_PITCH, joint::R_KNEE, joint::R_ANKLE_PITCH),
    ] {
        set(hip, 1.496);
        set(knee, -2.013);
        set(ankle, -0.817);
    }
    set(joint::TORSO_PITCH, 0.2);
    for first in [joint::L_SHOULDER_PITCH, joint::R_SHOULDER_PITCH] {
        set(first, -0.5);
        set(first + 1, 0.4);
        set(first + 3, 0.8);
    }
    q
}

fn poses(q: &Configuration<f64, N>) -> Kinematics<f64, N> {
    let mut kinematics = Kinematics::IDENTITY;
    forward_kinematics(&Icub23, &Posture::new(&Icub23, q), &mut kinematics);
    kinematics
}

/// With both soles flat on the floor.
fn standing() -> Configuration<f64, N> {
    let mut q = Configuration {
        joints: squat(),
        ..Configuration::NEUTRAL
    };
    let [left, right] = SOLES.each_ref().map(|sole| &sole.frame);
    q.base.rotation = poses(&q).frame(left).rotation.inverse();
    let kinematics = poses(&q);
    let middle = kinematics.frame(left).translation + kinematics.frame(right).translation;
    q.base.translation = -middle * 0.5;
    q
}

/// Corners of the soles.
fn balls() -> [Shape<f64>; 8] {
    let [left, right] = SOLES.each_ref();
    let corners = [
        Shape::corners(left, 0.005, 0),
        Shape::corners(right, 0.005, 4),
    ];
    core::array::from_fn(|i| {
        let sole = corners.get(i / 4).and_then(|corners| corners.as_ref());
        let ball = sole.and_then(|balls| balls.get(i % 4));
        let none = Shape::ball(rbd_core::Link::Base, [0.0; 3], 0.0, i);
        ball.copied().unwrap_or(none)
    })
}

fn settings() -> TorqueJumpSettings<f64, N> {
    let mut settings = TorqueJumpSettings::icub();
    settings.max_steps = STEPS;
    for (i, weight) in settings.posture_weight.iter_mut().enumerate() {
        *weight = match i {
            joint::L_KNEE | joint::R_KNEE => 3.0,
            joint::L_HIP_PITCH | joint::R_HIP_PITCH => 0.7,
            joint::L_SHOULDER_PITCH.. => 0.3,
            _ => 1.0,
        };
    }
    settings
}

/// Limits with a margin on speed.
fn guarded() -> [JointLimits<f64>; N] {
    let mut limits = LIMITS;
    for (i, limits) in limits.iter_mut().enumerate() {
        limits.speed *= if i < joint::L_SHOULDER_PITCH {
            0.95
        } else {
            0.9
        };
    }
    limits
}

/// A simulated iCub in the place of the robot: in a squat on both soles, at rest.
#[derive(Clone, Debug)]
pub struct IcubFlight {
    plant: NativeSimulator<f64, Icub23, N, 8, 8>,
    steps: usize,
    broken: bool,
}

impl IcubFlight {
    /// Before the push-off.
    #[must_use]
    pub fn new() -> Self {
        let mut plant = NativeSimulator::new(
            Icub23,
            balls(),
            Terrain::FLAT,
            Settings::new(&LIMITS, &MOTORS),
        );
        plant.reset(&standing(), &Tangent::ZERO);
        Self {
            plant,
            steps: 0,
            broken: false,
        }
    }

    /// Joint positions and velocities of now.
    #[must_use]
    pub fn joints(&self) -> ([f64; N], [f64; N]) {
        let (q, v) = (self.plant.configuration(), self.plant.velocity());
        (q.joints, v.joints)
    }

    /// What the controller is told: the truth.
    #[must_use]
    pub fn hear(&self) -> State {
        (*self.plant.configuration(), *self.plant.velocity())
    }

    /// 100 µs under these torques.
    pub fn step(&mut self, torques: &[f64; N]) {
        self.broken |= self.plant.step(torques).is_err();
        self.steps += 1;
    }

    /// Whether it has taken off.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.broken || self.steps >= (HOLD + PUSH) * RATIO
    }
}

impl Default for IcubFlight {
    fn default() -> Self {
        Self::new()
    }
}

/// The push-off's controller, from standing in the squat to take-off.
#[derive(Clone, Debug)]
pub struct IcubPush {
    program: Program,
    snapshot: Snapshot<f64, N>,
    contacts: [Contact<f64>; 2],
    limits: [JointLimits<f64>; N],
    profile: ComProfile<f64>,
    com: Vector3<f64>,
    ticks: u32,
    command: JointCommand<f64, N>,
}

impl IcubPush {
    /// Before the first tick; `None` if the push-off cannot be as wanted.
    #[must_use]
    pub fn new() -> Option<Self> {
        let start = standing();
        let speed = takeoff_speed(0.04, GRAVITY);
        Some(Self {
            program: Program::new(settings(), start.joints),
            snapshot: Snapshot::ZERO,
            contacts: SOLES.each_ref().map(|sole| Contact::new(sole, 0.5, 1000.0)),
            limits: guarded(),
            profile: ComProfile::by_displacement(Curve::rising(), speed, 0.11, GRAVITY)?,
            com: center_of_mass(&Icub23, &Posture::new(&Icub23, &start)).position_w,
            ticks: 0,
            command: JointCommand::damp(0.0),
        })
    }

    /// One tick of 1 kHz: torques and the solver's iterations. Without an answer the last command stays.
    pub fn tick(&mut self, (q, v): &State) -> Option<([f64; N], f64)> {
        let point = self
            .profile
            .at(1e-3 * (f64::from(self.ticks) - HOLD as f64));
        self.ticks = self.ticks.wrapping_add(1);
        let wanted = ComReference {
            position_w: self.com + Vector3::z() * point.rise,
            velocity_w: Vector3::z() * point.speed,
            acceleration_w: Vector3::z() * point.acceleration,
        };
        self.snapshot.update(&Icub23, q, v);
        let joints = (&self.limits, &MOTORS);
        let tick = self
            .program
            .tick(&Icub23, &self.snapshot, &self.contacts, joints, &wanted);
        let answer = tick.ok()?.answer;
        self.command.feed_forward = answer.torques;
        Some((answer.torques, f64::from(answer.iterations)))
    }

    /// What the joints are to do.
    #[must_use]
    pub const fn command(&self) -> &JointCommand<f64, N> {
        &self.command
    }
}

/// Pushes off in closed loop with the simulator, then tries the program where no push-off comes.
pub fn icub<R: Recorder>(recorder: &mut R) {
    let mut flight = IcubFlight::new();
    let Some(mut push) = IcubPush::new() else {
        return;
    };
    while !flight.is_over() {
        let state = flight.hear();
        digested::<f64, _, _, _>(
            recorder,
            SUBJECT,
            (&mut push, &state),
            |(push, state)| push.tick(state),
            |_| "torque tick",
        );
        for i in 0..RATIO {
            let (q, v) = flight.joints();
            let input = (push.command(), &q, &v);
            let torques = if i == 0 {
                digested::<f64, _, _, _>(
                    recorder,
                    SUBJECT,
                    input,
                    |(command, q, v)| command.torques(q, v, &MOTORS),
                    |_| "joint PD tick",
                )
            } else {
                push.command().torques(&q, &v, &MOTORS)
            };
            flight.step(&torques);
        }
    }
    let end = flight.plant.velocity().base.to_array();
    end.iter().for_each(|x| recorder.value(x.to_bits()));
    wild(recorder, &push.contacts, &push.limits);
}

/// The program in states far from any push-off: tilted, fast, at the ends of the joints, on one sole or none.
fn wild<R: Recorder>(
    recorder: &mut R,
    contacts: &[Contact<f64>; 2],
    limits: &[JointLimits<f64>; N],
) {
    let stream = &mut Stream::new(2026);
    let mut program = Program::new(settings(), squat());
    let mut snapshot = Snapshot::ZERO;
    for k in 0..WILD {
        let base = Transform::new(
            so3::exp(&Vector3::from(stream.array::<f64, 3>(0.8))),
            Vector3::new(0.0, 0.0, 0.5),
        );
        let mut joints = squat();
        for x in &mut joints {
            *x += stream.next::<f64>(0.6);
        }
        let q = Configuration { base, joints };
        let v = Tangent {
            base: Motion::from_array(stream.array(2.0)),
            joints: stream.array(6.0),
        };
        let mut contacts = *contacts;
        for (i, contact) in contacts.iter_mut().enumerate() {
            if (k >> i) & 1 == 1 {
                contact.max_force = 0.0;
            }
        }
        let wanted = ComReference {
            position_w: Vector3::from(stream.array::<f64, 3>(0.5)),
            velocity_w: Vector3::from(stream.array::<f64, 3>(2.0)),
            acceleration_w: Vector3::from(stream.array::<f64, 3>(20.0)),
        };
        let input = (&mut program, &mut snapshot);
        digested::<f64, _, _, _>(
            recorder,
            SUBJECT,
            input,
            |(program, snapshot)| {
                snapshot.update(&Icub23, &q, &v);
                let tick = program.tick(&Icub23, snapshot, &contacts, (limits, &MOTORS), &wanted);
                let answer = tick.ok()?.answer;
                Some((answer.torques, f64::from(answer.iterations), answer.capped))
            },
            |answer| match answer {
                Some((.., true)) => "capped torque tick",
                _ => "wild torque tick",
            },
        );
    }
}
