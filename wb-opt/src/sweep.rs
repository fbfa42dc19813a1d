//! Inverse dynamics, paper A eq. (4), and its first derivatives, in one sweep in world axes.
//!
//! With S the axis of a joint as a motion in the world, V and A velocity and acceleration of its body
//! (gravity as an acceleration of the world the other way), p its parent:
//!
//! ```text
//! V = V_p + S q̇,   Ṡ = V_p × S,   A = A_p + S q̈ + Ṡ q̇,   S̈ = A_p × S + V_p × Ṡ,   τ = S · f
//! ```
//!
//! with f the force of the subtree less the contact forces on it. For a joint j and an ancestor k, or k = j,
//! with I, C of the subtree of j ([`crate::moments`]):
//!
//! ```text
//! ∂τ_j/∂q_k = S̈_k · I S_j + Ṡ_k · Cᵀ S_j          ∂τ_k/∂q_j = S_k · (S_j ×* f + I S̈_j + C Ṡ_j)
//! ∂τ_j/∂q̇_k = 2 Ṡ_k · I S_j + S_k · Cᵀ S_j        ∂τ_k/∂q̇_j = S_k · (2 I Ṡ_j + C S_j)
//! ∂τ_j/∂q̈_k = S_k · I S_j = ∂τ_k/∂q̈_j
//! ```
//!
//! plus what contact forces add because they keep their direction in the world. `rbd-core` has these
//! derivatives in base axes; here they share the sweep with the second ones ([`crate::curvature`]).
//!
//! Source: Singh, Russell, Wensing, "Efficient analytical derivatives of rigid-body dynamics using
//! spatial vector algebra", RA-L 2022; the moments' form is derived in [`crate::moments`].

use nalgebra::{Matrix3, Vector3};
use rbd_core::model::{Body, Link};
use rbd_core::{Force, GRAVITY, Motion};
use so3::Scalar;

use crate::midpoint::Midpoint;
use crate::moments::{Moments, at_point, outer, turn};
use crate::robot::{Point, TURN};

/// A joint and its body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint<T: Scalar> {
    /// From the body's axes to the world's.
    pub(crate) rot: Matrix3<T>,
    pub(crate) pos: Vector3<T>,
    /// S.
    pub(crate) axis: Motion<T>,
    /// Ṡ.
    pub(crate) rate: Motion<T>,
    /// S̈.
    pub(crate) second: Motion<T>,
    pub(crate) velocity: Motion<T>,
    pub(crate) acceleration: Motion<T>,
}

impl<T: Scalar> Joint<T> {
    fn ground() -> Self {
        let [x, y, z] = GRAVITY;
        Self {
            rot: Matrix3::identity(),
            pos: Vector3::zeros(),
            axis: Motion::ZERO,
            rate: Motion::ZERO,
            second: Motion::ZERO,
            velocity: Motion::ZERO,
            acceleration: Motion::new(
                Vector3::new(T::of(-x), T::of(-y), T::of(-z)),
                Vector3::zeros(),
            ),
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

/// A point and its motion, world axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointMotion<T: Scalar> {
    pub(crate) link: usize,
    pub(crate) pos: Vector3<T>,
    /// From the point to where its force acts: down by the radius of a ball foot.
    pub(crate) arm: Vector3<T>,
    pub(crate) velocity: Vector3<T>,
    /// Acceleration less gravity.
    pub(crate) lifted: Vector3<T>,
}

/// A robot in motion.
pub(crate) struct Sweep<'a, T: Scalar, const N: usize> {
    pub(crate) bodies: &'a [Body<T>; N],
    pub(crate) joints: [Joint<T>; N],
    /// Sums over each body alone.
    pub(crate) own: [Moments<T>; N],
    /// Sums over the subtree of each joint.
    pub(crate) moments: [Moments<T>; N],
}

impl<'a, T: Scalar, const N: usize> Sweep<'a, T, N> {
    /// Motion of all bodies, and the sums over their subtrees; the base's angles turn from the chart of the middle.
    #[inline(never)]
    pub(crate) fn new<const FEET: usize>(
        bodies: &'a [Body<T>; N],
        mid: &Midpoint<T, N, FEET>,
    ) -> Self {
        let Midpoint {
            q, v, a, rot_wc, ..
        } = mid;
        let ground = Joint::ground();
        // Filled in place: the tables are too large to be moved around.
        let mut sweep = Self {
            bodies,
            joints: [ground; N],
            own: [Moments::zero(); N],
            moments: [Moments::zero(); N],
        };
        let (sin, cos) = so3::math::sin_cos_array(q);
        for i in 0..N {
            let body = &bodies[i];
            let parent = match body.parent {
                Link::Joint(p) => sweep.joints.get(p).unwrap_or(&ground),
                Link::Base => &ground,
            };
            let mut joint = parent.child(body, (sin[i], cos[i]), q[i], v[i], a[i]);
            if i.saturating_add(1) == TURN {
                joint.rot = *rot_wc.matrix();
            }
            if body.mass > T::ZERO {
                let (v, a) = (&joint.velocity, &joint.acceleration);
                let own = Moments::of(body, &joint.rot, &joint.pos, v, a);
                (sweep.own[i], sweep.moments[i]) = (own, own);
            }
            sweep.joints[i] = joint;
        }
        for i in (0..N).rev() {
            if let Link::Joint(p) = bodies[i].parent {
                let below = sweep.moments[i];
                if let Some(slot) = sweep.moments.get_mut(p) {
                    *slot = *slot + below;
                }
            }
        }
        sweep
    }

    fn body(&self, link: usize) -> &Joint<T> {
        self.joints.get(link).unwrap_or(&self.joints[0])
    }

    /// Where a point is.
    #[inline(always)]
    pub(crate) fn place(&self, point: &Point<T>) -> Vector3<T> {
        let body = self.body(point.link);
        body.pos + body.rot * point.offset_l
    }

    /// How a point moves.
    #[inline(always)]
    pub(crate) fn point(&self, point: &Point<T>) -> PointMotion<T> {
        let body = self.body(point.link);
        let pos = self.place(point);
        let velocity = at_point(&body.velocity, &pos);
        PointMotion {
            link: point.link,
            pos,
            arm: Vector3::zeros(),
            velocity,
            lifted: at_point(&body.acceleration, &pos) + body.velocity.angular.cross(&velocity),
        }
    }

    /// Acceleration of the material point at the contact as far as it does not come from rolling: a + α × arm.
    #[inline(always)]
    pub(crate) fn slip_rate(&self, point: &PointMotion<T>) -> Vector3<T> {
        let alpha = &self.body(point.link).acceleration.angular;
        point.lifted + Vector3::from(GRAVITY.map(T::of)) + alpha.cross(&point.arm)
    }

    /// The joint `i` and all its ancestors, from the tip to the base.
    #[inline(always)]
    pub(crate) fn path(&self, i: usize) -> Path<'_, T, N> {
        Path {
            bodies: self.bodies,
            next: Link::Joint(i),
            left: N,
        }
    }

    /// Effort of every joint under contact forces on points, world axes.
    pub(crate) fn effort<const FEET: usize>(
        &self,
        qdd: &[T; N],
        contacts: &Contacts<T, FEET>,
        effort: &mut [T; N],
    ) {
        for i in 0..N {
            effort[i] = self.joints[i].axis.dot(&self.moments[i].force)
                + self.bodies[i].rotor_inertia * qdd[i];
        }
        for (point, force) in contacts.active() {
            let wrench = Force::new(*force, (point.pos + point.arm).cross(force));
            for k in self.path(point.link) {
                effort[k] -= self.joints[k].axis.dot(&wrench);
            }
        }
    }

    /// Jacobians of the effort.
    #[inline(never)]
    pub(crate) fn differentiate<const FEET: usize>(
        &self,
        contacts: &Contacts<T, FEET>,
        out: &mut EffortJacobian<T, N, FEET>,
    ) {
        let pushes = contacts.sums(self);
        for (j, push) in pushes.iter().enumerate() {
            let (joint, sums) = (&self.joints[j], &self.moments[j]);
            let s = &joint.axis;
            let by_a = sums.inertia(s);
            let by_v = sums.carried_transposed(s);
            let above_v = sums.inertia(&joint.rate) * T::TWO + sums.carried(s);
            let kept = push.kept_direction(s);
            let above_q = s.cross_force(&sums.force)
                + sums.inertia(&joint.second)
                + sums.carried(&joint.rate)
                + Force::new(Vector3::zeros(), kept);
            let rotor = self.bodies[j].rotor_inertia;
            for k in self.path(j) {
                let other = &self.joints[k];
                out.by_q[k][j] = other.axis.dot(&above_q);
                out.by_v[k][j] = other.axis.dot(&above_v);
                let mass = other.axis.dot(&by_a);
                (out.by_a[j][k], out.by_a[k][j]) = (mass, mass);
                if k == j {
                    out.by_a[j][j] += rotor;
                }
                out.by_q[j][k] = other.second.dot(&by_a)
                    + other.rate.angular.dot(&by_v)
                    + other.axis.angular.dot(&kept);
                out.by_v[j][k] = other.rate.dot(&by_a) * T::TWO + other.axis.angular.dot(&by_v);
            }
        }
        for (f, (point, force)) in contacts.active().enumerate() {
            self.differentiate_couple(point, force, out);
            for k in self.path(point.link) {
                let column = -at_point(&self.joints[k].axis, &(point.pos + point.arm));
                if let Some(slot) = out.by_force[k].get_mut(f) {
                    *slot = column.into();
                }
            }
        }
    }
}

/// Joint indices from a tip to the base.
pub(crate) struct Path<'a, T, const N: usize> {
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

/// Points in contact and the forces on them, world axes; the first `count` are active.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contacts<T: Scalar, const FEET: usize> {
    pub(crate) points: [PointMotion<T>; FEET],
    pub(crate) forces: [Vector3<T>; FEET],
    pub(crate) count: usize,
}

impl<T: Scalar, const FEET: usize> Contacts<T, FEET> {
    pub(crate) fn active(&self) -> impl Iterator<Item = (&PointMotion<T>, &Vector3<T>)> {
        self.points.iter().zip(&self.forces).take(self.count)
    }

    /// Forces on the subtree of every joint.
    pub(crate) fn sums<const N: usize>(&self, sweep: &Sweep<'_, T, N>) -> [Push<T>; N] {
        let mut pushes = [Push::zero(); N];
        for (point, force) in self.active() {
            let moment = outer(&point.pos, force);
            for k in sweep.path(point.link) {
                pushes[k].force += force;
                pushes[k].spread += moment;
            }
        }
        pushes
    }
}

/// Sums over the contact forces F at r on a subtree.
#[derive(Clone, Copy)]
pub(crate) struct Push<T: Scalar> {
    /// Σ F.
    pub(crate) force: Vector3<T>,
    /// Σ r Fᵀ.
    pub(crate) spread: Matrix3<T>,
}

impl<T: Scalar> Push<T> {
    fn zero() -> Self {
        Self {
            force: Vector3::zeros(),
            spread: Matrix3::zeros(),
        }
    }

    /// Σ F × x(r): the moment by which the contact forces' wrench falls behind when the points move with
    /// X and the forces keep their direction.
    #[inline(always)]
    pub(crate) fn kept_direction(&self, x: &Motion<T>) -> Vector3<T> {
        self.force.cross(&x.linear) + turn(&self.spread, &x.angular)
    }
}

/// Jacobians of the effort by rows: `by_q[i][k]` is ∂τ_i/∂q_k; `by_force[i][f]` that of the f-th active contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EffortJacobian<T, const N: usize, const FEET: usize> {
    pub(crate) by_q: [[T; N]; N],
    pub(crate) by_v: [[T; N]; N],
    pub(crate) by_a: [[T; N]; N],
    pub(crate) by_force: [[[T; 3]; FEET]; N],
}

impl<T: Scalar, const N: usize, const FEET: usize> EffortJacobian<T, N, FEET> {
    pub(crate) const fn zero() -> Self {
        Self {
            by_q: [[T::ZERO; N]; N],
            by_v: [[T::ZERO; N]; N],
            by_a: [[T::ZERO; N]; N],
            by_force: [[[T::ZERO; 3]; FEET]; N],
        }
    }
}
