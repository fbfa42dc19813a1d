//! A body is turned to a wanted orientation by its rotation error: the law that sits in every attitude controller.
//!
//! `cargo run -p so3 --example attitude`

use so3::{Rotation3, Vector3, exp, log, rotation_error};

/// Stiffness and damping per inertia, 1/s² and 1/s.
const GAINS: [f64; 2] = [100.0, 20.0];
const STEP: f64 = 1e-3;

fn main() {
    // Almost upside down, and tumbling.
    let mut rot_wb: Rotation3<f64> = exp(&Vector3::new(3.0, 0.4, -0.2));
    let mut omega_b = Vector3::new(0.0, 2.0, 0.0);
    let wanted = exp(&Vector3::new(0.0, 0.0, 0.5));
    for k in 0..1000 {
        // In body axes: the rotation that is missing.
        let missing = rotation_error(&rot_wb, &wanted);
        if k % 200 == 0 {
            println!(
                "{:.1} s: {:6.1} degrees to go",
                k as f64 * STEP,
                missing.norm().to_degrees()
            );
        }
        let [stiffness, damping] = GAINS;
        omega_b += (missing * stiffness - omega_b * damping) * STEP;
        rot_wb *= exp(&(omega_b * STEP));
    }
    let left = log(&(rot_wb.transpose() * wanted)).norm().to_degrees();
    println!("1.0 s: {left:6.1} degrees to go");
    assert!(left < 1.0);
}
