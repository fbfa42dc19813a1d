//! One joint follows a plan of two nodes: the sampler at 1 kHz, the joint's PD at 10 kHz, a motor with its limits.
//!
//! `cargo run -p jump-control --example track`

use jump_control::{JointCommand, JointGains, Node, Plan, PlanError, Torques, sample};

fn main() -> Result<(), PlanError> {
    // From 0 to 0.5 rad in 0.4 s and no faster than the plan's spline wants.
    let nodes = [0.0, 0.4].map(|time| Node::<f64, 1, 1> {
        time,
        joints: [1.25 * time],
        ..Node::ZERO
    });
    let plan = Plan::new(&nodes, 0.2, 0.3, 0.4, Torques::Hold)?;
    let motor = a1_model::MOTORS[0];
    let gains = [JointGains {
        stiffness: 60.0,
        damping: 1.5,
    }];
    let (mut position, mut speed, mut node) = (0.0, 0.0, 0);
    for k in 0..500_u32 {
        let t = f64::from(k) * 1e-3;
        // The last node is the hint for the next search.
        let wanted = sample(&plan, t, node);
        node = wanted.node;
        let command = JointCommand::<f64, 1> {
            position: wanted.joints,
            velocity: wanted.joint_velocities,
            feed_forward: wanted.torques,
            gains,
        };
        for _ in 0..10 {
            let [torque] = command.torques(&[position], &[speed], &[motor]);
            speed += 1e-4 * torque / 0.02; // a load of 0.02 kg m²
            position += 1e-4 * speed;
        }
        if k % 100 == 0 {
            println!("{t:.1} s: {position:.3} rad of {:.3}", wanted.joints[0]);
        }
    }
    assert!((position - 0.5).abs() < 0.02);
    Ok(())
}
