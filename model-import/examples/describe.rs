//! What a URDF holds once doubts are told and frames are canonical: `describe [FILE]`, without a file a pendulum.
//!
//! `cargo run -p model-import --example describe -- robot.urdf`

use model_import::{Options, Robot};
use rbd_core::BaseKind;

const PENDULUM: &str = r#"<robot name="pendulum">
  <link name="stand"/>
  <joint name="swing" type="continuous">
    <parent link="stand"/><child link="bob"/><origin xyz="0 0 1"/><axis xyz="0 -1 0"/>
  </joint>
  <link name="bob"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"#;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let (text, base) = match std::env::args().nth(1) {
        Some(path) => (std::fs::read_to_string(path)?, BaseKind::Floating),
        None => (PENDULUM.to_owned(), BaseKind::Fixed),
    };
    let robot = Robot::from_urdf(
        &text,
        &Options {
            base,
            ..Options::default()
        },
    )?;
    println!(
        "{}: {} joints, {:.3} kg",
        robot.name,
        robot.joints.len(),
        robot.mass()
    );
    for (joint, body) in robot.joints.iter().zip(&robot.bodies) {
        println!(
            "  {:24} {:?} from {:?}, {:.3} kg",
            joint.name, body.kind, body.parent, body.mass
        );
    }
    for warning in &robot.warnings {
        println!("doubtful: {warning}");
    }
    Ok(())
}
