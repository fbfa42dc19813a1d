//! Steps in a row beside the textbook: a body that turns evenly over one foot which comes and goes.

use a1_model::A1;
use nalgebra::{Matrix3, RowVector3, Vector3};
use proptest::prelude::*;
use state_est::{Foot, Settings, State};

use crate::common::{World, config, feet, vector, world};

/// Kalman's filter with matrices. Rows are the IMU's point, its velocity and the foot; columns of the mean are the world's axes.
struct Textbook {
    mean: Matrix3<f64>,
    covariance: Matrix3<f64>,
}

impl Textbook {
    /// The state becomes f × state + shift, with this variance more.
    fn predict(&mut self, f: &Matrix3<f64>, shift: &Matrix3<f64>, variance: [f64; 3]) {
        self.mean = f * self.mean + shift;
        let noise = Matrix3::from_diagonal(&Vector3::from(variance));
        self.covariance = f * self.covariance * f.transpose() + noise;
    }

    /// h × state was measured.
    fn measure(&mut self, h: [f64; 3], value: &Vector3<f64>, variance: f64) {
        let h = RowVector3::from(h);
        let s = (h * self.covariance * h.transpose())[0] + variance;
        let gain = self.covariance * h.transpose() / s;
        self.mean += gain * (value.transpose() - h * self.mean);
        self.covariance -= gain * h * self.covariance;
    }
}

fn settings() -> impl Strategy<Value = Settings<f64>> {
    prop::array::uniform4(0.3..3.0_f64).prop_map(|[a, b, c, d]| {
        let mut settings = Settings::new();
        settings.accelerometer *= a;
        settings.foot_drift *= b;
        settings.foot_position *= c;
        settings.foot_speed *= d;
        // The attitude is left to the gyroscope.
        (settings.tilt_gain, settings.bias_gain) = (0.0, 0.0);
        settings.agreement = 0.0;
        settings
    })
}

fn square(x: f64) -> f64 {
    x * x
}

/// Evidence of a foot that is in the air or believed as far as its evidence goes.
fn evidence() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 4 => 0.51..1.0_f64]
}

/// One step of the textbook at the middle and at the end of which the body stands as told.
fn step(
    book: &mut Textbook,
    (world, foot, settings): (&World, &Foot<f64>, &Settings<f64>),
    acceleration_w: &Vector3<f64>,
    (confidence, anchored): (f64, bool),
    dt: f64,
) {
    let row = |x: Vector3<f64>| x.transpose();
    let zero = RowVector3::zeros();
    let f = Matrix3::new(1.0, dt, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let moved = Matrix3::from_rows(&[
        row(acceleration_w * (0.5 * dt * dt)),
        row(acceleration_w * dt),
        zero,
    ]);
    let noise = settings.accelerometer * dt;
    book.predict(&f, &moved, [0.0, noise * noise, 0.0]);
    if confidence == 0.0 {
        return;
    }
    let omega_w = world.q.base.rotation * world.omega_b;
    let up = Vector3::z() * foot.radius;
    let arm_w = world.arm_w(foot);
    let place = square(settings.foot_position) / confidence;
    if anchored {
        let rolled = Matrix3::from_rows(&[zero, zero, row(omega_w.cross(&up) * dt)]);
        let drift = square(settings.foot_drift) * dt / confidence;
        book.predict(&Matrix3::identity(), &rolled, [0.0, 0.0, drift]);
        book.measure([-1.0, 0.0, 1.0], &arm_w, place);
    } else {
        let copy = Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0);
        let there = Matrix3::from_rows(&[zero, zero, row(arm_w)]);
        book.predict(&copy, &there, [0.0, 0.0, place]);
    }
    // The body turns about the point where the ball touches.
    let velocity_w = -omega_w.cross(&(arm_w - up));
    let speed = square(settings.foot_speed / confidence);
    book.measure([0.0, 1.0, 0.0], &velocity_w, speed);
}

proptest! {
    #![proptest_config(config(64, 13))]

    /// The estimate is the textbook's, with the noise that [`Settings`] describes: variances of a foot grow as its confidence falls,
    /// that of its speed with the square.
    #[test]
    fn steps_are_the_textbook_kalman_filter(
        mut world in world(), settings in settings(), radius in 0.0..0.1_f64, leg in 0..4_usize, vel_w in vector(1.0),
        steps in prop::collection::vec((vector(15.0), evidence()), 1..20), dt in 1e-3..0.02_f64,
    ) {
        world.joint_velocities = [0.0; 12];
        let foot = Foot { radius, ..feet()[leg] };
        let estimator = world.estimator::<1, 3>([foot], settings);
        let mut state = State::new(&estimator, &A1, &world.q).moving(vel_w);
        let at_w = world.q.base.point(&world.imu.translation);
        let foot_w = world.pose_of(&foot.frame).translation;
        let rows = [at_w, vel_w, foot_w].map(|x| x.transpose());
        let mut book = Textbook { mean: Matrix3::from_rows(&rows), covariance: Matrix3::identity() * 1e-6 };
        let mut anchored = false;
        for (force_b, evidence) in steps {
            let estimate = estimator.step(&A1, &mut state, Some(&world.sample(&force_b, [evidence])), dt);
            let middle = world.q.base.rotation * so3::exp(&(world.omega_b * (0.5 * dt)));
            world = world.after(&Vector3::zeros(), dt);
            let acceleration_w = middle * force_b - Vector3::z() * 9.81;
            step(&mut book, (&world, &foot, &settings), &acceleration_w, (evidence, anchored), dt);
            anchored = evidence > 0.0;
            prop_assert!((estimate.confidence[0] - evidence).abs() < 1e-12);
            let turned = estimate.base.rotation.matrix() - world.q.base.rotation.matrix();
            prop_assert!(turned.amax() < 1e-9);
            let at = estimate.base.point(&world.imu.translation);
            let velocity = estimate.base.rotation * estimate.velocity.at_point(&world.imu.translation);
            prop_assert!((at - book.mean.row(0).transpose()).amax() < 1e-9);
            prop_assert!((velocity - book.mean.row(1).transpose()).amax() < 1e-9);
        }
    }
}
