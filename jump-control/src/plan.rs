//! A planned jump, as the controller reads it.

use core::fmt;

use nalgebra::{Rotation3, Vector3};
use rbd_core::{Motion, Transform};
use so3::{Scalar, math};

use crate::container::{Container, ContainerError, StoredNodes, parts};
use crate::sample::Torques;

/// One node of a plan with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<T: Scalar, const N: usize, const F: usize> {
    /// Time since the start of the plan, s.
    pub time: T,
    /// Pose of the base in the world.
    pub base: Transform<T>,
    /// Velocity of the base, base axes.
    pub base_velocity: Motion<T>,
    /// Joint positions, rad.
    pub joints: [T; N],
    /// Joint velocities, rad/s.
    pub joint_velocities: [T; N],
    /// Feed-forward torques τ_d from this node to the next, N m.
    pub torques: [T; N],
    /// Forces of the ground on the feet from this node to the next, world axes, N.
    pub forces_w: [Vector3<T>; F],
}

impl<T: Scalar, const N: usize, const F: usize> Node<T, N, F> {
    /// All zero.
    pub const ZERO: Self = Self {
        time: T::ZERO,
        base: Transform::IDENTITY,
        base_velocity: Motion::ZERO,
        joints: [T::ZERO; N],
        joint_velocities: [T::ZERO; N],
        torques: [T::ZERO; N],
        forces_w: [Vector3::new(T::ZERO, T::ZERO, T::ZERO); F],
    };

    fn is_finite(&self) -> bool {
        let numbers = self
            .joints
            .iter()
            .chain(&self.joint_velocities)
            .chain(&self.torques);
        numbers.chain([&self.time]).all(|x| x.is_finite_number())
    }
}

/// How the base of a plan is turned, and turns, at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedBase<T: Scalar> {
    /// Rotation.
    pub rot_wb: Rotation3<T>,
    /// Angular velocity, base axes, rad/s.
    pub omega_b: Vector3<T>,
}

/// A plan: nodes in order of time, and when its phases end.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a, T: Scalar, const N: usize, const F: usize> {
    nodes: Nodes<'a, T, N, F>,
    /// When the last stance phase ends and the robot leaves the ground, s.
    pub takeoff: T,
    /// Beginning of the pre-landing posture, the paper's `T_posing`, s.
    pub posing: T,
    /// When the plan expects the ground, s.
    pub touchdown: T,
    /// What torques do between nodes.
    pub torques: Torques,
}

/// Where a plan's nodes stand.
#[derive(Clone, Copy, Debug)]
enum Nodes<'a, T: Scalar, const N: usize, const F: usize> {
    /// As the sampler takes them, such as a `static` that the compiler filled.
    Ready(&'a [Node<T, N, F>]),
    /// As the container has them: each is read where it is needed.
    Stored(StoredNodes<'a, N, F>),
}

/// Why a plan cannot be executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlanError {
    /// There is no node.
    Empty,
    /// This node holds a number that is not finite.
    NotFinite(usize),
    /// This node is not later than the one before it.
    TimeOrder(usize),
    /// `takeoff ≤ posing ≤ touchdown` does not hold.
    PhaseOrder,
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("the plan has no nodes"),
            Self::NotFinite(node) => write!(f, "node {node} of the plan is not finite"),
            Self::TimeOrder(node) => write!(f, "node {node} is not later than the one before it"),
            Self::PhaseOrder => f.write_str("takeoff, posing and touchdown must follow each other"),
        }
    }
}

impl core::error::Error for PlanError {}

impl<'a, T: Scalar, const N: usize, const F: usize> Plan<'a, T, N, F> {
    /// A plan from its nodes.
    ///
    /// # Errors
    /// [`PlanError`] names the first node that cannot be executed, or the phases out of order.
    pub fn new(
        nodes: &'a [Node<T, N, F>],
        takeoff: T,
        posing: T,
        touchdown: T,
        torques: Torques,
    ) -> Result<Self, PlanError> {
        if nodes.is_empty() {
            return Err(PlanError::Empty);
        }
        if let Some(i) = nodes.iter().position(|node| !node.is_finite()) {
            return Err(PlanError::NotFinite(i));
        }
        let mut pairs = nodes.iter().zip(nodes.iter().skip(1));
        if let Some(i) = pairs.position(|(a, b)| b.time <= a.time) {
            return Err(PlanError::TimeOrder(i + 1));
        }
        if !(takeoff <= posing && posing <= touchdown) {
            return Err(PlanError::PhaseOrder);
        }
        Ok(Self {
            nodes: Nodes::Ready(nodes),
            takeoff,
            posing,
            touchdown,
            torques,
        })
    }

    /// A plan that stays where it is stored: what is followed are the container's bytes, and nothing is copied. The numbers are those of
    /// [`Container::read_into`], bit by bit; reading them takes time in every tick instead of memory.
    ///
    /// # Errors
    /// [`ContainerError::Value`] names the first number that cannot be ([`Container::check`]).
    pub fn stored(container: &Container<'a, N, F>) -> Result<Self, ContainerError> {
        container.check()?;
        let header = container.header();
        if header.takeoff > header.posing {
            let (node, what) = (None, "posing");
            return Err(ContainerError::Value { node, what });
        }
        let time = |x: f32| T::of(f64::from(x));
        Ok(Self {
            nodes: Nodes::Stored(container.stored()),
            takeoff: time(header.takeoff),
            posing: time(header.posing),
            touchdown: time(header.touchdown),
            torques: header.torques,
        })
    }

    /// The base at `time`, between `node` and the next: its rate linear, the rotation turned on from the node by the mean rate since. `None` where there are no two such nodes, or before the first of them; after the second it stays there.
    #[must_use]
    pub fn base(&self, (node, time): (usize, T)) -> Option<PlannedBase<T>> {
        self.following::<{ parts::BASE }, _>(node, |nodes| base_at(nodes, time))
    }

    /// Number of nodes.
    #[must_use]
    pub const fn count(&self) -> usize {
        match &self.nodes {
            Nodes::Ready(nodes) => nodes.len(),
            Nodes::Stored(nodes) => nodes.count(),
        }
    }

    /// Node `i`; none beyond the last.
    #[must_use]
    pub fn node(&self, i: usize) -> Option<Node<T, N, F>> {
        self.following::<{ parts::ALL }, _>(i, |nodes| nodes.first().copied())
    }

    /// The node at or before `time`; the first one before it, and where `time` is not a number. The search goes on from `hint`, which
    /// changes nothing but its length.
    #[must_use]
    pub fn node_at(&self, time: T, hint: usize) -> usize {
        let begun = |i| self.time(i).is_some_and(|begun| begun <= time);
        let mut i = if begun(hint) { hint } else { 0 };
        while begun(i + 1) {
            i += 1;
        }
        i
    }

    /// Forces of the ground on the feet from node `i` to the next, world axes, N.
    #[must_use]
    pub fn forces(&self, i: usize) -> Option<[Vector3<T>; F]> {
        self.following::<{ parts::FORCES }, _>(i, |nodes| nodes.first().map(|node| node.forces_w))
    }

    /// The time of node `i`, s.
    #[must_use]
    pub fn time(&self, i: usize) -> Option<T> {
        match &self.nodes {
            Nodes::Ready(nodes) => nodes.get(i).map(|node| node.time),
            Nodes::Stored(nodes) => nodes.time(i).map(|x| T::of(f64::from(x))),
        }
    }

    /// Joint positions at the first node, rad.
    #[must_use]
    pub fn start(&self) -> Option<[T; N]> {
        self.following::<{ parts::JOINTS }, _>(0, |nodes| nodes.first().map(|node| node.joints))
    }

    /// All nodes, where they stand as the sampler takes them.
    pub(crate) const fn ready(&self) -> Option<&'a [Node<T, N, F>]> {
        match &self.nodes {
            Nodes::Ready(nodes) => Some(nodes),
            Nodes::Stored(_) => None,
        }
    }

    /// What `read` makes of the nodes from `i` on, of which it looks at two and at their time and [`parts`] only.
    pub(crate) fn following<const PARTS: u8, R>(
        &self,
        i: usize,
        read: impl FnOnce(&[Node<T, N, F>]) -> R,
    ) -> R {
        match &self.nodes {
            Nodes::Ready(nodes) => read(nodes.get(i..).unwrap_or_default()),
            Nodes::Stored(nodes) => following_stored::<PARTS, _, _, _, _>(nodes, i, read),
        }
    }
}

/// [`Plan::following`] of stored nodes. Not inlined: two nodes on the stack are for those alone who follow such a plan.
#[inline(never)]
fn following_stored<const PARTS: u8, T: Scalar, const N: usize, const F: usize, R>(
    nodes: &StoredNodes<'_, N, F>,
    i: usize,
    read: impl FnOnce(&[Node<T, N, F>]) -> R,
) -> R {
    let first = nodes.parts::<PARTS>(i).map(|node| node.node());
    let next = nodes.parts::<PARTS>(i.saturating_add(1));
    match (first, next.map(|next| next.node())) {
        (Some(first), Some(next)) => read(&[first, next]),
        (Some(first), None) => read(&[first]),
        (None, _) => read(&[]),
    }
}

/// The base at `time` between the first two of these nodes; none before the first of them.
fn base_at<T: Scalar, const N: usize, const F: usize>(
    nodes: &[Node<T, N, F>],
    time: T,
) -> Option<PlannedBase<T>> {
    let mut following = nodes.iter();
    let (from, to) = following.next().zip(following.next())?;
    // Also false for NaN.
    let begun = time >= from.time;
    if !begun {
        return None;
    }
    let dt = to.time - from.time;
    let s = math::min((time - from.time) / dt, T::ONE);
    let rate = from.base_velocity.angular;
    let omega_b = rate + (to.base_velocity.angular - rate) * s;
    Some(PlannedBase {
        rot_wb: from.base.rotation * so3::exp(&((rate + omega_b) * (T::HALF * s * dt))),
        omega_b,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use nalgebra::{Rotation3, Vector3};
    use proptest::prelude::*;

    use super::{Node, Plan};
    use crate::Torques;

    /// Halfway to the next node the base has turned by the mean of its rates there and at the node.
    #[test]
    fn the_base_turns_on_from_its_node() {
        let mut nodes = [Node::<f64, 1, 1>::ZERO; 2];
        nodes[0].base.rotation = Rotation3::from_euler_angles(0.1, 0.2, -0.3);
        nodes[0].base_velocity.angular = Vector3::new(0.0, 0.5, 0.1);
        nodes[1].base_velocity.angular = Vector3::new(0.4, 0.5, 0.1);
        nodes[1].time = 0.01;
        let plan = Plan::new(&nodes, 0.01, 0.01, 0.01, Torques::Hold).unwrap();
        let halfway = plan.base((0, 0.005)).unwrap();
        assert!((halfway.omega_b - Vector3::new(0.2, 0.5, 0.1)).norm() < 1e-12);
        let turned = nodes[0].base.rotation.inverse() * halfway.rot_wb;
        let expected = Vector3::new(0.1, 0.5, 0.1) * 0.005;
        assert!((so3::log(&turned) - expected).norm() < 1e-12);
        for outside in [(0, -0.1), (1, 0.005), (0, f64::NAN)] {
            assert_eq!(plan.base(outside), None, "{outside:?}");
        }
    }

    proptest! {
        /// Whenever its node begins, a base that turns about one axis turns as fast as its rate says, has the rate of the next node once it
        /// is there, and keeps what it has from then on.
        #[test]
        fn the_base_is_at_its_next_node_in_time(
            begin in -5.0..5.0_f64,
            dt in 0.01..0.5_f64,
            turn in prop::array::uniform3(-1.0..1.0_f64),
            rates in prop::array::uniform2(-9.0..9.0_f64),
            share in 0.01..0.99_f64,
        ) {
            let axis = Vector3::new(0.48, -0.6, 0.64);
            let mut nodes = [Node::<f64, 1, 1>::ZERO; 2];
            nodes[0].base.rotation = so3::exp(&Vector3::from(turn));
            for (i, node) in nodes.iter_mut().enumerate() {
                node.time = begin + dt * i as f64;
                node.base_velocity.angular = axis * rates[i];
            }
            let plan = Plan::new(&nodes, begin, begin, begin, Torques::Hold).unwrap();
            let at = |after: f64| plan.base((0, begin + after)).unwrap();
            let (t, h) = (share * dt, 1e-3 * dt);
            let turned = at(t - h).rot_wb.inverse() * at(t + h).rot_wb;
            prop_assert!((so3::log(&turned) / (2.0 * h) - at(t).omega_b).norm() < 1e-7);
            let end = plan.base((0, nodes[1].time)).unwrap();
            prop_assert!((end.omega_b - axis * rates[1]).norm() < 1e-9);
            let mean = so3::exp(&(axis * (0.5 * dt * (rates[0] + rates[1]))));
            let there = nodes[0].base.rotation * mean;
            prop_assert!((end.rot_wb.matrix() - there.matrix()).norm() < 1e-9);
            let later = at(2.0 * dt);
            prop_assert!((later.omega_b - end.omega_b).norm() < 1e-9);
            prop_assert!((later.rot_wb.matrix() - there.matrix()).norm() < 1e-9);
        }
    }
}
