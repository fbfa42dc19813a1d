//! Which feet are on the ground, when sensors may lie.
//!
//! A foot sensor is believed until it has contradicted the force that the joints feel for a while: loaded where
//! the leg feels nothing (stuck), or unloaded where the leg carries (dead), or both in turn (chattering). From then on the joints
//! decide for that foot, and the foot is reported. A sensor that agrees again for long enough is believed again.

use rbd_core::{Build, Configuration, Frame, Limbs, Tangent, Tree};
use so3::{Scalar, math};

use crate::{ContactFilter, ForceObserver, ObserverState, TouchdownState};

/// The detector of a robot with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detector<T, const N: usize, const F: usize> {
    /// Debounce of the sensors.
    pub filter: ContactFilter<T>,
    /// Forces from the joints.
    pub observer: ForceObserver<T, N, F>,
    /// Upward force from which a leg certainly carries, N.
    pub loaded: T,
    /// Upward force below which a leg certainly does not, N.
    pub unloaded: T,
    /// Time for which a leg must carry before that alone counts as contact, s.
    pub confirm: T,
    /// Time of contradiction after which a sensor is not believed, s.
    pub patience: T,
}

/// Memory of the detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectorState<T: Scalar, const N: usize, const F: usize> {
    /// Whether each foot is in contact.
    pub contacts: [bool; F],
    /// Feet whose sensor is not believed.
    pub faulty: [bool; F],
    sensors: TouchdownState<T, F>,
    felt: TouchdownState<T, F>,
    observer: ObserverState<T, N>,
    carrying: [T; F],
    doubt: [T; F],
}

impl<T: Scalar, const N: usize, const F: usize> DetectorState<T, N, F> {
    /// All feet in the air, all sensors believed.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            contacts: [false; F],
            faulty: [false; F],
            sensors: TouchdownState::new(),
            felt: TouchdownState::new(),
            observer: ObserverState::new(),
            carrying: [T::ZERO; F],
            doubt: [T::ZERO; F],
        }
    }

    /// Jᵀ f of the ground as the joints feel it, low-passed, N m.
    #[must_use]
    pub const fn residual(&self) -> &[T; N] {
        self.observer.residual()
    }

    /// Whether any foot is in contact.
    #[must_use]
    pub fn any(&self) -> bool {
        self.contacts.contains(&true)
    }
}

impl<T: Scalar, const N: usize, const F: usize> Default for DetectorState<T, N, F> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Scalar, const N: usize, const F: usize> Detector<T, N, F> {
    /// A leg carries from 20 N, 15 % of the weight of a robot of 13.741 kg, and does not below 8 N, 6 % of it; forces scale by
    /// [dynamic similarity](rbd_core::similarity). 4 ms to confirm and 40 ms of patience are a few time constants of the observer, which
    /// does not scale.
    #[must_use]
    pub fn new(build: &Build<T>, feet: [Frame<T>; F]) -> Self {
        Self {
            filter: ContactFilter::new(build),
            observer: ForceObserver::new(build, feet),
            loaded: build.force(20.0),
            unloaded: build.force(8.0),
            confirm: T::of(0.004),
            patience: T::of(0.040),
        }
    }

    /// One tick of `dt` seconds: state, torques of the joints since the last tick (friction included), and what the foot
    /// sensors say, N. A sensor that says no number says nothing.
    #[expect(
        clippy::too_many_arguments,
        reason = "each is a separate thing the caller knows"
    )]
    pub fn update<M: Tree<T, N>>(
        &self,
        model: &M,
        state: &mut DetectorState<T, N, F>,
        configuration: &Configuration<T, N>,
        velocity: &Tangent<T, N>,
        torques: &[T; N],
        sensors: &[T; F],
        dt: T,
    ) {
        let limbs = Limbs::new(model, configuration, &self.observer.feet);
        self.update_at(model, state, &limbs, velocity, torques, sensors, dt);
    }

    /// [`Detector::update`] where the legs are known already: `limbs` of the observer's feet.
    #[expect(
        clippy::too_many_arguments,
        reason = "each is a separate thing the caller knows"
    )]
    pub fn update_at<M: Tree<T, N>>(
        &self,
        model: &M,
        state: &mut DetectorState<T, N, F>,
        limbs: &Limbs<T, N, F>,
        velocity: &Tangent<T, N>,
        torques: &[T; N],
        sensors: &[T; F],
        dt: T,
    ) {
        self.filter.update(&mut state.sensors, sensors, dt);
        let Some(forces) =
            self.observer
                .update_at(model, &mut state.observer, limbs, velocity, torques, dt)
        else {
            state.contacts = state.sensors.contacts;
            return;
        };
        let carried = forces.map(|f| f.z);
        let slots = state.carrying.iter_mut().zip(&mut state.doubt);
        let feet = slots
            .zip(&mut state.faulty)
            .zip(carried.iter().zip(sensors));
        for (((carrying, doubt), faulty), (carried, sensor)) in feet {
            *carrying = if *carried >= self.loaded {
                math::min(*carrying + dt, self.confirm)
            } else {
                T::ZERO
            };
            let says = *sensor >= self.filter.threshold;
            let denied = (says && *carried < self.unloaded) || (!says && *carried >= self.loaded);
            let twice = self.patience * T::TWO;
            *doubt = if denied {
                math::min(*doubt + dt, twice)
            } else {
                math::max(*doubt - dt * T::of(0.25), T::ZERO)
            };
            // Doubted at the limit, believed again only when nothing is left of it.
            *faulty = *doubt >= self.patience || (*faulty && *doubt > T::ZERO);
        }
        // What is felt is debounced like a sensor, with "certainly carries" for its threshold.
        let felt = ContactFilter {
            threshold: T::HALF,
            ..self.filter
        };
        let certain = state.carrying.map(|time| {
            if time >= self.confirm {
                T::ONE
            } else {
                T::ZERO
            }
        });
        felt.update(&mut state.felt, &certain, dt);
        let said = state.sensors.contacts.iter().zip(&state.faulty);
        let feet = said.zip(&state.felt.contacts);
        for (contact, ((said, faulty), felt)) in state.contacts.iter_mut().zip(feet) {
            *contact = *felt || (*said && !*faulty);
        }
    }
}
