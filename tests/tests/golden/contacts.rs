//! Dynamics and impacts with feet held, and forces from outside.

use nalgebra::Rotation3;
use rbd_core::{
    AbaWorkspace, Axes, BodyMotions, ContactRow, ContactWorkspace, Effort, Force, Frame,
    FrameJacobian, Kinematics, Link, MassFactors, MassMatrix, Posture, Tangent, Transform, Tree,
};
use saltus_tests::golden::Record;
use so3::Scalar;

use crate::{Entries as _, Worst, motion};

/// Every foot held: points for A1, soles for iCub. Wrenches from outside on the feet.
#[allow(clippy::too_many_arguments, reason = "one state in all its parts")]
pub(crate) fn contacts<T: Scalar, M: Tree<T, N>, const N: usize>(
    w: &mut Worst,
    model: &M,
    feet: &[(&str, Frame<T>)],
    state: &Record,
    posture: &Posture<T, N>,
    v: &Tangent<T, N>,
    a: &Tangent<T, N>,
    tau: &Effort<T, N>,
) {
    let mut mass = MassMatrix::ZERO;
    rbd_core::crba(model, posture, &mut mass);
    let mut factors = MassFactors::new();
    factors.factor(model, &mass);
    let mut kinematics = Kinematics::IDENTITY;
    rbd_core::forward_kinematics(model, posture, &mut kinematics);
    let mut bias = BodyMotions::ZERO;
    rbd_core::bias_accelerations(model, posture, v, &mut bias);
    let mut rows = Vec::new();
    let mut jacobian = FrameJacobian::ZERO;
    let mut forces = [Force::ZERO; N];
    for (name, foot) in feet {
        let axes = Axes::LocalWorldAligned;
        rbd_core::frame_jacobian(model, &kinematics, foot, axes, &mut jacobian);
        let xf_wf = kinematics.frame(foot);
        let drift = axes.motion(&xf_wf, &bias.frame_classical_acceleration(foot));
        rows.extend_from_slice(&ContactRow::surface(&jacobian, &drift)[..12 / feet.len()]);
        // From world axes at the foot to the frame of its body.
        let wrench = motion::<T>(state.values(&format!("external.{name}")));
        let aligned = Transform::new(Rotation3::identity(), xf_wf.translation);
        let wrench_w = aligned.force(&Force::new(wrench.linear, wrench.angular));
        if let Link::Joint(i) = foot.link {
            forces[i] = kinematics.bodies[i].inverse_force(&wrench_w);
        }
    }
    let free = rbd_core::aba(model, posture, v, tau, &mut AbaWorkspace::new());
    let mut ws = ContactWorkspace::<T, N, 12>::new();
    let held = rbd_core::contact_dynamics(&factors, &free, &rows, &mut ws);
    w.see(state, "constrained.acceleration", held.motion.entries());
    w.see(state, "constrained.force", held.forces);
    let after = rbd_core::impact(&factors, v, T::ZERO, &rows, &mut ws);
    w.see(state, "impulse.velocity", after.motion.entries());
    w.see(state, "impulse.impulse", after.forces);
    let effort = rbd_core::rnea_with_forces(model, posture, v, a, &Force::ZERO, &forces);
    w.see(state, "external.tau", effort.entries());
}
