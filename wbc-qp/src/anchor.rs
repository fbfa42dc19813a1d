//! The base's state from joints alone, while a foot neither slides nor turns: how paper B estimates its centre of mass
//! in the push-off.

use rbd_core::{
    BodyMotions, Configuration, Frame, Kinematics, Motion, Posture, Tangent, Transform, Tree,
    forward_kinematics, forward_velocities,
};
use so3::Scalar;

/// Configuration and velocity of a robot whose frame `foot` rests at the pose `xf_wf`.
///
/// T_wb = T_wf T_bf⁻¹ and, with V_f the velocity that the joints alone give the frame, v_b = −Ad(T_bf) V_f.
#[must_use]
pub fn anchored<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    joints: &[T; N],
    joint_velocities: &[T; N],
    foot: &Frame<T>,
    xf_wf: &Transform<T>,
) -> (Configuration<T, N>, Tangent<T, N>) {
    let mut configuration = Configuration {
        base: Transform::IDENTITY,
        joints: *joints,
    };
    let mut velocity = Tangent {
        base: Motion::ZERO,
        joints: *joint_velocities,
    };
    let posture = Posture::new(model, &configuration);
    let mut kinematics = Kinematics::IDENTITY;
    let mut motions = BodyMotions::ZERO;
    forward_kinematics(model, &posture, &mut kinematics);
    forward_velocities(model, &posture, &velocity, &mut motions);
    let xf_bf = kinematics.frame(foot);
    configuration.base = xf_wf.compose(&xf_bf.inverse());
    velocity.base = -xf_bf.motion(&motions.frame_velocity(foot));
    (configuration, velocity)
}
