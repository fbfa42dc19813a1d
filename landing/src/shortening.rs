//! Legs that wait shorter for a fast ground, so that their joints are not torn along.
//!
//! A foot that stops on the ground turns the joints of its leg at q̇ = J⁺ (−v − ω × r) from one tick to the next. In legs that are bent more the
//! same speed of the foot takes less of the knee, and more of the hip. Where the largest of these speeds is beyond what the joints can do, the
//! feet are raised by d = g (max |q̇| / ω_max − 1), which is bounded twice: a leg keeps the way on which it stops the body,
//! ℓ − v²/(2a), and where the farthest raise would not do it either, less is raised again, down to none:
//! a leg that is too slow anyway needs its length.

use rbd_core::{Build, LimbEnd, Motion};
use so3::{Scalar, math};

use crate::least_squares::solve_damped;

/// How legs are shortened for their joints' sake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortening<T> {
    /// Joint speed at the touch from which on legs are shortened, rad/s.
    pub joint_speed: T,
    /// g, m: how far feet are raised for a joint that would be twice as fast as that.
    pub gain: T,
    /// Farthest that feet are raised, m; zero leaves them where the landing posture has them.
    pub most: T,
    /// Fastest that feet are raised, m/s.
    pub rate: T,
    /// ℓ, m: the way that a body falls on landing legs before its trunk touches the ground.
    pub travel: T,
    /// a, m/s²: the deceleration with which legs stop a body.
    pub deceleration: T,
    /// Tikhonov term on the way of a foot, m²: keeps a stretched leg from infinite joint speeds.
    pub damping: T,
}

impl<T: Scalar> Shortening<T> {
    /// For a robot of this size, by [dynamic similarity](rbd_core::similarity), measured on A1, whose joints do 21 rad/s without load; five
    /// times gravity stop a robot of any size.
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        Self {
            joint_speed: build.rate(20.0),
            gain: build.length(0.3),
            most: build.length(0.04),
            rate: build.speed(1.0),
            travel: build.length(0.187),
            deceleration: T::of(50.0),
            damping: build.area(1e-4),
        }
    }

    /// Fastest joint of any leg once the feet of a body that moves with `velocity_b` (base axes, about the base's origin) have stopped, rad/s.
    #[must_use]
    pub fn fastest<const N: usize>(&self, legs: &[LimbEnd<T, N>], velocity_b: &Motion<T>) -> T {
        let mut fastest = T::ZERO;
        for end in legs {
            let speed_b = velocity_b.linear + velocity_b.angular.cross(&end.position);
            let force = solve_damped(end, self.damping, &speed_b);
            for (_, column) in end.columns() {
                fastest = math::max(fastest, math::abs(column.dot(&force)));
            }
        }
        fastest
    }

    /// How far feet are raised, m, `dt` (s) after it was by `raise`: legs so raised whose [`fastest`](Self::fastest) joint will be that fast,
    /// under a body that meets the ground at `fall` (m/s).
    #[must_use]
    pub fn raise(&self, raise: T, fastest: T, fall: T, dt: T) -> T {
        let needed = raise + (fastest / self.joint_speed - T::ONE) * self.gain;
        let helps = math::min(needed, self.most + self.most - needed);
        let fall = math::max(fall, T::ZERO);
        let spare = self.travel - fall * fall / (self.deceleration + self.deceleration);
        let wanted = math::clamp(helps, T::ZERO, math::max(spare, T::ZERO));
        let step = self.rate * dt;
        let next = math::clamp(wanted, raise - step, raise + step);
        if next.is_finite_number() { next } else { raise }
    }
}

#[cfg(test)]
mod tests {
    use super::Shortening;
    use a1_model::{A1Geared, BUILD, FEET};
    use nalgebra::Vector3;
    use proptest::prelude::{any, prop_assert, proptest};
    use rbd_core::{Configuration, Kinematics, Limbs, Motion, Posture, forward_kinematics};

    fn configuration(joints: [f64; 12]) -> Configuration<f64, 12> {
        Configuration {
            joints,
            ..Configuration::NEUTRAL
        }
    }

    /// Joints that move as fast as the law says leave every foot where it is in the world.
    #[test]
    fn joints_at_these_speeds_hold_the_feet_still() {
        let joints: [f64; 12] = core::array::from_fn(|i| [0.1, 0.8, -1.6][i % 3]);
        let limbs = Limbs::new(
            &A1Geared,
            &configuration(joints),
            &FEET.map(|foot| foot.frame),
        );
        let law = Shortening {
            damping: 1e-12,
            ..Shortening::new(&BUILD)
        };
        let velocity = Motion::new(Vector3::new(0.4, -0.2, -2.0), Vector3::new(0.5, -1.0, 0.3));
        let mut fastest = 0.0_f64;
        for (leg, end) in limbs.ends.iter().enumerate() {
            let foot = velocity.linear + velocity.angular.cross(&end.position);
            let force = crate::solve_damped(end, law.damping, &-foot);
            let mut speeds = [0.0; 12];
            end.add_tr_mul(&force, &mut speeds);
            fastest = speeds.iter().fold(fastest, |most, x| most.max(x.abs()));
            // By differences of the feet's places, not by the Jacobian that the law uses.
            let h = 1e-6;
            let moved = core::array::from_fn(|i| joints[i] + h * speeds[i]);
            let place = |joints| {
                let mut poses = Kinematics::IDENTITY;
                let posture = Posture::new(&A1Geared, &configuration(joints));
                forward_kinematics(&A1Geared, &posture, &mut poses);
                FEET.map(|foot| poses.frame(&foot.frame).translation)
            };
            let (from, to) = (place(joints), place(moved));
            let way = (to[leg] - from[leg]) / h;
            assert!((foot + way).norm() < 1e-4, "{foot} {way}");
        }
        assert!((law.fastest(&limbs.ends, &velocity) - fastest).abs() < 1e-9);
        assert_eq!(law.fastest(&limbs.ends, &Motion::ZERO), 0.0);
    }

    #[test]
    fn feet_are_raised_as_far_as_it_helps() {
        let law = Shortening::<f64>::new(&BUILD);
        let settled = |fastest: f64, fall: f64| law.raise(0.0, fastest, fall, 1.0);
        assert_eq!(settled(20.0, 1.5), 0.0);
        // A tenth too fast are 3 cm, a fifth would be 6 cm: 2 cm are what is left of 4.
        assert!((settled(22.0, 1.5) - 0.03).abs() < 1e-12);
        assert!((settled(24.0, 1.5) - 0.02).abs() < 1e-12);
        assert_eq!(settled(30.0, 1.5), 0.0);
        // Legs keep the way on which they stop the body.
        assert!((settled(22.0, 4.0) - 0.027).abs() < 1e-12);
        assert_eq!(settled(22.0, 5.0), 0.0);
        // A millisecond is a millimetre.
        assert!((law.raise(0.01, 22.0, 1.5, 1e-3) - 0.011).abs() < 1e-12);
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            for raise in [
                law.raise(0.01, bad, 1.0, 1e-3),
                law.raise(0.01, 22.0, bad, 1e-3),
            ] {
                assert!((0.009 - 1e-12..=0.011 + 1e-12).contains(&raise), "{raise}");
            }
        }
    }

    proptest! {
        #[test]
        fn no_raise_is_beyond_the_farthest(
            share in 0.0..1.0,
            fastest in any::<f64>(),
            fall in any::<f64>(),
            dt in 0.0..1.0,
        ) {
            let law = Shortening::<f64>::new(&BUILD);
            let raise = law.raise(share * law.most, fastest, fall, dt);
            prop_assert!((0.0..=law.most).contains(&raise));
        }
    }
}
