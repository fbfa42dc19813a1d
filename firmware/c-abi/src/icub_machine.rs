//! iCub: a whole jump on the spot, from standing to standing, pushed off and landed by programs of torques.

use core::ffi::c_void;

use icub_model::profile::{
    self, DISPLACEMENT, LANDING_POSTURE, Machine, SETTINGS, SOLE_CONTACTS, SQUAT, Settings,
    Workspace,
};
use icub_model::{Icub23GazeboGeared, MOTORS};
use jump_control::{ComProfile, Curve, takeoff_speed};
use jump_machine::humanoid::{Jump, Landing, PushOff, on_the_floor};
use rbd_core::{Configuration, GRAVITY, Motor};
use wbc_qp::jump::{LandingSettings, TorqueJumpSettings};

use crate::Status;
use crate::codes::Phase;
use crate::machine::{self, Jumper, Observation, Tick, not_armed};
use crate::memory::{Resident, align, input, place, resident, result, size, status};
use crate::state::{pose, xyzw};

const N: usize = 23;
const F: usize = 2;

/// A jump of iCub on the spot: how far it rises, from where, and how it comes down.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IcubJump {
    /// Height that the centre of mass gains after the take-off, m.
    pub height: f64,
    /// Its way up in the push-off, m.
    pub displacement: f64,
    /// Position of the base before the jump, in the estimator's world, m: both soles flat on the ground.
    pub position_w: [f64; 3],
    /// Orientation of the base there: a unit quaternion x, y, z, w.
    pub orientation_wb: [f64; 4],
    /// Joint positions there, rad.
    pub start_joints: [f64; 23],
    /// Joint positions in which the soles meet the ground and the robot then stands, rad.
    pub landing_joints: [f64; 23],
}

/// The machine; the programs' memory is lent to it.
struct IcubMachine(Machine<'static, Icub23GazeboGeared>);

impl Resident for IcubMachine {
    const KIND: u64 = 0x6963_7562_6a70;
    type Lent = Workspace;
}

impl Jumper<N, F> for IcubMachine {
    const SAFE_DAMPING: f64 = SETTINGS.safe_damping;
    const MOTORS: &'static [Motor<f64>; N] = &MOTORS;
    type Machine = Machine<'static, Icub23GazeboGeared>;

    fn machine(&mut self) -> &mut Self::Machine {
        &mut self.0
    }
}

impl IcubJump {
    /// As the machine takes it; none where it cannot be.
    fn read(&self) -> Option<Jump<f64, N>> {
        let gravity = -GRAVITY[2];
        let speed = takeoff_speed(self.height, gravity);
        let rising = Curve::rising();
        Some(Jump {
            profile: ComProfile::by_displacement(rising, speed, self.displacement, gravity)?,
            start: Configuration {
                base: pose(&self.position_w, &self.orientation_wb)?,
                joints: self.start_joints,
            },
            landing_joints: self.landing_joints,
        })
    }
}

/// The jump of paper B: from its squat, the soles on ground of height 0, the toes along x and the soles' middle in the origin, to a gain of
/// `height`, m; the paper's is 0.04.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_jump(height: f64, jump: *mut IcubJump) -> Status {
    status((|| {
        let out = result(jump)?;
        let start = on_the_floor(&Icub23GazeboGeared, &SOLE_CONTACTS, &SQUAT);
        let jump = out.write(IcubJump {
            height,
            displacement: DISPLACEMENT,
            position_w: start.base.translation.into(),
            orientation_wb: xyzw(&start.base.rotation),
            start_joints: SQUAT,
            landing_joints: LANDING_POSTURE,
        });
        jump.read().map(|_| ()).ok_or(Status::BadData)
    })())
}

/// Bytes of the block of a machine.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_machine_size() -> usize {
    size::<IcubMachine>()
}

/// Alignment of the block of a machine.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_machine_align() -> usize {
    align::<IcubMachine>()
}

/// Initialises a machine in a block; `version` is `SALTUS_VERSION`. It stands, without a jump; until the first tick its joints are damped.
/// The way out of an abort, too. `max_steps` is the most steps of a program's solver in a tick, 0 for no cap: with 10 a tick takes a million instructions on
/// a Cortex-M7 at most, and with every other 15,000 more. The programs' memory is made on the stack before it is moved into the block: this call
/// takes 370 kB of it.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_machine_init(
    memory: *mut c_void,
    bytes: usize,
    version: u32,
    max_steps: u32,
) -> Status {
    let max_steps = if max_steps == 0 { u32::MAX } else { max_steps };
    let settings = Settings {
        push_off: PushOff::Torque(TorqueJumpSettings {
            max_steps,
            ..profile::TORQUE
        }),
        landing: Landing::Program(LandingSettings {
            max_steps,
            ..profile::LANDING
        }),
        ..SETTINGS
    };
    let lent = || Workspace::new(&settings);
    let fill = |workspace| IcubMachine(Machine::new(&Icub23GazeboGeared, settings, workspace));
    status(place(memory, bytes, version, lent, fill))
}

/// Gives a standing robot a jump that begins at `start`, s, on the clock of `saltus_icub_machine_tick`; until then it holds the jump's first
/// posture. The start must not be before the last tick. The numbers are copied. `BadData` says that one of them is not finite, that height and displacement
/// are not positive, or that the orientation is none. If the status is not `Ok`, nothing changes.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_machine_arm(
    memory: *mut c_void,
    jump: *const IcubJump,
    start: f64,
) -> Status {
    status((|| {
        let IcubMachine(machine) = resident(memory)?;
        let jump = input(jump)?.read().ok_or(Status::BadData)?;
        machine.arm(&jump, start).map_err(not_armed)
    })())
}

/// One tick of 1 kHz at the time `now`, s, on a clock that only goes forward. `observation` is what has arrived since the last tick, null if
/// nothing: the last one is used until it is older than 10 ms. Whatever the status, `tick` holds a command that may be given to the joints
/// if it is neither null nor misaligned. `Aborted` says that joints are damped from now on, and the tick's fault why.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_machine_tick(
    memory: *mut c_void,
    now: f64,
    observation: *const Observation<23, 2>,
    tick: *mut Tick<23>,
) -> Status {
    machine::tick::<IcubMachine, N, F>(memory, now, observation, tick)
}

/// Torques of the 23 joints, N m, for 10 kHz, `dt` s after the last call, from their positions and velocities: inside what the motors can
/// do. Damping alone once ticks have been missing for 5 ms, or an encoder is not finite; and where the block is no machine.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_machine_joint_tick(
    memory: *mut c_void,
    joints: *const f64,
    joint_velocities: *const f64,
    dt: f64,
    torques: *mut f64,
) -> Status {
    machine::joint_tick::<IcubMachine, N, F>(memory, joints, joint_velocities, dt, torques)
}

/// Where the jump is.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_machine_phase(memory: *mut c_void, phase: *mut Phase) -> Status {
    machine::phase::<IcubMachine, N, F>(memory, phase)
}
