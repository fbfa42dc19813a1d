//! The Cartesian PD at 1 kHz: τ_ff = J(q)ᵀ[K_p(p_d − p) + K_d(v_d − v)] + τ_d (paper A, section IV).
//!
//! Feet are seen from the base, which moves rigidly with the hips; p_d and v_d are the forward kinematics of the
//! reference joints, so a plan need not carry them.

use nalgebra::Vector3;
use rbd_core::algo::motion::Axes;
use rbd_core::{
    Configuration, Force, Frame, FrameJacobian, Kinematics, Posture, Transform, Tree,
    forward_kinematics, frame_jacobian,
};
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
    /// Gains with which A1's jumps were measured: 200 N/m and 5 N s/m on feet, 60 N m/rad and 1.5 N m s/rad on joints.
    #[must_use]
    pub fn a1(feet: [Frame<T>; F]) -> Self {
        Self {
            feet,
            gains: CartesianGains {
                stiffness: [T::of(200.0); 3],
                damping: [T::of(5.0); 3],
            },
            joint_gains: [JointGains {
                stiffness: T::of(60.0),
                damping: T::of(1.5),
            }; N],
        }
    }

    /// The command of one 1 kHz tick: torques and joint targets of the `reference` for now, feet compared with the reference `then`,
    /// for when the measurement was taken. Feedback on late sensors must not answer for the plan's own motion.
    #[must_use]
    pub fn command<M: Tree<T, N>>(
        &self,
        model: &M,
        measured: &Measurement<T, N, F>,
        reference: &Reference<T, N>,
        then: &Reference<T, N>,
    ) -> JointCommand<T, N> {
        let seen = |joints: &[T; N]| {
            let q = Configuration {
                base: Transform::IDENTITY,
                joints: *joints,
            };
            let mut kinematics = Kinematics::IDENTITY;
            forward_kinematics(model, &Posture::new(model, &q), &mut kinematics);
            kinematics
        };
        let (now, wanted) = (seen(&measured.joints), seen(&then.joints));
        let (mut j, mut j_d) = (FrameJacobian::ZERO, FrameJacobian::ZERO);
        let mut feed_forward = reference.torques;
        let (kp, kd) = (
            Vector3::from(self.gains.stiffness),
            Vector3::from(self.gains.damping),
        );
        for foot in &self.feet {
            frame_jacobian(model, &now, foot, Axes::LocalWorldAligned, &mut j);
            frame_jacobian(model, &wanted, foot, Axes::LocalWorldAligned, &mut j_d);
            let position = wanted.frame(foot).translation - now.frame(foot).translation;
            let velocity =
                speed(&j_d, &then.joint_velocities) - speed(&j, &measured.joint_velocities);
            let pull = kp.component_mul(&position) + kd.component_mul(&velocity);
            let effort = j.tr_mul(&Force::new(pull, Vector3::zeros()));
            for (tau, x) in feed_forward.iter_mut().zip(effort.joints) {
                *tau += x;
            }
        }
        JointCommand {
            position: reference.joints,
            velocity: reference.joint_velocities,
            feed_forward,
            gains: self.joint_gains,
        }
    }
}

/// Velocity of the foot from joint velocities alone.
fn speed<T: Scalar, const N: usize>(j: &FrameJacobian<T, N>, qd: &[T; N]) -> Vector3<T> {
    j.joints
        .iter()
        .zip(qd)
        .fold(Vector3::zeros(), |v, (column, x)| v + column.linear * *x)
}
