//! A jump machine behind C, for any robot: what its files, such as `a1_machine`, have in common.

use core::mem::MaybeUninit;

use jump_control::container::{Container, model_hash};
use jump_machine::{Jump, Machine, Refusal};
use rbd_core::{Model, Tree};

use crate::Status;
use crate::codes::{Culprit, no_plan};
use crate::memory::{bytes, optional_result};

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

/// Arms a machine with a plan that is followed where it is.
pub(crate) fn arm<M: Tree<f64, N>, const N: usize, const F: usize>(
    machine: &mut Machine<'static, f64, M, N, F>,
    jump: Jump<'static, f64, N, F>,
    start: f64,
) -> Result<(), Blamed> {
    let armed = machine.arm(jump, start);
    armed.map_err(|refusal| {
        plain(match refusal {
            Refusal::TooLate => Status::TooLate,
            _ => Status::NotStanding,
        })
    })
}

/// An error once the machine has aborted.
pub(crate) fn alive(phase: jump_control::Phase) -> Result<(), Status> {
    match phase {
        jump_control::Phase::Abort => Err(Status::Aborted),
        _ => Ok(()),
    }
}
