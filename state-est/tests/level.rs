//! What gravity and standing feet say of tilt and bias, and when they are heard.

use a1_model::A1;
use nalgebra::Vector3;
use proptest::prelude::*;
use so3::math;
use state_est::{Estimate, Foot, Settings, State};

use crate::common::{World, config, feet, vector, world};

const DT: f64 = 1e-3;

/// Every foot is believed as far as its evidence goes, whatever it does.
fn trusting() -> Settings<f64> {
    let mut settings = Settings::new();
    settings.slip_gate = 1e9;
    settings
}

/// One step of an estimator that takes the robot to be tilted by `tilt`, rad, about the world's x axis.
fn tilted(world: &World, tilt: f64, force_b: &Vector3<f64>, evidence: f64) -> Estimate<f64, 4> {
    let estimator = world.estimator::<4, 6>(feet(), trusting());
    let mut believed = world.q;
    believed.base.rotation = so3::exp(&(Vector3::x() * tilt)) * world.q.base.rotation;
    let mut state = State::new(&estimator, &A1, &believed);
    let sample = world.sample(force_b, [evidence; 4]);
    estimator.step(&A1, &mut state, Some(&sample), DT)
}

/// How likely a foot stands; as likely as not, too.
fn evidence() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.5), 4 => 0.11..1.0_f64]
}

/// What the estimator knows after it has learnt the gyroscope's `bias` from the feet of the crouched robot, which stands.
fn learnt(bias: &Vector3<f64>) -> State<f64, 4, 6> {
    let mut world = World::crouched();
    world.omega_b = *bias;
    let mut settings = trusting();
    (settings.tilt_gain, settings.bias_gain) = (0.0, 50.0);
    settings.max_bias = 1.0;
    let estimator = world.estimator::<4, 6>(feet(), settings);
    let mut state = State::new(&estimator, &A1, &world.q);
    let sample = world.sample(&world.held(), [1.0; 4]);
    for _ in 0..200 {
        let _ = estimator.step(&A1, &mut state, Some(&sample), 0.01);
    }
    state
}

/// Angle between the estimated and the true vertical after a step.
fn tilt_of(world: &World, estimate: &Estimate<f64, 4>) -> f64 {
    let true_b = world.q.base.rotation.inverse() * Vector3::z();
    let up_b = estimate.base.rotation.inverse() * Vector3::z();
    math::atan2(true_b.cross(&up_b).norm(), true_b.dot(&up_b))
}

proptest! {
    #![proptest_config(config(64, 14))]

    /// While the robot stands still, a wrong tilt α falls as α̇ = −gain × sin α, whichever way it is and however the robot is turned.
    #[test]
    fn gravity_corrects_the_tilt_at_its_rate(mut world in world(), tilt in -1.5..1.5_f64) {
        world.omega_b = Vector3::zeros();
        world.joint_velocities = [0.0; 12];
        let left = tilt_of(&world, &tilted(&world, tilt, &world.held(), 1.0));
        let expected = tilt.abs() - Settings::<f64>::new().tilt_gain * DT * math::sin(tilt.abs());
        prop_assert!((left - expected).abs() < 1e-9, "{left} {expected}");
    }

    /// Gravity speaks only in a force within 1 m/s² of its own, while the robot turns by less than 0.5 rad/s on a foot that is more
    /// likely to stand than not.
    #[test]
    fn gravity_is_heard_only_at_rest(yaw in 0.0..1.0_f64, size in 8.0..12.0_f64, evidence in evidence()) {
        let mut world = World::crouched();
        world.omega_b = Vector3::z() * yaw;
        let tilt = 0.2;
        let left = tilt_of(&world, &tilted(&world, tilt, &(world.held() * (size / 9.81)), evidence));
        let rests = yaw < 0.5 && (size - 9.81).abs() < 1.0 && evidence > 0.5;
        let heard = (left - tilt).abs() > 1e-9;
        prop_assert_eq!(heard, rests, "{} {}", left, tilt);
    }

    /// Feet that disagree about the velocity tell the gyroscope's bias. What they miss in its rate minimises the squares of what is left
    /// between them, with the square of the rate times 0.01 m².
    #[test]
    fn the_bias_is_the_least_squares_of_the_feet(
        mut world in world(), turning in vector(0.2), slips in prop::array::uniform12(-0.1..0.1_f64),
        evidence in prop::array::uniform4(prop_oneof![Just(0.2), Just(0.8)]),
    ) {
        world.omega_b = turning;
        world.joint_velocities = slips;
        let mut settings = trusting();
        settings.max_bias = 10.0;
        settings.tilt_gain = 0.0;
        let estimator = world.estimator::<4, 6>(feet(), settings);
        let mut state = State::new(&estimator, &A1, &world.q);
        let dt = 1e-7;
        let estimate = estimator.step(&A1, &mut state, Some(&world.sample(&world.held(), evidence)), dt);
        // The bias is what is missing with the other sign, and the estimated rate is the gyroscope's without the bias.
        let missing_b = (estimate.velocity.angular - turning) / (settings.bias_gain * dt);
        let missing_w = world.q.base.rotation * missing_b;
        let stand: Vec<usize> = (0..4).filter(|i| evidence[*i] > 0.5).collect();
        if stand.is_empty() {
            prop_assert!(missing_b.amax() < 1e-6);
            return Ok(());
        }
        let feet = feet();
        let all: Vec<_> = stand.iter().map(|i| (world.arm_w(&feet[*i]), world.velocity_by(feet[*i]))).collect();
        let count = all.len() as f64;
        let middle: Vector3<f64> = all.iter().map(|(arm, _)| arm).sum::<Vector3<f64>>() / count;
        let mean: Vector3<f64> = all.iter().map(|(_, velocity)| velocity).sum::<Vector3<f64>>() / count;
        let cost = |rate: Vector3<f64>| {
            let left = all.iter().map(|(arm, velocity)| (rate.cross(&(arm - middle)) - (velocity - mean)).norm_squared());
            left.sum::<f64>() + 0.01 * rate.norm_squared()
        };
        // The slope of a quadratic function, exactly.
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let slope = (cost(missing_w + axis) - cost(missing_w - axis)) / 2.0;
            prop_assert!(slope.abs() < 1e-5, "{slope}");
        }
    }

}

proptest! {
    #![proptest_config(config(16, 17))]

    /// A robot that has learnt the bias of its gyroscope and leaves the ground turns by what is left of the rate, and is said to.
    #[test]
    fn a_learnt_bias_turns_nothing(bias in vector(0.25), turning in vector(3.0), time in 0.1..1.0_f64) {
        let mut state = learnt(&bias);
        let mut world = World::crouched();
        world.omega_b = turning + bias;
        let estimator = world.estimator::<4, 6>(feet(), Settings::new());
        let sample = world.sample(&Vector3::zeros(), [0.0; 4]);
        let mut step = || estimator.step(&A1, &mut state, Some(&sample), time / 100.0);
        let start = step().base.rotation;
        let last = (0..100).fold(step(), |_, _| step());
        prop_assert!((last.velocity.angular - turning).amax() < 1e-6, "{}", last.velocity.angular - turning);
        let end = start * so3::exp(&(turning * (time * 1.01)));
        let off = end.matrix() - last.base.rotation.matrix();
        prop_assert!(off.amax() < 1e-6, "{off}");
    }

    /// It is the robot's own rate that has to be small for gravity to be heard, not the gyroscope's with its bias.
    #[test]
    fn a_learnt_bias_is_no_motion(bias in vector(0.25), yaw in -1.0..1.0_f64) {
        let state = learnt(&bias);
        let mut world = World::crouched();
        world.omega_b = bias + Vector3::z() * yaw;
        let force_b = so3::exp(&(Vector3::x() * 0.1)) * world.held();
        let sample = world.sample(&force_b, [1.0; 4]);
        let after = |tilt_gain| {
            let mut settings = trusting();
            (settings.tilt_gain, settings.bias_gain) = (tilt_gain, 0.0);
            settings.max_bias = 1.0;
            let estimator = world.estimator::<4, 6>(feet(), settings);
            estimator.step(&A1, &mut { state }, Some(&sample), DT).base.rotation
        };
        prop_assert_eq!(after(1.0) != after(0.0), yaw.abs() < 0.5);
    }
}

proptest! {
    #![proptest_config(config(8, 16))]

    /// A robot that stands learns the bias of its gyroscope, up to the largest that is believed, along each axis.
    #[test]
    fn a_standing_robot_learns_the_bias(bias in vector(0.15)) {
        let mut world = World::crouched();
        world.omega_b = bias;
        let settings = Settings::new();
        let estimator = world.estimator::<4, 6>(feet(), settings);
        let mut state = State::new(&estimator, &A1, &world.q);
        let sample = world.sample(&world.held(), [1.0; 4]);
        let mut estimate = estimator.step(&A1, &mut state, Some(&sample), 0.01);
        for _ in 0..3000 {
            estimate = estimator.step(&A1, &mut state, Some(&sample), 0.01);
        }
        let left = bias.map(|x| x - x.clamp(-settings.max_bias, settings.max_bias));
        // What is left of the rate turns the robot, or is held against by gravity: the feet see all of it.
        let unlearnt = estimate.velocity.angular - left;
        prop_assert!(unlearnt.amax() < 1e-3, "{unlearnt} {left}");
    }
}

/// Angular velocity that is estimated for a crouched robot on its front feet, of this radius, after samples of its gyroscope.
fn estimated_rate(
    radius: f64,
    rates: &[Vector3<f64>],
    (bias_gain, agreement): (f64, f64),
) -> Vector3<f64> {
    let mut world = World::crouched();
    let mut settings = trusting();
    (settings.tilt_gain, settings.bias_gain) = (0.0, bias_gain);
    (settings.agreement, settings.max_bias) = (agreement, 1.0);
    let [left, right, ..] = feet();
    let feet = [left, right].map(|foot| Foot { radius, ..foot });
    let estimator = world.estimator::<2, 4>(feet, settings);
    let mut state = State::new(&estimator, &A1, &world.q);
    let mut rate = Vector3::zeros();
    for told in rates {
        world.omega_b = *told;
        let sample = world.sample(&world.held(), [1.0; 2]);
        let estimate = estimator.step(&A1, &mut state, Some(&sample), DT);
        rate = estimate.velocity.angular;
    }
    rate
}

proptest! {
    #![proptest_config(config(64, 18))]

    /// What soles that stand have told of the bias is the mean of what the gyroscope said, about the axis through them, too.
    #[test]
    fn soles_tell_the_mean_of_the_gyroscope(rates in prop::collection::vec(vector(0.1), 1..200)) {
        let last = rates.last().copied().unwrap_or_default();
        let mean = rates.iter().sum::<Vector3<f64>>() / rates.len() as f64;
        let left = estimated_rate(0.0, &rates, (1.0, 0.0));
        prop_assert!((left - (last - mean)).amax() < 1e-9, "{left} {last} {mean}");
    }
}

/// Two balls say nothing about the axis through them, two soles say all; with a gain of zero nothing is believed.
#[test]
fn soles_show_the_bias_about_the_axis_through_them() {
    let bias = [Vector3::new(0.01, 0.02, -0.03); 100];
    let ball = estimated_rate(0.02, &bias, (1.0, 0.0));
    assert!((ball.y - 0.02).abs() < 1e-3, "{ball}");
    let sole = estimated_rate(0.0, &bias, (1.0, 0.0));
    assert!(sole.amax() < 1e-9, "{sole}");
    assert_eq!(estimated_rate(0.0, &bias, (0.0, 0.0)), bias[0]);
}

/// Soles are heard once the feet have agreed for 50 ms, beside as much time without a bias.
#[test]
fn soles_are_heard_when_the_ground_no_longer_gives_way() {
    let bias = [Vector3::y() * 0.02; 500];
    for (time, share) in [(45, 1.0), (100, 0.5), (500, 0.1)] {
        let left = estimated_rate(0.0, &bias[..time], (1.0, 0.05)).y / 0.02;
        assert!((left - share).abs() < 0.02, "{left} after {time} ms");
    }
}

/// After its gain's time the bias is followed at that gain.
#[test]
fn soles_are_heard_at_the_gain_in_the_end() {
    let mut rates = vec![Vector3::zeros(); 200];
    rates.extend([Vector3::y() * 0.1; 50]);
    let left = estimated_rate(0.0, &rates, (10.0, 0.0)).y;
    // 0.1 s of zeros and more; then 0.05 s of the new rate.
    let expected = (0..50).fold(0.1, |left, _| left * (1.0 - 10.0 * DT));
    assert!((left - expected).abs() < 1e-9, "{left} {expected}");
}

/// While the accelerometer is out, the last force is held for the motion, and is no news of the tilt.
#[test]
fn an_old_force_says_nothing_of_the_tilt() {
    let world = World::crouched();
    let left = tilt_of(&world, &tilted(&world, 0.2, &(world.held() * 1e9), 1.0));
    assert!((left - 0.2).abs() < 1e-12);
}
