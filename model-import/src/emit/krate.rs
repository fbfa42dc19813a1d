//! A crate of its own around the tables.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::module::{Provenance, TOOL, module};
use super::names::type_name;
use crate::robot::Robot;

/// Where the written crate finds rbd-core.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Dependency {
    /// By version, from a registry.
    Version(String),
    /// By path.
    Path(PathBuf),
}

impl Default for Dependency {
    /// The rbd-core that this program was built with: by path if it was built from the workspace and that is still there, by version
    /// if it came from a registry.
    fn default() -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rbd-core");
        match folder.canonicalize() {
            Ok(folder) if folder.join("Cargo.toml").is_file() => Self::Path(folder),
            _ => Self::Version(env!("CARGO_PKG_VERSION").to_owned()),
        }
    }
}

/// What to call a written crate.
#[derive(Clone, Debug)]
pub struct Crate {
    /// Its package name, such as `a1-model`.
    pub package: String,
    /// Where it finds rbd-core.
    pub rbd_core: Dependency,
    /// It will be a member of the workspace around its folder. Otherwise it is a workspace of its own there, so that it builds
    /// as it is.
    pub member: bool,
}

/// Writes a crate with the robot's tables into a folder that does not exist yet or is empty.
///
/// # Errors
/// [`io::ErrorKind::AlreadyExists`] if the folder has content, and whatever the file system says.
pub fn write_crate(
    folder: &Path,
    robot: &Robot,
    about: &Crate,
    provenance: &Provenance,
) -> io::Result<()> {
    if folder.exists() && fs::read_dir(folder)?.next().is_some() {
        return Err(io::Error::new(
            io::ErrorKind::AlreadyExists,
            format!(
                "{} is not empty: choose another folder, or remove it first",
                folder.display()
            ),
        ));
    }
    fs::create_dir_all(folder.join("src"))?;
    let robot_type = type_name(&robot.name);
    fs::write(
        folder.join("Cargo.toml"),
        manifest(
            robot,
            about,
            provenance,
            !about.member && in_workspace(folder),
        ),
    )?;
    fs::write(
        folder.join("README.md"),
        readme(robot, about, provenance, &robot_type),
    )?;
    fs::write(folder.join("src/lib.rs"), LIB)?;
    fs::write(
        folder.join("src/tables.rs"),
        module(robot, &robot_type, provenance),
    )
}

/// What to type to build and test a crate that was written to `folder`, one command per line.
#[must_use]
pub fn commands(folder: &Path) -> String {
    let quoted = folder.display().to_string().replace('\'', r"'\''");
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+".contains(c);
    if quoted.chars().all(plain) {
        format!("cd {quoted}\ncargo build\ncargo test")
    } else {
        format!("cd '{quoted}'\ncargo build\ncargo test")
    }
}

/// Whether a folder stands in a Cargo workspace, whose root would claim a package in it.
fn in_workspace(folder: &Path) -> bool {
    let Ok(folder) = folder.canonicalize() else {
        return false;
    };
    let manifests = folder.ancestors().skip(1).map(|a| a.join("Cargo.toml"));
    let mut texts = manifests.filter_map(|m| fs::read_to_string(m).ok());
    texts.any(|text| {
        text.lines()
            .any(|line| line.trim().starts_with("[workspace"))
    })
}

const LIB: &str = "#![doc = include_str!(\"../README.md\")]
#![no_std]
#![forbid(unsafe_code)]

#[rustfmt::skip]
mod tables;

pub use tables::*;
";

fn manifest(robot: &Robot, about: &Crate, provenance: &Provenance, alone: bool) -> String {
    let alone = if alone {
        "\n# Stands alone in the workspace around it; remove this line to make it a member.\n[workspace]\n"
    } else {
        ""
    };
    let dependency = match &about.rbd_core {
        Dependency::Version(version) => format!("rbd-core = {version:?}"),
        Dependency::Path(path) => {
            format!("rbd-core = {{ path = {:?} }}", path.display().to_string())
        }
    };
    format!(
        "[package]
name = {:?}
version = \"0.1.0\"
edition = \"2024\"
description = {:?}
license = {:?}

[dependencies]
{dependency}
{alone}",
        about.package,
        format!("Dynamics tables of the robot {}.", robot.name),
        provenance.licence,
    )
}

fn readme(robot: &Robot, about: &Crate, provenance: &Provenance, robot_type: &str) -> String {
    let n = robot.bodies.len();
    let library = about.package.replace('-', "_");
    format!(
        "# {package}

The robot `{name}` for `rbd-core`: {n} joints, {mass:.6} kg, `no_std`, only tables.

```
use {library}::{robot_type};
use rbd_core::Model;

let names = Model::<f64, {n}>::joint_names(&{robot_type});
assert_eq!(names.len(), {n});
```

Written by {TOOL} from `{source}` (sha256 {sha256}), whose licence is {licence}; write it anew rather than
editing it.
",
        package = about.package,
        name = robot.name,
        mass = robot.mass(),
        source = provenance.source,
        sha256 = provenance.sha256,
        licence = provenance.licence,
    )
}
