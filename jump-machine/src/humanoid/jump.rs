//! What a humanoid's jump is made of.

use jump_control::ComProfile;
use nalgebra::Vector3;
use rbd_core::{Configuration, GRAVITY, Transform, Tree};
use so3::{Scalar, math};
use wbc_qp::Contact;

use super::stance::{Stance, com, first_foot};

/// One jump on the spot: how the centre of mass rises, from where, and in which posture the robot comes down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump<T: Scalar, const N: usize> {
    /// Height of the centre of mass over its start.
    pub profile: ComProfile<T>,
    /// Where the robot stands before it, in the estimator's world: all feet flat on the ground.
    pub start: Configuration<T, N>,
    /// Joint positions in which the feet meet the ground and the robot then stands, rad.
    pub landing_joints: [T; N],
}

/// A jump with what follows from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Armed<T: Scalar, const N: usize> {
    pub(super) jump: Jump<T, N>,
    /// Centre of mass at the start, world, m.
    pub(super) com_w: Vector3<T>,
    /// Where the first foot stands.
    pub(super) anchor: Transform<T>,
    /// Where the robot is to stand after the landing.
    pub(super) stance: Stance<T, N>,
    /// Time from the planned take-off to the planned touchdown, s.
    pub(super) flight: T,
}

impl<T: Scalar, const N: usize> Armed<T, N> {
    /// `None` where a number of the jump is not finite.
    pub(super) fn new<M: Tree<T, N>, const F: usize>(
        model: &M,
        feet: &[Contact<T>; F],
        jump: &Jump<T, N>,
    ) -> Option<Self> {
        let com_w = com(model, &jump.start);
        let stance = Stance::new(model, feet, &jump.landing_joints);
        let flight = flight_time(jump, com_w.z, stance.height);
        let joints = jump.start.joints.iter().chain(&jump.landing_joints);
        let numbers = joints.chain(com_w.iter()).chain([&stance.height, &flight]);
        let mut numbers = numbers.chain(jump.start.base.translation.iter());
        numbers.all(|x| x.is_finite_number()).then(|| Self {
            jump: *jump,
            com_w,
            anchor: first_foot(model, feet, &jump.start),
            stance,
            flight,
        })
    }
}

/// Time from the planned take-off to the planned touchdown, s, of a push-off that starts with the centre of mass at height `start`, m: the
/// throw ends where the legs of the landing posture reach the ground, with the centre of mass at height `end`.
fn flight_time<T: Scalar, const N: usize>(jump: &Jump<T, N>, start: T, end: T) -> T {
    let profile = &jump.profile;
    let g = T::of(-GRAVITY[2]);
    let drop = start + profile.at(profile.duration).rise - end;
    let v = profile.speed;
    (v + math::sqrt(math::max(v * v + T::TWO * g * drop, T::ZERO))) / g
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{Jump, flight_time};
    use jump_control::{ComProfile, Curve};
    use proptest::prelude::{ProptestConfig, prop_assert, proptest};
    use rbd_core::{Configuration, GRAVITY};

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// At the end of the flight the centre of mass, thrown as its profile ends, comes down to the height of the landing posture; one that does not get so high is
        /// at its highest.
        #[test]
        fn the_flight_ends_where_the_throw_comes_down_to_the_landing_posture(
            speed in 0.3..3.0_f64,
            displacement in 0.05..0.3_f64,
            start in 0.2..1.0_f64,
            drop in -0.3..0.3_f64,
        ) {
            let gravity = -GRAVITY[2];
            let profile = ComProfile::by_displacement(Curve::rising(), speed, displacement, gravity).unwrap();
            let jump = Jump::<f64, 0> {
                profile,
                start: Configuration::NEUTRAL,
                landing_joints: [],
            };
            let end = start + displacement - drop;
            let flight = flight_time(&jump, start, end);
            let reached = profile.at(profile.duration + flight);
            if 2.0 * gravity * -drop < speed * speed {
                prop_assert!((start + reached.rise - end).abs() < 1e-9, "{flight}");
                prop_assert!(reached.speed < 0.0, "{flight}");
            } else {
                prop_assert!(reached.speed.abs() < 1e-9, "{flight}");
            }
        }
    }
}
