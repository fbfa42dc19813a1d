//! Distances between links, as tasks: capsules around limbs that are to stay apart.
//!
//! A capsule ([`rbd_core::Shape`]) is a segment with a radius, a ball one of length zero. With p(s) = p₀ + s u and r(t) = r₀ + t v, s and t in [0, 1], the nearest points of two
//! segments, w = p − r and n = w/|w|, the distance is d = |w| less both radii. At the optimum moving s or t changes nothing to
//! first order, so ḋ = n·(ṗ − ṙ) with the velocities of the points as they are fixed to their links: that is J. The second
//! derivative also sees n turn and the points wander: the conditions w·u = 0 and w·v = 0 (of those that are not at an end) give
//! ṡ and ṫ, with which d̈ = J ν̇ + J̇ν is exact wherever d is smooth. It is not where the segments are parallel, where a nearest point comes to an
//! end of its segment, and where the segments meet.
//!
//! Kept apart by a velocity damper: a row d̈ or ḋ ≥ what [`Horizon::least_rate`](crate::Horizon::least_rate) and
//! [`Horizon::least_acceleration`](crate::Horizon::least_acceleration) allow (Faverjon and Tournassoud 1987).

use nalgebra::Vector3;
use rbd_core::{Axes, Effort, Force, Frame, FrameJacobian, Motion, Shape, Tree, frame_jacobian};
use so3::{Scalar, math};

use crate::{Snapshot, Task};

/// How near two capsules are, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance<T: Scalar> {
    /// Between the surfaces, m; negative where they overlap.
    pub distance: T,
    /// The nearest points of the two segments, each on its own, m.
    pub points_w: [Vector3<T>; 2],
    /// From the second to the first.
    pub normal_w: Vector3<T>,
}

/// A segment's direction in the world, its nearest point as a frame of its link, and how both move.
struct Segment<T: Scalar> {
    frame: Frame<T>,
    direction: Vector3<T>,
    /// Velocity and, at ν̇ = 0, acceleration of the nearest point as fixed to its link.
    velocity: Vector3<T>,
    drift: Vector3<T>,
    turn: Vector3<T>,
}

impl<T: Scalar, const N: usize> Snapshot<T, N> {
    /// How near two capsules are.
    #[must_use]
    pub fn clearance(&self, a: &Shape<T>, b: &Shape<T>) -> Clearance<T> {
        self.nearest(a, b).0
    }

    /// How near they are, and where on their segments.
    fn nearest(&self, a: &Shape<T>, b: &Shape<T>) -> (Clearance<T>, [T; 2]) {
        let ([p, u], [r, v]) = (self.segment(a), self.segment(b));
        let [s, t] = nearest(&(p - r), &u, &v);
        let points_w = [p + u * s, r + v * t];
        let w = points_w[0] - points_w[1];
        let length = math::sqrt(w.norm_squared());
        // Where the segments meet there is no direction; any does.
        let normal_w = if length > T::ZERO {
            w / length
        } else {
            Vector3::z()
        };
        let near = Clearance {
            distance: length - a.radius - b.radius,
            points_w,
            normal_w,
        };
        (near, [s, t])
    }

    /// The distance between two capsules as a task: x = d, one row.
    #[must_use]
    pub fn distance<M: Tree<T, N>>(&self, model: &M, a: &Shape<T>, b: &Shape<T>) -> Task<T, N, 1> {
        let (near, place) = self.nearest(a, b);
        let n = near.normal_w;
        let [first, second] = [
            self.moving(a, &near.points_w[0]),
            self.moving(b, &near.points_w[1]),
        ];
        let row = |segment: &Segment<T>| {
            let mut j = FrameJacobian::ZERO;
            let axes = Axes::LocalWorldAligned;
            frame_jacobian(model, &self.kinematics, &segment.frame, axes, &mut j);
            j.tr_mul(&Force::new(n, Vector3::zeros()))
        };
        let jacobian: Effort<T, N> = row(&first) - row(&second);
        let (u, v) = (first.direction, second.direction);
        let w = near.points_w[0] - near.points_w[1];
        let apart = first.velocity - second.velocity;
        // (w·u)˙ = 0 and (w·v)˙ = 0 with ẇ = apart + u ṡ − v ṫ.
        let known = [
            -(apart.dot(&u) + w.dot(&first.turn.cross(&u))),
            -(apart.dot(&v) + w.dot(&second.turn.cross(&v))),
        ];
        let [s, t] = wander(&u, &v, known, place.map(|x| x > T::ZERO && x < T::ONE));
        let motion = apart + u * s - v * t;
        let length = math::sqrt(w.norm_squared());
        let turning = if length > T::ZERO {
            (motion - n * n.dot(&motion)) / length
        } else {
            Vector3::zeros()
        };
        let wandering = first.turn.cross(&u) * s - second.turn.cross(&v) * t;
        Task {
            jacobian: [jacobian],
            drift: [n.dot(&(first.drift - second.drift + wandering)) + turning.dot(&apart)],
            rate: [n.dot(&apart)],
        }
    }

    /// First end and direction of a capsule's segment in the world.
    fn segment(&self, capsule: &Shape<T>) -> [Vector3<T>; 2] {
        let xf_wl = self.kinematics.link(capsule.link);
        let [a, b] = [capsule.from, capsule.to].map(|end| xf_wl.point(&Vector3::from(end)));
        [a, b - a]
    }

    fn moving(&self, capsule: &Shape<T>, point_w: &Vector3<T>) -> Segment<T> {
        let xf_wl = self.kinematics.link(capsule.link);
        let [_, direction] = self.segment(capsule);
        let offset = xf_wl.inverse().point(point_w);
        let frame = Frame {
            link: capsule.link,
            offset: offset.into(),
            ..Frame::IDENTITY
        };
        let turned =
            |m: Motion<T>| Motion::new(xf_wl.rotation * m.linear, xf_wl.rotation * m.angular);
        let velocity = turned(self.motions.frame_velocity(&frame));
        let drift = turned(self.motions.frame_classical_acceleration(&frame));
        Segment {
            frame,
            direction,
            velocity: velocity.linear,
            drift: drift.linear,
            turn: velocity.angular,
        }
    }
}

/// s and t of the nearest points w + s u and t v of two segments (Ericson 2005, section 5.1.9).
fn nearest<T: Scalar>(w: &Vector3<T>, u: &Vector3<T>, v: &Vector3<T>) -> [T; 2] {
    let unit = |x: T| math::clamp(x, T::ZERO, T::ONE);
    let (a, b, e) = (u.norm_squared(), u.dot(v), v.norm_squared());
    let (c, f) = (u.dot(w), v.dot(w));
    match (a > T::ZERO, e > T::ZERO) {
        (false, false) => return [T::ZERO; 2],
        (false, true) => return [T::ZERO, unit(f / e)],
        (true, false) => return [unit(-c / a), T::ZERO],
        (true, true) => {}
    }
    let det = a * e - b * b;
    // Parallel segments have many nearest points; the first end's is one.
    let s = if det > T::of(16.0) * T::EPSILON * a * e {
        unit((b * f - c * e) / det)
    } else {
        T::ZERO
    };
    let t = (b * s + f) / e;
    if t < T::ZERO {
        [unit(-c / a), T::ZERO]
    } else if t > T::ONE {
        [unit((b - c) / a), T::ONE]
    } else {
        [s, t]
    }
}

/// Rates of s and t that keep the nearest points nearest: a ṡ − b ṫ and b ṡ − e ṫ are known; a place at an end stays there.
fn wander<T: Scalar>(
    u: &Vector3<T>,
    v: &Vector3<T>,
    [k, l]: [T; 2],
    is_inside: [bool; 2],
) -> [T; 2] {
    let (a, b, e) = (u.norm_squared(), u.dot(v), v.norm_squared());
    let det = a * e - b * b;
    match is_inside {
        [true, true] if det > T::of(16.0) * T::EPSILON * a * e => {
            [(e * k - b * l) / det, (b * k - a * l) / det]
        }
        [true, false] => [k / a, T::ZERO],
        [false, true] => [T::ZERO, -l / e],
        _ => [T::ZERO; 2],
    }
}
