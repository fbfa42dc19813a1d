//! Forces on the feet without foot sensors.
//!
//! The joints' equations of motion give r = rnea(q, ν, ν̇) − τ = Σ Jᵀ f, with ν̇ from two successive velocities.
//! A first-order low pass makes the differences usable: that is the generalised-momentum observer to first order in the
//! period. The force of a leg is the least-squares solution of Jᵀ f = r over the joints that move its foot.

use nalgebra::Vector3;
use rbd_core::{Build, Configuration, Frame, Limbs, Tangent, Tree, rnea};
use so3::{Scalar, math};

use crate::least_squares::solve_damped;
use crate::touchdown::is_step;

/// The observer of a robot with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceObserver<T, const N: usize, const F: usize> {
    /// The feet; each is the end of a leg of its own.
    pub feet: [Frame<T>; F],
    /// Time constant of the low pass, s.
    pub time_constant: T,
    /// Tikhonov term on the force, m²: keeps a stretched leg from seeing endless forces along itself.
    pub damping: T,
    /// A torque beyond which a sample is no measurement, N m.
    pub max_torque: T,
}

/// Memory of the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverState<T: Scalar, const N: usize> {
    residual: [T; N],
    last: Option<Tangent<T, N>>,
}

impl<T: Scalar, const N: usize> ObserverState<T, N> {
    /// Jᵀ f of the ground as the joints feel it, low-passed, N m.
    #[must_use]
    pub const fn residual(&self) -> &[T; N] {
        &self.residual
    }

    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            residual: [T::ZERO; N],
            last: None,
        }
    }
}

impl<T: Scalar, const N: usize> Default for ObserverState<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Scalar, const N: usize, const F: usize> ForceObserver<T, N, F> {
    /// 6 ms, a matter of encoders and so the same for all robots; and, for a robot of 13.741 kg with legs of 0.4 m, 1e-3 m² and 10 kN m,
    /// scaled by [dynamic similarity](rbd_core::similarity).
    #[must_use]
    pub fn new(build: &Build<T>, feet: [Frame<T>; F]) -> Self {
        Self {
            feet,
            time_constant: T::of(0.006),
            damping: build.area(1e-3),
            max_torque: build.torque(1e4),
        }
    }

    /// One tick of `dt` seconds: state, and the torques that the joints had since the last tick, friction included.
    /// Gives the force of the ground on each foot, world axes, N; `None` on the first tick and where numbers are impossible,
    /// after which it starts anew.
    pub fn update<M: Tree<T, N>>(
        &self,
        model: &M,
        state: &mut ObserverState<T, N>,
        configuration: &Configuration<T, N>,
        velocity: &Tangent<T, N>,
        torques: &[T; N],
        dt: T,
    ) -> Option<[Vector3<T>; F]> {
        let limbs = Limbs::new(model, configuration, &self.feet);
        self.update_at(model, state, &limbs, velocity, torques, dt)
    }

    /// [`ForceObserver::update`] where the legs are known already: `limbs` of [`ForceObserver::feet`].
    pub fn update_at<M: Tree<T, N>>(
        &self,
        model: &M,
        state: &mut ObserverState<T, N>,
        limbs: &Limbs<T, N, F>,
        velocity: &Tangent<T, N>,
        torques: &[T; N],
        dt: T,
    ) -> Option<[Vector3<T>; F]> {
        if !is_step(dt) {
            *state = ObserverState::new();
            return None;
        }
        let last = state.last.replace(*velocity);
        let acceleration = (*velocity + last? * -T::ONE) * (T::ONE / dt);
        let needed = rnea(model, &limbs.posture, velocity, &acceleration).joints;
        let mut residual = state.residual;
        let share = dt / (self.time_constant + dt);
        let mut sane = true;
        for ((r, needed), tau) in residual.iter_mut().zip(needed).zip(torques) {
            let now = needed - *tau;
            // False for NaN.
            sane &= math::abs(now) <= self.max_torque;
            *r += share * (now - *r);
        }
        if !sane || !residual.iter().all(|r| r.is_finite_number()) {
            *state = ObserverState::new();
            return None;
        }
        state.residual = residual;
        let rot_wb = &limbs.posture.base().rotation;
        let mut forces = [Vector3::zeros(); F];
        for (force, end) in forces.iter_mut().zip(&limbs.ends) {
            // J r: the right-hand side of the normal equations.
            let right = end.mul(&residual);
            *force = rot_wb * solve_damped(end, self.damping, &right);
        }
        let finite = forces.iter().flat_map(|f| f.iter());
        { finite }.all(|x| x.is_finite_number()).then_some(forces)
    }
}
