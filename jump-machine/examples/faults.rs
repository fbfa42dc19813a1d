//! The machine of a whole jump as firmware runs it: it stands, and a sensor that fails ends in damping, not in a wild torque.
//!
//! `cargo run --release -p jump-machine --example faults`

use a1_model::{A1Geared, BUILD, FEET, MOTORS};
use jump_control::Measurement;
use jump_machine::{Machine, Observation, Settings};
use rbd_core::{Motion, Transform};

fn main() {
    let crouch = core::array::from_fn(|i| [0.0, 0.8, -1.6][i % 3]);
    let settings = Settings::new(&BUILD, FEET.map(|foot| foot.frame), MOTORS, crouch);
    // All memory there is; a static in firmware.
    let mut workspace = jump_machine::Workspace::new();
    let mut machine = Machine::<f64, _, 12, 4>::new(&A1Geared, settings, &mut workspace);
    let mut inputs = Observation {
        measured: Measurement {
            base: Transform::IDENTITY,
            base_velocity: Motion::ZERO,
            joints: crouch,
            joint_velocities: [0.0; 12],
            foot_forces: [33.7; 4],
            age: 0.0,
        },
        joint_torques: [0.0; 12],
    };
    for millisecond in 0..30 {
        if millisecond == 20 {
            inputs.measured.joints[4] = f64::NAN;
        }
        let tick = machine.tick(f64::from(millisecond) * 1e-3, Some(&inputs));
        let mut torques = [0.0; 12];
        for _ in 0..10 {
            torques = machine.joint_tick(&crouch, &[0.0; 12], 1e-4);
        }
        if millisecond % 5 == 0 {
            println!(
                "{millisecond:2} ms: {:?}, fault {:?}, knee {:.2} N m",
                tick.phase, tick.fault, torques[2]
            );
        }
    }
    assert!(machine.fault().is_some(), "the machine has named the joint");
    // A plan is given by `machine.arm(jump, start)`: see `jump-lab/src/closed_loop` for the whole loop.
}
