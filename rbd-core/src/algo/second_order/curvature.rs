//! Second derivatives of inverse dynamics, accelerations and positions, contracted with multipliers.
//!
//! The scalar is
//!
//! ```text
//! φ(q, q̇, q̈, F) = λ · τ(q, q̇, q̈, F) + Σ μ_f · a_f(q, q̇, q̈) + Σ ν_i · r_i(q)
//! ```
//!
//! with efforts τ, accelerations a_f of contact points and positions r_i of points. λ is treated as a
//! virtual velocity: Λ = Σ S λ over a body and its ancestors, and λ·τ = Σ_bodies Λ · f. When joint k moves,
//! its subtree is carried along, and seen from the subtree only what comes in through joint k changes:
//! δV = Ṡ_k, δA = S̈_k + Ṡ_k × V, δΛ = S^λ_k with S^λ = Λ × S; for q̇_k it is δV = S_k,
//! δA = 2 Ṡ_k + S_k × V. With the subtree's sums H = ∫ Λ, G = Σ Cᵀ Λ (I, C of [`super::moments`]), and for a joint j
//! and an ancestor k (or k = j):
//!
//! ```text
//! P = I S^λ_j + S_j ×* H                                   q_j q_k: S̈_k·P + Ṡ_k·Q + S^λ_k·R
//! Q = Cᵀ S^λ_j + Ṡ_j ×* 2H + S_j ×* G + Nᵀ Ṡ_j             q̇_j q_k: Ṡ_k·U + S^λ_k·W
//! R = S_j ×* f + I S̈_j + C Ṡ_j                             q̈_j q_k: S^λ_k·Φ
//! U = S_j ×* 2H + Nᵀ S_j                                   q_j q̇_k: 2 Ṡ_k·P + S_k·Q
//! W = 2 I Ṡ_j + C S_j,   Φ = I S_j                         q̇_j q̇_k: S_k·U,   q_j q̈_k: S_k·P
//! ```
//!
//! where N X = (0, 2 ∫ x(r) × Λ) . Contact forces, μ and ν keep their directions in the world while the bodies turn
//! under them; the terms that this adds are marked below.
//!
//! This is the contraction of the second-order derivatives of Singh, Russell, Wensing, "On second-order
//! derivatives of rigid-body dynamics", 2023, with one sweep instead of a tensor; derived here in the
//! moments' form.

use nalgebra::{Matrix3, Vector3};
use so3::{Scalar, hat};

use super::contacts::Push;
use super::moments::{moment_of, outer, turn};
use super::{Contacts, Hessian, PointMotion, Sweep};
use crate::model::Link;
use crate::spatial::{Force, Motion};

/// Sums over the virtual velocities and multipliers of a subtree.
#[derive(Clone, Copy)]
struct Weights<T: Scalar> {
    /// ∫ Λ and Σ μ.
    virtual_momentum: Vector3<T>,
    /// ∫ Λ rᵀ and Σ μ rᵀ.
    virtual_transport: Matrix3<T>,
    /// Angular part of G.
    gyration: Vector3<T>,
    /// Σ μ.
    pull: Vector3<T>,
    /// Σ μ rᵀ.
    pull_by_pos: Matrix3<T>,
    /// Σ μ vᵀ.
    pull_by_velocity: Matrix3<T>,
    /// Σ a μᵀ.
    acceleration_by_pull: Matrix3<T>,
    /// Σ Λ(r) Fᵀ over contact forces F.
    virtual_by_force: Matrix3<T>,
    /// Σ ν.
    push: Vector3<T>,
    /// Σ ν rᵀ.
    push_by_pos: Matrix3<T>,
}

impl<T: Scalar> Weights<T> {
    fn zero() -> Self {
        Self {
            virtual_momentum: Vector3::zeros(),
            virtual_transport: Matrix3::zeros(),
            gyration: Vector3::zeros(),
            pull: Vector3::zeros(),
            pull_by_pos: Matrix3::zeros(),
            pull_by_velocity: Matrix3::zeros(),
            acceleration_by_pull: Matrix3::zeros(),
            virtual_by_force: Matrix3::zeros(),
            push: Vector3::zeros(),
            push_by_pos: Matrix3::zeros(),
        }
    }

    fn add(&mut self, o: &Self) {
        self.virtual_momentum += o.virtual_momentum;
        self.virtual_transport += o.virtual_transport;
        self.gyration += o.gyration;
        self.pull += o.pull;
        self.pull_by_pos += o.pull_by_pos;
        self.pull_by_velocity += o.pull_by_velocity;
        self.acceleration_by_pull += o.acceleration_by_pull;
        self.virtual_by_force += o.virtual_by_force;
        self.push += o.push;
        self.push_by_pos += o.push_by_pos;
    }

    /// H.
    fn momentum(&self) -> Force<T> {
        Force::new(self.virtual_momentum, moment_of(&self.virtual_transport))
    }

    /// Nᵀ X.
    fn gyration_transposed(&self, x: &Motion<T>) -> Force<T> {
        let (p, k, w) = (&self.virtual_momentum, &self.virtual_transport, &x.angular);
        Force::new(p.cross(w), k * w - w * k.trace()) * T::TWO
    }
}

/// The virtual velocities of the bodies and what their joints do to them.
struct Virtuals<T, const N: usize> {
    /// Λ.
    motions: [Motion<T>; N],
    /// S^λ.
    rates: [Motion<T>; N],
}

/// What joint j gives to be multiplied with the axes of its ancestors: P, Q, R, U, W and Φ of the head of this file, with contact forces, μ
/// and ν.
struct Terms<T: Scalar> {
    p: Force<T>,
    q: Force<T>,
    r: Force<T>,
    u: Force<T>,
    w: Force<T>,
    f: Force<T>,
    /// Of the angular parts of S_k, in q_j, q̇_j and q̈_j: what keeps its direction in the world.
    z_q: Vector3<T>,
    z_v: Vector3<T>,
    z_a: Vector3<T>,
}

/// x × M-weighted points: `Σ x(r) × μ` from Σ μ and Σ μ rᵀ.
fn pulled<T: Scalar>(x: &Motion<T>, pull: &Vector3<T>, by_pos: &Matrix3<T>) -> Vector3<T> {
    x.linear.cross(pull) - turn(&by_pos.transpose(), &x.angular)
}

/// Multipliers of the terms of φ.
#[derive(Clone, Copy, Debug)]
pub struct Multipliers<'a, T: Scalar, const N: usize, const CONTACTS: usize> {
    /// λ of the efforts.
    pub effort: &'a [T; N],
    /// μ of the accelerations of the contacts that count ([`Sweep::slip_rate`]).
    pub acceleration: &'a [Vector3<T>; CONTACTS],
}

/// The sums ν of position terms, collected per body.
#[derive(Clone, Copy, Debug)]
pub struct PositionTerms<T: Scalar, const N: usize> {
    push: [(Vector3<T>, Matrix3<T>); N],
}

impl<T: Scalar, const N: usize> PositionTerms<T, N> {
    /// No positions.
    #[must_use]
    pub fn new() -> Self {
        Self {
            push: [(Vector3::zeros(), Matrix3::zeros()); N],
        }
    }

    /// Adds ν · r of a point at `pos` on body `link`.
    #[inline(always)]
    pub fn add(&mut self, link: usize, pos: &Vector3<T>, weight: &Vector3<T>) {
        if let Some((sum, by_pos)) = self.push.get_mut(link) {
            *sum += weight;
            *by_pos += outer(weight, pos);
        }
    }

    /// Adds Σ ν · r of points on body `link` with Σ ν = 0, given Σ ν rᵀ.
    pub fn add_spread(&mut self, link: usize, spread: &Matrix3<T>) {
        if let Some((_, by_pos)) = self.push.get_mut(link) {
            *by_pos += spread;
        }
    }
}

impl<T: Scalar, const N: usize> Default for PositionTerms<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Scalar, const N: usize> Sweep<'_, T, N> {
    /// Adds the second derivatives in (q, q̇, q̈, F) of
    ///
    /// φ = Σ λ_i τ_i + Σ μ_f · a_f + Σ ν_i · r_i
    ///
    /// with efforts τ ([`Self::effort`]), accelerations a of the contacts ([`Self::slip_rate`]) and positions r of points. Those in q̈ and
    /// q̇ and in q̈ twice are zero: inverse dynamics is linear in q̈, and M does not know q̇.
    #[inline(never)]
    pub fn curvature<const CONTACTS: usize>(
        &self,
        contacts: &Contacts<T, CONTACTS>,
        multipliers: &Multipliers<'_, T, N, CONTACTS>,
        positions: &PositionTerms<T, N>,
        out: &mut Hessian<T, N, CONTACTS>,
    ) {
        let virtuals = self.virtuals(multipliers.effort);
        let weights = self.weights(contacts, multipliers.acceleration, positions, &virtuals);
        let pushes = contacts.sums(self);
        for j in 0..N {
            let virtual_rate = &virtuals.rates[j];
            let terms = self.terms(j, &weights[j], &pushes[j], virtual_rate);
            for k in self.path(j) {
                let (other, other_rate) = (&self.joints[k], &virtuals.rates[k]);
                let turn_k = &other.axis.angular;
                let qq = other.second.dot(&terms.p)
                    + other.rate.dot(&terms.q)
                    + other_rate.dot(&terms.r)
                    + turn_k.dot(&terms.z_q);
                let vv = other.axis.dot(&terms.u);
                out.qq[j][k] += qq;
                out.vv[j][k] += vv;
                out.vq[j][k] +=
                    other.rate.dot(&terms.u) + other_rate.dot(&terms.w) + turn_k.dot(&terms.z_v);
                out.aq[j][k] += other_rate.dot(&terms.f) + turn_k.dot(&terms.z_a);
                if k != j {
                    out.qq[k][j] += qq;
                    out.vv[k][j] += vv;
                    out.vq[k][j] += other.rate.dot(&terms.p) * T::TWO + other.axis.dot(&terms.q);
                    out.aq[k][j] += other.axis.dot(&terms.p);
                }
            }
        }
        for (foot, mu) in contacts.active().zip(multipliers.acceleration) {
            self.rolling_curvature(foot, mu, &virtuals.motions, out);
        }
        self.force_curvature(contacts, &virtuals, out);
    }

    /// Λ and S^λ of every joint.
    #[inline(always)]
    fn virtuals(&self, effort: &[T; N]) -> Virtuals<T, N> {
        let mut virtuals = Virtuals {
            motions: [Motion::ZERO; N],
            rates: [Motion::ZERO; N],
        };
        for (i, lambda) in effort.iter().enumerate() {
            let parent = match self.bodies[i].parent {
                Link::Joint(p) => virtuals.motions.get(p).copied().unwrap_or(Motion::ZERO),
                Link::Base => Motion::ZERO,
            };
            let axis = &self.joints[i].axis;
            virtuals.rates[i] = parent.cross(axis);
            virtuals.motions[i] = parent + *axis * *lambda;
        }
        virtuals
    }

    /// The sums over every subtree.
    #[inline(always)]
    fn weights<const CONTACTS: usize>(
        &self,
        contacts: &Contacts<T, CONTACTS>,
        pulls: &[Vector3<T>; CONTACTS],
        positions: &PositionTerms<T, N>,
        virtuals: &Virtuals<T, N>,
    ) -> [Weights<T>; N] {
        let mut weights = [Weights::zero(); N];
        for (i, weight) in weights.iter_mut().enumerate() {
            (weight.push, weight.push_by_pos) = positions.push[i];
            self.own_weights(i, &virtuals.motions[i], weight);
        }
        for ((point, force), mu) in contacts.active().zip(pulls) {
            if let (Some(weight), Some(lambda)) = (
                weights.get_mut(point.link),
                virtuals.motions.get(point.link),
            ) {
                add_acceleration(weight, point, mu);
                weight.virtual_by_force += outer(&lambda.at_point(&point.pos), force);
            }
        }
        for i in (0..N).rev() {
            if let Link::Joint(p) = self.bodies[i].parent {
                let below = weights[i];
                if let Some(slot) = weights.get_mut(p) {
                    slot.add(&below);
                }
            }
        }
        weights
    }

    /// The [`Terms`] of joint `j`, from the sums over its subtree.
    #[inline(always)]
    fn terms(
        &self,
        j: usize,
        w: &Weights<T>,
        push: &Push<T>,
        virtual_rate: &Motion<T>,
    ) -> Terms<T> {
        let (joint, sums) = (&self.joints[j], &self.moments[j]);
        let (s, rate, second) = (&joint.axis, &joint.rate, &joint.second);
        let h = w.momentum();
        let angular = |v| Force::new(Vector3::zeros(), v);

        // μ keeps its direction: seen from the subtree it turns by −S_k × μ, where Λ gains S^λ_k.
        let pulled_axis = Force::new(w.pull.cross(&s.angular), -turn(&w.pull_by_pos, &s.angular));
        let p = sums.inertia(virtual_rate) + s.cross_force(&h) + pulled_axis;
        let q = angular(sums.carried_transposed(virtual_rate))
            + rate.cross_force(&h) * T::TWO
            + s.cross_force(&angular(w.gyration))
            + w.gyration_transposed(rate)
            - angular(turn(&w.pull_by_velocity, &s.angular) * T::TWO);
        let r = s.cross_force(&sums.force)
            + sums.inertia(second)
            + sums.carried(rate)
            + angular(push.kept_direction(s));
        let u = s.cross_force(&h) * T::TWO + w.gyration_transposed(s);
        let of_speed = sums.inertia(rate) * T::TWO + sums.carried(s);
        let f = sums.inertia(s);

        // What the axis of k sees of vectors that do not turn with it: F, μ, ν.
        let turning = |w: &Weights<T>, m: &Motion<T>| pulled(m, &w.pull, &w.pull_by_pos);
        let swept = |m: &Vector3<T>| -turn(&w.pull_by_velocity.transpose(), m) * T::TWO;
        let z_q = push.kept_direction(virtual_rate) - turn(&w.acceleration_by_pull, &s.angular)
            + turn(&w.virtual_by_force, &s.angular)
            + turning(w, second)
            + swept(&rate.angular)
            + pulled(s, &w.push, &w.push_by_pos);
        let z_v = turning(w, rate) * T::TWO + swept(&s.angular);
        let z_a = turning(w, s);

        Terms {
            p,
            q,
            r,
            u,
            w: of_speed,
            f,
            z_q,
            z_v,
            z_a,
        }
    }

    /// Adds the second derivatives in the contact forces and q.
    #[inline(always)]
    fn force_curvature<const CONTACTS: usize>(
        &self,
        contacts: &Contacts<T, CONTACTS>,
        virtuals: &Virtuals<T, N>,
        out: &mut Hessian<T, N, CONTACTS>,
    ) {
        for ((point, _), block) in contacts.active().zip(&mut out.force) {
            let Some(virtual_motion) = virtuals.motions.get(point.link) else {
                continue;
            };
            let slip = virtual_motion.at_point(&point.pos);
            let touch = point.pos + point.arm;
            for k in self.path(point.link) {
                let turn_k = &self.joints[k].axis.angular;
                let column = turn_k.cross(&slip)
                    + turn_k.cross(&virtual_motion.angular).cross(&point.arm)
                    + virtuals.rates[k].at_point(&touch);
                for (row, value) in block.iter_mut().zip(column.iter()) {
                    row.q[k] -= *value;
                }
            }
        }
    }

    /// ∫ Λ, ∫ Λ rᵀ and Cᵀ Λ of body `i` alone.
    #[inline(always)]
    fn own_weights(&self, i: usize, lambda: &Motion<T>, weight: &mut Weights<T>) {
        let own = &self.own[i];
        if own.mass > T::ZERO {
            weight.virtual_momentum = lambda.linear * own.mass + lambda.angular.cross(&own.first);
            weight.virtual_transport =
                outer(&lambda.linear, &own.first) + hat(&lambda.angular) * own.second;
            weight.gyration = own.carried_transposed(lambda);
        }
    }
}

/// Adds μ · a of a contact point.
#[inline(always)]
fn add_acceleration<T: Scalar>(weight: &mut Weights<T>, point: &PointMotion<T>, mu: &Vector3<T>) {
    let by_pos = outer(mu, &point.pos);
    weight.virtual_momentum += mu;
    weight.virtual_transport += by_pos;
    weight.gyration += point.velocity.cross(mu) * T::TWO;
    weight.pull += mu;
    weight.pull_by_pos += by_pos;
    weight.pull_by_velocity += outer(mu, &point.velocity);
    weight.acceleration_by_pull += outer(&point.lifted, mu);
}
