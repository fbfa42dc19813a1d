//! Samples that are late, missing or impossible.

use a1_model::A1;
use nalgebra::Vector3;
use proptest::prelude::*;
use rbd_core::Transform;
use state_est::{Estimate, Estimator, Fault, Sample, Settings, State, Status};

use crate::common::{World, config, feet, vector, world};

const DT: f64 = 1e-3;

type Four = (
    Estimator<f64, 12, 4, 6>,
    State<f64, 4, 6>,
    Sample<f64, 12, 4>,
);

/// The crouched robot, which stands.
fn standing() -> Four {
    let world = World::crouched();
    let estimator = world.estimator(feet(), Settings::new());
    let state = State::new(&estimator, &A1, &world.q);
    (estimator, state, world.sample(&world.held(), [1.0; 4]))
}

/// Numbers that no sensor with this range can say.
fn impossible(range: f64) -> impl Strategy<Value = f64> {
    let beyond = (1.0 + 1e-9) * range..1e3 * range;
    let beyond = (beyond, prop::bool::ANY).prop_map(|(x, minus)| if minus { -x } else { x });
    prop_oneof![
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        beyond
    ]
}

proptest! {
    #![proptest_config(config(64, 15))]

    /// What an impossible sample of one sensor leaves is what the last good one of this sensor gives.
    #[test]
    fn the_last_good_imu_sample_is_used(
        world in world(), force in vector(30.0), next in vector(30.0), rate in vector(3.0), axis in 0..3_usize,
        bad_force in impossible(320.0), bad_rate in impossible(70.0),
    ) {
        let estimator = world.estimator::<4, 6>(feet(), Settings::new());
        let mut start = State::new(&estimator, &A1, &world.q);
        let good = world.sample(&force, [0.0; 4]);
        let _ = estimator.step(&A1, &mut start, Some(&good), DT);
        let step = |sample: &Sample<f64, 12, 4>| {
            let mut state = start;
            estimator.step(&A1, &mut state, Some(sample), DT)
        };
        let after = Sample { specific_force_i: next, angular_velocity_i: rate, ..good };
        let (mut deaf, mut dizzy, mut both) = (after, after, after);
        deaf.specific_force_i[axis] = bad_force;
        dizzy.angular_velocity_i[axis] = bad_rate;
        both.specific_force_i[axis] = bad_force;
        both.angular_velocity_i[axis] = bad_rate;
        let held_force = Sample { specific_force_i: good.specific_force_i, ..after };
        let held_rate = Sample { angular_velocity_i: good.angular_velocity_i, ..after };
        for (bad, instead, fault) in [
            (deaf, held_force, Fault::Accelerometer),
            (dizzy, held_rate, Fault::Gyroscope),
            (both, good, Fault::Gyroscope),
        ] {
            let expected = Estimate { status: Status::Coasting, fault: Some(fault), ..step(&instead) };
            prop_assert_eq!(step(&bad), expected);
        }
        prop_assert_eq!(step(&after).fault, None);
    }

    /// The end of a sensor's range is still a sample, in every direction.
    #[test]
    fn full_scale_is_no_fault(axis in 0..3_usize, sign in prop_oneof![Just(1.0), Just(-1.0)]) {
        let (estimator, state, mut sample) = standing();
        sample.specific_force_i[axis] = sign * estimator.settings.max_specific_force;
        sample.angular_velocity_i[axis] = sign * estimator.settings.max_angular_velocity;
        let estimate = estimator.step(&A1, &mut { state }, Some(&sample), DT);
        prop_assert_eq!((estimate.status, estimate.fault), (Status::Good, None));
    }

    /// An impossible encoder takes out the feet that its joint moves and no other; the first is named.
    #[test]
    fn an_impossible_encoder_blinds_its_leg(joint in 0..12_usize, later in 0..12_usize, speed: bool, x in impossible(1e4)) {
        let (estimator, state, good) = standing();
        let mut bad = good;
        for i in [joint, later] {
            if speed { bad.joint_velocities[i] = x } else { bad.joints[i] = x }
        }
        let mut deaf = good;
        deaf.evidence[joint / 3] = 0.0;
        deaf.evidence[later / 3] = 0.0;
        let step = |sample| estimator.step(&A1, &mut { state }, Some(sample), DT);
        let expected = Estimate { fault: Some(Fault::Joint(joint.min(later))), ..step(&deaf) };
        prop_assert_eq!(step(&bad), expected);
    }

    /// Evidence that is not a number is none; the first is named, after the encoders.
    #[test]
    fn evidence_that_is_no_number_is_none(foot in 0..4_usize, later in 0..4_usize, joint in prop::option::of(0..12_usize)) {
        let (estimator, state, good) = standing();
        let (mut bad, mut none) = (good, good);
        for i in [foot, later] {
            bad.evidence[i] = f64::NAN;
            none.evidence[i] = 0.0;
        }
        let mut fault = Fault::Evidence(foot.min(later));
        if let Some(joint) = joint {
            bad.joints[joint] = f64::NAN;
            none.evidence[joint / 3] = 0.0;
            fault = Fault::Joint(joint);
        }
        let step = |sample| estimator.step(&A1, &mut { state }, Some(sample), DT);
        prop_assert_eq!(step(&bad), Estimate { fault: Some(fault), ..step(&none) });
    }

    /// No step is taken over a time that is none or too long; the longest is.
    #[test]
    fn an_impossible_time_changes_nothing(world in world(), force in vector(30.0), longer in 1.000_001..100.0_f64) {
        let estimator = world.estimator::<4, 6>(feet(), Settings::new());
        let mut state = State::new(&estimator, &A1, &world.q);
        let sample = world.sample(&force, [1.0; 4]);
        let last = estimator.step(&A1, &mut state, Some(&sample), DT);
        let before = state;
        let longest = estimator.settings.max_dt;
        for dt in [0.0, -0.0, -longest, f64::NAN, f64::INFINITY, longest * longer] {
            let estimate = estimator.step(&A1, &mut state, Some(&sample), dt);
            prop_assert_eq!(estimate, Estimate { fault: Some(Fault::Step), ..last });
            prop_assert_eq!(state, before);
        }
        let estimate = estimator.step(&A1, &mut state, Some(&sample), longest);
        prop_assert_eq!(estimate.fault, None);
    }

    /// Without samples the robot goes on with the last force and rate and no foot is believed; after the limit it is lost and stands
    /// still where it was, for as long as it takes; and the next sample finds it.
    #[test]
    fn a_gap_is_coasted_lost_and_found(
        world in world(), force in vector(30.0), gap in 1..20_usize, dt in 5e-4..5e-3_f64, coasted in 0..6_usize,
    ) {
        let mut settings = Settings::new();
        // Exactly so many steps, as they are summed: the limit itself is still coasted. None is a limit, too.
        settings.max_coasting = [dt; 6].iter().take(coasted).sum();
        let estimator = world.estimator::<4, 6>(feet(), settings);
        let mut state = State::new(&estimator, &A1, &world.q);
        let _ = estimator.step(&A1, &mut state, Some(&world.sample(&force, [1.0; 4])), dt);
        let mut followed = state;
        let mut last = None;
        for k in 1..=gap {
            let estimate = estimator.step(&A1, &mut state, None, dt);
            prop_assert_eq!(estimate.fault, Some(Fault::Missing));
            prop_assert_eq!(estimate.confidence, [0.0; 4]);
            if k <= coasted {
                // As with sensors that say the same again, and feet in the air.
                let same = estimator.step(&A1, &mut followed, Some(&world.sample(&force, [0.0; 4])), dt);
                prop_assert_eq!(estimate.status, Status::Coasting);
                prop_assert!((estimate.base.translation - same.base.translation).amax() < 1e-12);
                prop_assert!((estimate.velocity.linear - same.velocity.linear).amax() < 1e-12);
                prop_assert!((estimate.velocity.angular - world.omega_b).amax() < 1e-12);
            } else {
                prop_assert_eq!(estimate.status, Status::Lost);
                prop_assert_eq!(estimate.velocity.angular, Vector3::zeros());
                prop_assert_eq!(estimate.velocity.linear, Vector3::zeros());
                let base: Transform<f64> = estimate.base;
                prop_assert_eq!(*last.get_or_insert(base), base);
            }
        }
        let found = estimator.step(&A1, &mut state, Some(&world.sample(&force, [0.0; 4])), dt);
        prop_assert_eq!((found.status, found.fault), (Status::Good, None));
        prop_assert!((found.velocity.angular - world.omega_b).amax() < 1e-12);
    }

    /// A robot so fast that its place leaves the numbers keeps its last place, and this is named.
    #[test]
    fn numbers_that_end_are_restored(direction in 0..3_usize, minus: bool, share in 0.5..0.9_f64) {
        let (estimator, state, mut sample) = standing();
        sample.evidence = [0.0; 4];
        let mut vel_w = Vector3::zeros();
        vel_w[direction] = if minus { -share } else { share } * f64::MAX;
        let mut state = state.moving(vel_w);
        let mut diverged = false;
        for _ in 0..120 {
            let before = state;
            let estimate = estimator.step(&A1, &mut state, Some(&sample), 0.02);
            prop_assert!(estimate.base.translation.iter().all(|x| x.is_finite()));
            match estimate.fault {
                None => prop_assert!(!diverged && state != before),
                fault => {
                    prop_assert_eq!(fault, Some(Fault::Diverged));
                    prop_assert_eq!(state, before);
                    diverged = true;
                }
            }
        }
        prop_assert!(diverged);
    }
}

/// Every fault says something of its own, and names the joint or foot.
#[test]
fn faults_are_told_apart() {
    let all = [
        Fault::Missing,
        Fault::Step,
        Fault::Accelerometer,
        Fault::Gyroscope,
        Fault::Joint(7),
        Fault::Joint(8),
        Fault::Evidence(2),
        Fault::Diverged,
    ];
    let texts = all.map(|fault| fault.to_string());
    for (i, text) in texts.iter().enumerate() {
        assert!(!text.is_empty() && !texts[..i].contains(text), "{text}");
    }
    assert!(texts[4].contains('7') && texts[6].contains('2'));
}
