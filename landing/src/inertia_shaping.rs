//! Turning on time: legs drawn in or stretched while the robot flies.
//!
//! In the air the angular momentum stays what it was at take-off, and one per cent of it is seven degrees after two turns. A body that
//! turns too slowly is helped by less inertia, as a skater is. A foot at r moves by −σ (r − (r·n) n), n the axis of turning, towards
//! the axis for σ > 0, and σ̇ = k (θ/T + ω_d − ω)/ω: θ the angle by which the body is behind, T the time left, ω_d and ω the planned
//! and the measured rate. So the rate that is missing is found without knowing the inertia.

use nalgebra::Vector3;
use rbd_core::{Build, Limbs};
use so3::{Scalar, math};

use crate::least_squares::solve_damped;

/// How legs help a body to turn on time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertiaShaping<T> {
    /// k, 1/s; zero leaves the legs where the plan has them.
    pub gain: T,
    /// Largest share σ, either way, of its distance from the axis by which a foot moves.
    pub most: T,
    /// Slowest turning that is helped, rad/s.
    pub slowest: T,
    /// Time in which the legs are let go before they are needed, and taken after take-off, s.
    pub ramp: T,
    /// Tikhonov term on the way of a foot, m²: keeps stretched legs from large motions.
    pub damping: T,
}

/// What the body's turning is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning<T: Scalar> {
    /// Rotation from where the body is to where it should be, base axes, rad.
    pub missing_b: Vector3<T>,
    /// Planned angular velocity, base axes, rad/s.
    pub planned_b: Vector3<T>,
    /// Measured angular velocity, base axes, rad/s.
    pub omega_b: Vector3<T>,
    /// Time since take-off, s.
    pub since: T,
    /// Time until the legs must be where the plan has them, s.
    pub left: T,
}

impl<T: Scalar> InertiaShaping<T> {
    /// For a robot of this size, by [dynamic similarity](rbd_core::similarity): at most a fifth of the distance, which legs of any
    /// length can do; turning slower than 3 rad/s on legs of 0.4 m is left alone.
    ///
    /// Measured on A1's double backflip: `saltus envelope a1/double-backflip --without inertia-shaping` shows what it is worth.
    #[must_use]
    pub fn new(build: &Build<T>) -> Self {
        Self {
            gain: build.rate(20.0),
            most: T::of(0.2),
            slowest: build.rate(3.0),
            ramp: build.time(0.1),
            damping: build.area(1e-3),
        }
    }

    /// The share σ, `dt` after it was `share`.
    #[must_use]
    pub fn share(&self, share: T, turning: &Turning<T>, dt: T) -> T {
        let rate = math::sqrt(turning.omega_b.norm_squared());
        // Also false for NaN.
        if !(rate > self.slowest && turning.left > self.ramp) {
            return share;
        }
        let along = |x: &Vector3<T>| x.dot(&turning.omega_b) / rate;
        let wanted = along(&turning.missing_b) / turning.left + along(&turning.planned_b);
        let next = share + self.gain * dt * (wanted - rate) / rate;
        if next.is_finite_number() {
            math::clamp(next, -self.most, self.most)
        } else {
            share
        }
    }

    /// Joint displacements that move the feet so, to first order, rad; `limbs` are those of the legs before.
    #[must_use]
    pub fn joints<const N: usize, const F: usize>(
        &self,
        share: T,
        turning: &Turning<T>,
        limbs: &Limbs<T, N, F>,
    ) -> [T; N] {
        let mut joints = [T::ZERO; N];
        let near = math::min(turning.since, turning.left) / self.ramp;
        let share = share * math::clamp(near, T::ZERO, T::ONE);
        let squared = turning.omega_b.norm_squared();
        // Also false for NaN.
        if !(squared > self.slowest * self.slowest && share.is_finite_number()) || share == T::ZERO
        {
            return joints;
        }
        for end in &limbs.ends {
            let foot = &end.position;
            let along = turning.omega_b * (foot.dot(&turning.omega_b) / squared);
            let way = (along - foot) * share;
            end.add_tr_mul(&solve_damped(end, self.damping, &way), &mut joints);
        }
        if joints.iter().all(|q| q.is_finite_number()) {
            joints
        } else {
            [T::ZERO; N]
        }
    }
}
