//! A planned jump, as the controller reads it.

use core::fmt;

use nalgebra::Vector3;
use rbd_core::{Motion, Transform};
use so3::Scalar;

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

/// A plan: nodes in order of time, and when its phases end.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a, T: Scalar, const N: usize, const F: usize> {
    nodes: &'a [Node<T, N, F>],
    /// When the last stance phase ends and the robot leaves the ground, s.
    pub takeoff: T,
    /// Beginning of the pre-landing posture, the paper's `T_posing`, s.
    pub posing: T,
    /// When the plan expects the ground, s.
    pub touchdown: T,
    /// What torques do between nodes.
    pub torques: Torques,
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
            nodes,
            takeoff,
            posing,
            touchdown,
            torques,
        })
    }

    /// The nodes.
    #[must_use]
    pub const fn nodes(&self) -> &'a [Node<T, N, F>] {
        self.nodes
    }
}
