//! A robot that stands begins anew where it is told.

use a1_model::A1;
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use state_est::{Estimate, Estimator, Foot, Settings, State};

use crate::common::{World, config, feet, vector};

type Four = (Estimator<f64, 12, 4, 6>, State<f64, 4, 6>);

/// A crouched robot anywhere, tilted and headed anyhow, that has stood on these feet for a while; the IMU is off the base's origin.
fn standing(at: Vector3<f64>, heading: f64, tilt: f64, evidence: [f64; 4]) -> (World, Four) {
    let mut world = World::crouched();
    world.q.base.translation = at;
    world.q.base.rotation = Rotation3::from_euler_angles(0.5 * tilt, tilt, heading);
    world.imu.translation = Vector3::new(0.1, -0.05, 0.02);
    let estimator = world.estimator::<4, 6>(feet(), Settings::new());
    let mut state = State::new(&estimator, &A1, &world.q);
    go_on(&world, &estimator, &mut state, evidence, 20);
    (world, (estimator, state))
}

fn go_on(
    world: &World,
    estimator: &Estimator<f64, 12, 4, 6>,
    state: &mut State<f64, 4, 6>,
    evidence: [f64; 4],
    ticks: usize,
) -> Estimate<f64, 4> {
    // The tilt is not what the accelerometer says, and neither is the speed nought: everything goes on changing.
    let sample = world.sample(&(world.held() + Vector3::new(0.3, -0.2, 0.1)), evidence);
    let mut step = || estimator.step(&A1, state, Some(&sample), 1e-3);
    (1..ticks).fold(step(), |_, _| step())
}

/// Middle of the feet of a base there.
fn middle(world: &World, base: &Estimate<f64, 4>) -> Vector3<f64> {
    let mut there = *world;
    there.q.base = base.base;
    let sum: Vector3<f64> = feet()
        .iter()
        .map(|foot: &Foot<f64>| there.pose_of(&foot.frame).translation)
        .sum();
    sum / 4.0
}

fn heading(base: &Estimate<f64, 4>) -> f64 {
    let ahead = base.base.rotation * Vector3::x();
    so3::math::atan2(ahead.y, ahead.x)
}

proptest! {
    #![proptest_config(config(128, 21))]

    /// Feet and heading are where they are said to be, tilt and motion are what they were, and from then on every estimate is the one that it would have
    /// been, seen in the other world.
    #[test]
    fn the_same_goes_on_in_another_world(
        at in vector(3.0), first in -3.1..3.1_f64, tilt in -0.3..0.3_f64, to in vector(3.0), wanted in -3.1..3.1_f64,
    ) {
        let all = [1.0; 4];
        let (world, (estimator, mut old)) = standing(at, first, tilt, all);
        let mut new = old;
        prop_assert!(new.stand_at(&to, wanted));
        for ticks in [1, 30] {
            let [before, after] = [&mut old, &mut new].map(|state| go_on(&world, &estimator, state, all, ticks));
            // A tick changes place and heading by little, the change of the world by much.
            prop_assert!((middle(&world, &after) - to).norm() < 5e-3, "{}", middle(&world, &after));
            let off = so3::exp(&(Vector3::z() * (heading(&after) - wanted)));
            prop_assert!(so3::log(&off).norm() < 1e-3);
            let turned = after.base.rotation * before.base.rotation.inverse();
            let shift = after.base.translation - turned * before.base.translation;
            prop_assert!((turned * Vector3::z() - Vector3::z()).norm() < 1e-9, "the vertical turned");
            prop_assert!((turned * middle(&world, &before) + shift - middle(&world, &after)).norm() < 1e-9);
            prop_assert!((before.velocity.linear - after.velocity.linear).norm() < 1e-9);
            prop_assert!((before.velocity.angular - after.velocity.angular).norm() < 1e-9);
            prop_assert_eq!(before.confidence.map(|c| (c * 1e9) as i64), after.confidence.map(|c| (c * 1e9) as i64));
        }
    }

    /// Feet stand where the joints have them under the base, and none where one does not stand.
    #[test]
    fn the_feet_are_where_they_stand(at in vector(3.0), first in -3.1..3.1_f64, tilt in -0.3..0.3_f64, lifted in 0..4_usize) {
        let (world, (estimator, mut state)) = standing(at, first, tilt, [1.0; 4]);
        let base = go_on(&world, &estimator, &mut state, [1.0; 4], 30);
        let mut there = world;
        there.q.base = base.base;
        let feet_w = state.feet().unwrap();
        for (foot_w, foot) in feet_w.iter().zip(feet()) {
            // It sways, and what is believed of a foot is a mean.
            prop_assert!((foot_w - there.pose_of(&foot.frame).translation).norm() < 5e-3);
        }
        let mut evidence = [1.0; 4];
        evidence[lifted] = 0.0;
        let (_, (_, state)) = standing(at, first, tilt, evidence);
        prop_assert_eq!(state.feet(), None);
    }

    /// A foot in the air, or a number that is none, changes nothing.
    #[test]
    fn who_does_not_stand_stays_where_he_is(foot in 0..4_usize, axis in 0..3_usize, bad in prop_oneof![Just(f64::NAN), Just(f64::INFINITY)]) {
        let mut evidence = [1.0; 4];
        let to = Vector3::new(1.0, 2.0, 0.02);
        let (_, (_, state)) = standing(Vector3::zeros(), 0.3, 0.1, evidence);
        let refused = |state: &State<f64, 4, 6>, to: &Vector3<f64>, heading| {
            let mut after = *state;
            !after.stand_at(to, heading) && after == *state
        };
        let mut nowhere = to;
        nowhere[axis] = bad;
        prop_assert!(refused(&state, &nowhere, 0.5) && refused(&state, &to, bad));
        evidence[foot] = 0.0;
        let (_, (_, lifted)) = standing(Vector3::zeros(), 0.3, 0.1, evidence);
        prop_assert!(refused(&lifted, &to, 0.5));
    }
}
