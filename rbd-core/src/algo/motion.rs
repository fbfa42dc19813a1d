//! Velocities and accelerations of every body and frame.
//!
//! v_i = X_ip v_p + S q̇, a_i = X_ip a_p + S q̈ + v_i × S q̇: spatial quantities in body axes
//! (Featherstone 2008, chapter 5), gravity not included.

use so3::Scalar;

use super::{at, place, put};
use crate::joint::{JointKind, JointRotation};
use crate::model::{Frame, Link};
use crate::spatial::{Motion, Transform, cross};
use crate::state::{Posture, Tangent};
use crate::tree::{At, Fold, Nothing, Tree};

/// In which axes, and about which point, a 6-vector of a frame f is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Axes {
    /// World axes, about the origin of f: the default of this crate.
    #[default]
    LocalWorldAligned,
    /// Axes and origin of f.
    Local,
    /// World axes, about the world's origin.
    World,
}

impl Axes {
    /// Brings a motion of frame f from its own axes to these, given its pose in the world.
    #[inline]
    #[must_use]
    pub fn motion<T: Scalar>(self, xf_wf: &Transform<T>, motion_f: &Motion<T>) -> Motion<T> {
        match self {
            Self::Local => *motion_f,
            Self::World => xf_wf.motion(motion_f),
            Self::LocalWorldAligned => Motion {
                linear: xf_wf.rotation * motion_f.linear,
                angular: xf_wf.rotation * motion_f.angular,
            },
        }
    }
}

/// Velocity and spatial acceleration of every body, in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotions<T, const N: usize> {
    /// Velocity of the base.
    pub base_velocity: Motion<T>,
    /// Spatial acceleration of the base.
    pub base_acceleration: Motion<T>,
    /// Velocity of each body.
    pub velocities: [Motion<T>; N],
    /// Spatial acceleration of each body.
    pub accelerations: [Motion<T>; N],
}

impl<T: Scalar, const N: usize> BodyMotions<T, N> {
    /// At rest.
    pub const ZERO: Self = Self {
        base_velocity: Motion::ZERO,
        base_acceleration: Motion::ZERO,
        velocities: [Motion::ZERO; N],
        accelerations: [Motion::ZERO; N],
    };

    /// Velocity of a frame, in its own axes.
    #[inline]
    #[must_use]
    pub fn frame_velocity(&self, frame: &Frame<T>) -> Motion<T> {
        let body = match frame.link {
            Link::Base => self.base_velocity,
            Link::Joint(i) => at(&self.velocities, i),
        };
        frame.placement().inverse_motion(&body)
    }

    /// Spatial acceleration of a frame, in its own axes.
    #[inline]
    #[must_use]
    pub fn frame_acceleration(&self, frame: &Frame<T>) -> Motion<T> {
        let body = match frame.link {
            Link::Base => self.base_acceleration,
            Link::Joint(i) => at(&self.accelerations, i),
        };
        frame.placement().inverse_motion(&body)
    }

    /// Classical acceleration of a frame, in its own axes: the linear part is that of the material
    /// point at its origin, as an accelerometer without gravity would feel it.
    #[inline]
    #[must_use]
    pub fn frame_classical_acceleration(&self, frame: &Frame<T>) -> Motion<T> {
        self.frame_acceleration(frame)
            .to_classical(&self.frame_velocity(frame))
    }
}

struct Velocities<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    qd: &'a [T; N],
    velocities: &'a mut [Motion<T>; N],
}

/// X_ip m + S x, for velocities and accelerations alike.
#[inline(always)]
pub(crate) fn carried<J: JointKind, T: Scalar, const N: usize>(
    here: At<'_, T>,
    posture: &Posture<T, N>,
    parent: &Motion<T>,
    x: T,
) -> Motion<T> {
    let (rotation, offset) = place::<J, T, N>(here, posture);
    let linear = rotation.down(&(parent.linear + cross(&parent.angular, &offset)));
    let angular = rotation.down(&parent.angular);
    if J::KIND.is_revolute() {
        Motion {
            linear,
            angular: J::along_axis(angular, x),
        }
    } else {
        Motion {
            linear: J::along_axis(linear, x),
            angular,
        }
    }
}

impl<T: Scalar, const N: usize> Fold<T> for Velocities<'_, T, N> {
    type Down = Motion<T>;
    type Keep = Nothing;
    type Up = Nothing;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Motion<T>) -> (Motion<T>, Nothing) {
        let qd = at(self.qd, here.index) * here.body.sign;
        let velocity = carried::<J, T, N>(here, self.posture, up, qd);
        put(self.velocities, here.index, velocity);
        (velocity, Nothing)
    }

    #[inline(always)]
    fn up<J: JointKind>(&mut self, _: At<'_, T>, _: &Nothing, _: Nothing) -> Nothing {
        Nothing
    }
}

struct Accelerations<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    qd: &'a [T; N],
    qdd: Option<&'a [T; N]>,
    out: (&'a mut [Motion<T>; N], &'a mut [Motion<T>; N]),
}

impl<T: Scalar, const N: usize> Fold<T> for Accelerations<'_, T, N> {
    type Down = (Motion<T>, Motion<T>);
    type Keep = Nothing;
    type Up = Nothing;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Self::Down) -> (Self::Down, Nothing) {
        let sign = here.body.sign;
        let qd = at(self.qd, here.index) * sign;
        let qdd = self.qdd.map_or(T::ZERO, |x| at(x, here.index) * sign);
        let v = carried::<J, T, N>(here, self.posture, &up.0, qd);
        let mut a = carried::<J, T, N>(here, self.posture, &up.1, qdd);
        // v × S q̇
        if J::KIND.is_revolute() {
            a.linear = J::add_cross_axis(a.linear, &v.linear, qd);
            a.angular = J::add_cross_axis(a.angular, &v.angular, qd);
        } else {
            a.linear = J::add_cross_axis(a.linear, &v.angular, qd);
        }
        put(self.out.0, here.index, v);
        put(self.out.1, here.index, a);
        ((v, a), Nothing)
    }

    #[inline(always)]
    fn up<J: JointKind>(&mut self, _: At<'_, T>, _: &Nothing, _: Nothing) -> Nothing {
        Nothing
    }
}

/// Velocity of every body; accelerations in `out` are left as they are.
#[inline]
pub fn forward_velocities<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    out: &mut BodyMotions<T, N>,
) {
    out.base_velocity = velocity.base;
    let mut fold = Velocities {
        posture,
        qd: &velocity.joints,
        velocities: &mut out.velocities,
    };
    model.fold(&mut fold, &velocity.base);
}

/// Velocity and spatial acceleration of every body.
#[inline]
pub fn forward_accelerations<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: &Tangent<T, N>,
    out: &mut BodyMotions<T, N>,
) {
    accelerate(model, posture, velocity, Some(acceleration), out);
}

/// Velocity and *bias* acceleration of every body: the acceleration at ν̇ = 0. That of a frame is J̇ν,
/// the second term of paper A eq. (5) when taken as classical acceleration of a foot.
#[inline]
pub fn bias_accelerations<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    out: &mut BodyMotions<T, N>,
) {
    accelerate(model, posture, velocity, None, out);
}

#[inline(always)]
fn accelerate<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, N>,
    acceleration: Option<&Tangent<T, N>>,
    out: &mut BodyMotions<T, N>,
) {
    out.base_velocity = velocity.base;
    out.base_acceleration = acceleration.map_or(Motion::ZERO, |a| a.base);
    let base = (out.base_velocity, out.base_acceleration);
    let mut fold = Accelerations {
        posture,
        qd: &velocity.joints,
        qdd: acceleration.map(|a| &a.joints),
        out: (&mut out.velocities, &mut out.accelerations),
    };
    model.fold(&mut fold, &base);
}
