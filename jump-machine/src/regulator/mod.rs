//! The push-off regulated: a time-varying LQR on the single rigid body along the plan's nodes.
//!
//! Joint control does not see where the whole robot goes: with every joint on its target, ground that yields or a motor that is weak
//! leaves it too slow and leaning, and on two feet what leans topples, e-fold in a tenth of a second. What the feet's forces are to change is
//! the answer of a linear-quadratic problem. With x = (δc, δθ, δv, δL), the error of the centre of mass, of the rotation, of the velocity and of
//! the angular momentum about the centre of mass, world axes, measured less planned:
//!
//! ```text
//! δċ = δv    δθ̇ = I⁻¹ (δL + L × δθ)    δv̇ = Σ δf_i / m    δL̇ = F × δc + Σ r_i × δf_i
//! ```
//!
//! where r_i are the planned places of the feet seen from the centre of mass and F = Σ f_i. The cost is Σ (error/σ)² at touchdown, with a flight
//! without feedback until there, and at take-off, and Σ (error/σ)² + Σ (δf_i/σ_i)² over the push-off ([`Weights`]). A foot's σ_i is a share of its planned
//! force, so a foot that the plan does not push with is given none.
//!
//! Riccati's recursion runs backwards over the nodes once, when a jump is armed. What is kept of it are the six rows Λ of the cost-to-go S that
//! belong to the momenta; with the costates (λ_v, λ_L) = Λ x the best change of a foot's force is
//!
//! ```text
//! δf_i = −σ_i² (λ_v / m + λ_L × r_i)
//! ```
//!
//! where r_i is measured. So nothing in Λ depends on which feet stand now.
//!
//! Source: the discrete-time Riccati recursion (Anderson and Moore, *Optimal Control: Linear Quadratic Methods*, 1990, ch. 2), by rank-one
//! steps; the equations of motion are paper A's III-A, linearised.

mod body;
mod cost_to_go;
#[cfg(test)]
mod tests;
mod weights;

use core::num::NonZeroUsize;

use jump_control::Plan;
use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};
use rbd_core::{CentroidalState, Frame, Limbs, Tangent, Tree, centroidal_state};
use so3::{Scalar, math};

pub use weights::Weights;

use body::Body;
use cost_to_go::{
    ANGULAR, CostToGo, ERRORS, MOMENTA, PLACE, ROTATION, VELOCITY, at, product, stack,
};

/// Most states that are kept of a plan's push-off: 0.95 s of nodes that are 5 ms apart; of a longer one every second, and so on.
const STATES: usize = 192;
/// Most gains that are kept: they change more slowly, one in 10 ms is enough.
const GAINS: usize = 72;

/// Place, velocity and angular momentum of a plan's centre of mass, in single precision, as plans are stored.
type State = [[f32; 3]; 3];
/// Λ by columns.
type Gain = [[f32; MOMENTA]; ERRORS];

/// The gains of one jump, and the motion that they are for: 27.7 kB.
#[derive(Clone, Debug)]
pub struct Regulator {
    states: [State; STATES],
    gains: [Gain; GAINS],
    /// Nodes from one state, and one gain, to the next; states are counted from the first node on, gains back from the last before the take-off.
    every: [NonZeroUsize; 2],
    /// Number of nodes before the take-off.
    nodes: usize,
}

impl Regulator {
    /// Without a jump: forces are never changed.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            states: [[[0.0; 3]; 3]; STATES],
            gains: [[[0.0; MOMENTA]; ERRORS]; GAINS],
            every: [NonZeroUsize::MIN; 2],
            nodes: 0,
        }
    }

    /// Computes the gains for a plan. This takes as long as some hundred ticks: it is done when a jump is armed.
    pub fn prepare<T: Scalar, M: Tree<T, N>, const N: usize, const F: usize>(
        &mut self,
        model: &M,
        plan: &Plan<'_, T, N, F>,
        weights: &Weights<T>,
        feet: &[Frame<T>; F],
    ) {
        let time = |i| plan.time(i).unwrap_or(T::INFINITY);
        let mut nodes = 0;
        // A node at the take-off belongs to the flight, whatever rounding made of it.
        while time(nodes + 1) + time(nodes) < plan.takeoff * T::TWO {
            nodes += 1;
        }
        self.nodes = nodes;
        let more = [nodes / (STATES - 1), nodes / (GAINS - 1)];
        self.every = more.map(|more| NonZeroUsize::MIN.saturating_add(more));
        let mut cost = CostToGo::zero();
        cost.add(PLACE, &per_variance(weights.touchdown[0]));
        cost.add(ROTATION, &per_variance(weights.touchdown[1]));
        for i in (0..plan.count().saturating_sub(1)).rev() {
            let Some(node) = plan.node(i) else { return };
            let (body, dt) = (Body::new(model, &node, feet), time(i + 1) - node.time);
            if node.time < plan.touchdown {
                cost.before(&body.drift(dt));
            }
            if i == nodes {
                add_errors(&mut cost, &weights.takeoff, &body, T::ONE);
            }
            if i < nodes {
                answer(&mut cost, weights, &body, dt);
            }
            if i <= nodes {
                self.keep(i, &body, &cost);
                add_errors(&mut cost, &weights.running, &body, dt / weights.time);
            }
        }
    }

    /// Keeps state and gain of a node.
    fn keep<T: Scalar, const F: usize>(&mut self, i: usize, body: &Body<T, F>, cost: &CostToGo<T>) {
        let [state, gain] = self.every;
        let single = |x: T| x.to_f64() as f32;
        if let Some(to) = self
            .states
            .get_mut(i / state)
            .filter(|_| i.is_multiple_of(state.get()))
        {
            let of = [body.com_w, body.com_velocity_w, body.angular_w];
            *to = of.map(|part| <[T; 3]>::from(part).map(single));
        }
        let Some(left) = self.nodes.checked_sub(i + 1) else {
            return;
        };
        if let Some(to) = self
            .gains
            .get_mut(left / gain)
            .filter(|_| left.is_multiple_of(gain.get()))
        {
            *to = <[[T; MOMENTA]; ERRORS]>::from(cost.costate()).map(|column| column.map(single));
        }
    }

    /// What the forces of the ground on the feet are to change by, world axes, N.
    ///
    /// `moments` of the plan, each the node before it and the time, s: now, when `limbs` are as they are, and when `velocity` was. `planned_w` are the
    /// planned forces, world axes. Zero before the plan's first node and from the take-off on.
    pub fn forces<T: Scalar, M: Tree<T, N>, const N: usize, const F: usize>(
        &self,
        (model, weights): (&M, &Weights<T>),
        plan: &Plan<'_, T, N, F>,
        moments: [(usize, T); 2],
        velocity: &Tangent<T, N>,
        limbs: &Limbs<T, N, F>,
        planned_w: &[Vector3<T>; F],
    ) -> [Vector3<T>; F] {
        let mut changes = [Vector3::zeros(); F];
        let base = limbs.posture.base();
        let now = centroidal_state(model, &limbs.posture, velocity);
        let Some(costate) = self.costate(plan, moments, &base.rotation, &now) else {
            return changes;
        };
        let linear = Vector3::from_fn(|row, _| at(&costate, row, 0)) / now.mass;
        let angular = Vector3::from_fn(|row, _| at(&costate, 3 + row, 0));
        for ((change, end), planned) in changes.iter_mut().zip(&limbs.ends).zip(planned_w) {
            let arm = base.point(&end.position) - now.com_w;
            let gradient: Vector3<T> = linear + angular.cross(&arm);
            let wanted = Vector3::from_fn(|axis, _| {
                let slope = gradient.get(axis).copied().unwrap_or_default();
                -slope * weights.per_cost(planned.z, axis)
            });
            *change = weights.within_cone(planned, &wanted) - planned;
        }
        changes
    }

    /// Λ x; none outside the push-off.
    fn costate<T: Scalar, const N: usize, const F: usize>(
        &self,
        plan: &Plan<'_, T, N, F>,
        [(node, time), (was, then)]: [(usize, T); 2],
        rot_wb: &Rotation3<T>,
        now: &CentroidalState<T>,
    ) -> Option<SVector<T, MOMENTA>> {
        let planned = plan.base((node, time)).filter(|_| node < self.nodes)?;
        let [state, gain] = self.every;
        let at = |moment, k: usize| {
            let of = |state: &State| state.get(k).map_or_else(Vector3::zeros, vector);
            between(&self.states, state, moment, of)
        };
        let (here, there) = (
            (node, share(plan, node, time)?),
            (was, share(plan, was, then)?),
        );
        let place = now.com_w - at(here, 0)?;
        let rotation = so3::log(&(rot_wb * planned.rot_wb.inverse()));
        let velocity = now.com_velocity_w - at(there, 1)?;
        let angular = now.momentum_w.angular - at(there, 2)?;
        let error = stack(&[place, rotation, velocity, angular]);
        // Gains are counted from the last interval, over which its own is held: it is the one for which the end matters most.
        let gain = match self.nodes.checked_sub(node + 2) {
            Some(left) => between(&self.gains, gain, (left, T::ONE - here.1), matrix)?,
            None => matrix(self.gains.first()?),
        };
        Some(product(&gain, &error))
    }
}

impl Default for Regulator {
    fn default() -> Self {
        Self::new()
    }
}

/// 1/σ² of three errors.
fn per_variance<T: Scalar>(sigma: T) -> Matrix3<T> {
    Matrix3::identity() / (sigma * sigma)
}

/// Adds errors of place, rotation, velocity and turning rate I⁻¹ δL over their σ, squared and times `share`.
fn add_errors<T: Scalar, const F: usize>(
    cost: &mut CostToGo<T>,
    [place, rotation, velocity, rate]: &[T; 4],
    body: &Body<T, F>,
    share: T,
) {
    let inverse = &body.inverse_inertia_w;
    cost.add(PLACE, &(per_variance(*place) * share));
    cost.add(ROTATION, &(per_variance(*rotation) * share));
    cost.add(VELOCITY, &(per_variance(*velocity) * share));
    let rates = inverse.transpose() * (per_variance(*rate) * share) * inverse;
    cost.add(ANGULAR, &rates);
}

/// Lets the feet that push answer during `dt`, at the beginning of it.
fn answer<T: Scalar, const F: usize>(
    cost: &mut CostToGo<T>,
    weights: &Weights<T>,
    body: &Body<T, F>,
    dt: T,
) {
    for (foot, force) in body.forces_w.iter().enumerate() {
        for axis in 0..3 {
            let per_cost = weights.per_cost(force.z, axis) * dt;
            cost.answered(&body.push(foot, axis), per_cost);
        }
    }
}

/// Share of the way from a node to the next at `time`: 0 before it, 1 after the next.
fn share<T: Scalar, const N: usize, const F: usize>(
    plan: &Plan<'_, T, N, F>,
    node: usize,
    time: T,
) -> Option<T> {
    let (from, to) = (plan.time(node)?, plan.time(node + 1)?);
    Some(math::clamp((time - from) / (to - from), T::ZERO, T::ONE))
}

/// What is kept of every so many nodes, read by `of`, at a share of the way from a node to the next.
fn between<T: Scalar, K, R>(
    kept: &[K],
    every: NonZeroUsize,
    (node, share): (usize, T),
    of: impl Fn(&K) -> R,
) -> Option<R>
where
    R: core::ops::Add<Output = R> + core::ops::Mul<T, Output = R>,
{
    let (i, rest) = (node / every, node % every);
    let whole = |x: usize| T::of(f64::from(u32::try_from(x).unwrap_or(u32::MAX)));
    let share = (whole(rest) + share) / whole(every.get());
    let (from, to) = (kept.get(i)?, kept.get(i + 1)?);
    Some(of(from) * (T::ONE - share) + of(to) * share)
}

/// A vector that was kept in single precision.
fn vector<T: Scalar>(kept: &[f32; 3]) -> Vector3<T> {
    Vector3::from(kept.map(|x| T::of(f64::from(x))))
}

/// A gain that was kept in single precision.
fn matrix<T: Scalar>(kept: &Gain) -> SMatrix<T, MOMENTA, ERRORS> {
    SMatrix::from(kept.map(|column| column.map(|x| T::of(f64::from(x)))))
}
