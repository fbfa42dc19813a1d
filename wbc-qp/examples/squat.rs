//! iCub rises from a squat: in each tick a quadratic program finds joint speeds that lift the centre of mass over both soles.
//!
//! `cargo run --release -p wbc-qp --example squat`

use icub_model::{Icub23, LIMITS, SOLES};
use rbd_core::{Configuration, Tangent, integrate};
use wbc_qp::{Contact, Horizon, Snapshot, VelocityQp};

const TICK: f64 = 0.01;
/// Wanted speed of the centre of mass, m/s.
const RISE: [f64; 3] = [0.0, 0.0, 0.08];

fn main() -> Result<(), wbc_qp::Error> {
    let mut q = Configuration::NEUTRAL;
    for leg in [0, 6] {
        (q.joints[leg], q.joints[leg + 3], q.joints[leg + 4]) = (0.5, -1.0, -0.5);
    }
    let mut velocity = Tangent::ZERO;
    let contacts = SOLES.map(|sole| Contact::new(&sole, 0.5, 600.0));
    let horizon = Horizon {
        position: 0.02,
        velocity: 0.005,
        acceleration: 500.0,
    };
    let mut snapshot = Snapshot::<f64, 23>::ZERO;
    let mut qp = VelocityQp::<f64, 23, 29, 12>::new();
    let mut risen = 0.0;
    for k in 0..50 {
        snapshot.update(&Icub23, &q, &velocity);
        qp.begin(&Icub23, &snapshot, &contacts)?;
        qp.minimise(&snapshot.com(), &RISE, &[1e4; 3]);
        qp.minimise_joints(&[0.0; 23], &[1.0; 23]);
        qp.limit_joints(&snapshot, &LIMITS, &horizon);
        velocity = qp.solve()?.velocity;
        risen += TICK * snapshot.com().of(&velocity)[2];
        q = integrate(&q, &(velocity * TICK));
        if k % 10 == 0 {
            println!(
                "{:.1} s: {:4.1} cm, left knee {:6.1} degrees",
                f64::from(k) * TICK,
                100.0 * risen,
                q.joints[3].to_degrees()
            );
        }
    }
    println!("0.5 s: {:4.1} cm", 100.0 * risen);
    let program = size_of::<VelocityQp<f64, 23, 29, 12>>();
    println!("memory of the program: {program} B");
    assert!(risen > 0.036, "4 cm were asked for");
    Ok(())
}
