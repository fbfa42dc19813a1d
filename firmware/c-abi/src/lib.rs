//! Dynamics and controllers of A1 and iCub behind a C interface.
//!
//! The rules: memory is the caller's, its size and alignment are asked for; every function returns a [`Status`]; nothing
//! calls back, allocates or keeps a pointer, but a machine its plan; wrong use is an error, never undefined behaviour, as far as C lets a
//! callee know. A machine follows the plan's bytes where they are: what flies is what was audited.
//! The header `include/saltus.h` is generated from here.
//!
//! This crate alone has `unsafe`: pointers from C become references in `memory`, in one place for each kind of pointer.
#![cfg_attr(target_os = "none", no_std)]

mod a1;
mod a1_estimator;
mod a1_machine;
mod codes;
mod command;
mod dynamics;
mod estimator;
mod icub;
mod icub_estimator;
mod icub_machine;
mod machine;
mod memory;
mod state;

pub use a1::{
    A1Reference, A1Target, saltus_a1_cartesian_pd, saltus_a1_forward_dynamics,
    saltus_a1_inverse_dynamics, saltus_a1_joint_pd, saltus_a1_landing_align,
    saltus_a1_landing_init, saltus_a1_landing_size, saltus_a1_landing_step, saltus_a1_mass_matrix,
};
pub use a1_estimator::{
    saltus_a1_estimator_align, saltus_a1_estimator_init, saltus_a1_estimator_size,
    saltus_a1_estimator_update,
};
pub use a1_machine::{
    A1Plan, saltus_a1_machine_align, saltus_a1_machine_arm, saltus_a1_machine_init,
    saltus_a1_machine_joint_tick, saltus_a1_machine_phase, saltus_a1_machine_size,
    saltus_a1_machine_tick, saltus_a1_plan_read,
};
pub use codes::{
    Culprit, EstimateStatus, Fault, Phase, Refusal, SampleFault, Work, Yielded, saltus_fault_text,
    saltus_phase_text, saltus_refusal_text, saltus_sample_fault_text, saltus_status_text,
};
pub use command::Command;
pub use estimator::{Estimate, Sample, Start};
pub use icub::{
    saltus_icub_forward_dynamics, saltus_icub_inverse_dynamics, saltus_icub_mass_matrix,
};
pub use icub_estimator::{
    saltus_icub_estimator_align, saltus_icub_estimator_init, saltus_icub_estimator_size,
    saltus_icub_estimator_update,
};
pub use icub_machine::{
    IcubJump, saltus_icub_jump, saltus_icub_machine_align, saltus_icub_machine_arm,
    saltus_icub_machine_init, saltus_icub_machine_joint_tick, saltus_icub_machine_phase,
    saltus_icub_machine_size, saltus_icub_machine_tick,
};
pub use machine::{Observation, Tick};
pub use state::State;

/// Version of the interface; a controller is initialised with the version that the caller was compiled with.
pub const VERSION: u32 = 5;

/// What came of a call.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The call did what it says.
    Ok = 0,
    /// A pointer is null.
    NullPointer = 1,
    /// A pointer is not aligned for what it points to.
    Misaligned = 2,
    /// The block is too small: ask for its size.
    TooSmall = 3,
    /// The caller was compiled with another version of the header.
    WrongVersion = 4,
    /// The block was not initialised, or for another controller, or it was moved since.
    NotInitialised = 5,
    /// A number is not finite, or limits are inverted; outputs are the safe command.
    BadData = 6,
    /// The program was not solved; outputs are the best that was found, or the safe command.
    NotSolved = 7,
    /// The plan's bytes end before it does; the culprit has both lengths.
    PlanCutOff = 8,
    /// The bytes are no plan.
    NotAPlan = 9,
    /// The plan is of another version of the format; the culprit has both.
    PlanVersion = 10,
    /// The plan's checksum does not fit: bytes have changed.
    PlanDamaged = 11,
    /// The plan is for a robot with other numbers of joints and feet; the culprit has both.
    PlanSize = 12,
    /// The plan is for another robot of the same size; the culprit has both hashes.
    PlanRobot = 13,
    /// The plan's header contradicts its length.
    PlanHeader = 14,
    /// A value of the plan cannot be, though the checksum fits; the culprit names it and its node.
    PlanValue = 15,
    /// The robot does not stand: it holds for another jump, is under way, or has aborted.
    NotStanding = 16,
    /// The start is not a number, or leaves less time than holding still, weighing and moving the trunk take.
    TooLate = 17,
    /// The machine has aborted, its fault says why; outputs damp the joints and nothing else.
    Aborted = 18,
}

/// The version of the library: [`VERSION`].
#[unsafe(no_mangle)]
pub extern "C" fn saltus_version() -> u32 {
    VERSION
}

/// A reachable panic would be a link error: nothing defines this function.
#[cfg(target_os = "none")]
mod no_panic {
    unsafe extern "C" {
        safe fn saltus_panic_is_reachable() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        saltus_panic_is_reachable()
    }
}
