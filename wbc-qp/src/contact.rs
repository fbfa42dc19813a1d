//! Contacts: what a foot on the ground does not do, and what force the ground can give.
//!
//! # Ball
//! A ball on a plane with normal n rolls: its centre moves as v_c = ω × (r n). The force, three coordinates along two tangents and n,
//! acts at the point of contact and stays in the friction pyramid |f_x|, |f_y| ≤ μ f_z. The axes are the world's turned
//! the shortest way so that z becomes n: on level ground, and with radius 0 for a point on any plane.
//!
//! # Rectangle and polygon
//! A patch in the xy plane of its frame keeps its velocity, however the ground below it is inclined: the frame's z is the normal. The
//! wrench, six coordinates in the frame's own axes about its origin, satisfies (paper B eq. 6f)
//!
//! ```text
//! |f_x|, |f_y| ≤ μ f_z                         friction pyramid
//! y⁻ f_z ≤ n_x ≤ y⁺ f_z,  −x⁺ f_z ≤ n_y ≤ −x⁻ f_z   centre of pressure inside the rectangle
//! |n_z − (x₀ f_y − y₀ f_x)| ≤ μ_r f_z          yaw moment about the rectangle's middle (x₀, y₀)
//! ```
//!
//! With half sides X and Y, μ_r = μ (X + Y)/2 by default: half of what the exact cone of a rectangle (Caron 2015) has
//! to give when there is no tangential force. Of a convex polygon each edge from (x, y) with direction (d_x, d_y) of length 1 is a row,
//! −d_x n_x − d_y n_y + (d_x y − d_y x) f_z ≤ 0, (x₀, y₀) is the mean of its vertices, and μ_r that of a rectangle of the same perimeter.
//!
//! # Friction
//! The pyramid circumscribes the cone: on its diagonals it allows √2 μ. [`Contact::inscribed`] makes it the largest one inside.

use nalgebra::{Matrix3, Rotation3, Vector3};
use rbd_core::{
    Axes, ContactShape, Effort, Force, Frame, FrameJacobian, Motion, Transform, Tree,
    frame_jacobian,
};
use so3::{Scalar, math};

use crate::task::{orientation_error, rows};
use crate::{Error, Snapshot};

/// What touches the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Patch<T: Scalar> {
    /// A ball around the frame's origin on a plane.
    Ball {
        /// Radius, m; 0 for a point.
        radius: T,
        /// n: the plane's normal in the world, of length 1, out of the ground.
        normal_w: Vector3<T>,
    },
    /// A rectangle in the frame's xy plane.
    Rectangle {
        /// Lowest and highest x, m.
        x: [T; 2],
        /// Lowest and highest y, m.
        y: [T; 2],
    },
    /// A convex polygon in the frame's xy plane; [`Contact::polygon`] has looked whether it is one.
    Polygon {
        /// Vertices, counter-clockwise seen from +z, m.
        vertices: &'static [[T; 2]],
    },
}

impl<T: Scalar> Patch<T> {
    /// The shape of a robot's foot; a ball on level ground.
    #[must_use]
    pub fn of(shape: &ContactShape<T>) -> Self {
        match *shape {
            ContactShape::Sphere { radius } => Self::Ball {
                radius,
                normal_w: Vector3::z(),
            },
            ContactShape::Rectangle { x, y } => Self::Rectangle { x, y },
        }
    }
}

/// A contact as a controller sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T: Scalar> {
    /// Frame of the ball's centre, or of the patch.
    pub frame: Frame<T>,
    /// Ball, rectangle or polygon.
    pub shape: Patch<T>,
    /// Friction coefficient μ.
    pub friction: T,
    /// Yaw moment per normal force μ_r, m; not of balls.
    pub yaw: T,
    /// Least normal force while in contact, N.
    pub min_force: T,
    /// Largest normal force, N; not below the least.
    pub max_force: T,
    /// How much of the contact there is: 0 in the air, 1 on the ground. In between, `max_force` is scaled and the
    /// torque program's condition on the foot's motion is a cost that grows without bound towards 1: raise or lower it
    /// over some ticks and no force or torque jumps.
    pub load: T,
}

impl<T: Scalar> Contact<T> {
    /// On the ground, with the default yaw moment, no least force, and this largest one. A ball's ground is level.
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
            shape: Patch::of(&contact.shape),
            friction,
            yaw,
            min_force: T::ZERO,
            max_force,
            load: T::ONE,
        }
    }

    /// A ball of this radius, or a point, on a plane with this normal out of the ground, of length 1.
    #[must_use]
    pub const fn ball(
        frame: &Frame<T>,
        radius: T,
        normal_w: Vector3<T>,
        friction: T,
        max_force: T,
    ) -> Self {
        Self {
            frame: *frame,
            shape: Patch::Ball { radius, normal_w },
            friction,
            yaw: T::ZERO,
            min_force: T::ZERO,
            max_force,
            load: T::ONE,
        }
    }

    /// A convex polygon in the frame's xy plane, vertices counter-clockwise, with the default yaw moment.
    ///
    /// # Errors
    /// [`Error::NotConvex`]: fewer than three vertices, or a corner that does not turn left.
    pub fn polygon(
        frame: &Frame<T>,
        vertices: &'static [[T; 2]],
        friction: T,
        max_force: T,
    ) -> Result<Self, Error> {
        let mut perimeter = T::ZERO;
        let mut turned = T::ZERO;
        for (i, a) in vertices.iter().enumerate() {
            let (b, c) = (after(vertices, i + 1)?, after(vertices, i + 2)?);
            let (d, e) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
            let turn = math::atan2(d[0] * e[1] - d[1] * e[0], d[0] * e[0] + d[1] * e[1]);
            if turn <= T::ZERO || turn.is_nan_number() {
                return Err(Error::NotConvex);
            }
            turned += turn;
            perimeter += math::sqrt(d[0] * d[0] + d[1] * d[1]);
        }
        // Once around, and not twice as a star goes.
        let once = vertices.len() > 2 && turned < T::of(3.0) * T::PI;
        if !once {
            return Err(Error::NotConvex);
        }
        Ok(Self {
            frame: *frame,
            shape: Patch::Polygon { vertices },
            friction,
            yaw: friction * perimeter * T::of(0.125),
            min_force: T::ZERO,
            max_force,
            load: T::ONE,
        })
    }

    /// The same contact with the largest friction pyramid inside its cone: μ/√2 on each axis. Whatever it allows, the cone does.
    #[must_use]
    pub fn inscribed(mut self) -> Self {
        self.friction *= T::of(core::f64::consts::FRAC_1_SQRT_2);
        self
    }

    /// Number of force coordinates, and of rows of the contact's Jacobian.
    #[must_use]
    pub const fn size(&self) -> usize {
        match self.shape {
            Patch::Ball { .. } => 3,
            Patch::Rectangle { .. } | Patch::Polygon { .. } => 6,
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

    /// Jacobian rows, J̇ν and J ν: of the rolling condition in the plane's axes, or of the frame in its own. A ball uses three.
    pub(crate) fn motion<M: Tree<T, N>, const N: usize>(
        &self,
        model: &M,
        snapshot: &Snapshot<T, N>,
    ) -> ([Effort<T, N>; 6], [T; 6], [T; 6]) {
        if let Patch::Ball { radius, normal_w } = self.shape {
            return self.rolling_motion(model, snapshot, radius, normal_w);
        }
        let mut j = FrameJacobian::ZERO;
        let acceleration = snapshot.motions.frame_classical_acceleration(&self.frame);
        let velocity = snapshot.motions.frame_velocity(&self.frame);
        frame_jacobian(
            model,
            &snapshot.kinematics,
            &self.frame,
            Axes::Local,
            &mut j,
        );
        (rows(&j), acceleration.to_array(), velocity.to_array())
    }

    /// Those of a ball: a function of its own, so that other contacts do not pay for its stack.
    #[inline(never)]
    fn rolling_motion<M: Tree<T, N>, const N: usize>(
        &self,
        model: &M,
        snapshot: &Snapshot<T, N>,
        radius: T,
        normal_w: Vector3<T>,
    ) -> ([Effort<T, N>; 6], [T; 6], [T; 6]) {
        let mut j = FrameJacobian::ZERO;
        let acceleration = snapshot.motions.frame_classical_acceleration(&self.frame);
        let velocity = snapshot.motions.frame_velocity(&self.frame);
        let axes = Axes::LocalWorldAligned;
        frame_jacobian(model, &snapshot.kinematics, &self.frame, axes, &mut j);
        let xf_wf = snapshot.pose(&self.frame);
        let rolling = rolling(radius, normal_w);
        j.base = j.base.map(&rolling);
        j.joints = j.joints.map(&rolling);
        (
            rows(&j),
            rolling(axes.motion(&xf_wf, &acceleration)).to_array(),
            rolling(axes.motion(&xf_wf, &velocity)).to_array(),
        )
    }

    /// How far the contact is from where it was, to be brought back: the displacement from the present pose of its frame to
    /// `xf_wf`, m and rad, in the axes of its rows. A ball uses three entries, of the point of contact.
    #[must_use]
    pub fn error<const N: usize>(&self, snapshot: &Snapshot<T, N>, xf_wf: &Transform<T>) -> [T; 6] {
        let now = snapshot.pose(&self.frame);
        let turn = orientation_error(&xf_wf.rotation, &now.rotation);
        let error = Motion::new(xf_wf.translation - now.translation, Vector3::from(turn));
        match self.shape {
            Patch::Ball { radius, normal_w } => rolling(radius, normal_w)(error).to_array(),
            Patch::Rectangle { .. } | Patch::Polygon { .. } => {
                let to = now.rotation.inverse();
                Motion::new(to * error.linear, to * error.angular).to_array()
            }
        }
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
            Patch::Ball { radius, normal_w } => (
                xf_wf.translation - normal_w * radius,
                Force::new(plane_axes(&normal_w) * f.linear, Vector3::zeros()),
            ),
            Patch::Rectangle { .. } | Patch::Polygon { .. } => (
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
        match self.shape {
            Patch::Ball { .. } => None,
            Patch::Rectangle {
                x: [xl, xh],
                y: [yl, yh],
            } => {
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
            Patch::Polygon { vertices } => self.polygon_row(vertices, row - 4),
        }
    }

    /// A row per edge, then two for the yaw moment.
    #[inline(never)]
    fn polygon_row(&self, vertices: &[[T; 2]], row: usize) -> Option<[T; 6]> {
        let (o, i) = (T::ZERO, T::ONE);
        if let Some([x, y]) = vertices.get(row) {
            let [u, v] = after(vertices, row + 1).ok()?;
            let (dx, dy) = (u - *x, v - *y);
            let length = math::sqrt(dx * dx + dy * dy);
            let (dx, dy) = (dx / length, dy / length);
            return Some([o, o, dx * *y - dy * *x, -dx, -dy, o]);
        }
        let sum = vertices
            .iter()
            .fold([o; 2], |[a, b], [x, y]| [a + *x, b + *y]);
        let [x, y] = sum.map(|s| s / T::of(vertices.len() as f64));
        [[y, -x, -self.yaw, o, o, i], [-y, x, -self.yaw, o, o, -i]]
            .get(row - vertices.len())
            .copied()
    }
}

/// Vertex `i`, counted around.
fn after<T: Scalar>(vertices: &[[T; 2]], i: usize) -> Result<[T; 2], Error> {
    let i = i.checked_rem(vertices.len()).ok_or(Error::NotConvex)?;
    vertices.get(i).copied().ok_or(Error::NotConvex)
}

/// Motion of a ball's point of contact as fixed to the ball, in the axes of its plane, from that of its centre.
fn rolling<T: Scalar>(radius: T, normal_w: Vector3<T>) -> impl Fn(Motion<T>) -> Motion<T> {
    let up = normal_w * radius;
    let to = plane_axes(&normal_w).inverse();
    move |m| Motion::new(to * (m.linear - m.angular.cross(&up)), m.angular)
}

/// Two tangents and the normal as columns: the rotation that takes z to n the shortest way; where n points down, from −z (Duff and others 2017).
fn plane_axes<T: Scalar>(n: &Vector3<T>) -> Rotation3<T> {
    let sign = if n.z < T::ZERO { -T::ONE } else { T::ONE };
    let q = -T::ONE / (sign + n.z);
    let p = n.x * n.y * q;
    Rotation3::from_matrix_unchecked(Matrix3::new(
        T::ONE + sign * n.x * n.x * q,
        p,
        n.x,
        sign * p,
        sign + n.y * n.y * q,
        n.y,
        -sign * n.x,
        -n.y,
        n.z,
    ))
}
