//! Where is the base? A1 stands for a second, then its IMU feels a free fall of 0.2 s with all feet in the air.
//!
//! `cargo run --release -p state-est --example estimate`

use a1_model::{A1, FEET};
use nalgebra::Vector3;
use rbd_core::{Configuration, Transform};
use state_est::{Estimator, Foot, Sample, Settings, State, Status};

fn main() {
    let estimator = Estimator::<f64, 12, 4, 6> {
        feet: FEET.map(|foot| Foot::of(&foot)),
        imu: Transform::IDENTITY,
        settings: Settings::new(),
    };
    let mut start = Configuration::<f64, 12>::NEUTRAL;
    start.joints = core::array::from_fn(|i| [0.0, 0.8, -1.6][i % 3]);
    start.base.translation.z = 0.3;
    let mut state = State::new(&estimator, &A1, &start);
    let standing = Sample {
        specific_force_i: Vector3::new(0.0, 0.0, 9.81),
        angular_velocity_i: Vector3::zeros(),
        joints: start.joints,
        joint_velocities: [0.0; 12],
        evidence: [1.0; 4], // every foot is surely loaded
    };
    let falling = Sample {
        specific_force_i: Vector3::zeros(),
        evidence: [0.0; 4],
        ..standing
    };
    let mut estimate = estimator.step(&A1, &mut state, Some(&standing), 1e-3);
    for k in 1..1200 {
        let sample = if k < 1000 { &standing } else { &falling };
        estimate = estimator.step(&A1, &mut state, Some(sample), 1e-3);
        if k % 200 == 199 {
            println!(
                "{:.1} s: {:?}, {:6.3} m/s, confidence {:.1?}",
                f64::from(k + 1) * 1e-3,
                estimate.status,
                estimate.velocity.linear.z,
                estimate.confidence
            );
        }
    }
    assert_eq!(estimate.status, Status::Good);
    let fallen = -9.81 * 0.2;
    assert!(
        (estimate.velocity.linear.z - fallen).abs() < 0.02,
        "ballistics"
    );
}
