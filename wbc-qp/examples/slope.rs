//! A humanoid stands on slopes: soles as convex polygons, a friction pyramid inside the cone. Until the ground is too steep the program
//! holds it still; then it says what gave way, and by how much.
//!
//! `cargo run --release -p wbc-qp --example slope`

use icub_model::{Icub23, LIMITS, MOTORS, SOLES};
use nalgebra::Vector3;
use rbd_core::{Configuration, Frame, Tangent, Transform};
use wbc_qp::task::position_error;
use wbc_qp::{
    Contact, Error, Gains, Horizon, Rank, Snapshot, TorqueQp, VelocityQp, Yielded, anchored,
};

/// A sole with cut corners, m.
static SOLE: [[f64; 2]; 6] = [
    [0.04, -0.03],
    [0.06, 0.0],
    [0.04, 0.03],
    [-0.08, 0.03],
    [-0.1, 0.0],
    [-0.08, -0.03],
];
const FRICTION: f64 = 0.6;

/// Where the middle between the soles is, in the world.
fn middle(snapshot: &Snapshot<f64, 23>) -> Vector3<f64> {
    let places = SOLES.map(|sole| snapshot.pose(&sole.frame).translation);
    (places[0] + places[1]) * 0.5
}

/// Bends ankles and hips until the centre of mass stands over the middle of the soles.
fn lean(
    start: Configuration<f64, 23>,
    contacts: &[Contact<f64>; 2],
) -> Result<Configuration<f64, 23>, Error> {
    let mut q = start;
    let mut snapshot = Snapshot::ZERO;
    let mut qp = VelocityQp::<f64, 23, 29, 12>::new();
    let horizon = Horizon {
        position: 0.1,
        velocity: 0.02,
        acceleration: 500.0,
    };
    for _ in 0..300 {
        snapshot.update(&Icub23, &q, &Tangent::ZERO);
        qp.begin(&Icub23, &snapshot, contacts)?;
        let com = snapshot.com();
        let over = middle(&snapshot);
        let error = position_error(&over, &snapshot.com_w());
        qp.minimise(
            &com.select([0, 1]),
            &[5.0 * error[0], 5.0 * error[1]],
            &[1e4; 2],
        );
        qp.minimise(&com.select([2]), &[0.0], &[1e2]);
        qp.minimise_joints(&[0.0; 23], &[1.0; 23]);
        qp.limit_joints(&snapshot, &LIMITS, &horizon);
        q = rbd_core::integrate(&q, &(qp.solve()?.velocity * 0.01));
    }
    Ok(q)
}

fn main() -> Result<(), Error> {
    let mut held = Vec::new();
    for degrees in [0.0_f64, 10.0, 15.0, 20.0, 25.0] {
        // Uphill is where the toes point: the soles are turned, and the world stays upright.
        let slope = so3::exp(&(Vector3::y() * degrees.to_radians()));
        let ground = Transform::new(slope, Vector3::zeros());
        let mut joints = [0.0; 23];
        for leg in [0, 6] {
            (joints[leg], joints[leg + 3], joints[leg + 4]) = (0.5, -1.0, -0.5);
        }
        for arm in [15, 19] {
            (joints[arm], joints[arm + 1], joints[arm + 3]) = (-0.5, 0.4, 0.8);
        }
        let (q, _) = anchored(&Icub23, &joints, &[0.0; 23], &SOLES[0].frame, &ground);
        let sole = |i: usize| Contact::polygon(&SOLES[i].frame, &SOLE, FRICTION, 600.0);
        let contacts = [sole(0)?.inscribed(), sole(1)?.inscribed()];
        let q = lean(q, &contacts)?;

        let mut snapshot = Snapshot::<f64, 23>::ZERO;
        snapshot.update(&Icub23, &q, &Tangent::ZERO);
        // 12 contact rows, 12 per cone, 23 torques, 6 held.
        let mut qp = TorqueQp::<f64, 23, 12, 35, 65>::new();
        qp.begin(&Icub23, &snapshot, &contacts, &[0.0; 23])?;
        let com = snapshot.com();
        let still = com.acceleration(
            [0.0; 3],
            [0.0; 3],
            [0.0; 3],
            Gains {
                stiffness: 100.0,
                damping: 20.0,
            },
        );
        qp.hold(&com, &still)?;
        let trunk = snapshot.frame_orientation(&Icub23, &Frame::IDENTITY);
        qp.constrain(&trunk, &[0.0; 3], &[0.0; 3], Rank::Task)?;
        qp.minimise_joints(&[0.0; 23], &[1.0; 23]);
        qp.minimise_forces(&[0.0; 12], &[1e-3; 12]);
        qp.limit_torques(&MOTORS.map(|m| [-m.torque, m.torque]))?;
        let answer = qp.solve()?;
        println!("{degrees:2} degrees: {:?}", answer.yielded);
        for line in qp.report(&answer, 1e-3) {
            println!("    {:?} {:?}", line.limit, line.extent);
        }
        held.push(answer.yielded == Yielded::Nothing);
    }
    let program = size_of::<TorqueQp<f64, 23, 12, 35, 65>>();
    println!("memory of the program: {program} B");
    // atan(0.6/√2) = 23 degrees.
    assert_eq!(held, [true, true, true, true, false]);
    Ok(())
}
