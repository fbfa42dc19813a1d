//! Which feet are believed, and how far.

use a1_model::A1;
use nalgebra::Vector3;
use proptest::prelude::*;
use state_est::{Estimate, Foot, Settings, State};

use crate::common::{World, config, feet, vector, world};

/// One very short step of an estimator that believes to move at `vel_w`.
fn step<const F: usize, const S: usize>(
    world: &World,
    feet: [Foot<f64>; F],
    settings: Settings<f64>,
    vel_w: Vector3<f64>,
    evidence: [f64; F],
) -> Estimate<f64, F> {
    let estimator = world.estimator::<F, S>(feet, settings);
    let mut state = State::new(&estimator, &A1, &world.q).moving(vel_w);
    let sample = world.sample(&world.held(), evidence);
    estimator.step(&A1, &mut state, Some(&sample), 1e-9)
}

proptest! {
    #![proptest_config(config(128, 12))]

    /// A foot alone is believed by its evidence, by half of it at the slip gate, and less with the square of the slip. One of two is no majority.
    #[test]
    fn a_slipping_foot_is_believed_less(world in world(), slip in vector(1.0), evidence in 0.0..1.0_f64, gate in 0.1..1.0_f64) {
        let mut settings = Settings::new();
        settings.slip_gate = gate;
        let [foot, other, ..] = feet();
        let vel_w = world.velocity_by(foot) + slip;
        let estimate = step::<2, 4>(&world, [foot, other], settings, vel_w, [evidence, 0.0]);
        let share = 1.0 / (1.0 + slip.norm_squared() / (gate * gate));
        prop_assert!((estimate.confidence[0] - evidence * share).abs() < 1e-6);
        prop_assert_eq!(estimate.confidence[1], 0.0);
    }

    /// More than half of all feet, if each is within the gate of their mean, are believed by their own slip from it, however wrong the filter is.
    #[test]
    fn a_majority_that_agrees_is_believed_against_the_filter(
        world in world(), standing in prop::array::uniform4(prop::bool::weighted(0.7)), stretch in 0.5..2.0_f64,
    ) {
        let velocities = feet().map(|foot| world.velocity_by(foot));
        let stands: Vec<usize> = (0..4).filter(|i| standing[*i]).collect();
        let sum: Vector3<f64> = stands.iter().map(|i| velocities[*i]).sum();
        let mean = sum / stands.len().max(1) as f64;
        let slips = velocities.map(|velocity| (velocity - mean).norm());
        let worst = stands.iter().map(|i| slips[*i]).fold(0.0, f64::max);
        let mut settings = Settings::new();
        settings.slip_gate = worst.max(0.1) * stretch;
        let agreed = stands.len() > 2 && worst < settings.slip_gate;
        // The filter believes in a velocity far from all.
        let wrong = mean + Vector3::new(300.0, 400.0, 0.0) * settings.slip_gate;
        let evidence = standing.map(|stands| if stands { 1.0 } else { 0.0 });
        let estimate = step::<4, 6>(&world, feet(), settings, wrong, evidence);
        for i in stands {
            let ratio = slips[i] / settings.slip_gate;
            let expected = if agreed { 1.0 / (1.0 + ratio * ratio) } else { 0.0 };
            prop_assert!((estimate.confidence[i] - expected).abs() < 1e-4, "{estimate:?}");
        }
    }

    /// Below the least confidence a foot changes nothing, and from it on it does. Evidence beyond its range is taken at its end.
    #[test]
    fn a_foot_that_is_not_believed_changes_nothing(world in world(), slip in vector(1.0), least in 0.51..0.99_f64, above in 0.0..9.0_f64) {
        let mut settings = Settings::new();
        settings.least_confidence = least;
        settings.foot_speed = 1e-9;
        let [foot, ..] = feet();
        let vel_w = world.velocity_by(foot) + slip;
        let velocity = |evidence| {
            let estimate = step::<1, 3>(&world, [foot], settings, vel_w, [evidence]);
            (estimate.velocity.linear, estimate.confidence[0])
        };
        let air = velocity(0.0).0;
        prop_assert_eq!(velocity(least * (1.0 - 1e-9)).0, air);
        let ground = velocity(least).0;
        prop_assert!((ground - air).norm() > 0.5 * slip.norm());
        prop_assert_eq!(velocity(1.0 + above), velocity(1.0));
        prop_assert_eq!(velocity(-above), velocity(0.0));
    }
}
