//! Motion of all bodies and the sums over their subtrees, in one sweep in world axes: what inverse dynamics, paper A eq. (4),
//! and its derivatives are made of.
//!
//! With S the axis of a joint as a motion in the world, V and A velocity and acceleration of its body
//! (gravity as an acceleration of the world the other way), p its parent:
//!
//! ```text
//! V = V_p + S q̇,   Ṡ = V_p × S,   A = A_p + S q̈ + Ṡ q̇,   S̈ = A_p × S + V_p × Ṡ
//! ```

use nalgebra::{Matrix3, Rotation3, Vector3};
use so3::Scalar;

use super::moments::Moments;
use super::{Gradient, PointMotion};
use crate::GRAVITY;
use crate::model::{Body, Link};
use crate::spatial::Motion;

/// A joint and its body, in motion: world axes about the world's origin.
#[derive(Clone, Copy, Debug)]
pub struct JointMotion<T: Scalar> {
    /// From the body's axes to the world's.
    pub rot: Matrix3<T>,
    /// Origin of the body, m.
    pub pos: Vector3<T>,
    /// S: the motion of the body per unit of q̇.
    pub axis: Motion<T>,
    /// Ṡ.
    pub rate: Motion<T>,
    /// S̈, with gravity as an acceleration of the world upwards.
    pub second: Motion<T>,
    /// V of the body.
    pub velocity: Motion<T>,
    /// A of the body, spatial, with gravity as an acceleration of the world upwards.
    pub acceleration: Motion<T>,
}

impl<T: Scalar> JointMotion<T> {
    fn zero() -> Self {
        Self {
            rot: Matrix3::zeros(),
            pos: Vector3::zeros(),
            axis: Motion::ZERO,
            rate: Motion::ZERO,
            second: Motion::ZERO,
            velocity: Motion::ZERO,
            acceleration: Motion::ZERO,
        }
    }

    fn ground() -> Self {
        let up = Vector3::from(GRAVITY.map(|g| T::of(-g)));
        Self {
            rot: Matrix3::identity(),
            acceleration: Motion::new(up, Vector3::zeros()),
            ..Self::zero()
        }
    }

    /// The body behind a joint on `self`.
    #[inline(always)]
    fn child(&self, body: &Body<T>, (sin, cos): (T, T), q: T, qd: T, qdd: T) -> Self {
        let frame = if body.kind.is_tilted() {
            self.rot * body.tilt_matrix()
        } else {
            self.rot
        };
        let column = |i: usize| frame.column(i).into_owned();
        let k = body.kind.axis();
        let along = column(k) * body.sign;
        let mut pos = self.pos + self.rot * Vector3::from(body.offset);
        let mut rot = frame;
        let axis = if body.kind.is_revolute() {
            // The plane turns; the sign of the coordinate is in the sine.
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let sin = sin * body.sign;
            let (x, y) = (column(i), column(j));
            rot.set_column(i, &(x * cos + y * sin));
            rot.set_column(j, &(y * cos - x * sin));
            Motion::new(pos.cross(&along), along)
        } else {
            pos += along * q;
            Motion::new(along, Vector3::zeros())
        };
        let rate = self.velocity.cross(&axis);
        Self {
            rot,
            pos,
            axis,
            rate,
            second: self.acceleration.cross(&axis) + self.velocity.cross(&rate),
            velocity: self.velocity + axis * qd,
            acceleration: self.acceleration + axis * qdd + rate * qd,
        }
    }
}

/// A robot in motion at one instant.
pub struct Sweep<'a, T: Scalar, const N: usize> {
    /// The robot's table: the first bodies hang in the world.
    pub bodies: &'a [Body<T>; N],
    /// Every joint with its body.
    pub joints: [JointMotion<T>; N],
    /// Sums over each body alone.
    pub(super) own: [Moments<T>; N],
    /// Sums over the subtree of each joint.
    pub(super) moments: [Moments<T>; N],
}

impl<'a, T: Scalar, const N: usize> Sweep<'a, T, N> {
    /// Of a robot with coordinates `q`, rates `v` and accelerations `a`.
    ///
    /// `chart` is for a base on SO(3): where it is `(i, R)`, the axes of body `i` are those of the rotation R from the body to the
    /// world, whatever its joint says, so that the angles of the joints behind it count from R. The body itself has no mass then and no
    /// length, and its parents do not turn.
    #[must_use]
    pub fn new(
        bodies: &'a [Body<T>; N],
        motion: [&[T; N]; 3],
        chart: Option<(usize, &Rotation3<T>)>,
    ) -> Self {
        let mut sweep = Self::zero(bodies);
        sweep.set(motion, chart);
        sweep
    }

    /// Tables of zeros, for [`Self::set`].
    #[inline(always)]
    #[must_use]
    pub fn zero(bodies: &'a [Body<T>; N]) -> Self {
        Self {
            bodies,
            joints: [JointMotion::zero(); N],
            own: [Moments::zero(); N],
            moments: [Moments::zero(); N],
        }
    }

    /// As [`Self::new`], over whatever is in the tables, which are too large to be moved around where time counts.
    #[inline(never)]
    pub fn set(&mut self, [q, v, a]: [&[T; N]; 3], chart: Option<(usize, &Rotation3<T>)>) {
        let (bodies, ground) = (self.bodies, JointMotion::ground());
        let (sin, cos) = so3::math::sin_cos_array(q);
        for i in 0..N {
            let body = &bodies[i];
            let parent = match body.parent {
                Link::Joint(p) => self.joints.get(p).unwrap_or(&ground),
                Link::Base => &ground,
            };
            let mut joint = parent.child(body, (sin[i], cos[i]), q[i], v[i], a[i]);
            if let Some((at, rot)) = chart
                && at == i
            {
                joint.rot = *rot.matrix();
            }
            let own = if body.mass > T::ZERO {
                let (v, a) = (&joint.velocity, &joint.acceleration);
                Moments::of(body, &joint.rot, &joint.pos, v, a)
            } else {
                Moments::zero()
            };
            self.own[i] = own;
            self.moments[i] = own;
            self.joints[i] = joint;
        }
        for i in (0..N).rev() {
            if let Link::Joint(p) = bodies[i].parent {
                let below = self.moments[i];
                if let Some(slot) = self.moments.get_mut(p) {
                    *slot = *slot + below;
                }
            }
        }
    }

    #[inline(always)]
    pub(super) fn body(&self, link: usize) -> &JointMotion<T> {
        self.joints.get(link).unwrap_or(&self.joints[0])
    }

    /// Where a point fixed to body `link` is, m, from its offset in the body's frame.
    #[inline(always)]
    #[must_use]
    pub fn place(&self, link: usize, offset_l: &Vector3<T>) -> Vector3<T> {
        let body = self.body(link);
        body.pos + body.rot * offset_l
    }

    /// How a point fixed to body `link` moves.
    #[inline(always)]
    #[must_use]
    pub fn point(&self, link: usize, offset_l: &Vector3<T>) -> PointMotion<T> {
        let body = self.body(link);
        let pos = self.place(link, offset_l);
        let velocity = body.velocity.at_point(&pos);
        PointMotion {
            link,
            pos,
            arm: Vector3::zeros(),
            velocity,
            lifted: body.acceleration.at_point(&pos) + body.velocity.angular.cross(&velocity),
        }
    }

    /// Acceleration of the material point at the contact as far as it does not come from rolling: a + α × arm, m/s².
    #[inline(always)]
    #[must_use]
    pub fn slip_rate(&self, point: &PointMotion<T>) -> Vector3<T> {
        let alpha = &self.body(point.link).acceleration.angular;
        point.lifted + Vector3::from(GRAVITY.map(T::of)) + alpha.cross(&point.arm)
    }

    /// Gradients of the three coordinates of [`Self::slip_rate`].
    #[must_use]
    pub fn acceleration_gradients<const CONTACTS: usize>(
        &self,
        point: &PointMotion<T>,
    ) -> [Gradient<T, N, CONTACTS>; 3] {
        let mut rows = [Gradient::ZERO; 3];
        for k in self.path(point.link) {
            let joint = &self.joints[k];
            let turn = &joint.axis.angular;
            let carried = |w: &Vector3<T>| w.cross(&point.velocity) * T::TWO;
            let by_q = joint.second.at_point(&point.pos)
                + carried(&joint.rate.angular)
                + turn.cross(&point.lifted);
            let by_v = joint.rate.at_point(&point.pos) * T::TWO + carried(turn);
            let by_a = joint.axis.at_point(&point.pos);
            let rolling = self.angular_columns(point.link, k);
            let by_q = by_q + rolling.by_q.cross(&point.arm);
            let by_v = by_v + rolling.by_v.cross(&point.arm);
            let by_a = by_a + rolling.by_a.cross(&point.arm);
            for (c, row) in rows.iter_mut().enumerate() {
                (row.q[k], row.v[k], row.a[k]) = (by_q[c], by_v[c], by_a[c]);
            }
        }
        rows
    }

    /// Gradient of the position of a point of body `link` along a direction, world axes.
    #[must_use]
    pub fn position_gradient<const CONTACTS: usize>(
        &self,
        link: usize,
        pos: &Vector3<T>,
        direction: &Vector3<T>,
    ) -> Gradient<T, N, CONTACTS> {
        let mut gradient = Gradient::ZERO;
        for k in self.path(link) {
            gradient.q[k] = direction.dot(&self.joints[k].axis.at_point(pos));
        }
        gradient
    }

    /// The joint `i` and all its ancestors, from the tip to the base.
    #[inline(always)]
    #[must_use]
    pub fn path(&self, i: usize) -> Path<'_, T, N> {
        Path {
            bodies: self.bodies,
            next: Link::Joint(i),
            left: N,
        }
    }
}

/// Joint indices from a tip to the base, less than `N`.
#[derive(Clone, Debug)]
pub struct Path<'a, T, const N: usize> {
    bodies: &'a [Body<T>; N],
    next: Link,
    left: usize,
}

impl<T, const N: usize> Iterator for Path<'_, T, N> {
    type Item = usize;
    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let Link::Joint(i) = self.next else {
            return None;
        };
        self.left = self.left.checked_sub(1)?;
        self.next = self.bodies.get(i)?.parent;
        Some(i)
    }
}
