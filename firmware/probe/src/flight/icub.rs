//! iCub jumps: joint loop at 10 kHz, push-off by the torque program (paper B, eqs. (6a) to (6f)), flight, landing and standing at 1 kHz, as
//! `saltus run icub/torque`.

use contact_sim::{NativeSimulator, Shape, Terrain};
use icub_model::profile::{self, JOINTS, Machine, SETTINGS, SOLE_CONTACTS, Settings, Workspace};
use icub_model::{Icub23GazeboGeared, LIMITS, MOTORS, SOLES};
use jump_machine::Tick;
use jump_machine::humanoid::{Jump, Landing, PushOff, Work, on_the_floor};
use nalgebra::Vector3;
use rbd_core::{Configuration, Motion, Tangent, Transform};
use wbc_qp::jump::{ComReference, LandingSettings, TorqueJump, TorqueJumpSettings};
use wbc_qp::{Snapshot, Yielded};

use super::closed_loop::{Flown, Simulated, told};
use super::digested;
use crate::inputs::Stream;
use crate::{Numbers, Recorder};

const SUBJECT: &str = "icub-jump";
/// Time of standing in the squat before the jump, s.
const ICUB_HOLD: f64 = 0.1;
/// Time of push-off, flight, landing and standing, ms: it stands after 1.9 s.
const JUMP: usize = 2100;
/// Most steps of a program's solver in a tick: with them a tick takes less than 720,000 instructions on a Cortex-M7. The push-off needs 7.
const STEPS: u32 = 10;
/// States that no jump visits.
const WILD: usize = 200;
/// The robot as `saltus run` simulates it, and as its controllers know it.
static ROBOT: Icub23GazeboGeared = Icub23GazeboGeared;

/// iCub's settings with a longest time for each tick.
#[must_use]
pub const fn icub_settings() -> Settings {
    Settings {
        push_off: PushOff::Torque(PUSH_OFF),
        landing: Landing::Program(LandingSettings {
            max_steps: STEPS,
            ..profile::LANDING
        }),
        ..SETTINGS
    }
}

const PUSH_OFF: TorqueJumpSettings<f64, JOINTS> = TorqueJumpSettings {
    max_steps: STEPS,
    ..profile::TORQUE
};

/// Standing in the squat.
fn standing() -> Configuration<f64, JOINTS> {
    on_the_floor(&ROBOT, &SOLE_CONTACTS, &profile::SQUAT)
}

/// The jump of paper B; `None` if it cannot be as wanted.
fn icub_jump() -> Option<Jump<f64, JOINTS>> {
    Some(Jump {
        profile: profile::rise(profile::HEIGHT)?,
        start: standing(),
        landing_joints: profile::LANDING_POSTURE,
    })
}

/// The machine, standing, with the jump armed; `None` if it is refused.
pub fn icub_machine(workspace: &mut Workspace) -> Option<Machine<'_, Icub23GazeboGeared>> {
    let mut machine = Machine::new(&ROBOT, icub_settings(), workspace);
    machine.arm(&icub_jump()?, ICUB_HOLD).ok()?;
    Some(machine)
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

/// A simulated iCub in the place of the robot: in a squat on both soles, at rest.
pub type IcubFlight = Simulated<f64, Icub23GazeboGeared, JOINTS, 2, 8>;

impl IcubFlight {
    /// Before the push-off.
    #[must_use]
    pub fn new() -> Self {
        let settings = contact_sim::Settings::new(&LIMITS, &MOTORS);
        let plant = NativeSimulator::new(ROBOT, balls(), Terrain::FLAT, settings);
        let hold = (ICUB_HOLD * 1e3) as usize;
        Self::at_rest(plant, &standing(), (|ball| ball / 4, false), hold + JUMP)
    }
}

impl Default for IcubFlight {
    fn default() -> Self {
        Self::new()
    }
}

impl Numbers for Tick<Work<f64>> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        take(f64::from(self.phase as u8));
        take(f64::from(u8::from(self.fault.is_some())));
        if let Work::PushOff(Ok(solved)) | Work::Landing(Ok(solved)) = self.work {
            take(f64::from(solved.iterations));
            (solved.residuals.com, solved.residuals.momentum).visit(take);
            (solved.yielded == Yielded::Nothing, solved.capped).visit(take);
        }
    }
}

/// What a tick of the machine is called in a jump, and in states that no jump visits.
const fn name(tick: &Tick<Work<f64>>, wild: bool) -> &'static str {
    match (&tick.work, wild) {
        (Work::PushOff(Ok(solved)), _) if solved.capped => "capped push-off tick",
        (Work::PushOff(_), _) => "push-off tick",
        (Work::Landing(Ok(solved)), true) if solved.capped => "capped machine tick",
        (Work::Landing(Ok(solved)), false) if solved.capped => "capped landing tick",
        (Work::Landing(_), true) => "wild machine tick",
        (Work::Landing(_), false) => "landing tick",
        (Work::Servos | Work::Damping, _) => "damping tick",
    }
}

/// Jumps and lands in closed loop with the simulator, then tries machine and program where no jump comes.
pub fn icub<R: Recorder>(recorder: &mut R) {
    let mut workspace = Workspace::new(&icub_settings());
    let Some(machine) = icub_machine(&mut workspace) else {
        return;
    };
    let mut flown = Flown::new(machine, SUBJECT, name, true);
    flown.fly(recorder, IcubFlight::new());
    wild_machine(recorder, &mut flown);
    wild(recorder);
}

/// A state far from any jump, of number `k`: tilted, fast, at the ends of the joints, on both soles, one or none.
fn wild_state(
    stream: &mut Stream,
    k: usize,
) -> (Configuration<f64, JOINTS>, Tangent<f64, JOINTS>, [bool; 2]) {
    let base = Transform::new(
        so3::exp(&Vector3::from(stream.array::<f64, 3>(0.8))),
        Vector3::new(0.0, 0.0, 0.5),
    );
    let mut joints = profile::SQUAT;
    for x in &mut joints {
        *x += stream.next::<f64>(0.6);
    }
    let v = Tangent {
        base: Motion::from_array(stream.array(2.0)),
        joints: stream.array(6.0),
    };
    let soles = core::array::from_fn(|i| (k >> i) & 1 == 0);
    (Configuration { base, joints }, v, soles)
}

/// The machine after its landing, told of states where no jump comes, a millisecond after the other.
fn wild_machine<R: Recorder>(
    recorder: &mut R,
    flown: &mut Flown<Machine<'_, Icub23GazeboGeared>, Work<f64>>,
) {
    let stream = &mut Stream::new(2027);
    for i in 0..WILD {
        let (q, v, soles) = wild_state(stream, i);
        let forces = soles.map(|on| if on { 200.0 } else { 0.0 });
        flown.tick(recorder, &told(&q, &v, forces), true);
    }
}

/// The push-off's program in states far from any push-off.
fn wild<R: Recorder>(recorder: &mut R) {
    let stream = &mut Stream::new(2026);
    let mut program = TorqueJump::<f64, JOINTS, 12, 35, 55>::new(PUSH_OFF, profile::SQUAT);
    let mut snapshot = Snapshot::ZERO;
    for k in 0..WILD {
        let (q, v, soles) = wild_state(stream, k);
        let mut contacts = SOLE_CONTACTS;
        for (contact, on) in contacts.iter_mut().zip(soles) {
            if !on {
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
                snapshot.update(&ROBOT, &q, &v);
                let joints = (&SETTINGS.limits, &MOTORS);
                let tick = program.tick(&ROBOT, snapshot, &contacts, joints, &wanted, 1e-3);
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
