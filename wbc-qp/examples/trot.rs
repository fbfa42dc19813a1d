//! A quadruped trots on the spot: two diagonal feet carry it while the others swing, and loads lead from one pair to the other without
//! a step in any torque. The program's torques drive it in the contact simulator.
//!
//! `cargo run --release -p wbc-qp --example trot`

use a1_model::{A1, FEET, FOOT_RADIUS, MOTORS, a1::LIMITS};
use contact_sim::{NativeSimulator, Settings, Shape, Simulator, Terrain};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, Frame, Tangent, joint_friction};
use wbc_qp::task::{orientation_error, position_error};
use wbc_qp::{Contact, Gains, Horizon, Limit, Snapshot, TorqueQp};

type Plant = NativeSimulator<f64, A1, 12, 4, 4>;
type Program = TorqueQp<f64, 12, 12, 24, 40>;

/// One pair's swing, s, and how long a load takes to come or go.
const SWING: f64 = 0.16;
const RAMP: f64 = 0.03;
/// Standing before, s.
const STAND: f64 = 0.3;
/// Height of a step, m.
const STEP: f64 = 0.04;
const TRUNK: Gains<f64> = Gains {
    stiffness: 150.0,
    damping: 25.0,
};
const FOOT: Gains<f64> = Gains {
    stiffness: 900.0,
    damping: 60.0,
};
const HORIZON: Horizon<f64> = Horizon {
    position: 0.04,
    velocity: 0.01,
    acceleration: 2000.0,
};

/// Load of a pair of feet at a time, and how far its swing has got, 0 to 1.
fn gait(pair: usize, time: f64) -> (f64, f64) {
    let time = time - STAND;
    // Between two swings all feet stand for a ramp each.
    let half = SWING + 2.0 * RAMP;
    let turn = (time / half).floor();
    if time < 0.0 || turn as usize % 2 != pair {
        return (1.0, 0.0);
    }
    let into = time - turn * half;
    let load = ((RAMP - into) / RAMP)
        .max((into - RAMP - SWING) / RAMP)
        .clamp(0.0, 1.0);
    (load, ((into - RAMP) / SWING).clamp(0.0, 1.0))
}

/// Writes the program of a tick.
fn write(
    qp: &mut Program,
    s: &Snapshot<f64, 12>,
    home: &Snapshot<f64, 12>,
    time: f64,
) -> Result<(), wbc_qp::Error> {
    let mut contacts = FEET.map(|foot| Contact::new(&foot, 0.5, 200.0));
    for (i, contact) in contacts.iter_mut().enumerate() {
        contact.load = gait(usize::from(i == 1 || i == 2), time).0;
    }
    let friction = joint_friction(&LIMITS, &s.velocity.joints, 0.1);
    qp.begin(&A1, s, &contacts, &friction)?;
    let com = s.com();
    let error = position_error(&home.com_w(), &s.com_w());
    let wanted = com.acceleration([0.0; 3], [0.0; 3], error, TRUNK);
    qp.minimise(&com, &wanted, &[1e3; 3]);
    let trunk = s.frame_orientation(&A1, &Frame::IDENTITY);
    let error = orientation_error(&Rotation3::identity(), &s.configuration.base.rotation);
    let wanted = trunk.acceleration([0.0; 3], [0.0; 3], error, TRUNK);
    qp.minimise(&trunk, &wanted, &[1e3; 3]);
    for (i, foot) in FEET.iter().enumerate() {
        let (load, x) = gait(usize::from(i == 1 || i == 2), time);
        if load >= 1.0 {
            continue;
        }
        // Up and down again, at rest at both ends: 16 x² (1 − x)².
        let up = Vector3::z() * (16.0 * STEP * x * x * (1.0 - x) * (1.0 - x));
        let task = s.frame_position(&A1, &foot.frame);
        let place = home.pose(&foot.frame).translation + up;
        let error = position_error(&place, &s.pose(&foot.frame).translation);
        let wanted = task.acceleration([0.0; 3], [0.0; 3], error, FOOT);
        qp.minimise(&task, &wanted, &[10.0 * (1.0 - load); 3]);
    }
    qp.minimise_joints(&s.velocity.joints.map(|x| -5.0 * x), &[1e-2; 12]);
    qp.minimise_forces(&[0.0; 12], &[1e-3; 12]);
    qp.limit_joints(s, &LIMITS, &HORIZON);
    qp.limit_torques(&MOTORS.map(|m| [-m.torque, m.torque]))
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let spheres = core::array::from_fn(|i| Shape::of(&FEET[i], i));
    let [Some(a), Some(b), Some(c), Some(d)] = spheres else {
        return Err("the feet are balls".into());
    };
    let spheres = [a, b, c, d];
    let settings = Settings::new(&LIMITS, &MOTORS);
    let mut plant = Plant::new(A1, spheres, Terrain::FLAT, settings);
    let mut q = Configuration::NEUTRAL;
    q.joints = core::array::from_fn(|i| [0.0, 0.9, -1.8][i % 3]);
    let mut s = Snapshot::ZERO;
    s.update(&A1, &q, &Tangent::ZERO);
    q.base.translation.z = FOOT_RADIUS - s.pose(&FEET[0].frame).translation.z;
    s.update(&A1, &q, &Tangent::ZERO);
    let home = s;
    plant.reset(&q, &Tangent::ZERO);

    let mut qp = Program::new();
    let (mut away, mut tilt, mut lift) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut friction_ticks = 0;
    for k in 0..1500 {
        let time = f64::from(k) * 1e-3;
        let (q, v) = (*plant.configuration(), *plant.velocity());
        s.update(&A1, &q, &v);
        write(&mut qp, &s, &home, time)?;
        let answer = qp.solve()?;
        let cones = qp.report(&answer, 1e-3);
        friction_ticks += usize::from(cones.into_iter().any(|x| matches!(x.limit, Limit::Cone(_))));
        away = away.max((s.com_w() - home.com_w()).norm());
        tilt = tilt.max((q.base.rotation * Vector3::z()).xy().norm());
        lift = lift.max(s.pose(&FEET[0].frame).translation.z - FOOT_RADIUS);
        if k % 100 == 0 {
            let loads = [0, 1].map(|pair| gait(pair, time).0);
            println!(
                "{time:.1} s: loads {loads:.1?}, {:?}, centre of mass {:4.1} mm away",
                answer.yielded,
                1e3 * (s.com_w() - home.com_w()).norm()
            );
        }
        for _ in 0..10 {
            plant.step(&answer.torques)?;
        }
    }
    println!(
        "at most {:.1} mm away, {:.1} degrees tilted; feet rose {:.0} mm; friction limited {friction_ticks} ticks of 1500",
        1e3 * away,
        tilt.to_degrees(),
        1e3 * lift
    );
    assert!(away < 0.03 && tilt < 0.1 && lift > 0.5 * STEP);
    Ok(())
}
