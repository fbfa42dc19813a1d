//! Pointers from C: the only place with `unsafe`.

use core::ffi::c_void;
use core::mem::{align_of, size_of};

use crate::{Status, VERSION};

/// A controller in memory of the caller.
#[repr(C)]
pub(crate) struct Block<C> {
    /// Says which controller this is, mixed with the block's own address: a copy is not mistaken for it.
    seal: u64,
    controller: C,
}

/// A controller that can live in a block.
pub(crate) trait Resident: Sized {
    /// Differs between controllers.
    const KIND: u64;
}

fn seal<C: Resident>(address: usize) -> u64 {
    // Odd and unlikely in memory that was never written.
    (C::KIND ^ 0x5a17_5bed_c0de_0001).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ address as u64
}

/// Bytes that [`place`] needs.
pub(crate) const fn size<C>() -> usize {
    size_of::<Block<C>>()
}

/// Alignment that [`place`] needs.
pub(crate) const fn align<C>() -> usize {
    align_of::<Block<C>>()
}

fn checked<T>(pointer: *const T) -> Result<(), Status> {
    if pointer.is_null() {
        Err(Status::NullPointer)
    } else if pointer.is_aligned() {
        Ok(())
    } else {
        Err(Status::Misaligned)
    }
}

/// Initialises a block.
pub(crate) fn place<C: Resident>(
    memory: *mut c_void,
    bytes: usize,
    version: u32,
    fill: impl FnOnce() -> C,
) -> Result<(), Status> {
    let block = memory.cast::<Block<C>>();
    checked(block)?;
    if bytes < size::<C>() {
        return Err(Status::TooSmall);
    }
    if version != VERSION {
        return Err(Status::WrongVersion);
    }
    // SAFETY: not null, aligned, and the caller says that so many bytes are its own to give.
    unsafe {
        block.write(Block {
            seal: seal::<C>(block.addr()),
            controller: fill(),
        });
    }
    Ok(())
}

/// The controller of an initialised block.
pub(crate) fn resident<'a, C: Resident>(memory: *mut c_void) -> Result<&'a mut C, Status> {
    let block = memory.cast::<Block<C>>();
    checked(block)?;
    // SAFETY: not null and aligned; the seal is the first field, so every block holds it. Volatile, because nothing is known
    // about memory that was never initialised.
    let found = unsafe { block.cast::<u64>().read_volatile() };
    if found != seal::<C>(block.addr()) {
        return Err(Status::NotInitialised);
    }
    // SAFETY: the seal says that `place` wrote this block here; the header forbids use by two threads at once.
    Ok(unsafe { &mut (*block).controller })
}

/// What the caller gives to read.
pub(crate) fn input<'a, T>(pointer: *const T) -> Result<&'a T, Status> {
    checked(pointer)?;
    // SAFETY: not null and aligned; the header says what it points to, and that nobody writes to it during the call.
    Ok(unsafe { &*pointer })
}

/// Where the caller wants a result.
pub(crate) fn output<'a, T>(pointer: *mut T) -> Result<&'a mut T, Status> {
    checked(pointer.cast_const())?;
    // SAFETY: as for `input`, for writing; every `T` here is numbers only, for which any bytes are a value.
    Ok(unsafe { &mut *pointer })
}

/// A result as C takes it.
pub(crate) fn status(result: Result<(), Status>) -> Status {
    result.err().unwrap_or(Status::Ok)
}
