//! Puts the board's memory map and the names of its interrupts where the linker finds them.

use std::path::PathBuf;
use std::{env, fs};

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let board = env::var("SALTUS_BOARD").unwrap_or_else(|_| "mps2-an500".into());
    let map = PathBuf::from("../smoke/memory").join(format!("{board}.x"));
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::copy(&map, out.join("memory.x")).map_err(|e| format!("{}: {e}", map.display()))?;
    let interrupts = "PROVIDE(SPARE0 = DefaultHandler);\nPROVIDE(SPARE1 = DefaultHandler);\n";
    fs::write(out.join("device.x"), interrupts)?;
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-env-changed=SALTUS_BOARD");
    println!("cargo:rerun-if-changed={}", map.display());
    if env::var("CARGO_CFG_TARGET_OS")? == "none" {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=--nmagic");
    }
    Ok(())
}
