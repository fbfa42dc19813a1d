//! A quadruped through the same tasks: it stands, and it hops, in the contact simulator.
#![allow(clippy::unwrap_used, missing_docs, reason = "tests")]

use a1_model::{A1, FEET, MOTORS, a1};
use contact_sim::{NativeSimulator, Settings, Shape, Simulator, Terrain};
use nalgebra::{Rotation3, Vector3};
use rbd_core::{Configuration, Frame, Tangent, joint_friction};
use wbc_qp::task::{orientation_error, position_error};
use wbc_qp::{Contact, Gains, Snapshot, TorqueQp, Yielded};

type Plant = NativeSimulator<f64, A1, 12, 4, 4>;

fn standing() -> Configuration<f64, 12> {
    let mut q = Configuration::NEUTRAL;
    q.joints = core::array::from_fn(|i| [0.0, 0.9, -1.8][i % 3]);
    let mut s = Snapshot::ZERO;
    s.update(&A1, &q, &Tangent::ZERO);
    q.base.translation.z = a1_model::FOOT_RADIUS - s.pose(&FEET[0].frame).translation.z;
    q
}

/// What the torque program is asked for at a time.
#[derive(Default)]
struct Wanted {
    /// Of the centre of mass, from where it starts.
    place: Vector3<f64>,
    speed: Vector3<f64>,
    acceleration: Vector3<f64>,
    /// Load of the front left foot.
    missing: f64,
}

/// What a tick was like.
struct Tick {
    rise: f64,
    speed: f64,
    tilt: f64,
    touches: bool,
    /// Force on the front left foot.
    force: f64,
    torques: [f64; 12],
}

/// Runs the torque program until `end`.
fn run(end: f64, wanted: impl Fn(f64) -> Wanted) -> Vec<Tick> {
    let spheres = core::array::from_fn(|i| Shape::of(&FEET[i], i).unwrap());
    let settings = Settings::new(&a1::LIMITS, &MOTORS);
    let mut plant = Plant::new(A1, spheres, Terrain::FLAT, settings);
    let start = standing();
    plant.reset(&start, &Tangent::ZERO);
    let mut contacts = FEET.map(|foot| Contact::new(&foot, 0.5, 120.0));
    let mut qp = TorqueQp::<f64, 12, 12, 24, 46>::new();
    let mut s = Snapshot::ZERO;
    s.update(&A1, &start, &Tangent::ZERO);
    let home = s.com_w();
    let mut out = Vec::new();
    for k in 0..(end * 1e3) as usize {
        let (q, v) = (*plant.configuration(), *plant.velocity());
        s.update(&A1, &q, &v);
        let wanted = wanted(k as f64 * 1e-3);
        contacts[0].load = 1.0 - wanted.missing;
        let friction = joint_friction(&a1::LIMITS, &v.joints, 0.1);
        qp.begin(&A1, &s, &contacts, &friction).unwrap();
        let gains = Gains {
            stiffness: 100.0,
            damping: 20.0,
        };
        let com = s.com();
        let error = position_error(&(home + wanted.place), &s.com_w());
        let target = com.acceleration(
            wanted.acceleration.into(),
            wanted.speed.into(),
            error,
            gains,
        );
        qp.minimise(&com, &target, &[1e3; 3]);
        let trunk = s.frame_orientation(&A1, &Frame::IDENTITY);
        let error = orientation_error(&Rotation3::identity(), &q.base.rotation);
        let target = trunk.acceleration([0.0; 3], [0.0; 3], error, gains);
        qp.minimise(&trunk, &target, &[1e3; 3]);
        let rest: [f64; 12] = core::array::from_fn(|i| -20.0 * v.joints[i]);
        qp.minimise_joints(&rest, &[1e-2; 12]);
        qp.minimise_forces(&[0.0; 12], &[1e-3; 12]);
        qp.limit_torques(&MOTORS.map(|m| [-m.torque, m.torque]))
            .unwrap();
        let answer = qp.solve().unwrap();
        assert_eq!(answer.yielded, Yielded::Nothing, "tick {k}");
        for _ in 0..10 {
            plant.step(&answer.torques).unwrap();
        }
        out.push(Tick {
            rise: s.com_w().z - home.z,
            speed: s.com_velocity_w().z,
            tilt: (q.base.rotation * Vector3::z()).xy().norm(),
            touches: plant.contact_forces_w().iter().any(|f| f.norm() > 1.0),
            force: answer.forces[2],
            torques: answer.torques,
        });
    }
    out
}

#[test]
fn it_stands() {
    let ticks = run(1.5, |_| Wanted::default());
    let last = ticks.last().unwrap();
    assert!(last.rise.abs() < 0.003 && last.speed.abs() < 0.01);
    assert!(last.tilt < 0.01 && last.touches);
}

/// Half a second of standing, then a push of 0.2 s to 1 m/s.
#[test]
fn it_hops() {
    let (hold, push, speed) = (0.5, 0.2, 1.0);
    let ticks = run(hold + push, |t| {
        let x = ((t - hold) / push).max(0.0);
        let up = Vector3::z();
        // v̂ = x², over the push.
        Wanted {
            place: up * (speed * push * x * x * x / 3.0),
            speed: up * (speed * x * x),
            acceleration: up * (2.0 * speed / push * x),
            missing: 0.0,
        }
    });
    let last = ticks.last().unwrap();
    assert!((last.speed - speed).abs() < 0.05, "{}", last.speed);
    assert!(last.tilt < 0.03, "{}", last.tilt);
}

/// Largest change of a torque from one tick to the next while a foot is taken off the ground and put back over `ramp` seconds, the
/// others carrying the robot, and the force on the foot in between.
fn change_of_contacts(ramp: f64) -> (f64, f64) {
    let ticks = run(2.0, |t| Wanted {
        // Away from the foot first: the others' triangle must hold the centre of mass.
        place: Vector3::new(-0.035, -0.025, 0.0) * ((t - 0.1) / 0.4).clamp(0.0, 1.0),
        missing: ((t - 1.0) / ramp)
            .clamp(0.0, 1.0)
            .min(((1.5 - t) / ramp).clamp(0.0, 1.0)),
        ..Wanted::default()
    });
    let last = ticks.last().unwrap();
    assert!(last.tilt < 0.02 && last.speed.abs() < 0.02, "{}", last.tilt);
    let steps = ticks.windows(2).skip(900).map(|pair| {
        let torques = pair[0].torques.iter().zip(&pair[1].torques);
        torques.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
    });
    (steps.fold(0.0, f64::max), ticks[1400].force)
}

#[test]
fn contacts_come_and_go_without_a_step() {
    let (smooth, force) = change_of_contacts(0.1);
    let (sudden, _) = change_of_contacts(1e-6);
    assert!(force.abs() < 1e-9, "{force}");
    assert!(smooth < 0.5, "{smooth} N m in a millisecond");
    assert!(sudden > 3.0 * smooth, "{sudden} {smooth}");
}
