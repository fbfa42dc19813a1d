//! The push-off regulated: a time-varying LQR on the single rigid body along the plan's nodes.
//!
//! Joint control does not see where the whole robot goes: with every joint on its target, ground that yields or a motor that is weak
//! leaves it too slow and leaning, and on two feet what leans topples, e-fold in a tenth of a second. What the feet's forces are to change is
//! the answer of a linear-quadratic problem. With x = (δc, δθ, δv, δL), the error of the centre of mass, of the rotation, of the velocity and of
//! the angular momentum about the centre of mass, world axes, measured less planned:
//!
//! ```text
//! δċ = δv    δθ̇ = I⁻¹ (δL + L × δθ)    δv̇ = Σ δf_i / m    δL̇ = F × δc + Σ r_i × δf_i + p Σ (r_i − l) × f_i
//! ```
//!
//! where r_i are the planned places of the feet seen from the centre of mass and F = Σ f_i. The last term is known beforehand: it is what a robot that
//! carries p of its mass at l is turned by ([`Load`]). The cost is Σ (error/σ)² at touchdown, with a flight
//! without feedback until there, and at take-off, and Σ (error/σ)² + Σ (δf_i/σ_i)² over the push-off ([`Weights`]). A foot's σ_i is a share of its planned
//! force, so a foot that the plan does not push with is given none.
//!
//! Riccati's recursion runs backwards over the nodes once, a few in every tick of the hold ([`NODES_PER_TICK`]): all of them at once take longer than
//! the joint loop waits for a tick. What is kept of it are the six rows Λ of the cost-to-go that belong to the momenta; with the costates
//! (λ_v, λ_L) = Λ (x, p) the best change of a foot's force is
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
use nalgebra::{Matrix3, Rotation3, SVector, Vector3};
use rbd_core::{CentroidalState, Frame, Limbs, Tangent, Tree, centroidal_state};
use so3::{Scalar, math};

pub use weights::Weights;

use crate::Load;

use body::Body;
use cost_to_go::{ANGULAR, CostToGo, ERRORS, MOMENTA, PLACE, ROTATION, VELOCITY, stack};

/// Most states that are kept of a plan's push-off: 0.95 s of nodes that are 5 ms apart; of a longer one every second, and so on.
const STATES: usize = 192;
/// Most gains that are kept: they change more slowly, one in 10 ms is enough.
const GAINS: usize = 72;

/// Nodes over which the recursion goes back in a tick of the hold.
///
/// In double precision a node of A1's push-off takes a Cortex-M7 some 22,000 instructions, one of its flight 12,500, and the rest of the tick 15,600: with two
/// a tick of the hold keeps within the budget of one of the landing, 80,000. They are through a plan of 300 nodes in the 0.15 s in which A1 weighs itself.
pub const NODES_PER_TICK: usize = 2;

/// Place, velocity and angular momentum of a plan's centre of mass, in single precision, as plans are stored.
type State = [[f32; 3]; 3];
/// Errors, and the load.
const COLUMNS: usize = ERRORS + 1;
/// Λ by rows.
type Gain = [[f32; COLUMNS]; MOMENTA];

/// The gains of one jump, and the motion that they are for: 29.4 kB, and the recursion that computes them.
///
/// Armed is what [`Regulator::begin`] was called for and [`Regulator::advance`] has not yet gone through; a push-off may begin when
/// [`Regulator::is_ready`].
#[derive(Clone, Debug)]
pub struct Regulator<T: Scalar> {
    states: [State; STATES],
    gains: [Gain; GAINS],
    /// Nodes from one state, and one gain, to the next; states are counted from the first node on, gains back from the last before the take-off.
    /// That of the node where the count ends is kept as well, however near it is to the one before.
    every: [NonZeroUsize; 2],
    /// Number of nodes before the take-off.
    nodes: usize,
    /// The recursion: the cost from node `left` on, which is the last that it has gone through.
    cost: CostToGo<T>,
    left: usize,
}

impl<T: Scalar> Regulator<T> {
    /// Without a jump: forces are never changed.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            states: [[[0.0; 3]; 3]; STATES],
            gains: [[[0.0; COLUMNS]; MOMENTA]; GAINS],
            every: [NonZeroUsize::MIN; 2],
            nodes: 0,
            cost: CostToGo::ZERO,
            left: 0,
        }
    }

    /// Ticks of the hold before the start in which the gains of a plan are computed, at most.
    #[must_use]
    pub const fn ticks<const N: usize, const F: usize>(plan: &Plan<'_, T, N, F>) -> usize {
        plan.count().div_ceil(NODES_PER_TICK)
    }

    /// Begins the recursion for a plan at its end. One without a push-off is ready at once.
    pub fn begin<const N: usize, const F: usize>(
        &mut self,
        plan: &Plan<'_, T, N, F>,
        weights: &Weights<T>,
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
        self.cost = CostToGo::ZERO;
        self.cost.add(PLACE, &per_variance(weights.touchdown[0]));
        self.cost.add(ROTATION, &per_variance(weights.touchdown[1]));
        self.left = match nodes {
            0 => 0,
            _ => plan.count(),
        };
    }

    /// Whether the gains of the plan are computed.
    #[must_use]
    pub const fn is_ready(&self) -> bool {
        self.left == 0
    }

    /// Goes on with the recursion, for the plan, model, weights and height of loads with which it was begun: over at most so many nodes. `limbs` is memory for
    /// the legs of a node.
    pub fn advance<M: Tree<T, N>, const N: usize, const F: usize>(
        &mut self,
        (model, weights): (&M, &Weights<T>),
        plan: &Plan<'_, T, N, F>,
        (feet, limbs): (&[Frame<T>; F], &mut Limbs<T, N, F>),
        load_height: T,
        most: usize,
    ) {
        for _ in 0..most {
            let Some(i) = self.left.checked_sub(1) else {
                return;
            };
            let Some(node) = plan.node(i) else {
                return;
            };
            let next = plan.time(i + 1).unwrap_or(node.time);
            let body = Body::new(model, &node, feet, (limbs, load_height));
            if node.time < plan.touchdown {
                self.cost.before(&body.drift(next - node.time));
            }
            self.back_to(i, weights, &body, next - node.time);
            self.left = i;
        }
    }

    /// What is added to the cost at node `i`, `dt` before the next.
    fn back_to<const F: usize>(
        &mut self,
        i: usize,
        weights: &Weights<T>,
        body: &Body<T, F>,
        dt: T,
    ) {
        if i > self.nodes {
            return;
        }
        if i == self.nodes {
            add_errors(&mut self.cost, &weights.takeoff, body, T::ONE);
        } else {
            answer(&mut self.cost, weights, body, dt);
        }
        self.keep(i, body);
        add_errors(&mut self.cost, &weights.running, body, dt / weights.time);
    }

    /// Keeps state and gain of a node.
    fn keep<const F: usize>(&mut self, i: usize, body: &Body<T, F>) {
        let [state, gain] = self.every;
        let single = |x: T| x.to_f64() as f32;
        let place = |i: usize, every: NonZeroUsize, last: usize| {
            (i == last || i.is_multiple_of(every.get())).then(|| i.div_ceil(every.get()))
        };
        if let Some(to) = place(i, state, self.nodes).and_then(|k| self.states.get_mut(k)) {
            let of = [body.com_w, body.com_velocity_w, body.angular_w];
            *to = of.map(|part| <[T; 3]>::from(part).map(single));
        }
        let Some(left) = self.nodes.checked_sub(i + 1) else {
            return;
        };
        if let Some(to) = place(left, gain, self.nodes - 1).and_then(|k| self.gains.get_mut(k)) {
            for (to, (of_errors, of_load)) in to.iter_mut().zip(self.cost.costate()) {
                for (to, x) in to.iter_mut().zip(of_errors.iter().chain([&of_load])) {
                    *to = single(*x);
                }
            }
        }
    }

    /// What the forces of the ground on the feet are to change by, world axes, N.
    ///
    /// `moments` of the plan, each the node before it and the time, s: now, when `limbs` are as they are, and when `velocity` was. The
    /// planned rotation is that of now, and `planned_w` are the planned forces, world axes. The centre of mass is `offset_b` from the
    /// model's, base axes, m, and what the robot carries raises it. Zero from the take-off on.
    pub fn forces<M: Tree<T, N>, const N: usize, const F: usize>(
        &self,
        (model, weights): (&M, &Weights<T>),
        plan: &Plan<'_, T, N, F>,
        moments: [(usize, T); 2],
        velocity: &Tangent<T, N>,
        (limbs, offset_b, load): (&Limbs<T, N, F>, &Vector3<T>, &Load<T>),
        (planned_rot_wb, planned_w): (&Rotation3<T>, &[Vector3<T>; F]),
    ) -> [Vector3<T>; F] {
        let mut changes = [Vector3::zeros(); F];
        let base = limbs.posture.base();
        let mut now = centroidal_state(model, &limbs.posture, velocity);
        // The trunk is to be as high as planned, not the centre of mass; what flies is the latter.
        let raised_b = load.raises(&(base.rotation.inverse() * (now.com_w - base.translation)));
        now.com_w += base.rotation * offset_b;
        now.com_velocity_w += base.rotation * velocity.base.angular.cross(&(offset_b + raised_b));
        let turned = base.rotation * planned_rot_wb.inverse();
        let Some(costate) = self.costate(plan, moments, &turned, (&now, load.share)) else {
            return changes;
        };
        let [x, y, z, roll, pitch, yaw] = costate.into();
        let linear = Vector3::new(x, y, z) / now.mass;
        let angular = Vector3::new(roll, pitch, yaw);
        for ((change, end), planned) in changes.iter_mut().zip(&limbs.ends).zip(planned_w) {
            let arm = base.point(&end.position) - now.com_w;
            let gradient: Vector3<T> = linear + angular.cross(&arm);
            let wanted = -gradient.component_mul(&weights.per_cost(planned.z));
            *change = weights.within_cone(planned, &wanted) - planned;
        }
        changes
    }

    /// Λ (x, p); none outside the push-off.
    fn costate<const N: usize, const F: usize>(
        &self,
        plan: &Plan<'_, T, N, F>,
        [(node, time), (was, then)]: [(usize, T); 2],
        turned: &Rotation3<T>,
        (now, load): (&CentroidalState<T>, T),
    ) -> Option<SVector<T, MOMENTA>> {
        // Also false for NaN.
        let pushes = node < self.nodes && time >= plan.time(node)?;
        if !pushes {
            return None;
        }
        let [state, gain] = self.every;
        let at = |moment, k: usize| {
            let of = |state: &State| state.get(k).map_or_else(Vector3::zeros, vector);
            between(&self.states, (state, self.nodes), moment, of)
        };
        let (here, there) = (
            (node, share(plan, node, time)?),
            (was, share(plan, was, then)?),
        );
        let place = now.com_w - at(here, 0)?;
        let rotation = so3::log(turned);
        let velocity = now.com_velocity_w - at(there, 1)?;
        let angular = now.momentum_w.angular - at(there, 2)?;
        let error: SVector<T, ERRORS> = stack([place, rotation, velocity, angular]);
        let error = error.push(load);
        // Gains are counted from the last interval, over which its own is held: it is the one for which the end matters most.
        match self.nodes.checked_sub(node + 2) {
            Some(left) => {
                let of = |gain: &Gain| product(gain, &error);
                between(
                    &self.gains,
                    (gain, self.nodes - 1),
                    (left, T::ONE - here.1),
                    of,
                )
            }
            None => self.gains.first().map(|gain| product(gain, &error)),
        }
    }
}

impl<T: Scalar> Default for Regulator<T> {
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
        let per_cost = weights.per_cost(force.z) * dt;
        for (axis, per_cost) in per_cost.iter().enumerate() {
            // A foot that does not push changes nothing.
            if *per_cost > T::ZERO {
                cost.answered(&body.push(foot, axis), *per_cost);
            }
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

/// What is kept of every so many nodes and of the last, read by `of`, at a share of the way from a node to the next.
fn between<T: Scalar, K, R>(
    kept: &[K],
    (every, last): (NonZeroUsize, usize),
    (node, share): (usize, T),
    of: impl Fn(&K) -> R,
) -> Option<R>
where
    R: core::ops::Add<Output = R> + core::ops::Mul<T, Output = R>,
{
    let (i, rest) = (node / every, node % every);
    let whole = |x: usize| T::of(f64::from(u32::try_from(x).unwrap_or(u32::MAX)));
    let length = every.get().min(last.saturating_sub(node - rest));
    let share = (whole(rest) + share) / whole(length);
    let (from, to) = (kept.get(i)?, kept.get(i + 1)?);
    Some(of(from) * (T::ONE - share) + of(to) * share)
}

/// A vector that was kept in single precision.
fn vector<T: Scalar>(kept: &[f32; 3]) -> Vector3<T> {
    Vector3::from(kept.map(|x| T::of(f64::from(x))))
}

/// Λ (x, p) of a gain that was kept in single precision.
fn product<T: Scalar>(gain: &Gain, error: &SVector<T, COLUMNS>) -> SVector<T, MOMENTA> {
    SVector::from(gain.map(|row| {
        let terms = row.iter().zip(error);
        terms.fold(T::ZERO, |sum, (gain, error)| {
            sum + T::of(f64::from(*gain)) * *error
        })
    }))
}
