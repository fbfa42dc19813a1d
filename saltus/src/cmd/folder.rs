//! Files and folders of results: whole or not there, and nothing is overwritten.

use super::failure::Failure;
use super::leftovers::{self, unfinished};
use jump_planner::file::told;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A file's error with its name and what to do.
pub(crate) fn describe(path: &Path, error: &io::Error) -> String {
    format!("{}: {}", path.display(), told(error))
}

/// Fails where a new folder of results cannot be made, before the work that would fill it: `wanted`, or one in `out`. What killed
/// processes left there is removed.
pub(crate) fn check_new(wanted: Option<&Path>) -> Result<(), Failure> {
    let path = wanted.unwrap_or(Path::new("out/new"));
    // A link that leads nowhere is there too, and a name may be longer than names can be.
    match path.symlink_metadata() {
        Ok(_) if wanted.is_some() => Err(taken(path).into()),
        Err(error) if is_unusable(&error) => Err(describe(path, &error).into()),
        _ => check_parent(path),
    }
}

/// Whether nothing can ever be at a path of which this is told.
fn is_unusable(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::InvalidFilename | io::ErrorKind::InvalidInput
    )
}

/// Fails where a file cannot be written, before the work of which it tells.
pub(crate) fn check_file(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        let error = io::Error::from(io::ErrorKind::IsADirectory);
        return Err(describe(path, &error).into());
    }
    if path.exists() && !path.is_file() {
        return Ok(());
    }
    let shown = path.display();
    if path.as_os_str().to_string_lossy().ends_with('/') {
        return Err(format!("{shown}: this names a folder: give the name of a file").into());
    }
    match path.symlink_metadata() {
        Err(error) if is_unusable(&error) => return Err(describe(path, &error).into()),
        Ok(_) if !path.exists() => {
            return Err(format!("{shown}: a link that leads nowhere: remove it").into());
        }
        _ => {}
    }
    check_parent(path)
}

/// Tries to make something where `path` will be: rights alone do not tell whether that can be.
fn check_parent(path: &Path) -> Result<(), Failure> {
    let parent = parent(path);
    leftovers::remove(parent);
    let there = parent.ancestors().map(or_here).find(|path| path.exists());
    let probe = unfinished(there.unwrap_or(Path::new(".")));
    let made = fs::create_dir(&probe).and_then(|()| fs::remove_dir(&probe));
    made.map_err(|error| describe(path, &error).into())
}

/// The folder of a path.
fn parent(path: &Path) -> &Path {
    or_here(path.parent().unwrap_or(Path::new("")))
}

/// The empty path is where the program runs.
fn or_here(path: &Path) -> &Path {
    if path.as_os_str().is_empty() {
        Path::new(".")
    } else {
        path
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
) -> Result<PathBuf, Failure> {
    let name = name.replace(['/', '\\'], "-");
    let parent = wanted.map_or(Path::new("out"), parent);
    fs::create_dir_all(parent).map_err(|error| Failure::Outside(describe(parent, &error)))?;
    let unfinished = unfinished(parent);
    let result = fill(&unfinished, files).and_then(|()| match wanted {
        Some(path) => place(&unfinished, path)?.ok_or_else(|| taken(path)),
        None => number(parent, &name, |path| place(&unfinished, path)),
    });
    if result.is_err() {
        // Best effort: the error that is told is the first one.
        let _ = fs::remove_dir_all(&unfinished);
    }
    result.map_err(Failure::Outside)
}

fn fill(folder: &Path, files: &[(&str, &[u8])]) -> Result<(), String> {
    fs::create_dir(folder).map_err(|error| describe(folder, &error))?;
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(|error| describe(&path, &error))?;
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
pub(crate) fn create(wanted: Option<&Path>, name: &str) -> Result<PathBuf, Failure> {
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
    Ok(match wanted {
        Some(path) => make(path)?.ok_or_else(|| taken(path))?,
        None => number(Path::new("out"), name, make)?,
    })
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

/// Writes one file of a folder that fills while the command works.
pub(crate) fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), Failure> {
    let path = folder.join(name);
    fs::write(&path, bytes).map_err(|error| Failure::Outside(describe(&path, &error)))
}

/// Writes a file that appears only when it is complete, and its folder; a pipe or a device takes the bytes as they come.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let outside = |error| Failure::Outside(describe(path, &error));
    if fs::symlink_metadata(path).is_ok_and(|there| !there.is_file()) {
        return fs::write(path, bytes).map_err(outside);
    }
    fs::create_dir_all(parent(path)).map_err(outside)?;
    let unfinished = unfinished(parent(path));
    let written = fs::write(&unfinished, bytes).and_then(|()| fs::rename(&unfinished, path));
    if written.is_err() {
        // Best effort: the error that is told is the first one.
        let _ = fs::remove_file(&unfinished);
    }
    written.map_err(outside)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{check_file, check_new, publish, write_file};
    use std::fs;

    #[test]
    fn a_folder_appears_whole_or_not_at_all() {
        let root = std::env::temp_dir().join(format!("saltus-folder-{}", std::process::id()));
        let _ = fs::remove_dir_all(&root);
        let out = root.join("a/b");
        let made = publish(Some(&out), "x", &[("one", b"1"), ("two", b"2")]).unwrap();
        assert_eq!(fs::read(made.join("two")).unwrap(), b"2");
        let error = publish(Some(&out), "x", &[("one", b"3")])
            .unwrap_err()
            .message();
        assert!(error.contains("nothing is overwritten"), "{error}");
        assert_eq!(fs::read(out.join("one")).unwrap(), b"1");
        // A file that cannot be written leaves nothing behind.
        let other = root.join("a/c");
        assert!(publish(Some(&other), "x", &[("one", b"1"), ("no/such", b"2")]).is_err());
        assert_eq!(fs::read_dir(root.join("a")).unwrap().count(), 1);
        let file = root.join("a/file");
        write_file(&file, b"1").unwrap();
        write_file(&file, b"2").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"2");
        assert!(write_file(&out, b"1").is_err());
        assert_eq!(fs::read_dir(root.join("a")).unwrap().count(), 2);
        fs::remove_dir_all(&root).unwrap();
    }

    #[test]
    fn a_target_that_cannot_be_is_noticed_before() {
        let root = std::env::temp_dir().join(format!("saltus-target-{}", std::process::id()));
        let _ = fs::remove_dir_all(&root);
        fs::create_dir_all(&root).unwrap();
        fs::write(root.join("file"), "").unwrap();
        assert!(check_new(Some(&root.join("new/deep"))).is_ok());
        assert!(check_file(&root.join("file")).is_ok());
        for bad in [root.clone(), root.join("file"), root.join("file/below")] {
            assert!(check_new(Some(&bad)).is_err(), "{}", bad.display());
        }
        for bad in [root.clone(), root.join("file/below")] {
            assert!(check_file(&bad).is_err(), "{}", bad.display());
        }
        // Nobody, root neither, makes folders there.
        #[cfg(target_os = "linux")]
        assert!(check_new(Some("/proc/saltus/new".as_ref())).is_err());
        // Looking left nothing.
        assert_eq!(fs::read_dir(&root).unwrap().count(), 1);
        fs::remove_dir_all(&root).unwrap();
    }
}
