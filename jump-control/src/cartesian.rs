//! The Cartesian PD at 1 kHz: τ_ff = J(q)ᵀ[K_p(p_d − p) + K_d(v_d − v)] + τ_d (paper A, section IV).
//!
//! Feet are seen from the base, which moves rigidly with the hips; p_d and v_d are the forward kinematics of the
//! reference joints, so a plan need not carry them.

use nalgebra::Vector3;
use rbd_core::{Build, Configuration, Frame, Limbs, Tree};
use so3::Scalar;

use crate::joint::JointGains;
use crate::sample::Reference;
use crate::{JointCommand, Measurement};

/// Diagonal gains of the foot controller, base axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartesianGains<T> {
    /// `K_p`, N/m.
    pub stiffness: [T; 3],
    /// `K_d`, N s/m.
    pub damping: [T; 3],
}

/// The foot controller of a robot with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartesianPd<T, const N: usize, const F: usize> {
    /// The feet.
    pub feet: [Frame<T>; F],
    /// Gains of each foot.
    pub gains: CartesianGains<T>,
    /// Gains handed on to the joint controller.
    pub joint_gains: [JointGains<T>; N],
}

impl<T: Scalar, const N: usize, const F: usize> CartesianPd<T, N, F> {
    /// Gains for a robot of this size, by [dynamic similarity](rbd_core::similarity) from those with which A1's jumps were measured
    /// (`saltus verdicts`): 200 N/m and 5 N s/m on feet, 60 N m/rad and 1.5 N m s/rad on joints.
    #[must_use]
    pub fn new(build: &Build<T>, feet: [Frame<T>; F]) -> Self {
        Self {
            feet,
            gains: CartesianGains {
                stiffness: [build.stiffness(200.0); 3],
                damping: [build.damping(5.0); 3],
            },
            joint_gains: [JointGains {
                stiffness: build.joint_stiffness(60.0),
                damping: build.joint_damping(1.5),
            }; N],
        }
    }

    /// The command of one 1 kHz tick: torques and joint targets of the `reference` for now, feet as measured compared with it.
    #[must_use]
    pub fn command<M: Tree<T, N>>(
        &self,
        model: &M,
        measured: &Measurement<T, N, F>,
        reference: &Reference<T, N>,
    ) -> JointCommand<T, N> {
        let seen = |joints: &[T; N]| {
            let q = Configuration {
                joints: *joints,
                ..Configuration::NEUTRAL
            };
            Limbs::new(model, &q, &self.feet)
        };
        let (now, wanted) = (seen(&measured.joints), seen(&reference.joints));
        self.command_at(&now, &wanted, &measured.joint_velocities, reference)
    }

    /// [`CartesianPd::command`] where the legs are known already: those of [`CartesianPd::feet`] as measured, and as the reference
    /// has them.
    #[must_use]
    pub fn command_at(
        &self,
        now: &Limbs<T, N, F>,
        wanted: &Limbs<T, N, F>,
        joint_velocities: &[T; N],
        reference: &Reference<T, N>,
    ) -> JointCommand<T, N> {
        let mut feed_forward = reference.torques;
        let (kp, kd) = (
            Vector3::from(self.gains.stiffness),
            Vector3::from(self.gains.damping),
        );
        for (end, wanted) in now.ends.iter().zip(&wanted.ends) {
            let position = wanted.position - end.position;
            let velocity = wanted.mul(&reference.joint_velocities) - end.mul(joint_velocities);
            let pull = kp.component_mul(&position) + kd.component_mul(&velocity);
            end.add_tr_mul(&pull, &mut feed_forward);
        }
        JointCommand {
            position: reference.joints,
            velocity: reference.joint_velocities,
            feed_forward,
            gains: self.joint_gains,
        }
    }
}
