//! Memory maps of the boards, in `maps`, and what the build scripts of their images do with them.
use core::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Links the images of the calling package with the map of a board: that of `SALTUS_BOARD`, else `board`. Returns the folder that the
/// linker searches, for what else it should find.
///
/// # Errors
/// A board without a map, and what the file system says.
pub fn link(board: &str) -> Result<PathBuf, Box<dyn Error>> {
    let board = env::var("SALTUS_BOARD").unwrap_or_else(|_| board.into());
    let maps = Path::new(env!("CARGO_MANIFEST_DIR")).join("maps");
    let map = maps.join(format!("{board}.x"));
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::copy(&map, out.join("memory.x")).map_err(|e| format!("{}: {e}", map.display()))?;
    println!("cargo:rerun-if-env-changed=SALTUS_BOARD");
    println!("cargo:rerun-if-changed={}", map.display());
    println!("cargo:rustc-link-search={}", out.display());
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=--nmagic");
    }
    Ok(out)
}
