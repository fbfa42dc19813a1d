//! The plan at any time.
//!
//! Positions and velocities are linear between nodes, as in paper A, section IV. Torques are what the plan
//! assumed: a plan with one torque per interval holds it. Before the first node and after the last the robot stands
//! still at them.

use so3::{Scalar, math};

use crate::container::parts;
use crate::plan::{Node, Plan};

/// What feed-forward torques do between nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Torques {
    /// Constant from a node to the next: for plans with one torque per interval.
    Hold,
    /// Linear from node to node.
    Linear,
}

/// The plan at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference<T, const N: usize> {
    /// Joint positions, rad.
    pub joints: [T; N],
    /// Joint velocities, rad/s.
    pub joint_velocities: [T; N],
    /// Feed-forward torques, N m.
    pub torques: [T; N],
    /// The node at or before this time.
    pub node: usize,
}

impl<T: Scalar, const N: usize> Reference<T, N> {
    /// All zero.
    pub const ZERO: Self = Self {
        joints: [T::ZERO; N],
        joint_velocities: [T::ZERO; N],
        torques: [T::ZERO; N],
        node: 0,
    };
}

/// The plan at `time`. A time that is not a number gives the first node, standing still.
///
/// `hint` is the node of the last sample, 0 at first: the search goes on from there, so a controller that samples
/// forward does constant work per tick; any hint gives the same result.
#[must_use]
pub fn sample<T: Scalar, const N: usize, const F: usize>(
    plan: &Plan<'_, T, N, F>,
    time: T,
    hint: usize,
) -> Reference<T, N> {
    match plan.ready() {
        Some(nodes) => sample_in(nodes, plan.torques, time, hint),
        None => sample_stored(plan, time, hint),
    }
}

/// [`sample`] of a plan that is read where it is stored: of its two nodes around `time`.
#[inline(never)]
fn sample_stored<T: Scalar, const N: usize, const F: usize>(
    plan: &Plan<'_, T, N, F>,
    time: T,
    hint: usize,
) -> Reference<T, N> {
    let i = plan.node_at(time, hint);
    plan.following::<{ parts::JOINTS }, _>(i, |nodes| {
        let mut reference = sample_in(nodes, plan.torques, time, 0);
        reference.node += i;
        reference
    })
}

fn sample_in<T: Scalar, const N: usize, const F: usize>(
    nodes: &[Node<T, N, F>],
    torques: Torques,
    time: T,
    hint: usize,
) -> Reference<T, N> {
    let from = match nodes.get(hint) {
        Some(node) if node.time <= time => hint,
        _ => 0,
    };
    let mut found = None;
    for (i, node) in nodes.iter().enumerate().skip(from) {
        if node.time <= time {
            found = Some((i, node));
        } else {
            break;
        }
    }
    match (found, nodes.first()) {
        (Some((i, a)), _) => match nodes.get(i + 1) {
            Some(b) => between(i, a, b, time, torques),
            None => still(i, a),
        },
        (None, Some(first)) => still(0, first),
        (None, None) => Reference::ZERO,
    }
}

fn still<T: Scalar, const N: usize, const F: usize>(
    node: usize,
    at: &Node<T, N, F>,
) -> Reference<T, N> {
    Reference {
        joints: at.joints,
        joint_velocities: [T::ZERO; N],
        torques: at.torques,
        node,
    }
}

fn between<T: Scalar, const N: usize, const F: usize>(
    node: usize,
    a: &Node<T, N, F>,
    b: &Node<T, N, F>,
    time: T,
    torques: Torques,
) -> Reference<T, N> {
    let s = math::clamp((time - a.time) / (b.time - a.time), T::ZERO, T::ONE);
    let blend = |x: &[T; N], y: &[T; N]| {
        let mut z = *x;
        for (z, y) in z.iter_mut().zip(y) {
            *z += (*y - *z) * s;
        }
        z
    };
    Reference {
        joints: blend(&a.joints, &b.joints),
        joint_velocities: blend(&a.joint_velocities, &b.joint_velocities),
        torques: match torques {
            Torques::Hold => a.torques,
            Torques::Linear => blend(&a.torques, &b.torques),
        },
        node,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{Torques, sample};
    use crate::plan::{Node, Plan, PlanError};

    fn nodes() -> [Node<f64, 1, 1>; 3] {
        let node = |time: f64| Node {
            time,
            joints: [time * time],
            joint_velocities: [2.0 * time],
            torques: [10.0 * time],
            ..Node::ZERO
        };
        [node(0.0), node(0.1), node(0.3)]
    }

    #[test]
    fn linear_between_nodes_torques_as_told_still_outside() {
        let nodes = nodes();
        for (torques, expected) in [(Torques::Hold, 1.0), (Torques::Linear, 2.0)] {
            let plan = Plan::new(&nodes, 0.1, 0.2, 0.3, torques).unwrap();
            for hint in [0, 1, 2, 77] {
                let r = sample(&plan, 0.2, hint);
                assert!((r.joints[0] - 0.05).abs() < 1e-12);
                assert!((r.joint_velocities[0] - 0.4).abs() < 1e-12);
                assert!((r.torques[0] - expected).abs() < 1e-12);
                assert_eq!(r.node, 1);
            }
            let late = sample(&plan, 9.0, 0);
            assert_eq!((late.joints[0], late.joint_velocities[0]), (0.09, 0.0));
            let nan = sample(&plan, f64::NAN, 2);
            assert_eq!(
                (nan.joints[0], nan.joint_velocities[0], nan.node),
                (0.0, 0.0, 0)
            );
        }
    }

    #[test]
    fn plans_that_cannot_run_are_refused_by_name() {
        let mut bad = nodes();
        bad[2].time = 0.1;
        let make =
            |nodes: &[Node<f64, 1, 1>]| Plan::new(nodes, 0.1, 0.2, 0.3, Torques::Hold).map(|_| ());
        assert_eq!(make(&bad), Err(PlanError::TimeOrder(2)));
        bad[1].torques[0] = f64::INFINITY;
        assert_eq!(make(&bad), Err(PlanError::NotFinite(1)));
        assert_eq!(make(&[]), Err(PlanError::Empty));
        let good = nodes();
        let order = Plan::new(&good, 0.3, 0.2, 0.3, Torques::Hold).map(|_| ());
        assert_eq!(order, Err(PlanError::PhaseOrder));
    }
}
