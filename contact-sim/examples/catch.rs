//! A1 falls 10 cm and is caught by springs in its joints: a simulator, a controller, a loop.
//!
//! `cargo run --release -p contact-sim --example catch`

use a1_model::{A1Geared, FEET, MOTORS, a1};
use contact_sim::{Error, NativeSimulator, Settings, Shape, Simulator, Terrain};
use rbd_core::{Configuration, Tangent};

const CROUCH: [f64; 3] = [0.0, 0.8, -1.6];

fn main() -> Result<(), Error> {
    let feet = core::array::from_fn(|i| {
        let frame = FEET[i].frame;
        Shape::ball(frame.link, frame.offset, a1_model::FOOT_RADIUS, i)
    });
    let settings = Settings::new(&a1::LIMITS, &MOTORS);
    let mut plant =
        NativeSimulator::<f64, _, 12, 4, 4>::new(A1Geared, feet, Terrain::FLAT, settings);
    let mut start = Configuration::NEUTRAL;
    start.joints = core::array::from_fn(|i| CROUCH[i % 3]);
    start.base.translation.z = 0.4;
    plant.reset(&start, &Tangent::ZERO);
    for k in 0..15_000 {
        let (q, v) = (plant.configuration().joints, plant.velocity().joints);
        let torques = core::array::from_fn(|i| 80.0 * (CROUCH[i % 3] - q[i]) - 2.0 * v[i]);
        plant.step(&torques)?; // 100 µs; the motors' limits are the plant's
        if k % 2_500 == 0 {
            let height = plant.configuration().base.translation.z;
            let load: f64 = plant.contact_forces_w().iter().map(|f| f.z).sum();
            println!(
                "{:.2} s: trunk at {height:.3} m, ground carries {load:5.1} N",
                f64::from(k) * 1e-4
            );
        }
    }
    let load: f64 = plant.contact_forces_w().iter().map(|f| f.z).sum();
    assert!(
        (load - 13.741 * 9.81).abs() < 1.0,
        "it stands on its weight: {load} N"
    );
    Ok(())
}
