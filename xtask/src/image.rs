//! Building the bare-metal images of `firmware/smoke`.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result};
use object::{Object, ObjectSegment};
use serde_json::Value;

use crate::bare::Bare;
use crate::board::Board;
use crate::run;

/// Where the boards' memory maps put data: everything from here on.
const DATA: u64 = 0x2000_0000;

/// What an image takes of memory, bytes.
#[derive(Clone, Copy)]
pub(crate) struct Size {
    /// Code, tables, and what data begin with.
    pub(crate) flash: u64,
    /// Static data.
    pub(crate) data: u64,
}

impl Size {
    pub(crate) fn of(image: &Path) -> Result<Self> {
        let bytes = std::fs::read(image).with_context(|| image.display().to_string())?;
        let elf = object::File::parse(&*bytes)?;
        let data = elf.segments().filter(|segment| segment.address() >= DATA);
        Ok(Self {
            flash: elf.segments().map(|segment| segment.file_range().1).sum(),
            data: data.map(|segment| segment.size()).sum(),
        })
    }
}

/// Where cargo puts what it builds of the firmware's workspace.
pub(crate) fn firmware_target() -> Result<PathBuf> {
    let mut metadata = run::firmware_cargo();
    metadata.args(["metadata", "--format-version=1", "--no-deps", "--locked"]);
    let metadata: Value = serde_json::from_str(&run::stdout(&mut metadata)?)?;
    let folder = metadata["target_directory"].as_str();
    folder.map(PathBuf::from).context("cargo names no folder")
}

/// An image to build.
pub(crate) struct Image<'a> {
    pub(crate) board: &'a Board,
    pub(crate) name: &'a str,
    pub(crate) bare: &'a Bare,
}

/// Builds images side by side: linking takes most of the time, and uses one core. Errors come back from [`Image::command`].
pub(crate) fn build_ahead(board: &Board, bare: &Bare, names: &[&str]) -> Result<()> {
    let mut build = bare.build_for(board.name, board.rustflags);
    build.args(["--keep-going", "--package", "saltus-smoke"]);
    run::output(build.args(names.iter().flat_map(|name| ["--bin", name])))?;
    Ok(())
}

impl Image<'_> {
    /// The command that builds the image.
    pub(crate) fn command(&self) -> Command {
        self.command_with(self.board.rustflags)
    }

    fn command_with(&self, rustflags: &[&str]) -> Command {
        let mut build = self.bare.build_for(self.board.name, rustflags);
        build.args(["--package", "saltus-smoke", "--bin", self.name]);
        build
    }

    /// Builds the image and returns where it is.
    pub(crate) fn build(&self) -> Result<PathBuf> {
        self.build_with(self.board.rustflags, &[])
    }

    /// As [`Image::build`], with other compiler flags and more arguments of cargo.
    pub(crate) fn build_with(&self, rustflags: &[&str], arguments: &[&str]) -> Result<PathBuf> {
        let mut build = self.command_with(rustflags);
        build.args(["--quiet", "--message-format=json-render-diagnostics"]);
        build.args(arguments).stderr(Stdio::inherit());
        let messages = run::stdout(&mut build)?;
        let executable = run::executables(&messages).next();
        executable.with_context(|| format!("cargo built no executable of {}", self.name))
    }
}
