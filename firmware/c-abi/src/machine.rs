//! A jump machine behind C, for any robot: what its files, such as `a1_machine`, have in common.

use core::ffi::c_void;
use core::mem::MaybeUninit;

use jump_control::container::{Container, model_hash};
use jump_control::{JointCommand, Measurement};
use jump_machine::{Jump, JumpMachine, Refusal};
use rbd_core::{Model, Motion, Motor};

use crate::Status;
use crate::codes::{self, Culprit, Fault, Phase, Work, Worked, Yielded, no_plan};
use crate::command::Command;
use crate::memory::{
    Resident, bytes, input, optional, optional_result, output, resident, result, status,
};
use crate::state::{no_pose, pose};

/// What the machine is told every millisecond; the base as an estimator has it, such as this header's.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation<const N: usize, const F: usize> {
    /// Position of the base in the world, m.
    pub position_w: [f64; 3],
    /// Orientation of the base: a unit quaternion x, y, z, w.
    pub orientation_wb: [f64; 4],
    /// Linear velocity of the base in base axes, m/s.
    pub linear_velocity_b: [f64; 3],
    /// Angular velocity of the base in base axes, rad/s.
    pub angular_velocity_b: [f64; 3],
    /// Joint positions, rad.
    pub joints: [f64; N],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f64; N],
    /// Mean torques of the joints since the last observation, friction included, N m. iCub's machine does not read them.
    pub torques: [f64; N],
    /// Normal forces on the feet, N.
    pub foot_forces: [f64; F],
    /// Age of the oldest of these numbers, s; infinite where the base is not known.
    pub age: f64,
}

/// What came of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick<const N: usize> {
    /// Where the jump is.
    pub phase: Phase,
    /// What was computed.
    pub work: Work,
    /// Iterations of a program's solver, 0 where nothing was solved.
    pub iterations: u32,
    /// Which rows of a program had to yield.
    pub yielded: Yielded,
    /// Why the machine has aborted: the first fault.
    pub fault: Fault,
    /// The fault's joint or foot.
    pub fault_index: u32,
    /// Why the last jump was not begun.
    pub refusal: codes::Refusal,
    /// The refusal's joint.
    pub refusal_joint: u32,
    /// What the joints are to do until the next tick: for motor boards that take such commands. Who calls the machine's joint tick
    /// need not look at it.
    pub command: Command<N>,
}

/// A machine in a block.
pub(crate) trait Jumper<const N: usize, const F: usize>: Resident {
    /// Damping of the safe command, N m s/rad.
    const SAFE_DAMPING: f64;
    /// The robot's motors.
    const MOTORS: &'static [Motor<f64>; N];
    /// The machine.
    type Machine: JumpMachine<f64, N, F, Work: Into<Worked>>;

    fn machine(&mut self) -> &mut Self::Machine;
}

impl<const N: usize, const F: usize> Observation<N, F> {
    /// As the machine takes it. An impossible base is left to the machine: it aborts, and names it.
    fn read(&self) -> jump_machine::Observation<f64, N, F> {
        let ([vx, vy, vz], [wx, wy, wz]) = (self.linear_velocity_b, self.angular_velocity_b);
        let measured = Measurement {
            base: pose(&self.position_w, &self.orientation_wb).unwrap_or_else(no_pose),
            base_velocity: Motion::from_array([vx, vy, vz, wx, wy, wz]),
            joints: self.joints,
            joint_velocities: self.joint_velocities,
            foot_forces: self.foot_forces,
            age: self.age,
        };
        jump_machine::Observation {
            measured,
            joint_torques: self.torques,
        }
    }
}

impl<const N: usize> Tick<N> {
    /// Of a machine that cannot be reached.
    const fn unknown(damping: f64) -> Self {
        Self {
            phase: Phase::Abort,
            work: Work::Damping,
            iterations: 0,
            yielded: Yielded::Nothing,
            fault: Fault::None,
            fault_index: 0,
            refusal: codes::Refusal::None,
            refusal_joint: 0,
            command: Command::damp(damping),
        }
    }
}

/// One tick of 1 kHz of the machine in a block.
pub(crate) fn tick<J: Jumper<N, F>, const N: usize, const F: usize>(
    memory: *mut c_void,
    now: f64,
    observation: *const Observation<N, F>,
    tick: *mut Tick<N>,
) -> Status {
    status((|| {
        let out = result(tick)?.write(Tick::unknown(J::SAFE_DAMPING));
        let machine = resident::<J>(memory)?.machine();
        let heard = optional(observation)?.map(Observation::read);
        let done = machine.tick(now, heard.as_ref());
        let worked: Worked = done.work.into();
        let (fault, fault_index) = codes::fault(done.fault);
        let (refusal, refusal_joint) = codes::refusal(done.refusal);
        *out = Tick {
            phase: done.phase.into(),
            work: worked.work,
            iterations: worked.iterations,
            yielded: worked.yielded,
            fault,
            fault_index,
            refusal,
            refusal_joint,
            command: Command::of(machine.command()),
        };
        alive(done.phase)
    })())
}

/// One tick of 10 kHz of the machine in a block.
pub(crate) fn joint_tick<J: Jumper<N, F>, const N: usize, const F: usize>(
    memory: *mut c_void,
    joints: *const f64,
    joint_velocities: *const f64,
    dt: f64,
    torques: *mut f64,
) -> Status {
    status((|| {
        let out: &mut [f64; N] = output(torques.cast())?;
        *out = [0.0; N];
        let (q, qd): (&[f64; N], _) = (input(joints.cast())?, input(joint_velocities.cast())?);
        match resident::<J>(memory) {
            Ok(block) => {
                let machine = block.machine();
                *out = machine.joint_tick(q, qd, dt);
                alive(machine.phase())
            }
            Err(error) => {
                *out = JointCommand::damp(J::SAFE_DAMPING).torques(q, qd, J::MOTORS);
                Err(error)
            }
        }
    })())
}

/// The phase of the machine in a block.
pub(crate) fn phase<J: Jumper<N, F>, const N: usize, const F: usize>(
    memory: *mut c_void,
    phase: *mut Phase,
) -> Status {
    status((|| {
        let out = result(phase)?.write(Phase::Abort);
        *out = resident::<J>(memory)?.machine().phase().into();
        Ok(())
    })())
}

/// A call that failed: why, and the number that is to blame.
pub(crate) type Blamed = (Status, Culprit);

/// A status with nothing else to say.
pub(crate) const fn plain(status: Status) -> Blamed {
    (status, Culprit::NONE)
}

/// Does `work`, and tells a caller who wants to know it what is to blame.
pub(crate) fn blame(
    culprit: *mut Culprit,
    work: impl FnOnce() -> Result<(), Blamed>,
) -> Result<(), Status> {
    let slot: Option<&mut MaybeUninit<Culprit>> = optional_result(culprit)?;
    let result = work();
    if let Some(slot) = slot {
        slot.write(result.err().map_or(Culprit::NONE, |(_, culprit)| culprit));
    }
    result.map_err(|(status, _)| status)
}

/// A plan for this robot where the caller has it, every number of it looked at.
pub(crate) fn open<M: Model<f64, N>, const N: usize, const F: usize>(
    model: &M,
    plan: *const u8,
    count: usize,
) -> Result<(Container<'static, N, F>, Jump<'static, f64, N, F>), Blamed> {
    let bytes = bytes(plan, count).map_err(plain)?;
    let container = Container::open(bytes, model_hash(model));
    let container = container.map_err(|error| no_plan(&error, [N, F]))?;
    let jump = Jump::stored(&container).map_err(|error| no_plan(&error, [N, F]))?;
    Ok((container, jump))
}

/// Why a machine would not be armed.
pub(crate) const fn not_armed(refusal: Refusal) -> Status {
    match refusal {
        Refusal::TooLate => Status::TooLate,
        Refusal::NotFinite => Status::BadData,
        _ => Status::NotStanding,
    }
}

/// An error once the machine has aborted.
fn alive(phase: jump_control::Phase) -> Result<(), Status> {
    match phase {
        jump_control::Phase::Abort => Err(Status::Aborted),
        _ => Ok(()),
    }
}
