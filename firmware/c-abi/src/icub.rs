//! iCub: dynamics, and the push-off by torques.

use core::ffi::c_void;

use icub_model::{Icub23, LIMITS, MOTORS, SOLES, profile};
use nalgebra::Vector3;
use wbc_qp::jump::{ComReference, TorqueJump, TorqueJumpSettings};
use wbc_qp::{Contact, Error, Snapshot, Yielded};

use crate::memory::{Resident, align, input, output, place, resident, size, status};
use crate::state::{IcubState, effort, tangent};
use crate::{Status, dynamics};

const N: usize = 23;
/// Ground friction that the program counts on, and the largest normal force of a sole, N.
const FRICTION: f64 = 0.5;
const MAX_FORCE: f64 = 1000.0;

/// Where the centre of mass is to be in this tick, world axes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IcubTarget {
    /// Position, m.
    pub position_w: [f64; 3],
    /// Velocity, m/s.
    pub velocity_w: [f64; 3],
    /// Acceleration, m/s².
    pub acceleration_w: [f64; 3],
}

/// What the push-off's program found.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IcubCommand {
    /// Joint torques, N m, inside their limits.
    pub torques: [f64; 23],
    /// Wrenches on left and right sole in the soles' axes: force in N, then moment in N m.
    pub wrenches: [f64; 12],
    /// Which rows had to yield: 0 none, 1 held tasks, 2 also limits on the joints' motion, 3 also contacts.
    pub yielded: u32,
    /// Iterations of the solver.
    pub iterations: u32,
    /// 1 if the cap on the solver's time ended the search: torques are the last iterate's, cut to their limits, and the next tick goes
    /// on from there. Otherwise 0.
    pub capped: u32,
}

struct IcubPush {
    program: TorqueJump<f64, N, 12, 35, 55>,
    snapshot: Snapshot<f64, N>,
    contacts: [Contact<f64>; 2],
}

impl Resident for IcubPush {
    const KIND: u64 = 0x6963_7562_7073;
    type Lent = ();
}

/// Inverse dynamics of iCub: effort = M a + h. `acceleration` and `effort` have 29 numbers: 6 of the base, then joints.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_inverse_dynamics(
    state: *const IcubState,
    acceleration: *const f64,
    effort: *mut f64,
) -> Status {
    status((|| {
        let (q, v) = input(state)?.read()?;
        let a = dynamics::split::<N, 29>(input(acceleration.cast())?)?;
        dynamics::inverse::<_, N, 29>(
            &Icub23,
            &q,
            &v,
            &tangent(&a.0, &a.1),
            output(effort.cast())?,
        );
        Ok(())
    })())
}

/// Forward dynamics of iCub, free in the air: acceleration = M⁻¹ (effort − h); 29 numbers each.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_forward_dynamics(
    state: *const IcubState,
    given: *const f64,
    acceleration: *mut f64,
) -> Status {
    status((|| {
        let (q, v) = input(state)?.read()?;
        let f = dynamics::split::<N, 29>(input(given.cast())?)?;
        dynamics::forward::<_, N, 29>(
            &Icub23,
            &q,
            &v,
            &effort(&f.0, &f.1),
            output(acceleration.cast())?,
        );
        Ok(())
    })())
}

/// Mass matrix of iCub, 29 × 29 numbers, symmetric.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_mass_matrix(state: *const IcubState, mass: *mut f64) -> Status {
    status((|| {
        let (q, _) = input(state)?.read()?;
        dynamics::mass::<_, N, 29>(&Icub23, &q, output(mass.cast())?);
        Ok(())
    })())
}

/// Bytes of the block of the push-off controller.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_push_size() -> usize {
    size::<IcubPush>()
}

/// Alignment of the block of the push-off controller.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_push_align() -> usize {
    align::<IcubPush>()
}

/// Initialises the push-off controller in a block; `version` is `SALTUS_VERSION`, `posture` the 23 joints to stay near, rad, and `max_steps` the
/// most steps of the solver in a tick, 0 for no cap: with 12 a tick takes 720,000 instructions on a Cortex-M7, with every other 15,000 more.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_push_init(
    memory: *mut c_void,
    bytes: usize,
    version: u32,
    posture: *const f64,
    max_steps: u32,
) -> Status {
    status((|| {
        let posture: &[f64; N] = input(posture.cast())?;
        if !posture.iter().all(|x| x.is_finite()) {
            return Err(Status::BadData);
        }
        let mut settings = TorqueJumpSettings {
            posture_weight: [1.0; N],
            ..profile::TORQUE
        };
        if max_steps > 0 {
            settings.max_steps = max_steps;
        }
        let fill = |&mut ()| IcubPush {
            program: TorqueJump::new(settings, *posture),
            snapshot: Snapshot::ZERO,
            contacts: SOLES
                .each_ref()
                .map(|sole| Contact::new(sole, FRICTION, MAX_FORCE)),
        };
        place(memory, bytes, version, || (), fill)
    })())
}

/// One tick of the push-off on both soles, for 1 kHz. If the status is not `Ok`, torques are zero.
#[unsafe(no_mangle)]
pub extern "C" fn saltus_icub_push_tick(
    memory: *mut c_void,
    state: *const IcubState,
    target: *const IcubTarget,
    command: *mut IcubCommand,
) -> Status {
    status((|| {
        let out = output(command)?;
        *out = IcubCommand {
            torques: [0.0; N],
            wrenches: [0.0; 12],
            yielded: 0,
            iterations: 0,
            capped: 0,
        };
        let IcubPush {
            program,
            snapshot,
            contacts,
        } = resident::<IcubPush>(memory)?;
        let (q, v) = input(state)?.read()?;
        let target = input(target)?;
        let wanted = ComReference {
            position_w: Vector3::from(target.position_w),
            velocity_w: Vector3::from(target.velocity_w),
            acceleration_w: Vector3::from(target.acceleration_w),
        };
        snapshot.update(&Icub23, &q, &v);
        let joints = (&LIMITS, &MOTORS);
        let tick = program.tick(&Icub23, snapshot, contacts, joints, &wanted);
        let answer = tick.map_err(|error| match error {
            Error::Data(_) => Status::BadData,
            _ => Status::NotSolved,
        })?;
        let answer = answer.answer;
        *out = IcubCommand {
            torques: answer.torques,
            wrenches: answer.forces,
            yielded: match answer.yielded {
                Yielded::Nothing => 0,
                Yielded::Tasks => 1,
                Yielded::MotionLimits => 2,
                Yielded::Contacts => 3,
            },
            iterations: answer.iterations,
            capped: u32::from(answer.capped),
        };
        Ok(())
    })())
}
