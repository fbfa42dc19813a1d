//! What the joints feel, and when a sensor is believed.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use crate::common::{config, smooth};
use a1_model::{A1Geared, BUILD, FEET};
use landing::{Detector, DetectorState, ForceObserver, ObserverState};
use nalgebra::Vector3;
use proptest::prelude::*;
use rbd_core::{Configuration, Limbs, Motion, Posture, Tangent, generalized_gravity, rnea};

const DT: f64 = 1e-3;

/// Forces that are felt after a tenth of a second with this motion and these torques beside those of the motion.
fn felt(
    q: &Configuration<f64, 12>,
    (v, a): (Tangent<f64, 12>, Tangent<f64, 12>),
    beside: &[f64; 12],
) -> [Vector3<f64>; 4] {
    let observer = ForceObserver::new(&BUILD, FEET.map(|foot| foot.frame));
    let mut state = ObserverState::new();
    let posture = Posture::new(&A1Geared, q);
    let mut forces = None;
    for tick in 0..100 {
        let now = v + a * (DT * f64::from(tick));
        let needed = rnea(&A1Geared, &posture, &now, &a).joints;
        let torques = core::array::from_fn(|i| needed[i] - beside[i]);
        forces = observer.update(&A1Geared, &mut state, q, &now, &torques, DT);
    }
    forces.unwrap()
}

proptest! {
    #![proptest_config(config(24, 8))]

    /// Whatever the motion is, it is not felt as a force; what is beside it is felt as at rest.
    #[test]
    fn a_motion_is_no_force(
        case in smooth(1.0),
        linear in prop::array::uniform(-20.0..20.0_f64), joints in prop::array::uniform(-100.0..100.0_f64),
        beside in prop_oneof![1 => Just([0.0; 12]), 3 => prop::array::uniform(-30.0..30.0_f64)],
    ) {
        let a = Tangent { base: Motion::from_array(linear), joints };
        let moving = felt(&case.q, (case.v, a), &beside);
        let resting = felt(&case.q, (Tangent::ZERO, Tangent::ZERO), &beside);
        for (moving, resting) in moving.iter().zip(&resting) {
            prop_assert!((moving - resting).amax() < 1e-8 * (1.0 + resting.amax()), "{} {}", moving, resting);
        }
        if beside == [0.0; 12] {
            prop_assert!(moving.iter().all(|force| force.amax() < 1e-8));
        }
    }
}

proptest! {
    #![proptest_config(config(64, 9))]

    /// Forces of the ground on a robot at rest are felt as they are, in world axes, with a first-order lag of the time constant.
    #[test]
    fn forces_are_felt_with_a_lag(
        case in smooth(0.3), forces in prop::array::uniform4(prop::array::uniform3(-100.0..100.0_f64)), dt in 5e-4..5e-3_f64, ticks in 1..40_u32,
    ) {
        let mut observer = ForceObserver::new(&BUILD, FEET.map(|foot| foot.frame));
        observer.damping = 1e-12;
        let forces = forces.map(Vector3::from);
        let posture = Posture::new(&A1Geared, &case.q);
        // Each foot's force takes its leg's torques away.
        let mut torques = generalized_gravity(&A1Geared, &posture).joints;
        let limbs = Limbs::new(&A1Geared, &case.q, &observer.feet);
        for (end, force_w) in limbs.ends.iter().zip(&forces) {
            end.add_tr_mul(&-(case.q.base.rotation.inverse() * force_w), &mut torques);
        }
        let mut state = ObserverState::new();
        let mut update = || observer.update(&A1Geared, &mut state, &case.q, &Tangent::ZERO, &torques, dt);
        prop_assert_eq!(update(), None);
        let felt = (0..ticks).fold(None, |_, _| update()).unwrap();
        let tau = observer.time_constant;
        let share = 1.0 - so3::math::powi(tau / (tau + dt), ticks);
        for (felt, force_w) in felt.iter().zip(&forces) {
            prop_assert!((felt - force_w * share).amax() < 1e-5, "{} {}", felt, force_w * share);
        }
    }
}

/// No force is felt over a time that is none or that no tick has, and what was seen before it is forgotten: the next tick is a first one again.
#[test]
fn a_tick_of_no_time_is_no_measurement() {
    let observer = ForceObserver::<f64, 12, 4>::new(&BUILD, FEET.map(|foot| foot.frame));
    let (q, v) = (Configuration::NEUTRAL, Tangent::ZERO);
    for ticks in 0..3 {
        for bad in [0.0, -0.0, -DT, 1.001, f64::NAN, f64::INFINITY] {
            let mut state = ObserverState::new();
            let mut felt = |dt| observer.update(&A1Geared, &mut state, &q, &v, &[1.0; 12], dt);
            for tick in 0..ticks {
                assert_eq!(felt(DT).is_some(), tick > 0);
            }
            assert_eq!(felt(bad), None);
            assert_eq!(felt(DT), None, "{bad} after {ticks}");
            assert!(felt(DT).is_some());
        }
    }
}

/// A sensor that says contact while the leg feels nothing is doubted after [`Detector::patience`]; it is believed again only when nothing is
/// left of a doubt of twice that, which falls at a quarter of the rate.
#[test]
fn a_stuck_sensor_is_believed_again_when_no_doubt_is_left() {
    let detector = Detector::new(&BUILD, FEET.map(|foot| foot.frame));
    let mut state = DetectorState::new();
    let mut q = Configuration::NEUTRAL;
    q.joints = core::array::from_fn(|i| [0.0, 0.8, -1.6][i % 3]);
    let torques = generalized_gravity(&A1Geared, &Posture::new(&A1Geared, &q)).joints;
    let mut after = |says: f64, time: f64| {
        for _ in 0..(time / DT) as u32 {
            let v = Tangent::ZERO;
            detector.update(
                &A1Geared,
                &mut state,
                &q,
                &v,
                &torques,
                &[says, 0.0, 0.0, 0.0],
                DT,
            );
        }
        (state.faulty, state.contacts[0])
    };
    let (fault, healthy) = ([true, false, false, false], [false; 4]);
    let patience = detector.patience;
    assert_eq!(after(100.0, 0.9 * patience), (healthy, true));
    assert_eq!(after(100.0, 2.1 * patience), (fault, false));
    assert_eq!(after(0.0, 7.5 * patience), (fault, false));
    assert_eq!(after(0.0, patience), (healthy, false));
}
