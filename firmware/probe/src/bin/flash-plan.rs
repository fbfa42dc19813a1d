//! Writes the plan that stands in flash from a container of `saltus plan`: `flash-plan plan.bin a1-double-backflip.bin`.

use a1_model::A1Geared;
use jump_control::Node;
use jump_control::container::{Container, model_hash};

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(from), Some(to)) = (arguments.next(), arguments.next()) else {
        return Err("flash-plan CONTAINER FILE".into());
    };
    let bytes = std::fs::read(&from)?;
    let plan = Container::<12, 4>::open(&bytes, model_hash::<f64, _, 12>(&A1Geared))?;
    let header = plan.header();
    let step = header.ground.ok_or("the plan has no box to jump from")?;
    let nodes: Vec<Node<f64, 12, 4>> = plan.nodes().map(|node| node.node()).collect();
    let Some(last) = nodes.last() else {
        return Err("the plan has no nodes".into());
    };
    let head = [
        header.takeoff,
        header.posing,
        header.touchdown,
        header.margins.weight,
    ];
    let mut out: Vec<f64> = head.map(f64::from).to_vec();
    // The robot waits for the ground in this posture, and the plan ends in it.
    out.extend(last.joints);
    out.extend([step.drop, step.distance].map(f64::from));
    for node in &nodes {
        out.push(node.time);
        out.extend(node.base.rotation.matrix().transpose().iter());
        out.extend(node.base.translation.iter());
        out.extend(node.base_velocity.to_array());
        out.extend(node.joints.iter().chain(&node.joint_velocities));
        out.extend(node.torques);
        out.extend(node.forces_w.iter().flatten());
    }
    let bytes: Vec<u8> = out.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    std::fs::write(&to, &bytes)?;
    println!("{to}: {} nodes, {} bytes", nodes.len(), bytes.len());
    Ok(())
}
