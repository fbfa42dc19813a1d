//! A1 falls from 0.5 m, tilted by 10 degrees, and the landing controller brings it to rest.
//!
//! `cargo run --release -p landing --example drop`

use a1_model::{A1Geared, BUILD, FEET, FOOT_RADIUS, MOTORS, a1};
use contact_sim::{Error, NativeSimulator, Shape, Simulator, Terrain};
use landing::{Landing, Settings, Target, Workspace};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, Tangent};

fn main() -> Result<(), Error> {
    let balls = core::array::from_fn(|i| {
        let frame = FEET[i].frame;
        Shape::ball(frame.link, frame.offset, FOOT_RADIUS, i)
    });
    let settings = contact_sim::Settings::new(&a1::LIMITS, &MOTORS);
    let mut plant =
        NativeSimulator::<f64, _, 12, 4, 4>::new(A1Geared, balls, Terrain::FLAT, settings);
    let mut start = Configuration::NEUTRAL;
    start.joints = core::array::from_fn(|i| [0.0, 0.77, -1.54][i % 3]);
    start.base.rotation = Rotation3::from_euler_angles(0.17, 0.0, 0.0);
    start.base.translation.z = 0.8;
    plant.reset(&start, &Tangent::ZERO);

    // What firmware holds: the controller, and its memory in a static.
    let feet = FEET.map(|foot| foot.frame);
    let landing = Landing::<f64, 12, 4>::new(feet, Settings::new(&BUILD), [33.5; 12]);
    let mut workspace = Workspace::new();
    let target = Target {
        height: 0.25,
        ..Target::LEVEL
    };
    for k in 0..2000 {
        let (q, v) = (*plant.configuration(), *plant.velocity());
        // A foot sensor that feels 15 N stands; `landing::Detector` does this for sensors that lie.
        let contacts = plant.contact_forces_w().map(|f| f.norm() > 15.0);
        let c = landing.step(
            &A1Geared,
            &q,
            &v,
            &contacts,
            &target,
            &start.joints,
            &mut workspace,
        );
        for _ in 0..10 {
            let (q, v) = (plant.configuration().joints, plant.velocity().joints);
            let torques = core::array::from_fn(|i| {
                c.feed_forward[i] + c.stiffness[i] * (c.position[i] - q[i]) - c.damping[i] * v[i]
            });
            plant.step(&torques)?;
        }
        if k % 250 == 0 {
            let up = q.base.rotation * Vector3::z();
            let (height, tilt) = (q.base.translation.z, so3::math::acos(up.z).to_degrees());
            println!(
                "{:.2} s: {height:.3} m, tilted by {tilt:4.1} degrees, {contacts:?}",
                f64::from(k) * 1e-3
            );
        }
    }
    let up = plant.configuration().base.rotation * Vector3::z();
    assert!(
        up.z > 0.985 && plant.velocity().base.linear.norm() < 0.05,
        "upright and at rest"
    );
    Ok(())
}
