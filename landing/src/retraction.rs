//! Feet that go along with the ground as it comes: ground speed matching.
//!
//! A foot that stands still in base axes meets the ground at the speed of the body, and what it weighs together with its rotor stops at
//! once: a blow of seven weights at 1.7 m/s, and joints that are torn along. A foot that is drawn up just before meets it with the rest of the
//! speed. That takes length from the legs, which a fast fall needs to come to rest: so it fades out there.
//!
//! The feet that come first are drawn up until they touch; the others go on, for when one foot is on the ground the body still falls.

use rbd_core::Build;
use so3::{Scalar, math};

/// How feet are drawn up before the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Retraction<T> {
    /// Largest share of the speed at which the ground comes; zero leaves the feet where the landing posture has them.
    pub share: T,
    /// Speed at which a foot may meet the ground, m/s: it is drawn up by what is more. Feet that meet it slower than they can are late, and
    /// those that came first have to stop the body alone.
    pub gentle: T,
    /// Largest speed of the ground that counts, m/s.
    pub fastest: T,
    /// Height over the planned ground below which it begins, m: what the height of the body is known to.
    pub near: T,
    /// Farthest way of a foot, m.
    pub most: T,
    /// Falls of the body from which on it fades and at which it is gone, m/s.
    pub fading: [T; 2],
    /// Time after the first touch for which the other feet go on, s.
    pub lasting: T,
}

impl<T: Scalar> Retraction<T> {
    /// For a robot of this size, by [dynamic similarity](rbd_core::similarity). Measured on A1:
    /// `saltus envelope a1/lateral-down --sim mujoco --without retraction` shows what it is worth.
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        Self {
            share: T::of(0.6),
            gentle: build.speed(1.0),
            fastest: build.speed(2.0),
            near: build.length(0.01),
            most: build.length(0.06),
            fading: [build.speed(2.2), build.speed(3.0)],
            lasting: build.time(0.04),
        }
    }

    /// Speed at which a foot is drawn up, m/s: one that was drawn up by `retracted` (m) and is at this `height` over the planned ground (m),
    /// to which it comes at `foot_fall` while the body falls at `body_fall` (m/s). Zero for numbers that are not finite.
    #[must_use]
    pub fn speed(&self, retracted: T, height: T, (foot_fall, body_fall): (T, T)) -> T {
        let near = height < self.near || retracted > T::ZERO;
        if !(near && retracted < self.most && foot_fall > T::ZERO) {
            return T::ZERO;
        }
        let [begin, end] = self.fading;
        let fading = math::clamp((end - body_fall) / (end - begin), T::ZERO, T::ONE);
        let fall = math::min(foot_fall, self.fastest);
        let speed = math::min(self.share * fall, math::max(fall - self.gentle, T::ZERO)) * fading;
        if speed.is_finite_number() {
            speed
        } else {
            T::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Retraction;
    use a1_model::BUILD;
    use proptest::prelude::{any, prop_assert, proptest};

    #[test]
    fn a_foot_near_the_ground_meets_it_gently() {
        let law = Retraction::<f64>::new(&BUILD);
        let met = |height: f64, fall: f64| fall - law.speed(0.0, height, (fall, fall));
        for gentle in [0.3, 1.0] {
            assert_eq!(met(0.0, gentle), gentle);
        }
        assert!((met(0.009, 1.5) - 1.0).abs() < 1e-12);
        assert_eq!(met(0.011, 1.5), 1.5);
        // At most by its share, of the fastest ground.
        let slower = Retraction { gentle: 0.1, ..law };
        assert!((slower.speed(0.0, 0.0, (1.5, 1.5)) - 0.9).abs() < 1e-12);
        assert!((slower.speed(0.0, 0.0, (2.5, 1.5)) - 1.2).abs() < 1e-12);
        // Once begun it goes on, as far as it may.
        assert!((law.speed(0.01, 0.02, (1.5, 1.5)) - 0.5).abs() < 1e-12);
        assert_eq!(law.speed(0.06, 0.0, (1.5, 1.5)), 0.0);
        // A foot that goes up is left alone, and so is a body that falls fast.
        assert_eq!(law.speed(0.0, 0.0, (-0.1, 1.5)), 0.0);
        assert!((law.speed(0.0, 0.0, (1.5, 2.6)) - 0.5 * 0.5).abs() < 1e-12);
        assert_eq!(law.speed(0.0, 0.0, (3.5, 3.0)), 0.0);
        for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            for speed in [
                law.speed(bad, 0.0, (1.0, 1.0)),
                law.speed(0.0, bad, (1.0, 1.0)),
                law.speed(0.0, 0.0, (bad, 1.0)),
                law.speed(0.0, 0.0, (1.0, bad)),
            ] {
                assert!((0.0..=1.2).contains(&speed));
            }
        }
    }

    proptest! {
        #[test]
        fn no_foot_is_faster_than_its_share(
            retracted in any::<f64>(),
            height in any::<f64>(),
            foot_fall in any::<f64>(),
            body_fall in any::<f64>(),
        ) {
            let law = Retraction::<f64>::new(&BUILD);
            let speed = law.speed(retracted, height, (foot_fall, body_fall));
            prop_assert!((0.0..=law.share * law.fastest).contains(&speed));
            prop_assert!(speed <= law.share * foot_fall.abs());
        }
    }
}
