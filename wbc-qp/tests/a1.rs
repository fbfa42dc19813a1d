//! A quadruped through the same tasks: it stands, and it hops, in the contact simulator.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use a1_model::{A1, FEET, MOTORS, a1};
use contact_sim::{ContactSphere, NativeSimulator, Settings, Simulator, Terrain};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, Frame, Tangent, joint_friction};
use wbc_qp::task::{orientation_error, position_error};
use wbc_qp::{Contact, Gains, Snapshot, TorqueQp, Yielded};

type Plant = NativeSimulator<f64, A1, 12, 4>;

fn standing() -> Configuration<f64, 12> {
    let mut q = Configuration::NEUTRAL;
    q.joints = core::array::from_fn(|i| [0.0, 0.9, -1.8][i % 3]);
    let mut s = Snapshot::ZERO;
    s.update(&A1, &q, &Tangent::ZERO);
    q.base.translation.z = a1_model::FOOT_RADIUS - s.pose(&FEET[0].frame).translation.z;
    q
}

/// Runs the torque program against height, speed and acceleration wanted at each time, until `end`; the height of the centre of
/// mass over the start, its speed, the largest tilt, and whether any foot touched, per tick.
fn run(end: f64, wanted: impl Fn(f64) -> (f64, f64, f64)) -> Vec<(f64, f64, f64, bool)> {
    let spheres = FEET.map(|foot| ContactSphere::of(&foot).unwrap());
    let settings = Settings::new(&a1::LIMITS, &MOTORS);
    let mut plant = Plant::new(A1, spheres, Terrain::FLAT, settings);
    let start = standing();
    plant.reset(&start, &Tangent::ZERO);
    let contacts = FEET.map(|foot| Contact::new(&foot, 0.5, 300.0));
    let mut qp = TorqueQp::<f64, 12, 12, 24, 40>::new();
    let mut s = Snapshot::ZERO;
    s.update(&A1, &start, &Tangent::ZERO);
    let home = s.com_w();
    let mut out = Vec::new();
    for k in 0..(end * 1e3) as usize {
        let (q, v) = (*plant.configuration(), *plant.velocity());
        s.update(&A1, &q, &v);
        let friction = joint_friction(&a1::LIMITS, &v.joints, 0.1);
        qp.begin(&A1, &s, &contacts, &friction).unwrap();
        let (rise, speed, acceleration) = wanted(k as f64 * 1e-3);
        let up = Vector3::z();
        let gains = Gains {
            stiffness: 100.0,
            damping: 20.0,
        };
        let com = s.com();
        let error = position_error(&(home + up * rise), &s.com_w());
        let target = com.acceleration([0.0, 0.0, acceleration], [0.0, 0.0, speed], error, gains);
        qp.minimise(&com, &target, &[1e3; 3]);
        let trunk = s.frame_orientation(&A1, &Frame::IDENTITY);
        let error = orientation_error(&Rotation3::identity(), &q.base.rotation);
        let target = trunk.acceleration([0.0; 3], [0.0; 3], error, gains);
        qp.minimise(&trunk, &target, &[1e3; 3]);
        qp.minimise_joints(&[0.0; 12], &[1e-2; 12]);
        qp.minimise_forces(&[0.0; 12], &[1e-3; 12]);
        qp.limit_torques(&MOTORS.map(|m| [-m.torque, m.torque]))
            .unwrap();
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Nothing, "tick {k}");
        for _ in 0..10 {
            plant.step(&answer.torques).unwrap();
        }
        let tilt = (q.base.rotation * up).xy().norm();
        let touches = plant.contact_forces_w().iter().any(|f| f.norm() > 1.0);
        out.push((s.com_w().z - home.z, s.com_velocity_w().z, tilt, touches));
    }
    out
}

#[test]
fn it_stands() {
    let ticks = run(1.5, |_| (0.0, 0.0, 0.0));
    let &(rise, speed, tilt, touches) = ticks.last().unwrap();
    assert!(rise.abs() < 0.003 && speed.abs() < 0.01 && tilt < 0.01 && touches);
}

/// Half a second of standing, then a push of 0.2 s to 1 m/s.
#[test]
fn it_hops() {
    let (hold, push, speed) = (0.5, 0.2, 1.0);
    let ticks = run(hold + push, |t| {
        let x = ((t - hold) / push).max(0.0);
        // v̂ = x², over the push.
        (
            speed * push * x * x * x / 3.0,
            speed * x * x,
            2.0 * speed / push * x,
        )
    });
    let &(_, reached, tilt, _) = ticks.last().unwrap();
    assert!((reached - speed).abs() < 0.05, "{reached}");
    assert!(tilt < 0.03, "{tilt}");
}
