//! Derivatives of the velocity and acceleration of a frame.
//!
//! With S the axis of a joint that moves the frame, Ṡ = v × S, S̈ = a × S + v × Ṡ (v, a of the joint's own
//! body), and v_f the velocity of the frame, all in the axes of the frame, the columns of that joint are
//!
//! - ∂v_f/∂q = Ṡ, ∂v_f/∂q̇ = S;
//! - ∂a_f/∂q = S̈ + Ṡ × v_f, ∂a_f/∂q̇ = 2 Ṡ + S × v_f, ∂a_f/∂q̈ = S.
//!
//! A displacement of the base changes nothing of this, since the motion of the base is given in base axes;
//! for the base's velocity, ∂a_f/∂ν = (v_b − v_f) × e for each unit motion e of the base. The classical acceleration
//! a + ω × v adds ∂ω × v + ω × ∂v. In other axes x = X x_f, each column gains from the turning of the frame:
//! ∂x = X (∂x_f + J × x_f) about the world's origin, and its rotational part about the frame's own.
//!
//! Source: the spatial derivatives of Singh, Russell, Wensing 2022, RA-L, put into the moving frame.

use nalgebra::Vector3;
use so3::Scalar;

use super::jacobian::{FrameJacobian, columns};
use super::kinematics::Kinematics;
use super::motion::{Axes, BodyMotions};
use super::{at, put};
use crate::model::{Body, Frame, Link};
use crate::spatial::{Motion, Transform};
use crate::tree::Tree;

/// Which acceleration of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccelerationKind {
    /// Rate of the coordinates of the frame's velocity in the frame itself.
    Spatial,
    /// That of the material point at the frame's origin, a + ω × v.
    Classical,
}

/// Derivatives of a frame's velocity and acceleration, 6 × (6 + N) each, by columns.
///
/// To first order, dv = `velocity_by_position` dq + `jacobian` dν and da = `acceleration_by_position` dq
/// + `acceleration_by_velocity` dν + `jacobian` dν̇.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameDerivatives<T, const N: usize> {
    /// ∂v/∂ν = ∂a/∂ν̇ = J.
    pub jacobian: FrameJacobian<T, N>,
    /// ∂v/∂q.
    pub velocity_by_position: FrameJacobian<T, N>,
    /// ∂a/∂q.
    pub acceleration_by_position: FrameJacobian<T, N>,
    /// ∂a/∂ν.
    pub acceleration_by_velocity: FrameJacobian<T, N>,
}

impl<T: Scalar, const N: usize> FrameDerivatives<T, N> {
    /// All zero: only storage.
    pub const ZERO: Self = Self {
        jacobian: FrameJacobian::ZERO,
        velocity_by_position: FrameJacobian::ZERO,
        acceleration_by_position: FrameJacobian::ZERO,
        acceleration_by_velocity: FrameJacobian::ZERO,
    };
}

impl<T: Scalar, const N: usize> FrameDerivatives<T, N> {
    #[inline(always)]
    fn set_base(&mut self, k: usize, columns: Columns<T>) {
        put(&mut self.jacobian.base, k, columns.jacobian);
        put(
            &mut self.velocity_by_position.base,
            k,
            columns.velocity_by_position,
        );
        put(
            &mut self.acceleration_by_position.base,
            k,
            columns.acceleration_by_position,
        );
        put(
            &mut self.acceleration_by_velocity.base,
            k,
            columns.acceleration_by_velocity,
        );
    }

    #[inline(always)]
    fn set_joint(&mut self, j: usize, columns: Columns<T>) {
        put(&mut self.jacobian.joints, j, columns.jacobian);
        put(
            &mut self.velocity_by_position.joints,
            j,
            columns.velocity_by_position,
        );
        put(
            &mut self.acceleration_by_position.joints,
            j,
            columns.acceleration_by_position,
        );
        put(
            &mut self.acceleration_by_velocity.joints,
            j,
            columns.acceleration_by_velocity,
        );
    }
}

/// The four columns of one coordinate.
#[derive(Clone, Copy)]
struct Columns<T> {
    jacobian: Motion<T>,
    velocity_by_position: Motion<T>,
    acceleration_by_position: Motion<T>,
    acceleration_by_velocity: Motion<T>,
}

/// The frame whose derivatives are asked for, and how.
struct Observer<T: Scalar> {
    xf_wf: Transform<T>,
    velocity_f: Motion<T>,
    /// The acceleration asked for.
    acceleration_f: Motion<T>,
    kind: AccelerationKind,
    axes: Axes,
}

impl<T: Scalar> Observer<T> {
    /// From the axes of the frame to those asked for.
    #[inline(always)]
    fn expressed(&self, columns: Columns<T>) -> Columns<T> {
        let Columns {
            jacobian: j,
            velocity_by_position: vq,
            acceleration_by_position: mut aq,
            acceleration_by_velocity: mut av,
        } = columns;
        let v = &self.velocity_f;
        if self.kind == AccelerationKind::Classical {
            aq.linear += vq.angular.cross(&v.linear) + v.angular.cross(&vq.linear);
            av.linear += j.angular.cross(&v.linear) + v.angular.cross(&j.linear);
        }
        let turn = match self.axes {
            Axes::Local => Motion::ZERO,
            Axes::World => j,
            Axes::LocalWorldAligned => Motion::new(Vector3::zeros(), j.angular),
        };
        let give = |m: &Motion<T>| self.axes.motion(&self.xf_wf, m);
        Columns {
            jacobian: give(&j),
            velocity_by_position: give(&(vq + turn.cross(v))),
            acceleration_by_position: give(&(aq + turn.cross(&self.acceleration_f))),
            acceleration_by_velocity: give(&av),
        }
    }
}

/// Axis of a joint in its body's frame, with the sign of the robot's own coordinate.
#[inline(always)]
fn axis_in_body<T: Scalar>(body: &Body<T>) -> Motion<T> {
    let z = Vector3::z() * body.sign;
    let axis = match body.kind.axis() {
        0 => Vector3::new(z.z, z.x, z.y),
        1 => Vector3::new(z.x, z.z, z.y),
        _ => z,
    };
    if body.kind.is_revolute() {
        Motion::new(Vector3::zeros(), axis)
    } else {
        Motion::new(axis, Vector3::zeros())
    }
}

/// Derivatives of the velocity of a frame, and of its spatial or classical acceleration, with respect to
/// configuration, velocity and acceleration of the robot, in the chosen axes.
///
/// `kinematics` and `motions` are those of the state, the latter from
/// [`forward_accelerations`](crate::forward_accelerations); gravity has no part in them. The quantities derived are
/// `axes.motion(..)` of [`BodyMotions::frame_velocity`] and of [`BodyMotions::frame_acceleration`] or
/// [`BodyMotions::frame_classical_acceleration`]. Cost: the depth of the frame; every other column is zero.
#[inline]
pub fn frame_derivatives<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    kinematics: &Kinematics<T, N>,
    motions: &BodyMotions<T, N>,
    frame: &Frame<T>,
    kind: AccelerationKind,
    axes: Axes,
    out: &mut FrameDerivatives<T, N>,
) {
    let xf_wf = kinematics.frame(frame);
    let observer = Observer {
        xf_wf,
        velocity_f: motions.frame_velocity(frame),
        acceleration_f: match kind {
            AccelerationKind::Spatial => motions.frame_acceleration(frame),
            AccelerationKind::Classical => motions.frame_classical_acceleration(frame),
        },
        kind,
        axes,
    };
    let xf_fw = xf_wf.inverse();
    for columns in [
        &mut out.jacobian.joints,
        &mut out.velocity_by_position.joints,
        &mut out.acceleration_by_position.joints,
        &mut out.acceleration_by_velocity.joints,
    ] {
        *columns = [Motion::ZERO; N];
    }

    let xf_fb = xf_fw.compose(&kinematics.base);
    let slip = xf_fb.motion(&motions.base_velocity) - observer.velocity_f;
    // A shift of the base moves the frame along an axis of the base, a turn about one as well.
    let axes_f = columns(xf_fb.rotation.matrix());
    let still = Vector3::zeros();
    let shifts = axes_f.map(|axis| {
        (
            Motion::new(axis, still),
            Motion::new(slip.angular.cross(&axis), still),
        )
    });
    let turns = axes_f.map(|axis| {
        let jacobian = Motion::new(xf_fb.translation.cross(&axis), axis);
        (jacobian, slip.cross(&jacobian))
    });
    for (k, (jacobian, by_velocity)) in shifts.into_iter().chain(turns).enumerate() {
        let columns = observer.expressed(Columns {
            jacobian,
            velocity_by_position: Motion::ZERO,
            acceleration_by_position: Motion::ZERO,
            acceleration_by_velocity: by_velocity,
        });
        out.set_base(k, columns);
    }

    let mut link = frame.link;
    // At most N steps from a leaf to the base.
    for _ in 0..N {
        let Link::Joint(j) = link else { break };
        let Some(body) = model.bodies().get(j) else {
            break;
        };
        let (v, a) = (at(&motions.velocities, j), at(&motions.accelerations, j));
        let axis = axis_in_body(body);
        let rate = v.cross(&axis);
        let second = a.cross(&axis) + v.cross(&rate);
        let xf_fj = xf_fw.compose(&at(&kinematics.bodies, j));
        let (axis, rate) = (xf_fj.motion(&axis), xf_fj.motion(&rate));
        let columns = observer.expressed(Columns {
            jacobian: axis,
            velocity_by_position: rate,
            acceleration_by_position: xf_fj.motion(&second) + rate.cross(&observer.velocity_f),
            acceleration_by_velocity: rate * T::TWO + axis.cross(&observer.velocity_f),
        });
        out.set_joint(j, columns);
        link = body.parent;
    }
}
