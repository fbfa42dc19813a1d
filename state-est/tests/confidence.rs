//! Which feet are believed, and how far.

use a1_model::A1;
use nalgebra::Vector3;
use proptest::prelude::*;
use state_est::{Estimate, Foot, Settings, State};

use crate::common::{World, config, feet, rotation, vector, world};

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
    /// The gate is wider by what the filter does not know of its own velocity: at the start 1 mm/s along each axis.
    #[test]
    fn a_slipping_foot_is_believed_less(world in world(), slip in vector(1.0), evidence in 0.0..1.0_f64, gate in 0.1..1.0_f64) {
        let mut settings = Settings::new();
        settings.slip_gate = gate;
        let [foot, other, ..] = feet();
        let vel_w = world.velocity_by(foot) + slip;
        let estimate = step::<2, 4>(&world, [foot, other], settings, vel_w, [evidence, 0.0]);
        let wide = gate * gate + 3.0 * 1e-3 * 1e-3;
        let share = wide / (wide + slip.norm_squared());
        prop_assert!((estimate.confidence[0] - evidence * share).abs() < 1e-7);
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
        settings.agreement = 0.0;
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

    /// Feet that sink together do not take the estimate along while they agree for less than the time asked for; a filter that is wrong is put right
    /// after it. A tick without a majority begins the time again.
    #[test]
    fn a_majority_is_believed_after_it_has_agreed_for_a_time(
        orientation in rotation(), direction in rotation(), fast in 1.0..3.0_f64, agreement in 0.01..0.08_f64, lifted in 1..9_usize,
    ) {
        // So far from what the feet say that none of them is believed by itself.
        let wrong = direction * Vector3::x() * fast;
        let mut world = World::crouched();
        world.q.base.rotation = orientation;
        let mut settings = Settings::new();
        settings.agreement = agreement;
        let estimator = world.estimator::<4, 6>(feet(), settings);
        // The feet say that the robot stands.
        let run = |lifted: Option<usize>| {
            let mut state = State::new(&estimator, &A1, &world.q).moving(wrong);
            let ticks = 1..=2 * (agreement / 1e-3) as usize + 10;
            ticks.map(|tick| {
                let evidence = if Some(tick) == lifted { [0.0; 4] } else { [1.0; 4] };
                let sample = world.sample(&world.held(), evidence);
                let estimate = estimator.step(&A1, &mut state, Some(&sample), 1e-3);
                (tick, (estimate.velocity.linear.norm(), estimate.confidence[0]))
            }).collect::<Vec<_>>()
        };
        for (pause, lifted) in [(0, None), (lifted, Some(lifted))] {
            for (tick, (speed, confidence)) in run(lifted) {
                let agreed = (tick as f64 - if tick >= pause { pause as f64 } else { 0.0 }) * 1e-3;
                if agreed < agreement - 1e-9 {
                    prop_assert!((speed - fast).abs() < 1e-6, "{tick}: {speed}");
                } else {
                    prop_assert!(confidence > 0.99 && speed < fast, "{tick}: {confidence} {speed}");
                }
            }
        }
    }

    /// Samples beyond the range at an impact leave the velocity unknown by the range for each of them, and feet that stand say it at once, without
    /// the time that a majority needs against a filter that is sure.
    #[test]
    fn after_an_impact_beyond_the_range_feet_are_believed_at_once(
        orientation in rotation(), direction in rotation(), missed in 1..8_usize, share in 0.0..1.0_f64,
    ) {
        let settings = Settings::new();
        let wrong = direction * Vector3::x() * (share * settings.max_specific_force * 1e-3 * missed as f64);
        let mut world = World::crouched();
        world.q.base.rotation = orientation;
        let estimator = world.estimator::<4, 6>(feet(), settings);
        let beyond = Vector3::new(0.0, 0.0, 2.0 * settings.max_specific_force);
        let speed = |missed: usize| {
            let mut state = State::new(&estimator, &A1, &world.q).moving(wrong);
            let mut step = |force_b: &Vector3<f64>, evidence| {
                let sample = world.sample(force_b, evidence);
                estimator.step(&A1, &mut state, Some(&sample), 1e-3).velocity.linear.norm()
            };
            for _ in 0..missed {
                step(&beyond, [0.0; 4]);
            }
            (0..10).fold(0.0, |_, _| step(&world.held(), [1.0; 4]))
        };
        prop_assert!(speed(missed) < 0.05, "{} of {}", speed(missed), wrong.norm());
        // By themselves they are not believed from three gates on.
        if wrong.norm() > 1.0 {
            prop_assert!(speed(0) > 0.999 * wrong.norm(), "{}", speed(0));
        }
    }

    /// Below the least confidence a foot changes nothing, and from it on it does. Evidence beyond its range is taken at its end.
    #[test]
    fn a_foot_that_is_not_believed_changes_nothing(world in world(), slip in vector(1.0), least in 0.51..0.99_f64, above in 0.0..9.0_f64) {
        let mut settings = Settings::new();
        settings.least_confidence = least;
        settings.agreement = 0.0;
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
