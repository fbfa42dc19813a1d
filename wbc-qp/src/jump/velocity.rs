//! The velocity controller: posture and continuity, paper B eq. (3a); centre of mass, eq. (3b); feet at rest, eq. (3c);
//! angular momentum, eq. (3d), driven to zero with its integral as in eq. (4); joint limits, eq. (3e).

use nalgebra::Vector3;
use rbd_core::{JointLimits, Tree};
use so3::Scalar;

use super::{ComReference, Residuals, distance};
use crate::task::position_error;
use crate::{Contact, Error, Horizon, Snapshot, VelocityQp};

/// Gains and weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityJumpSettings<T, const N: usize> {
    /// K of eq. (3b), 1/s.
    pub com_gain: T,
    /// K of eq. (3d), 1/s: on the integral of the angular momentum.
    pub momentum_gain: T,
    /// `K_p` of the posture, ṡ* = −K_p (s − s_d), 1/s.
    pub posture_gain: T,
    /// Λ of eq. (3a), per joint.
    pub posture_weight: [T; N],
    /// Δ of eq. (3a), per joint.
    pub continuity_weight: [T; N],
    /// Weight of the centre of mass's rows, per (m/s)².
    pub com_weight: T,
    /// Weight of the angular momentum's rows, per (kg m²/s)²; zero leaves eq. (3d) out.
    pub momentum_weight: T,
    /// How limits act.
    pub horizon: Horizon<T>,
}

impl<const N: usize> VelocityJumpSettings<f64, N> {
    /// The same in either precision.
    #[must_use]
    pub fn cast<T: Scalar>(&self) -> VelocityJumpSettings<T, N> {
        VelocityJumpSettings {
            com_gain: T::of(self.com_gain),
            momentum_gain: T::of(self.momentum_gain),
            posture_gain: T::of(self.posture_gain),
            posture_weight: self.posture_weight.map(T::of),
            continuity_weight: self.continuity_weight.map(T::of),
            com_weight: T::of(self.com_weight),
            momentum_weight: T::of(self.momentum_weight),
            horizon: self.horizon.cast(),
        }
    }
}

/// The controller with its memory.
#[derive(Clone, Debug)]
pub struct VelocityJump<T: Scalar, const N: usize, const V: usize, const M: usize> {
    /// Gains and weights.
    pub settings: VelocityJumpSettings<T, N>,
    /// s_d: the posture to stay near.
    pub posture: [T; N],
    qp: VelocityQp<T, N, V, M>,
    previous: [T; N],
    momentum_integral: Vector3<T>,
}

/// The result of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityTick<T, const N: usize> {
    /// ṡ, the command.
    pub velocities: [T; N],
    /// How far the paper's equalities were from holding.
    pub residuals: Residuals<T>,
    /// Iterations of the solver.
    pub iterations: u32,
}

impl<T: Scalar, const N: usize, const V: usize, const M: usize> VelocityJump<T, N, V, M> {
    /// At rest in a posture.
    #[must_use]
    pub fn new(settings: VelocityJumpSettings<T, N>, posture: [T; N]) -> Self {
        Self {
            settings,
            posture,
            qp: VelocityQp::new(),
            previous: [T::ZERO; N],
            momentum_integral: Vector3::zeros(),
        }
    }

    /// At rest again in a posture: velocities and momentum of earlier ticks are forgotten.
    pub fn restart(&mut self, posture: &[T; N]) {
        self.posture = *posture;
        self.previous = [T::ZERO; N];
        self.momentum_integral = Vector3::zeros();
    }

    /// The program of the last tick: for a log, or another solver's opinion.
    #[must_use]
    pub const fn program(&self) -> &VelocityQp<T, N, V, M> {
        &self.qp
    }

    /// One tick of length `dt`.
    ///
    /// # Errors
    /// As [`VelocityQp::solve`]; the command is then to stand still.
    pub fn tick<R: Tree<T, N>>(
        &mut self,
        model: &R,
        snapshot: &Snapshot<T, N>,
        contacts: &[Contact<T>],
        limits: &[JointLimits<T>; N],
        wanted: &ComReference<T>,
        dt: T,
    ) -> Result<VelocityTick<T, N>, Error> {
        let s = &self.settings;
        self.momentum_integral += snapshot.momentum_w.angular * dt;
        self.qp.begin(model, snapshot, contacts)?; // (3c)
        let com = snapshot.com(); // (3b)
        let error = position_error(&wanted.position_w, &snapshot.com_w());
        let com_target = com.velocity(wanted.velocity_w.into(), error, s.com_gain);
        self.qp.minimise(&com, &com_target, &[s.com_weight; 3]);
        let momentum = snapshot.angular_momentum(); // (3d)
        let momentum_target = (-self.momentum_integral * s.momentum_gain).into();
        let weight = [s.momentum_weight; 3];
        self.qp.minimise(&momentum, &momentum_target, &weight);
        let mut posture = self.posture; // (3a)
        for (x, q) in posture.iter_mut().zip(&snapshot.configuration.joints) {
            *x = s.posture_gain * (*x - *q);
        }
        self.qp.minimise_joints(&posture, &s.posture_weight);
        self.qp
            .minimise_joints(&self.previous, &s.continuity_weight);
        self.qp.limit_joints(snapshot, limits, &s.horizon); // (3e)
        let answer = self.qp.solve()?;
        self.previous = answer.velocity.joints;
        Ok(VelocityTick {
            velocities: answer.velocity.joints,
            residuals: Residuals {
                com: distance(&com.of(&answer.velocity), &com_target),
                momentum: distance(&momentum.of(&answer.velocity), &momentum_target),
            },
            iterations: answer.iterations,
        })
    }
}
