//! Writes the tables of `a1-model` and `icub-model` from the URDFs in `models/`, or checks that they are up
//! to date.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use model_import::emit::{Provenance, module};
use model_import::{Options, Robot};

/// Arguments of `cargo xtask gen-model`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Write nothing; fail if a file is not what would be written.
    #[arg(long)]
    check: bool,
}

/// One module of tables and what it is made from.
struct Generated {
    urdf: &'static str,
    licence: &'static str,
    locks: &'static [&'static str],
    robot_type: &'static str,
    module: &'static str,
}

/// The neck and the wrists: paper B moves 23 of iCub's joints.
pub(crate) const ICUB_LOCKS: &[&str] = &[
    "neck_pitch",
    "neck_roll",
    "neck_yaw",
    "l_wrist_prosup",
    "l_wrist_pitch",
    "l_wrist_yaw",
    "r_wrist_prosup",
    "r_wrist_pitch",
    "r_wrist_yaw",
];

const MODULES: [Generated; 4] = [
    Generated {
        urdf: "a1.urdf",
        licence: "BSD-3-Clause",
        locks: &[],
        robot_type: "A1",
        module: "a1-model/src/a1.rs",
    },
    Generated {
        urdf: "a1_reference.urdf",
        licence: "BSD-3-Clause",
        locks: &[],
        robot_type: "A1Reference",
        module: "a1-model/src/a1_reference.rs",
    },
    Generated {
        urdf: "icub_gazebo_v2_5.urdf",
        licence: "CC-BY-SA-4.0",
        locks: ICUB_LOCKS,
        robot_type: "AsPublished",
        module: "icub-model/src/gazebo.rs",
    },
    Generated {
        urdf: "icub_genova04.urdf",
        licence: "CC-BY-SA-4.0",
        locks: ICUB_LOCKS,
        robot_type: "AsPublished",
        module: "icub-model/src/cad.rs",
    },
];

pub(crate) fn run(args: &Args) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for generated in &MODULES {
        let text = tables(&root, generated)?;
        let path = root.join(generated.module);
        if !args.check {
            fs::write(&path, text).with_context(|| generated.module.to_owned())?;
            println!("{}", generated.module);
        } else if fs::read_to_string(&path).ok().as_ref() != Some(&text) {
            bail!(
                "{} is not what {} gives: run `cargo xtask gen-model`",
                generated.module,
                generated.urdf
            );
        }
    }
    Ok(())
}

fn tables(root: &Path, generated: &Generated) -> Result<String> {
    let urdf = fs::read_to_string(root.join("models").join(generated.urdf))
        .with_context(|| generated.urdf.to_owned())?;
    let options = Options {
        locks: (generated.locks.iter())
            .map(|joint| ((*joint).to_owned(), 0.0))
            .collect(),
        ..Options::default()
    };
    let robot = Robot::from_urdf(&urdf, &options).with_context(|| generated.urdf.to_owned())?;
    let provenance = Provenance::new(generated.urdf, &urdf, generated.licence);
    Ok(module(&robot, generated.robot_type, &provenance))
}
