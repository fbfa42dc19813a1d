//! A1: dynamics, joint PD, Cartesian PD, landing.

use core::ffi::c_void;

use a1_model::{A1Geared, BUILD, FEET, MOTORS};
use jump_control::{CartesianPd, Measurement, Reference};
use landing::{Landing, Outcome, Settings, Target, Workspace};

use crate::command::Command;
use crate::memory::{Resident, align, input, output, place, resident, size, status};
use crate::state::{State, effort, tangent};
use crate::{Status, dynamics};

const N: usize = 12;

/// What a plan says about one instant.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct A1Reference {
    /// Joint positions, rad.
    pub joints: [f64; 12],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f64; 12],
    /// Torques, N m.
    pub torques: [f64; 12],
}

/// Where the landing is to bring the body.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct A1Target {
    /// Height of the centre of mass over the feet in contact, m.
    pub height: f64,
    /// Rotation of the base at rest, base to world, by rows.
    pub rotation_wb: [f64; 9],
    /// Offset of the centre of mass from the middle of the feet, world axes, m.
    pub offset_w: [f64; 2],
    /// Posture of legs that are in the air, rad.
    pub waiting: [f64; 12],
}

/// Damping of the safe command, N m s/rad.
pub(crate) const SAFE_DAMPING: f64 = 2.0;
const SAFE: Command<N> = Command::damp(SAFE_DAMPING);

struct A1Landing {
    landing: Landing<f64, N, 4>,
    workspace: Workspace<f64, N, 4>,
}

impl Resident for A1Landing {
    const KIND: u64 = 0x6131_6c61_6e64;
    type Lent = ();
}

/// Inverse dynamics of A1 with rotors: effort = M a + h. `acceleration` and `effort` have 18 numbers: 6 of the base, then joints.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_inverse_dynamics(
    state: *const State<12>,
    acceleration: *const f64,
    effort: *mut f64,
) -> Status {
    status((|| {
        let (q, v) = input(state)?.read()?;
        let a = dynamics::split::<N, 18>(input(acceleration.cast())?)?;
        dynamics::inverse::<_, N, 18>(
            &A1Geared,
            &q,
            &v,
            &tangent(&a.0, &a.1),
            output(effort.cast())?,
        );
        Ok(())
    })())
}

/// Forward dynamics of A1 with rotors, free in the air: acceleration = M⁻¹ (effort − h); 18 numbers each.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_forward_dynamics(
    state: *const State<12>,
    given: *const f64,
    acceleration: *mut f64,
) -> Status {
    status((|| {
        let (q, v) = input(state)?.read()?;
        let f = dynamics::split::<N, 18>(input(given.cast())?)?;
        dynamics::forward::<_, N, 18>(
            &A1Geared,
            &q,
            &v,
            &effort(&f.0, &f.1),
            output(acceleration.cast())?,
        );
        Ok(())
    })())
}

/// Mass matrix of A1 with rotors, 18 × 18 numbers, symmetric.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_mass_matrix(state: *const State<12>, mass: *mut f64) -> Status {
    status((|| {
        let (q, _) = input(state)?.read()?;
        dynamics::mass::<_, N, 18>(&A1Geared, &q, output(mass.cast())?);
        Ok(())
    })())
}

/// Torques of the twelve joints, for 10 kHz: the command inside what the motors can do. Joints whose numbers are not finite get
/// zero torque.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_joint_pd(
    command: *const Command<12>,
    joints: *const f64,
    joint_velocities: *const f64,
    torques: *mut f64,
) -> Status {
    status((|| {
        let (q, qd) = (input(joints.cast())?, input(joint_velocities.cast())?);
        *output(torques.cast())? = input(command)?.read().torques(q, qd, &MOTORS);
        Ok(())
    })())
}

/// The Cartesian PD of push-off and flight, for 1 kHz: feet along a reference.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_cartesian_pd(
    state: *const State<12>,
    reference: *const A1Reference,
    command: *mut Command<12>,
) -> Status {
    status((|| {
        let out = output(command)?;
        *out = SAFE;
        let (q, v) = input(state)?.read()?;
        let given = input(reference)?;
        let numbers = given.joints.iter().chain(&given.joint_velocities);
        if !numbers.chain(&given.torques).all(|x| x.is_finite()) {
            return Err(Status::BadData);
        }
        let reference = Reference {
            joints: given.joints,
            joint_velocities: given.joint_velocities,
            torques: given.torques,
            node: 0,
        };
        let measured = Measurement {
            base: q.base,
            base_velocity: v.base,
            joints: q.joints,
            joint_velocities: v.joints,
            foot_forces: [0.0; 4],
            age: 0.0,
        };
        let pd = CartesianPd::new(&BUILD, FEET.each_ref().map(|foot| foot.frame));
        *out = Command::of(&pd.command(&A1Geared, &measured, &reference));
        Ok(())
    })())
}

/// Bytes of the block of the landing controller.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_landing_size() -> usize {
    size::<A1Landing>()
}

/// Alignment of the block of the landing controller.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_landing_align() -> usize {
    align::<A1Landing>()
}

/// Initialises the landing controller in a block; `version` is `SALTUS_VERSION`.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_landing_init(
    memory: *mut c_void,
    bytes: usize,
    version: u32,
) -> Status {
    let fill = |&mut ()| A1Landing {
        landing: Landing::new(
            FEET.each_ref().map(|foot| foot.frame),
            Settings::new(&BUILD),
            MOTORS.each_ref().map(|motor| motor.torque),
        ),
        workspace: Workspace::new(),
    };
    status(place(memory, bytes, version, || (), fill))
}

/// One tick of the landing, for 1 kHz: forces of the feet in contact (`contacts`, four of them, zero or not) that bring the body to rest.
/// Whatever the status, `command` may be given to the joints if it is neither `NullPointer` nor `Misaligned`.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_a1_landing_step(
    memory: *mut c_void,
    state: *const State<12>,
    contacts: *const u8,
    target: *const A1Target,
    command: *mut Command<12>,
) -> Status {
    status((|| {
        let out = output(command)?;
        *out = SAFE;
        let controller = resident::<A1Landing>(memory)?;
        let (q, v) = input(state)?.read()?;
        let given = input(target)?;
        let rotation = State {
            rotation_wb: given.rotation_wb,
            joints: given.waiting,
            position_w: [given.height, given.offset_w[0], given.offset_w[1]],
            linear_velocity_b: [0.0; 3],
            angular_velocity_b: [0.0; 3],
            joint_velocities: [0.0; N],
        };
        let (checked, _) = rotation.read()?;
        let target = Target {
            height: given.height,
            rot_wb: checked.base.rotation,
            offset_w: given.offset_w,
        };
        let on = input::<[u8; 4]>(contacts.cast())?.map(|contact| contact != 0);
        let A1Landing { landing, workspace } = controller;
        let c = landing.step(&A1Geared, &q, &v, &on, &target, &given.waiting, workspace);
        *out = Command {
            position: c.position,
            velocity: [0.0; N],
            feed_forward: c.feed_forward,
            stiffness: c.stiffness,
            damping: c.damping,
        };
        match c.outcome {
            Outcome::Airborne | Outcome::Solved(_) => Ok(()),
            Outcome::Failed(_) => Err(Status::NotSolved),
            Outcome::BadData => Err(Status::BadData),
        }
    })())
}
