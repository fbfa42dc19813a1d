//! Files and folders of results: whole or not there, and nothing is overwritten.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A file's error with its name and what to do.
pub(crate) fn describe(path: &Path, error: &io::Error) -> String {
    use io::ErrorKind::{IsADirectory, NotADirectory, NotFound, PermissionDenied, StorageFull};
    let remedy = match error.kind() {
        NotFound => "check the path",
        IsADirectory => "give a file, not a folder",
        NotADirectory => "a part of the path is a file: check it",
        PermissionDenied => "choose a place that you may read and write",
        StorageFull => "make room on the disk",
        _ => "check the path and the disk",
    };
    format!("{}: {error}: {remedy}", path.display())
}

/// Fails if a folder for results is there already: before the work that would fill it.
pub(crate) fn must_be_new(path: Option<&Path>) -> Result<(), String> {
    match path.filter(|path| path.exists()) {
        Some(path) => Err(taken(path)),
        None => Ok(()),
    }
}

fn taken(path: &Path) -> String {
    format!(
        "{} exists already: choose another --out, nothing is overwritten",
        path.display()
    )
}

/// Writes files into a new folder, which appears only when all are in it: `wanted`, or `out/NAME`, `out/NAME-2` and so on.
pub(crate) fn publish(
    wanted: Option<&Path>,
    name: &str,
    files: &[(&str, &[u8])],
) -> Result<PathBuf, String> {
    let name = name.replace(['/', '\\'], "-");
    let parent = match wanted {
        Some(path) => path.parent().unwrap_or(Path::new("")),
        None => Path::new("out"),
    };
    if !parent.as_os_str().is_empty() {
        fs::create_dir_all(parent).map_err(|error| describe(parent, &error))?;
    }
    let unfinished = parent.join(format!(".saltus-{}", std::process::id()));
    let result = fill(&unfinished, files).and_then(|()| match wanted {
        Some(path) => place(&unfinished, path)?.ok_or_else(|| taken(path)),
        None => number(parent, &name, |path| place(&unfinished, path)),
    });
    if result.is_err() {
        // Best effort: the error that is told is the first one.
        let _ = fs::remove_dir_all(&unfinished);
    }
    result
}

fn fill(folder: &Path, files: &[(&str, &[u8])]) -> Result<(), String> {
    fs::create_dir(folder).map_err(|error| describe(folder, &error))?;
    for (name, bytes) in files {
        write(folder, name, bytes)?;
    }
    Ok(())
}

/// Gives the finished folder its name; `None` if the name is taken.
fn place(finished: &Path, path: &Path) -> Result<Option<PathBuf>, String> {
    if path.exists() {
        return Ok(None);
    }
    fs::rename(finished, path).map_err(|error| describe(path, &error))?;
    Ok(Some(path.to_owned()))
}

/// A new empty folder that fills while the command works: `wanted`, or `out/NAME`, `out/NAME-2` and so on.
pub(crate) fn create(wanted: Option<&Path>, name: &str) -> Result<PathBuf, String> {
    let make = |path: &Path| {
        if let Some(parent) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
            fs::create_dir_all(parent).map_err(|error| describe(parent, &error))?;
        }
        match fs::create_dir(path) {
            Ok(()) => Ok(Some(path.to_owned())),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(None),
            Err(error) => Err(describe(path, &error)),
        }
    };
    match wanted {
        Some(path) => make(path)?.ok_or_else(|| taken(path)),
        None => number(Path::new("out"), name, make),
    }
}

/// The first of NAME, NAME-2 and so on that `make` takes.
fn number(
    parent: &Path,
    name: &str,
    make: impl Fn(&Path) -> Result<Option<PathBuf>, String>,
) -> Result<PathBuf, String> {
    for i in 1..10_000 {
        let path = parent.join(if i == 1 {
            name.to_owned()
        } else {
            format!("{name}-{i}")
        });
        if let Some(made) = make(&path)? {
            return Ok(made);
        }
    }
    Err(format!(
        "{} holds ten thousand results of this name: clean it up",
        parent.display()
    ))
}

/// Writes one file.
pub(crate) fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), String> {
    let path = folder.join(name);
    fs::write(&path, bytes).map_err(|error| describe(&path, &error))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::publish;
    use std::fs;

    #[test]
    fn a_folder_appears_whole_or_not_at_all() {
        let root = std::env::temp_dir().join(format!("saltus-folder-{}", std::process::id()));
        let _ = fs::remove_dir_all(&root);
        let out = root.join("a/b");
        let made = publish(Some(&out), "x", &[("one", b"1"), ("two", b"2")]).unwrap();
        assert_eq!(fs::read(made.join("two")).unwrap(), b"2");
        let error = publish(Some(&out), "x", &[("one", b"3")]).unwrap_err();
        assert!(error.contains("nothing is overwritten"), "{error}");
        assert_eq!(fs::read(out.join("one")).unwrap(), b"1");
        // A file that cannot be written leaves nothing behind.
        let other = root.join("a/c");
        assert!(publish(Some(&other), "x", &[("one", b"1"), ("no/such", b"2")]).is_err());
        assert_eq!(fs::read_dir(root.join("a")).unwrap().count(), 1);
        fs::remove_dir_all(&root).unwrap();
    }
}
