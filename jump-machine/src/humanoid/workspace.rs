//! The programs' memory.

use so3::Scalar;
use wbc_qp::Snapshot;
use wbc_qp::jump::{self, TorqueJump, VelocityJump};

use super::{Landing, PushOff, Settings};

/// The program that pushes off.
#[derive(Clone, Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one of it, in a static: a box would need an allocator"
)]
pub(super) enum Program<
    T: Scalar,
    const N: usize,
    const K: usize,
    const V: usize,
    const W: usize,
    const R: usize,
> {
    /// At the level of velocities.
    Velocity(VelocityJump<T, N, W, K>),
    /// At the level of torques.
    Torque(TorqueJump<T, N, K, V, R>),
}

/// All memory of the programs of a robot with N joints and K force coordinates of its feet (three per ball, six per rectangle): V = N + K and
/// W = N + 6 variables at the levels of torques and of velocities, R rows of the torque program as
/// [`TorqueQp`](wbc_qp::TorqueQp) counts them.
#[derive(Clone, Debug)]
pub struct Workspace<
    T: Scalar,
    const N: usize,
    const K: usize,
    const V: usize,
    const W: usize,
    const R: usize,
> {
    pub(super) push_off: Program<T, N, K, V, W, R>,
    /// None where servos land.
    pub(super) landing: Option<jump::Landing<T, N, K, V, R>>,
    pub(super) snapshot: Snapshot<T, N>,
}

impl<T: Scalar, const N: usize, const K: usize, const V: usize, const W: usize, const R: usize>
    Workspace<T, N, K, V, W, R>
{
    /// Memory for the programs of these settings.
    #[must_use]
    pub fn new<const F: usize>(settings: &Settings<T, N, F>) -> Self {
        let posture = settings.standing;
        Self {
            push_off: match settings.push_off {
                PushOff::Velocity(push) => Program::Velocity(VelocityJump::new(push, posture)),
                PushOff::Torque(push) => Program::Torque(TorqueJump::new(push, posture)),
            },
            landing: match settings.landing {
                Landing::Program(landing) => Some(jump::Landing::new(landing)),
                Landing::Servos(_) => None,
            },
            snapshot: Snapshot::ZERO,
        }
    }

    /// Takes over these settings; memory that was made for other programs is made anew.
    pub(super) fn adopt<const F: usize>(&mut self, settings: &Settings<T, N, F>) {
        match (&mut self.push_off, settings.push_off) {
            (Program::Velocity(program), PushOff::Velocity(push)) => program.settings = push,
            (Program::Torque(program), PushOff::Torque(push)) => program.settings = push,
            (program, PushOff::Velocity(push)) => {
                *program = Program::Velocity(VelocityJump::new(push, settings.standing));
            }
            (program, PushOff::Torque(push)) => {
                *program = Program::Torque(TorqueJump::new(push, settings.standing));
            }
        }
        match (&mut self.landing, settings.landing) {
            (Some(program), Landing::Program(landing)) => {
                program.settings = landing;
                program.restart();
            }
            (program, Landing::Program(landing)) => *program = Some(jump::Landing::new(landing)),
            (program, Landing::Servos(_)) => *program = None,
        }
    }

    /// Before a push-off from this posture: nothing of an earlier one is remembered.
    pub(super) fn restart(&mut self, posture: &[T; N]) {
        match &mut self.push_off {
            Program::Velocity(program) => program.restart(posture),
            Program::Torque(program) => program.restart(posture),
        }
    }
}
