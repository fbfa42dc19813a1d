//! Pointers from C: the only place with `unsafe`.

use core::ffi::c_void;
use core::mem::{MaybeUninit, align_of, size_of};

use crate::{Status, VERSION};

/// A controller in memory of the caller.
///
/// A block never moves: its seal holds its own address. So the controller may borrow what stands beside it for as long as the block is
/// initialised. Nobody else reaches that part: [`resident`] gives out the controller's field alone, never a reference to the whole block.
#[repr(C)]
pub(crate) struct Block<C: Resident> {
    /// Says which controller this is, mixed with the block's own address: a copy is not mistaken for it.
    seal: u64,
    controller: C,
    lent: C::Lent,
}

/// A controller that can live in a block.
pub(crate) trait Resident: Sized {
    /// Differs between controllers.
    const KIND: u64;
    /// What the controller borrows; its own until the block is initialised anew.
    type Lent: 'static;
}

fn seal<C: Resident>(address: usize) -> u64 {
    // Odd and unlikely in memory that was never written.
    (C::KIND ^ 0x5a17_5bed_c0de_0001).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ address as u64
}

/// Bytes that [`place`] needs.
pub(crate) const fn size<C: Resident>() -> usize {
    size_of::<Block<C>>()
}

/// Alignment that [`place`] needs.
pub(crate) const fn align<C: Resident>() -> usize {
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

/// Initialises a block: first what is lent, then the controller that borrows it.
pub(crate) fn place<C: Resident>(
    memory: *mut c_void,
    bytes: usize,
    version: u32,
    lent: impl FnOnce() -> C::Lent,
    fill: impl FnOnce(&'static mut C::Lent) -> C,
) -> Result<(), Status> {
    let block = memory.cast::<Block<C>>();
    checked(block)?;
    if bytes < size::<C>() {
        return Err(Status::TooSmall);
    }
    if version != VERSION {
        return Err(Status::WrongVersion);
    }
    // SAFETY: not null, aligned, and the caller says that so many bytes are its own to give; fields are written without a reference to
    // what was there before, which may be nothing. The borrow ends, at the latest, with the caller's last call for this block: it is kept
    // in the controller alone, the controller is reached through `resident` alone, and no reference outlives a call. Writing over an
    // earlier controller ends its borrow.
    unsafe {
        (&raw mut (*block).lent).write(lent());
        (&raw mut (*block).controller).write(fill(&mut (*block).lent));
        (&raw mut (*block).seal).write(seal::<C>(block.addr()));
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
    // SAFETY: the seal says that `place` wrote this block here; the header forbids use by two threads at once. The reference covers
    // the controller's field only, so it does not meet the controller's own borrow of the field beside it.
    Ok(unsafe { &mut (*block).controller })
}

/// What the caller gives to read.
pub(crate) fn input<'a, T>(pointer: *const T) -> Result<&'a T, Status> {
    checked(pointer)?;
    // SAFETY: not null and aligned; the header says what it points to, and that nobody writes to it during the call.
    Ok(unsafe { &*pointer })
}

/// What the caller gives to read, if anything.
pub(crate) fn optional<'a, T>(pointer: *const T) -> Result<Option<&'a T>, Status> {
    if pointer.is_null() {
        return Ok(None);
    }
    input(pointer).map(Some)
}

/// Bytes that the caller keeps in place and unchanged for as long as `'a`: of a plan, until its machine has another or is initialised anew.
pub(crate) fn bytes<'a>(pointer: *const u8, count: usize) -> Result<&'a [u8], Status> {
    checked(pointer)?;
    // No object of C is longer than this; a longer count is a negative number that was cast.
    if isize::try_from(count).is_err() {
        return Err(Status::TooSmall);
    }
    // SAFETY: not null, bytes are always aligned, and the header says that so many of them are there, for how long they stay, and that
    // nobody writes to them meanwhile.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
}

/// Where the caller wants a result.
pub(crate) fn output<'a, T>(pointer: *mut T) -> Result<&'a mut T, Status> {
    checked(pointer.cast_const())?;
    // SAFETY: as for `input`, for writing; every `T` here is numbers only, for which any bytes are a value.
    Ok(unsafe { &mut *pointer })
}

/// Where the caller wants a result that not every byte is a value of: it has to be written before it is read.
pub(crate) fn result<'a, T>(pointer: *mut T) -> Result<&'a mut MaybeUninit<T>, Status> {
    checked(pointer.cast_const())?;
    // SAFETY: as for `output`; any bytes at all are a value of `MaybeUninit`.
    Ok(unsafe { &mut *pointer.cast::<MaybeUninit<T>>() })
}

/// The same where the caller may do without.
pub(crate) fn optional_result<'a, T>(
    pointer: *mut T,
) -> Result<Option<&'a mut MaybeUninit<T>>, Status> {
    if pointer.is_null() {
        return Ok(None);
    }
    result(pointer).map(Some)
}

/// A result as C takes it.
pub(crate) fn status(result: Result<(), Status>) -> Status {
    result.err().unwrap_or(Status::Ok)
}
