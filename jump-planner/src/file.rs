//! Files that are read whole, up to a length: a device, or a log given by mistake, must not fill the memory.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Longest file that is read, bytes: plans take less than one of these 64 MiB.
const LONGEST: u64 = 64 << 20;

/// The bytes of a file.
///
/// # Errors
/// What the operating system says, or that the file is longer than 64 MiB.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut file = File::open(path)?.take(LONGEST + 1);
    file.read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LONGEST {
        let what = format!("longer than {} MiB, the most that is read", LONGEST >> 20);
        return Err(Error::new(ErrorKind::FileTooLarge, what));
    }
    Ok(bytes)
}

/// The text of a file.
///
/// # Errors
/// As [`read`], or that it is no UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let what = |_| Error::new(ErrorKind::InvalidData, "not UTF-8 text");
    String::from_utf8(read(path)?).map_err(what)
}

/// An error of a file, with what to do about it.
#[must_use]
pub fn told(error: &Error) -> String {
    use ErrorKind::{
        FileTooLarge, InvalidData, InvalidFilename, IsADirectory, NotADirectory, NotFound,
        PermissionDenied, ReadOnlyFilesystem, StorageFull,
    };
    let remedy = match error.kind() {
        NotFound => "check the path",
        IsADirectory => "give a file, not a folder",
        NotADirectory => "a part of the path is a file: check it",
        PermissionDenied | ReadOnlyFilesystem => "choose a place that you may read and write",
        StorageFull => "make room on the disk",
        FileTooLarge => "give another file",
        InvalidData => "give a text file",
        InvalidFilename => "choose a shorter name",
        _ => "check the path and the disk",
    };
    format!("{error}: {remedy}")
}
