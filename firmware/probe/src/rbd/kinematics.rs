//! Poses, velocities, accelerations and Jacobians.

use rbd_core::{
    Axes, BodyMotions, Frame, FrameJacobian, Kinematics, Limbs, Motion, Posture, Tree,
    bias_accelerations, forward_accelerations, forward_kinematics, forward_velocities,
    frame_jacobian, joint_jacobians,
};

use super::state::State;
use crate::{Real, Recorder, Subject};

/// What later calls need to know of a frame on the moving robot.
pub(super) struct Place<'a, T: Real, const N: usize> {
    pub(super) frame: &'a Frame<T>,
    pub(super) poses: Kinematics<T, N>,
    pub(super) motions: BodyMotions<T, N>,
    /// Local-world-aligned.
    pub(super) jacobian: FrameJacobian<T, N>,
    /// Classical acceleration of the frame at rest of the joints, J̇ν.
    pub(super) bias: Motion<T>,
}

pub(super) fn run<'a, T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
    frame: &'a Frame<T>,
) -> Place<'a, T, N> {
    let mut poses = Kinematics::IDENTITY;
    on.call(
        "forward_kinematics",
        (model, posture, &mut poses),
        |(m, p, out)| {
            forward_kinematics(m, p, out);
            &*out
        },
    );
    on.call("Kinematics::frame", (&poses, frame), |(poses, frame)| {
        poses.frame(frame)
    });
    on.call("Kinematics::link", (&poses, frame.link), |(poses, link)| {
        poses.link(link)
    });
    let (motions, bias) = motions(on, model, posture, state, frame);
    let jacobian = jacobians::<T, R, M, N, V>(on, model, &poses, state, frame);
    Place {
        frame,
        poses,
        motions,
        jacobian,
        bias,
    }
}

fn motions<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    posture: &Posture<T, N>,
    state: &State<T, N>,
    frame: &Frame<T>,
) -> (BodyMotions<T, N>, Motion<T>) {
    let State {
        velocity,
        acceleration,
        ..
    } = state;
    let at = (model, posture);
    let mut motions = BodyMotions::ZERO;
    on.call(
        "forward_velocities",
        (at, velocity, &mut motions),
        |((m, p), v, out)| {
            forward_velocities(m, p, v, out);
            &*out
        },
    );
    on.call(
        "bias_accelerations",
        (at, velocity, &mut motions),
        |((m, p), v, out)| {
            bias_accelerations(m, p, v, out);
            &*out
        },
    );
    let bias = on.call(
        "BodyMotions::frame_classical_acceleration",
        (&motions, frame),
        |(x, frame)| x.frame_classical_acceleration(frame),
    );
    let moving = (at, velocity, acceleration, &mut motions);
    on.call("forward_accelerations", moving, |((m, p), v, a, out)| {
        forward_accelerations(m, p, v, a, out);
        &*out
    });
    let place = (&motions, frame);
    on.call("BodyMotions::frame_velocity", place, |(x, frame)| {
        x.frame_velocity(frame)
    });
    on.call("BodyMotions::frame_acceleration", place, |(x, frame)| {
        x.frame_acceleration(frame)
    });
    (motions, bias)
}

fn jacobians<T: Real, R: Recorder, M: Tree<T, N>, const N: usize, const V: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    poses: &Kinematics<T, N>,
    state: &State<T, N>,
    frame: &Frame<T>,
) -> FrameJacobian<T, N> {
    let mut jacobian = FrameJacobian::ZERO;
    for axes in [Axes::World, Axes::Local, Axes::LocalWorldAligned] {
        let input = (model, poses, frame, axes, &mut jacobian);
        on.call("frame_jacobian", input, |(m, poses, frame, axes, out)| {
            frame_jacobian(m, poses, frame, axes, out);
            &*out
        });
        let moved = (axes, &poses.base, &state.velocity.base);
        on.call("Axes::motion", moved, |(axes, pose, motion)| {
            axes.motion(pose, motion)
        });
    }
    on.call(
        "FrameJacobian::mul",
        (&jacobian, &state.velocity),
        |(j, v)| j.mul(v),
    );
    on.call(
        "FrameJacobian::tr_mul",
        (&jacobian, &state.base_force),
        |(j, f)| j.tr_mul(f),
    );
    on.call("FrameJacobian::to_dense", &jacobian, |j| j.to_dense::<V>());
    let mut columns = [Motion::ZERO; N];
    on.call(
        "joint_jacobians",
        (model, poses, &mut columns),
        |(m, poses, out)| {
            joint_jacobians(m, poses, out);
            &*out
        },
    );
    limbs(on, model, state, frame);
    jacobian
}

fn limbs<T: Real, R: Recorder, M: Tree<T, N>, const N: usize>(
    on: &mut Subject<'_, T, R>,
    model: &M,
    state: &State<T, N>,
    frame: &Frame<T>,
) {
    let (q, joints) = (&state.configuration, &state.velocity.joints);
    let at = (model, q, [*frame]);
    let limbs = on.call("Limbs::new", at, |(m, q, frames)| Limbs::new(m, q, &frames));
    let Some(end) = limbs.ends.first() else {
        return;
    };
    let speed = on.call("LimbEnd::mul", (end, joints), |(end, qd)| end.mul(qd));
    on.call("LimbEnd::add_tr_mul", (end, speed), |(end, f)| {
        let mut torques = [T::ZERO; N];
        end.add_tr_mul(&f, &mut torques);
        torques
    });
    on.call("LimbEnd::columns", end, |end| end.columns().count() > 0);
}
