//! What is written builds: a crate in an empty folder, with the commands that are printed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use model_import::emit::{Crate, Dependency, Provenance, commands, write_crate};
use model_import::{Options, Robot};
use rbd_core::BaseKind;

/// A pendulum with a geared twin, so that every table is written.
const ROBOT: &str = r#"<robot name="twin pendulum"><link name="stand"/>
<joint name="first" type="continuous"><parent link="stand"/><child link="a"/><axis xyz="0 1 0"/></joint>
<link name="a"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="second" type="continuous"><parent link="stand"/><child link="b"/><axis xyz="0 0.6 0.8"/>
  <mimic joint="first" multiplier="-2"/></joint>
<link name="b"><inertial><origin xyz="0.1 0 -0.5"/><mass value="2"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#;

fn write(folder: &Path, member: bool) {
    let options = Options {
        base: BaseKind::Fixed,
        ..Options::default()
    };
    let robot = Robot::from_urdf(ROBOT, &options).unwrap();
    let about = Crate {
        package: "twin-model".to_owned(),
        rbd_core: Dependency::default(),
        member,
    };
    let provenance = Provenance::new("twin.urdf", ROBOT, "MIT");
    write_crate(folder, &robot, &about, &provenance).unwrap();
}

fn scratch(parent: &Path, name: &str) -> PathBuf {
    let folder = parent.join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Types the printed commands, without a network and in their own target folder.
fn build(folder: &Path) {
    // What the workspace has locked is what is at hand without a network.
    let lock = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.lock");
    fs::copy(lock, folder.join("Cargo.lock")).unwrap();
    let output = Command::new("sh")
        .args(["-e", "-c", &commands(folder)])
        .env("CARGO_NET_OFFLINE", "true")
        .env(
            "CARGO_TARGET_DIR",
            Path::new(env!("CARGO_TARGET_TMPDIR")).join("built"),
        )
        .env_remove("RUSTFLAGS")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(!said.contains("warning"), "{said}");
}

#[test]
fn a_crate_builds_in_an_empty_folder() {
    let name = format!("saltus import {}", std::process::id());
    let folder = scratch(&std::env::temp_dir(), &name);
    write(&folder, false);
    let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
    assert!(!manifest.contains("[workspace]"), "nothing around it");
    build(&folder);
    fs::remove_dir_all(folder).unwrap();
}

/// Where the example of a README writes it: inside a workspace that does not know it.
#[test]
fn a_crate_builds_inside_a_foreign_workspace() {
    let around = scratch(Path::new(env!("CARGO_TARGET_TMPDIR")), "foreign");
    fs::write(
        around.join("Cargo.toml"),
        "[workspace]\nmembers = []\nresolver = \"3\"\n",
    )
    .unwrap();
    write(&around.join("alone"), false);
    build(&around.join("alone"));
    write(&around.join("member"), true);
    let manifest = fs::read_to_string(around.join("member/Cargo.toml")).unwrap();
    assert!(!manifest.contains("[workspace]"));
}

#[test]
fn without_its_workspace_the_version_is_named() {
    // This very build has a workspace: its default is a path, which exists.
    assert!(matches!(Dependency::default(), Dependency::Path(p) if p.join("src/lib.rs").is_file()));
    let folder = scratch(Path::new(env!("CARGO_TARGET_TMPDIR")), "by-version");
    let robot = Robot::from_urdf(
        ROBOT,
        &Options {
            base: BaseKind::Fixed,
            ..Options::default()
        },
    )
    .unwrap();
    let about = Crate {
        package: "twin-model".to_owned(),
        rbd_core: Dependency::Version("0.1.0".to_owned()),
        member: false,
    };
    write_crate(&folder, &robot, &about, &Provenance::new("t", "", "MIT")).unwrap();
    assert!(
        fs::read_to_string(folder.join("Cargo.toml"))
            .unwrap()
            .contains("rbd-core = \"0.1.0\"")
    );
}
