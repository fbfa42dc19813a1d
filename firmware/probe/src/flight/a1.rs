//! A1 jumps: joint PD at 10 kHz, Cartesian PD and landing at 1 kHz, from a plan in flash.

use a1_model::{A1Geared, BUILD};
use contact_sim::{Block, NativeSimulator, Settings, Shape, Terrain};
use jump_control::{Measurement, Phase, Plan};
use jump_machine::{Jump, Machine, Observation, Tick, Work};
use landing::{Landing, Outcome, Target, Workspace};
use nalgebra::Vector3;
use rbd_core::{Configuration, Frame, Limbs, Link, Model, Motion, Tangent, Transform};

use super::closed_loop::{Flown, Simulated, told};
use super::digested;
use super::plan::{self, Planned};
use crate::inputs::Stream;
use crate::{Label, Numbers, Real, Recorder};

const SUBJECT: &str = "a1-jump";
/// Time of standing before the jump, s.
pub const HOLD: f64 = 1.2;
/// Time after the planned touchdown at which the run ends, s.
const SETTLE: f64 = 0.8;
/// Balls that touch the ground: feet and knees.
const BALLS: usize = 8;
/// States that no jump visits, on which the landing is tried.
const WILD: usize = 1000;

impl Numbers for Tick {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        take(f64::from(self.phase as u8));
        take(f64::from(u8::from(self.fault.is_some())));
    }
}

/// A simulated A1 in the place of the robot: on its box, at rest.
pub type Flight<T> = Simulated<T, A1Geared, 12, 4, BALLS>;

impl<T: Planned> Flight<T>
where
    A1Geared: Model<T, 12>,
{
    /// Where the plan begins.
    #[must_use]
    pub fn new() -> Self {
        let motors = crate::control::motors(&A1Geared);
        let plant = NativeSimulator::new(
            A1Geared,
            balls(&feet()),
            behind_the_box(),
            Settings::new(A1Geared.limits(), &motors),
        );
        let first = T::nodes().first();
        let start = first.map_or(Configuration::NEUTRAL, |first| Configuration {
            base: first.base,
            joints: first.joints,
        });
        let time = ((HOLD + plan::TIMES[2] + SETTLE) * 1e3) as usize;
        Self::at_rest(plant, &start, (|ball| ball, true), time)
    }
}

impl<T: Planned> Default for Flight<T>
where
    A1Geared: Model<T, 12>,
{
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize, const F: usize> Numbers for Observation<T, N, F> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        let Measurement {
            base,
            base_velocity,
            joints,
            joint_velocities,
            foot_forces,
            age,
        } = &self.measured;
        (base, base_velocity).visit(take);
        (joints, joint_velocities).visit(take);
        (foot_forces, age, self.joint_torques).visit(take);
    }
}

/// A1's feet.
#[must_use]
pub fn feet<T: Planned>() -> [Frame<T>; 4]
where
    A1Geared: Model<T, 12>,
{
    let contacts = A1Geared.contacts();
    core::array::from_fn(|i| contacts.get(i).map_or(Frame::IDENTITY, |c| c.frame))
}

/// A1's settings of the machine.
#[must_use]
pub fn settings<T: Planned>() -> jump_machine::Settings<T, 12, 4>
where
    A1Geared: Model<T, 12>,
{
    let motors = crate::control::motors(&A1Geared);
    let build = BUILD.cast();
    jump_machine::Settings::new(&build, feet(), motors, landing_joints())
}

/// The posture in which the robot waits for the ground, rad.
fn landing_joints<T: Real>() -> [T; 12] {
    plan::LANDING.map(|x| T::of(f64::from(x)))
}

/// The double backflip; `None` if the plan in flash is refused.
#[must_use]
pub fn jump<T: Planned>() -> Option<Jump<'static, T, 12, 4>> {
    let [takeoff, posing, touchdown] = plan::TIMES.map(T::of);
    let torques = plan::PLAN.header().torques;
    Some(Jump {
        plan: Plan::new(T::nodes(), takeoff, posing, touchdown, torques).ok()?,
        rot_goal: so3::exp(&Vector3::new(T::ZERO, T::ZERO, T::of(plan::HEADING))),
        landing_joints: landing_joints(),
    })
}

/// What a tick of the machine is called in a jump, and in states that no jump visits.
const fn name(tick: &Tick, wild: bool) -> &'static str {
    match (&tick.work, wild) {
        (Work::Cartesian, _) if matches!(tick.phase, Phase::Hold) => "hold tick",
        (Work::Cartesian, _) => "Cartesian PD tick",
        (Work::Landing(Outcome::Failed(_)), true) => "capped machine tick",
        (Work::Landing(_), true) => "wild machine tick",
        (Work::Landing(_), false) => "landing tick",
        (Work::Damping, _) => "damping tick",
    }
}

/// Arms and flies the double backflip and lands it, then tries machine and landing where no jump comes.
pub fn a1<T: Planned, R: Recorder>(recorder: &mut R)
where
    A1Geared: Model<T, 12>,
{
    let mut workspace = jump_machine::Workspace::new();
    let mut machine = Machine::<T, _, 12, 4>::new(&A1Geared, settings(), &mut workspace);
    let label = Label {
        subject: SUBJECT,
        scalar: T::NAME,
        algorithm: "arming",
    };
    let armed = recorder.call(label, &mut machine, |machine| {
        jump().map(|jump| machine.arm(jump, T::of(HOLD)))
    });
    let Some(Ok(())) = armed else { return };
    let mut flown = Flown::new(machine, SUBJECT, name, false);
    flown.fly(recorder, Flight::new());
    wild_machine(recorder, &mut flown);
    wild(recorder, &A1Geared, &feet());
}

/// The machine after its landing, told of states where no jump comes, a millisecond after the other.
fn wild_machine<T: Planned, R: Recorder>(
    recorder: &mut R,
    flown: &mut Flown<Machine<'_, T, A1Geared, 12, 4>, Work>,
) where
    A1Geared: Model<T, 12>,
{
    let stream = &mut Stream::new(2027);
    for k in 0..WILD {
        let (q, v) = wild_state(stream);
        let on = wild_feet(k);
        let heard = Observation {
            joint_torques: stream.array(20.0),
            ..told(&q, &v, on.map(|on| if on { T::of(100.0) } else { T::ZERO }))
        };
        flown.tick(recorder, &heard, true);
    }
}

/// Any posture, tilt and speed.
fn wild_state<T: Real>(stream: &mut Stream) -> (Configuration<T, 12>, Tangent<T, 12>) {
    let base = Transform::new(
        so3::exp(&Vector3::from(stream.array::<T, 3>(1.5))),
        Vector3::from(stream.array::<T, 3>(0.3)),
    );
    let q = Configuration {
        base,
        joints: stream.array(1.5),
    };
    let v = Tangent {
        base: Motion::from_array(stream.array(6.0)),
        joints: stream.array(20.0),
    };
    (q, v)
}

/// Every set of feet in turn.
fn wild_feet(k: usize) -> [bool; 4] {
    core::array::from_fn(|i| (k >> i) & 1 == 0)
}

/// The robot starts on a box and lands on the floor behind it.
fn behind_the_box<T: Real>() -> Terrain<T> {
    let [height, edge] = plan::BOX.map(T::of);
    let wide = T::of(0.6);
    Terrain {
        floor: -height,
        block: Some(Block {
            lower: [-edge, -wide, -height],
            upper: [wide, wide, T::ZERO],
        }),
    }
}

/// Feet, and the calf joints as knees.
fn balls<T: Real>(feet: &[Frame<T>; 4]) -> [Shape<T>; BALLS] {
    core::array::from_fn(|i| match feet.get(i) {
        Some(foot) => Shape::ball(foot.link, foot.offset, T::of(a1_model::FOOT_RADIUS), i),
        None => {
            let knee = Link::Joint(3 * (i - feet.len()) + 2);
            Shape::ball(knee, [T::ZERO; 3], T::of(0.02), i)
        }
    })
}

/// The landing in states far from any jump: any posture, tilt, speed and set of feet.
fn wild<T: Real, R: Recorder, M: Model<T, 12>>(recorder: &mut R, model: &M, feet: &[Frame<T>; 4]) {
    let motors = crate::control::motors(model);
    let torques = motors.map(|motor| motor.torque);
    let landing = Landing::<T, 12, 4>::new(*feet, landing::Settings::new(&BUILD.cast()), torques);
    let mut workspace = Workspace::new();
    let mut limbs = Limbs::ZERO;
    let stream = &mut Stream::new(2026);
    for k in 0..WILD {
        let (q, v) = wild_state(stream);
        let target = Target {
            height: T::of(0.25),
            ..Target::LEVEL
        };
        let on = wild_feet(k);
        let input = (&q, &v, &mut limbs, &mut workspace);
        digested::<T, _, _, _>(
            recorder,
            SUBJECT,
            input,
            |(q, v, limbs, ws)| {
                limbs.update(model, q, feet);
                landing.step_at(model, limbs, v, &on, &target, &q.joints, ws)
            },
            |command| match command.outcome {
                Outcome::Failed(_) => "capped landing tick",
                _ => "wild landing tick",
            },
        );
    }
}
