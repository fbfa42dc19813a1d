//! What all derivatives share: joint axes with their rates, and composites of subtrees, in base axes.
//!
//! Everything is expressed in the base's axes about its origin, so that nothing is transformed on the
//! way through the tree. For the joint of body i, with v and a the velocity and acceleration of body i:
//!
//! - S, the axis; Ṡ = v × S, how it moves; S̈ = a × S + v × Ṡ.
//! - I, h, Σ: mass moments of the subtree; f = Σ (I a + v ×* I v) − Σ f_ext its net force;
//! - p = ∫ ṙ dm and K = ∫ ṙ rᵀ dm: a rotation rate w of the whole subtree, on top of what it already
//!   does, adds the Coriolis acceleration 2 w × ṙ to every particle, hence the wrench
//!   B w = (2 w × p, 2 (tr(K) 1 − K) w).
//!
//! This B is twice the matrix B^C of Singh, Russell, Wensing 2022 ("Efficient analytical derivatives of
//! rigid-body dynamics using spatial vector algebra", RA-L); only its three rotational columns are
//! not zero. With them the force on the subtree of i changes, per unit of q_i, q̇_i and q̈_i, by
//!
//! - P = I S̈ + B Ṡ + S ×* f,
//! - Q = 2 I Ṡ + B S,
//! - F = I S,
//!
//! and the effort of i, when an ancestor j moves, by F·S̈_j + G·Ṡ_j, 2 F·Ṡ_j + G·S_j and F·S_j, with
//! G = Bᵀ S.
//!
//! # Layout
//! Only the way down, which needs the joint kinds, is a fold. What follows is the same for every body, so it
//! runs as plain loops over tables by *quantity* (`[[T; N]; K]`): neighbouring bodies, and neighbouring
//! joints of one branch, share a vector instruction.

#![allow(clippy::needless_range_loop, reason = "one index walks several tables")]

use nalgebra::{Matrix3, Vector3};
use so3::{Scalar, math};

use super::subtree::{COMPOSITE, Composite};
use super::table::{column, set_column};
use super::{at, place, put};
use crate::abreast::abreast_as;
use crate::joint::{JointKind, JointRotation};
use crate::model::Link;
use crate::spatial::{Force, Inertia, Motion, Symmetric3, product};
use crate::state::Posture;
use crate::tree::{At, Fold, Nothing, Tree};

/// Numbers in a [`Moving`].
const MOVING: usize = 40;
/// Numbers in the answer of a subtree: P, Q, F, G.
const ANSWER: usize = 21;

/// A body in the base's axes: where it is, how it moves, what it weighs, and the axis of its joint.
#[derive(Clone, Copy, Debug)]
struct Moving<T> {
    rotation: Matrix3<T>,
    origin: Vector3<T>,
    velocity: Motion<T>,
    acceleration: Motion<T>,
    /// S.
    axis: Motion<T>,
    /// In the body's own frame.
    inertia: Inertia<T>,
}

impl<T: Scalar> Moving<T> {
    #[inline(always)]
    fn pack(&self) -> [T; MOVING] {
        let (r, p, i) = (&self.rotation, &self.origin, &self.inertia);
        let (v, w) = (&self.velocity.linear, &self.velocity.angular);
        let (a, b) = (&self.acceleration.linear, &self.acceleration.angular);
        let (l, z) = (&self.axis.linear, &self.axis.angular);
        let (h, s) = (&i.first, &i.second);
        [
            r.m11, r.m12, r.m13, r.m21, r.m22, r.m23, r.m31, r.m32, r.m33, p.x, p.y, p.z, //
            v.x, v.y, v.z, w.x, w.y, w.z, a.x, a.y, a.z, b.x, b.y, b.z, //
            l.x, l.y, l.z, z.x, z.y, z.z, //
            i.mass, h.x, h.y, h.z, s.xx, s.yy, s.zz, s.xy, s.xz, s.yz,
        ]
    }

    #[inline(always)]
    fn unpack(x: &[T; MOVING]) -> Self {
        let vector = |i: usize| Vector3::new(x[i], x[i + 1], x[i + 2]);
        Self {
            rotation: Matrix3::new(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8]),
            origin: vector(9),
            velocity: Motion::new(vector(12), vector(15)),
            acceleration: Motion::new(vector(18), vector(21)),
            axis: Motion::new(vector(24), vector(27)),
            inertia: Inertia {
                mass: x[30],
                first: vector(31),
                second: Symmetric3::new([x[34], x[35], x[36], x[37], x[38], x[39]]),
            },
        }
    }

    /// Ṡ and S̈.
    #[inline(always)]
    fn rates(&self) -> (Motion<T>, Motion<T>) {
        let rate = self.velocity.cross(&self.axis);
        let second = self.acceleration.cross(&self.axis) + self.velocity.cross(&rate);
        (rate, second)
    }

    /// The inertia in the base's axes about the base's origin.
    #[inline(always)]
    fn carried(&self) -> Inertia<T> {
        let (r, i) = (&self.rotation, &self.inertia);
        i.assembled(r * i.first, i.second.rotated(r), &self.origin)
    }
}

/// How a joint moves its subtree, and what the subtree answers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint<T> {
    /// S.
    pub(crate) axis: Motion<T>,
    /// Ṡ.
    pub(crate) rate: Motion<T>,
    /// P = I S̈ + B Ṡ + S ×* f.
    pub(crate) by_q: Force<T>,
    /// Q = 2 I Ṡ + B S.
    pub(crate) by_v: Force<T>,
    /// F = I S.
    pub(crate) by_a: Force<T>,
    /// G = Bᵀ S.
    pub(crate) coriolis: Vector3<T>,
}

/// Scratch of the derivatives: bodies, subtrees and joints, in base axes, by quantity.
#[derive(Clone, Copy, Debug)]
pub struct DerivativesWorkspace<T, const N: usize> {
    /// [`Moving`].
    bodies: [[T; N]; MOVING],
    /// [`Composite`]: of each body, then of its subtree.
    subtrees: [[T; N]; COMPOSITE],
    /// S, Ṡ, S̈.
    pub(crate) axes: [[T; N]; 18],
    /// P, Q, F, G.
    pub(crate) answers: [[T; N]; ANSWER],
}

impl<T: Scalar, const N: usize> DerivativesWorkspace<T, N> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            bodies: [[T::ZERO; N]; MOVING],
            subtrees: [[T::ZERO; N]; COMPOSITE],
            axes: [[T::ZERO; N]; 18],
            answers: [[T::ZERO; N]; ANSWER],
        }
    }

    /// Own composite and axis rates of every body, each for itself.
    #[inline(never)]
    fn compose(&mut self) {
        for i in 0..N {
            let body = Moving::unpack(&column(&self.bodies, i));
            let own = Composite::of(body.carried(), &body.velocity, &body.acceleration);
            set_column(&mut self.subtrees, i, own.pack());
            let (rate, second) = body.rates();
            let [a, b, c, d, e, f] = body.axis.to_array();
            let [g, h, j, k, l, m] = rate.to_array();
            let [n, o, p, q, r, s] = second.to_array();
            let values = [a, b, c, d, e, f, g, h, j, k, l, m, n, o, p, q, r, s];
            set_column(&mut self.axes, i, values);
        }
    }

    /// F alone, what the mass matrix needs of each subtree's answer to its joint.
    #[inline(never)]
    pub(crate) fn answer_mass(&mut self) {
        for i in 0..N {
            let [m, hx, hy, hz, xx, yy, zz, xy, xz, yz, ..] = column(&self.subtrees, i);
            let inertia = Inertia {
                mass: m,
                first: Vector3::new(hx, hy, hz),
                second: Symmetric3::new([xx, yy, zz, xy, xz, yz]),
            };
            let [a, b, c, d, e, f, ..] = column(&self.axes, i);
            let by_a = inertia.mul(&Motion::from_array([a, b, c, d, e, f]));
            for (row, x) in self.answers[12..].iter_mut().zip(by_a.to_array()) {
                row[i] = x;
            }
        }
    }

    /// What each subtree answers to its joint, each for itself.
    #[inline(never)]
    pub(crate) fn answer(&mut self) {
        for i in 0..N {
            let subtree = Composite::unpack(&column(&self.subtrees, i));
            let [a, b, c, d, e, f, g, h, j, k, l, m, n, o, p, q, r, s] = column(&self.axes, i);
            let axis = Motion::from_array([a, b, c, d, e, f]);
            let rate = Motion::from_array([g, h, j, k, l, m]);
            let second = Motion::from_array([n, o, p, q, r, s]);
            let by_q = subtree.inertia.mul(&second)
                + subtree.coriolis(&rate.angular)
                + axis.cross_force(&subtree.force);
            let by_v = subtree.inertia.mul(&(rate * T::TWO)) + subtree.coriolis(&axis.angular);
            let by_a = subtree.inertia.mul(&axis);
            let [a, b, c, d, e, f] = by_q.to_array();
            let [g, h, j, k, l, m] = by_v.to_array();
            let [n, o, p, q, r, s] = by_a.to_array();
            let t = subtree.coriolis_transposed(&axis);
            let values = [
                a, b, c, d, e, f, g, h, j, k, l, m, n, o, p, q, r, s, t.x, t.y, t.z,
            ];
            set_column(&mut self.answers, i, values);
        }
    }

    /// Takes from the net forces what acts from outside, given in the frames of the bodies.
    #[inline(never)]
    fn subtract(&mut self, applied: &[Force<T>; N]) {
        for (i, force) in applied.iter().enumerate() {
            let body = Moving::unpack(&column(&self.bodies, i));
            let mut own = Composite::unpack(&column(&self.subtrees, i));
            let linear = body.rotation * force.linear;
            let angular = body.rotation * force.angular + body.origin.cross(&linear);
            own.force = own.force - Force::new(linear, angular);
            set_column(&mut self.subtrees, i, own.pack());
        }
    }

    /// Effort of the joints, S·f.
    #[inline(always)]
    pub(crate) fn efforts(&self) -> [T; N] {
        let mut out = [T::ZERO; N];
        for k in 0..6 {
            let (s, f) = (&self.axes[k], &self.subtrees[22 + k]);
            for i in 0..N {
                out[i] = math::mul_add(s[i], f[i], out[i]);
            }
        }
        out
    }

    /// From the state of the last [`sweep`] to one with more acceleration, everything else the same.
    ///
    /// With Δa_i = Δa_parent + S_i Δq̈_i, the axes gain ΔS̈ = Δa × S and the net forces
    /// Δf_i = I_i Δa_i + Σ F_j Δq̈_j over the joints j behind i. Needs F and leaves all answers.
    pub(crate) fn accelerate<M: Tree<T, N>>(
        &mut self,
        model: &M,
        base: &Motion<T>,
        joints: &[T; N],
    ) {
        let (mut motions, mut forces) = ([[T::ZERO; N]; 6], [[T::ZERO; N]; 6]);
        let base = base.to_array();
        let count = model.joint_count();
        for (i, body) in model.bodies().iter().enumerate().take(count) {
            let x = at(joints, i);
            for k in 0..6 {
                let carried = match body.parent {
                    Link::Base => base[k],
                    Link::Joint(p) => at(&motions[k], p),
                };
                put(&mut motions[k], i, carried + at(&self.axes[k], i) * x);
            }
        }
        for (i, body) in model.bodies().iter().enumerate().take(count).rev() {
            if let Link::Joint(p) = body.parent {
                let x = at(joints, i);
                for k in 0..6 {
                    let force = at(&forces[k], i) + at(&self.answers[12 + k], i) * x;
                    if let Some(slot) = forces[k].get_mut(p) {
                        *slot += force;
                    }
                }
            }
        }
        self.push(&motions, &forces);
        self.answer();
    }

    /// Adds motions to every body and, besides, forces to every subtree, each for itself.
    #[inline(never)]
    fn push(&mut self, motions: &[[T; N]; 6], forces: &[[T; N]; 6]) {
        for i in 0..N {
            let motion = Motion::from_array(column(motions, i));
            let mut subtree = Composite::unpack(&column(&self.subtrees, i));
            subtree.force += subtree.inertia.mul(&motion) + Force::from_array(column(forces, i));
            set_column(&mut self.subtrees, i, subtree.pack());
            let mut axes = column(&self.axes, i);
            let [a, b, c, d, e, f, ..] = axes;
            let gain = motion
                .cross(&Motion::from_array([a, b, c, d, e, f]))
                .to_array();
            for (x, y) in axes[12..].iter_mut().zip(gain) {
                *x += y;
            }
            set_column(&mut self.axes, i, axes);
        }
    }

    /// The subtree of joint `i`.
    #[inline(always)]
    pub(crate) fn subtree(&self, i: usize) -> Composite<T> {
        Composite::unpack(&column(&self.subtrees, i))
    }

    /// Joint `i` with the answer of its subtree.
    #[inline(always)]
    pub(crate) fn joint(&self, i: usize) -> Joint<T> {
        let [a, b, c, d, e, f, g, h, j, k, l, m, ..] = column(&self.axes, i);
        let (axis, rate) = ([a, b, c, d, e, f], [g, h, j, k, l, m]);
        let [
            a,
            b,
            c,
            d,
            e,
            f,
            g,
            h,
            j,
            k,
            l,
            m,
            n,
            o,
            p,
            q,
            r,
            s,
            x,
            y,
            z,
        ] = column(&self.answers, i);
        Joint {
            axis: Motion::from_array(axis),
            rate: Motion::from_array(rate),
            by_q: Force::from_array([a, b, c, d, e, f]),
            by_v: Force::from_array([g, h, j, k, l, m]),
            by_a: Force::from_array([n, o, p, q, r, s]),
            coriolis: Vector3::new(x, y, z),
        }
    }
}

impl<T: Scalar, const N: usize> Default for DerivativesWorkspace<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// What a body hands to those it carries.
#[derive(Clone, Copy, Debug)]
struct Carrier<T> {
    rotation: Matrix3<T>,
    origin: Vector3<T>,
    velocity: Motion<T>,
    acceleration: Motion<T>,
}

abreast_as!(
    Carrier<T> => (Matrix3<T>, (Vector3<T>, (Motion<T>, Motion<T>))),
    |c| (c.rotation, (c.origin, (c.velocity, c.acceleration))),
    |(rotation, (origin, (velocity, acceleration)))| Self { rotation, origin, velocity, acceleration }
);

struct Outward<'a, T: Scalar, const N: usize> {
    posture: &'a Posture<T, N>,
    velocity: &'a [T; N],
    acceleration: &'a [T; N],
    bodies: &'a mut [[T; N]; MOVING],
}

impl<T: Scalar, const N: usize> Fold<T> for Outward<'_, T, N> {
    const ABREAST: bool = false;
    type Down = Carrier<T>;
    type Keep = Nothing;
    type Up = Nothing;

    #[inline(always)]
    fn down<J: JointKind>(&mut self, here: At<'_, T>, up: &Carrier<T>) -> (Carrier<T>, Nothing) {
        let i = here.index;
        let (turn, offset) = place::<J, T, N>(here, self.posture);
        let rotation = turn.after(&up.rotation);
        let origin = up.origin + product(&up.rotation, &offset);
        let z = match J::KIND.axis() {
            0 => Vector3::new(rotation.m11, rotation.m21, rotation.m31),
            1 => Vector3::new(rotation.m12, rotation.m22, rotation.m32),
            _ => Vector3::new(rotation.m13, rotation.m23, rotation.m33),
        } * here.body.sign;
        let axis = if J::KIND.is_revolute() {
            Motion::new(origin.cross(&z), z)
        } else {
            Motion::new(z, Vector3::zeros())
        };
        let (qd, qdd) = (at(self.velocity, i), at(self.acceleration, i));
        let velocity = up.velocity + axis * qd;
        let acceleration = up.acceleration + axis * qdd + velocity.cross(&axis) * qd;
        let body = Moving {
            rotation,
            origin,
            velocity,
            acceleration,
            axis,
            inertia: here.body.inertia(),
        };
        set_column(self.bodies, i, body.pack());
        let carrier = Carrier {
            rotation,
            origin,
            velocity,
            acceleration,
        };
        (carrier, Nothing)
    }

    #[inline(always)]
    fn up<J: JointKind>(&mut self, _: At<'_, T>, _: &Nothing, _: Nothing) -> Nothing {
        Nothing
    }
}

/// How a robot moves: of the base, with gravity as an upward acceleration where it counts, and of the
/// joints.
pub(crate) struct Moves<'a, T: Scalar, const N: usize> {
    /// What counts as the base's inertia.
    pub(crate) base_inertia: Inertia<T>,
    pub(crate) base_velocity: Motion<T>,
    pub(crate) base_acceleration: Motion<T>,
    pub(crate) velocity: &'a [T; N],
    pub(crate) acceleration: &'a [T; N],
    pub(crate) applied: Option<&'a [Force<T>; N]>,
}

/// Fills the workspace but for the answers of the subtrees; returns the composite of the whole robot.
#[inline(always)]
pub(crate) fn sweep<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    posture: &Posture<T, N>,
    moves: &Moves<'_, T, N>,
    ws: &mut DerivativesWorkspace<T, N>,
) -> Composite<T> {
    let mut fold = Outward {
        posture,
        velocity: moves.velocity,
        acceleration: moves.acceleration,
        bodies: &mut ws.bodies,
    };
    let base = Carrier {
        rotation: Matrix3::identity(),
        origin: Vector3::zeros(),
        velocity: moves.base_velocity,
        acceleration: moves.base_acceleration,
    };
    model.fold(&mut fold, &base);
    ws.compose();
    if let Some(applied) = moves.applied {
        ws.subtract(applied);
    }
    let own = Composite::of(
        moves.base_inertia,
        &moves.base_velocity,
        &moves.base_acceleration,
    );
    let mut whole = own.pack();
    let count = model.joint_count();
    for (i, body) in model.bodies().iter().enumerate().take(count).rev() {
        let values = column(&ws.subtrees, i);
        match body.parent {
            Link::Base => {
                for (x, y) in whole.iter_mut().zip(values) {
                    *x += y;
                }
            }
            Link::Joint(p) => {
                for (row, y) in ws.subtrees.iter_mut().zip(values) {
                    if let Some(x) = row.get_mut(p) {
                        *x += y;
                    }
                }
            }
        }
    }
    Composite::unpack(&whole)
}
