//! What a container holds.

use nalgebra::{Rotation3, Vector3};
use rbd_core::{Motion, Transform};
use serde::{Deserialize, Serialize};
use so3::Scalar;

use super::Row;
use crate::plan::Node;
use crate::sample::Torques;

/// Most contact phases of a plan.
pub const MOST_PHASES: usize = 8;

/// What holds for a whole plan. Names are borrowed from the container.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header<'a> {
    /// Name of the task.
    pub task: &'a str,
    /// Name of the robot.
    pub robot: &'a str,
    /// What torques do between nodes.
    pub torques: Torques,
    /// When the robot leaves the ground, s.
    pub takeoff: f32,
    /// Beginning of the pre-landing posture, s.
    pub posing: f32,
    /// When the plan expects the ground, s.
    pub touchdown: f32,
    /// Phases in use.
    pub phase_count: u8,
    /// Contact phases.
    pub phases: [PlanPhase; MOST_PHASES],
    /// The box that the robot jumps from or onto.
    pub ground: Option<GroundStep>,
    /// What the plan left to the controller.
    pub margins: Margins,
    /// Number of nodes.
    pub nodes: u16,
    /// Whether gains follow the nodes.
    pub has_gains: bool,
}

/// A contact phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanPhase {
    /// Bit i is set where foot i stands.
    pub contacts: u8,
    /// Duration, s.
    pub duration: f32,
}

/// A step of the ground: beyond the edge it is lower by `drop`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GroundStep {
    /// Height of the start over the landing, m; negative where the robot jumps up.
    pub drop: f32,
    /// World axis across the edge: 0 is x, 1 is y.
    pub axis: u8,
    /// Side of the landing along the axis, ±1.
    pub side: i8,
    /// Distance of the edge from the origin towards the landing, m.
    pub distance: f32,
}

/// What a plan used, and so what it left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Margins {
    /// Friction of the ground that was planned for.
    pub friction: f32,
    /// Share of it that the plan may use.
    pub friction_share: f32,
    /// Largest normal force per foot, N.
    pub max_force: f32,
    /// Share of the torque limits that it may use.
    pub torque_share: f32,
    /// Share of the motors' speeds that it may use.
    pub speed_share: f32,
    /// Weight that it was planned for, N.
    pub weight: f32,
}

/// A node of a robot with `N` joints and `F` feet. Torques and forces hold from this node to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanNode<const N: usize, const F: usize> {
    /// Index of the contact phase.
    pub phase: u8,
    /// Time since the start of the plan, s; negative for the posture that waits for it.
    pub time: f32,
    /// Position of the base in the world, m.
    pub position_w: [f32; 3],
    /// Rotation from base to world as a quaternion x, y, z, w.
    pub rotation_wb: [f32; 4],
    /// Velocity of the base, linear then angular, base axes, m/s and rad/s.
    pub velocity_b: [f32; 6],
    /// Joint positions, rad.
    pub joints: Row<f32, N>,
    /// Joint velocities, rad/s.
    pub joint_velocities: Row<f32, N>,
    /// Torques, N m.
    pub torques: Row<f32, N>,
    /// Forces of the ground on the feet, world axes, N.
    pub forces_w: Row<[f32; 3], F>,
    /// Feet seen from their hips, base axes, m.
    pub feet_b: Row<[f32; 3], F>,
    /// Their velocities relative to the base, base axes, m/s.
    pub foot_velocities_b: Row<[f32; 3], F>,
}

/// Feedback from a node to the next: Δτ = K (x − x_plan), with x the base's six coordinates (position m, and the plan's three angles,
/// rad), the joints, and the rates of both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NodeGains<const N: usize> {
    /// Torques by the base's position in the world and its rotation vector in base axes, N m per m or rad.
    pub by_base: Row<[f32; 6], N>,
    /// Torques by joint positions, N m/rad.
    pub by_joints: Row<Row<f32, N>, N>,
    /// Torques by the base's velocity in the world and its angular velocity in base axes.
    pub by_base_rates: Row<[f32; 6], N>,
    /// Torques by joint velocities, N m s/rad.
    pub by_joint_rates: Row<Row<f32, N>, N>,
}

impl<const N: usize, const F: usize> PlanNode<N, F> {
    /// As the sampler takes it.
    #[must_use]
    pub fn node<T: Scalar>(&self) -> Node<T, N, F> {
        let of = |x: f32| T::of(f64::from(x));
        let vector = |x: [f32; 3]| Vector3::from(x.map(of));
        // No rotation at all can only come from a writer that went wrong: level is the safe reading.
        let quat_wb = so3::quat::from_xyzw(self.rotation_wb.map(of));
        let rotation =
            quat_wb.map_or_else(|_| Rotation3::identity(), |q| so3::quat::to_rotation(&q));
        Node {
            time: of(self.time),
            base: Transform::new(rotation, vector(self.position_w)),
            base_velocity: Motion::from_array(self.velocity_b.map(of)),
            joints: self.joints.0.map(of),
            joint_velocities: self.joint_velocities.0.map(of),
            torques: self.torques.0.map(of),
            forces_w: self.forces_w.0.map(vector),
        }
    }
}
