//! Dynamics and controllers of A1 and iCub behind a C interface.
//!
//! The rules: memory is the caller's, its size and alignment are asked for; every function returns a [`Status`]; nothing
//! calls back, allocates or keeps a pointer; wrong use is an error, never undefined behaviour, as far as C lets a callee
//! know. The header `include/saltus.h` is generated from here.
//!
//! This crate alone has `unsafe`: pointers from C become references in `memory`, in one place for each kind of pointer.
#![cfg_attr(target_os = "none", no_std)]

mod a1;
mod dynamics;
mod icub;
mod memory;
mod state;

pub use a1::{
    A1Command, A1Reference, A1Target, saltus_a1_cartesian_pd, saltus_a1_forward_dynamics,
    saltus_a1_inverse_dynamics, saltus_a1_joint_pd, saltus_a1_landing_align,
    saltus_a1_landing_init, saltus_a1_landing_size, saltus_a1_landing_step, saltus_a1_mass_matrix,
};
pub use icub::{
    IcubCommand, IcubTarget, saltus_icub_forward_dynamics, saltus_icub_inverse_dynamics,
    saltus_icub_mass_matrix, saltus_icub_push_align, saltus_icub_push_init, saltus_icub_push_size,
    saltus_icub_push_tick,
};
pub use state::{A1State, IcubState};

/// Version of the interface; a controller is initialised with the version that the caller was compiled with.
pub const VERSION: u32 = 2;

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
