//! Contacts: what a foot on the ground does not do, and what force the ground can give.
//!
//! # Point
//! A ball on level ground rolls: its centre moves as v_c = ω × (r ẑ). The force, three coordinates in world axes, acts at its
//! lowest point and stays in the friction pyramid |f_x|, |f_y| ≤ μ f_z.
//!
//! # Surface
//! A rectangle in the xy plane of its frame keeps its velocity. The wrench, six coordinates in the frame's own axes about its
//! origin, satisfies (paper B eq. 6f)
//!
//! ```text
//! |f_x|, |f_y| ≤ μ f_z                         friction pyramid
//! y⁻ f_z ≤ n_x ≤ y⁺ f_z,  −x⁺ f_z ≤ n_y ≤ −x⁻ f_z   centre of pressure inside the rectangle
//! |n_z − (x₀ f_y − y₀ f_x)| ≤ μ_r f_z          yaw moment about the rectangle's middle (x₀, y₀)
//! ```
//!
//! With half sides X and Y, μ_r = μ (X + Y)/2 by default: half of what the exact cone of a rectangle (Caron 2015) has
//! to give when there is no tangential force.

use nalgebra::Vector3;
use rbd_core::{
    Axes, ContactShape, Effort, Force, Frame, FrameJacobian, Motion, Tree, frame_jacobian,
};
use so3::Scalar;

use crate::Snapshot;
use crate::task::rows;

/// A contact as a controller sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T> {
    /// Frame of the ball's centre, or of the rectangle.
    pub frame: Frame<T>,
    /// Ball or rectangle.
    pub shape: ContactShape<T>,
    /// Friction coefficient μ.
    pub friction: T,
    /// Yaw moment per normal force μ_r, m; of rectangles only.
    pub yaw: T,
    /// Least normal force while in contact, N.
    pub min_force: T,
    /// Largest normal force, N.
    pub max_force: T,
    /// How much of the contact there is: 0 in the air, 1 on the ground. In between, `max_force` is scaled and the
    /// torque program's condition on the foot's motion is a cost that grows without bound towards 1: raise or lower it
    /// over some ticks and no force or torque jumps.
    pub load: T,
}

impl<T: Scalar> Contact<T> {
    /// On the ground, with the default yaw moment, no least force, and this largest one.
    #[must_use]
    pub fn new(contact: &rbd_core::Contact<T>, friction: T, max_force: T) -> Self {
        let yaw = match contact.shape {
            ContactShape::Sphere { .. } => T::ZERO,
            ContactShape::Rectangle {
                x: [xl, xh],
                y: [yl, yh],
            } => friction * (xh - xl + yh - yl) * T::of(0.25),
        };
        Self {
            frame: contact.frame,
            shape: contact.shape,
            friction,
            yaw,
            min_force: T::ZERO,
            max_force,
            load: T::ONE,
        }
    }

    /// Number of force coordinates, and of rows of the contact's Jacobian.
    #[must_use]
    pub const fn size(&self) -> usize {
        match self.shape {
            ContactShape::Sphere { .. } => 3,
            ContactShape::Rectangle { .. } => 6,
        }
    }

    /// Index of the normal force among the contact's coordinates: f_z in either case.
    pub const NORMAL: usize = 2;

    /// Whether the contact can carry anything.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.load > T::ZERO
    }

    /// Whether all of the contact is there, to a thousandth: loads are summed up in steps, and round-off in the sum must not
    /// become a weight.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.load >= T::of(0.999)
    }

    /// Jacobian rows, J̇ν and J ν: of the rolling condition, or of the frame in its own axes. A ball uses three.
    pub(crate) fn motion<M: Tree<T, N>, const N: usize>(
        &self,
        model: &M,
        snapshot: &Snapshot<T, N>,
    ) -> ([Effort<T, N>; 6], [T; 6], [T; 6]) {
        let mut j = FrameJacobian::ZERO;
        let acceleration = snapshot.motions.frame_classical_acceleration(&self.frame);
        let velocity = snapshot.motions.frame_velocity(&self.frame);
        let ContactShape::Sphere { radius } = self.shape else {
            frame_jacobian(
                model,
                &snapshot.kinematics,
                &self.frame,
                Axes::Local,
                &mut j,
            );
            return (rows(&j), acceleration.to_array(), velocity.to_array());
        };
        let axes = Axes::LocalWorldAligned;
        frame_jacobian(model, &snapshot.kinematics, &self.frame, axes, &mut j);
        let xf_wf = snapshot.pose(&self.frame);
        let up = Vector3::z() * radius;
        let rolling = |m: Motion<T>| Motion::new(m.linear - m.angular.cross(&up), m.angular);
        j.base = j.base.map(rolling);
        j.joints = j.joints.map(rolling);
        (
            rows(&j),
            rolling(axes.motion(&xf_wf, &acceleration)).to_array(),
            rolling(axes.motion(&xf_wf, &velocity)).to_array(),
        )
    }

    /// Wrench in the world, about the point where it acts, and that point, for these coordinates.
    #[must_use]
    pub fn wrench_w<const N: usize>(
        &self,
        snapshot: &Snapshot<T, N>,
        coordinates: [T; 6],
    ) -> (Vector3<T>, Force<T>) {
        let xf_wf = snapshot.pose(&self.frame);
        let f = Force::from_array(coordinates);
        match self.shape {
            ContactShape::Sphere { radius } => (
                xf_wf.translation - Vector3::z() * radius,
                Force::new(f.linear, Vector3::zeros()),
            ),
            ContactShape::Rectangle { .. } => (
                xf_wf.translation,
                Force::new(xf_wf.rotation * f.linear, xf_wf.rotation * f.angular),
            ),
        }
    }

    /// The rows of the cone, each ≤ 0, as coefficients of the contact's own coordinates; `None` ends them.
    #[must_use]
    pub fn cone(&self, row: usize) -> Option<[T; 6]> {
        let mu = self.friction;
        let (o, i) = (T::ZERO, T::ONE);
        let pyramid = [
            [i, o, -mu, o, o, o],
            [-i, o, -mu, o, o, o],
            [o, i, -mu, o, o, o],
            [o, -i, -mu, o, o, o],
        ];
        if let Some(found) = pyramid.get(row) {
            return Some(*found);
        }
        let ContactShape::Rectangle {
            x: [xl, xh],
            y: [yl, yh],
        } = self.shape
        else {
            return None;
        };
        let (x, y) = ((xl + xh) * T::HALF, (yl + yh) * T::HALF);
        [
            [o, o, -yh, i, o, o],
            [o, o, yl, -i, o, o],
            [o, o, xl, o, i, o],
            [o, o, -xh, o, -i, o],
            [y, -x, -self.yaw, o, o, i],
            [-y, x, -self.yaw, o, o, -i],
        ]
        .get(row - 4)
        .copied()
    }
}
