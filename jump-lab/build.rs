//! Tells a program with MuJoCo where it finds the library that it was linked with, so that it starts from any shell.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=MUJOCO_DYNAMIC_LINK_DIR");
    let is_unix = env::var("CARGO_CFG_TARGET_FAMILY").is_ok_and(|family| family == "unix");
    let folder = env::var("MUJOCO_DYNAMIC_LINK_DIR").ok().filter(|_| is_unix);
    if let (Some(folder), Some(_)) = (folder, env::var_os("CARGO_FEATURE_MUJOCO")) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{folder}");
    }
}
