//! Which feet are on the ground.
//!
//! Paper A switches to the landing controller when any contact sensor shows c_s ≥ δ and t ≥ `T_posing`. In a hard
//! landing the feet bounce and sensors chatter; a foot therefore counts as in contact from its first sample at
//! or above δ until it has been below for the release time.

use rbd_core::Build;
use so3::Scalar;

/// The contact filter's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactFilter<T> {
    /// Force threshold δ, N.
    pub threshold: T,
    /// Time below δ after which a foot is in the air again, s.
    pub release: T,
}

/// Memory of the filter over `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchdownState<T, const F: usize> {
    /// Whether each foot is in contact.
    pub contacts: [bool; F],
    unloaded: [T; F],
}

impl<T: Scalar, const F: usize> TouchdownState<T, F> {
    /// All feet in the air.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            contacts: [false; F],
            unloaded: [T::ZERO; F],
        }
    }

    /// Whether any foot is in contact.
    #[must_use]
    pub fn any(&self) -> bool {
        self.contacts.contains(&true)
    }
}

impl<T: Scalar, const F: usize> Default for TouchdownState<T, F> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Scalar> ContactFilter<T> {
    /// 15 N, released after 20 ms, for a robot of 13.741 kg with legs of 0.4 m, scaled by
    /// [dynamic similarity](rbd_core::similarity): feet bounce as high, in their legs, on any robot.
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        Self {
            threshold: build.force(15.0),
            release: build.time(0.020),
        }
    }

    /// Takes the forces of one tick of `dt` seconds. A force that is not a number is no evidence either way: the foot
    /// keeps its state. A step that is not one counts as no time.
    pub fn update<const F: usize>(&self, state: &mut TouchdownState<T, F>, forces: &[T; F], dt: T) {
        let dt = if is_step(dt) { dt } else { T::ZERO };
        let feet = state.contacts.iter_mut().zip(&mut state.unloaded);
        for ((contact, unloaded), force) in feet.zip(forces) {
            if *force >= self.threshold {
                *contact = true;
                *unloaded = T::ZERO;
            } else if force.is_finite_number() && *contact {
                *unloaded += dt;
                *contact = *unloaded < self.release;
            }
        }
    }
}

/// Whether a time step is positive and no longer than a second; false for NaN.
pub(crate) fn is_step<T: Scalar>(dt: T) -> bool {
    dt > T::ZERO && dt <= T::ONE
}

#[cfg(test)]
mod tests {
    use super::{ContactFilter, TouchdownState};
    use a1_model::BUILD;

    #[test]
    fn a_missing_sample_does_not_lift_a_foot_and_twenty_milliseconds_do() {
        let filter = ContactFilter::new(&BUILD);
        let mut state = TouchdownState::<f64, 2>::new();
        filter.update(&mut state, &[14.0, 15.0], 1e-3);
        assert_eq!(state.contacts, [false, true]);
        for _ in 0..19 {
            filter.update(&mut state, &[0.0, 0.0], 1e-3);
            assert!(state.any());
        }
        filter.update(&mut state, &[0.0, f64::NAN], 1e-3);
        assert!(state.any());
        filter.update(&mut state, &[0.0, 0.0], 1.1e-3);
        assert!(!state.any());
    }
}
