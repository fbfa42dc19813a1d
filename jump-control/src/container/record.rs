//! What a container holds.

use nalgebra::{Matrix3, Rotation3, Vector3};
use rbd_core::{Motion, Transform};
use so3::Scalar;

use super::bytes::{Reader, Writer};
use crate::plan::Node;
use crate::sample::Torques;

/// Most contact phases of a plan.
pub const MOST_PHASES: usize = 8;
/// Most bytes of the name of a task, which may be the path of a file.
pub const LONGEST_TASK: usize = 255;
/// Most bytes of the name of a robot.
pub const LONGEST_ROBOT: usize = 63;
/// How far the rows of a rotation may be from orthonormal: single precision leaves a hundredth of it.
const ORTHONORMAL: f64 = 1e-5;

/// What holds for a whole plan of a robot with `N` joints. Names are borrowed from the container.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header<'a, const N: usize> {
    /// Name of the task, at most [`LONGEST_TASK`] bytes.
    pub task: &'a str,
    /// Name of the robot, at most [`LONGEST_ROBOT`] bytes.
    pub robot: &'a str,
    /// What torques do between nodes.
    pub torques: Torques,
    /// Phases in use.
    pub phase_count: u8,
    /// Number of nodes.
    pub nodes: u16,
    /// When the robot leaves the ground, s.
    pub takeoff: f32,
    /// Beginning of the pre-landing posture, s.
    pub posing: f32,
    /// When the plan expects the ground, s.
    pub touchdown: f32,
    /// Contact phases.
    pub phases: [PlanPhase; MOST_PHASES],
    /// The box that the robot jumps from or onto.
    pub ground: Option<GroundStep>,
    /// What the plan left to the controller.
    pub margins: Margins,
    /// Where the base is to be in the end, seen from where it started, world axes, m.
    pub goal_w: [f32; 3],
    /// Where it is to look then: the angle about the world's z, rad.
    pub heading: f32,
    /// Joint positions in which the robot waits for the ground, rad.
    pub landing_joints: [f32; N],
}

/// A contact phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanPhase {
    /// Bit i is set where foot i stands.
    pub contacts: u8,
    /// Duration, s.
    pub duration: f32,
}

/// A step of the ground: beyond the edge it is lower by `drop`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// Parts of a node, as bits: who follows a stored plan reads those alone that it needs.
pub(crate) mod parts {
    /// Place and motion of the base.
    pub(crate) const BASE: u8 = 1;
    /// Positions, velocities and torques of the joints.
    pub(crate) const JOINTS: u8 = 2;
    /// Forces on the feet.
    pub(crate) const FORCES: u8 = 4;
    /// All that the sampler takes.
    pub(crate) const ALL: u8 = BASE | JOINTS | FORCES;
}

/// A node of a robot with `N` joints and `F` feet. Torques and forces hold from this node to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanNode<const N: usize, const F: usize> {
    /// Index of the contact phase.
    pub phase: u8,
    /// Time since the start of the plan, s; negative for the posture that waits for it.
    pub time: f32,
    /// Position of the base in the world, m.
    pub position_w: [f32; 3],
    /// Rotation from base to world, the rows of its matrix. Not a quaternion, so that nothing has to be computed, and nothing is rounded,
    /// between what is stored and what is flown, by the compiler or by a controller of either precision.
    pub rotation_wb: [[f32; 3]; 3],
    /// Velocity of the base, linear then angular, base axes, m/s and rad/s.
    pub velocity_b: [f32; 6],
    /// Joint positions, rad.
    pub joints: [f32; N],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f32; N],
    /// Torques, N m.
    pub torques: [f32; N],
    /// Forces of the ground on the feet, world axes, N.
    pub forces_w: [[f32; 3]; F],
    /// Feet seen from their hips, base axes, m.
    pub feet_b: [[f32; 3]; F],
    /// Their velocities relative to the base, base axes, m/s.
    pub foot_velocities_b: [[f32; 3]; F],
}

impl<'a, const N: usize> Header<'a, N> {
    /// Bytes of a header: 452 and the landing posture.
    pub const BYTES: usize = (1 + LONGEST_TASK) + (1 + LONGEST_ROBOT) + 132 + 4 * N;

    /// None where there is a name that is none, or a rule for torques that nobody knows.
    pub(super) const fn read(from: &mut Reader<'a>) -> Option<Self> {
        let (Some(task), Some(robot)) = (from.text::<LONGEST_TASK>(), from.text::<LONGEST_ROBOT>())
        else {
            return None;
        };
        let [torques, phase_count] = from.take();
        let torques = match torques {
            0 => Torques::Hold,
            1 => Torques::Linear,
            _ => return None,
        };
        let nodes = u16::from_le_bytes(from.take());
        let [takeoff, posing, touchdown] = from.numbers();
        let mut phases = [PlanPhase {
            contacts: 0,
            duration: 0.0,
        }; MOST_PHASES];
        let mut i = 0;
        while i < MOST_PHASES {
            let [contacts, ..] = from.take::<4>();
            let duration = from.number();
            phases[i] = PlanPhase { contacts, duration };
            i += 1;
        }
        let [axis, side, ..] = from.take::<4>();
        let [drop, distance] = from.numbers();
        let step = GroundStep {
            drop,
            axis,
            side: side as i8,
            distance,
        };
        let margins = from.numbers();
        Some(Self {
            task,
            robot,
            torques,
            phase_count,
            nodes,
            takeoff,
            posing,
            touchdown,
            phases,
            ground: if side == 0 { None } else { Some(step) },
            margins: Margins::from_array(margins),
            goal_w: from.numbers(),
            heading: from.number(),
            landing_joints: from.numbers(),
        })
    }

    pub(super) fn write(&self, to: &mut Writer<'_>) {
        to.text::<LONGEST_TASK>(self.task);
        to.text::<LONGEST_ROBOT>(self.robot);
        let torques = match self.torques {
            Torques::Hold => 0,
            Torques::Linear => 1,
        };
        to.put([torques, self.phase_count]);
        to.put(self.nodes.to_le_bytes());
        to.numbers(&[self.takeoff, self.posing, self.touchdown]);
        for phase in &self.phases {
            to.put([phase.contacts, 0, 0, 0]);
            to.numbers(&[phase.duration]);
        }
        let step = self.ground.unwrap_or_default();
        to.put([step.axis, step.side as u8, 0, 0]);
        to.numbers(&[step.drop, step.distance]);
        to.numbers(&self.margins.to_array());
        to.numbers(&self.goal_w);
        to.numbers(&[self.heading]);
        to.numbers(&self.landing_joints);
    }
}

impl Margins {
    const fn from_array(x: [f32; 6]) -> Self {
        let [
            friction,
            friction_share,
            max_force,
            torque_share,
            speed_share,
            weight,
        ] = x;
        Self {
            friction,
            friction_share,
            max_force,
            torque_share,
            speed_share,
            weight,
        }
    }

    const fn to_array(self) -> [f32; 6] {
        [
            self.friction,
            self.friction_share,
            self.max_force,
            self.torque_share,
            self.speed_share,
            self.weight,
        ]
    }
}

impl<const N: usize, const F: usize> PlanNode<N, F> {
    /// All zero, and level.
    pub const ZERO: Self = Self {
        phase: 0,
        time: 0.0,
        position_w: [0.0; 3],
        rotation_wb: LEVEL,
        velocity_b: [0.0; 6],
        joints: [0.0; N],
        joint_velocities: [0.0; N],
        torques: [0.0; N],
        forces_w: [[0.0; 3]; F],
        feet_b: [[0.0; 3]; F],
        foot_velocities_b: [[0.0; 3]; F],
    };
    /// Bytes of a node: phase, time, pose and velocity of the base, joints, torques, and per foot force, place and velocity.
    pub const BYTES: usize = 4 * (1 + 1 + 3 + 9 + 6 + 3 * N + 9 * F);

    /// Only the time.
    pub(super) const fn time(from: &mut Reader<'_>) -> f32 {
        let [..] = from.take::<4>();
        from.number()
    }

    pub(super) const fn read(from: &mut Reader<'_>) -> Self {
        let mut node = Self::read_parts::<{ parts::ALL }>(from);
        node.feet_b = from.rows();
        node.foot_velocities_b = from.rows();
        node
    }

    /// Phase, time and these [`parts`]; zeros elsewhere.
    #[inline(always)]
    pub(super) const fn read_parts<const PARTS: u8>(from: &mut Reader<'_>) -> Self {
        let mut node = Self::ZERO;
        [node.phase, ..] = from.take::<4>();
        node.time = from.number();
        if PARTS & parts::BASE != 0 {
            node.position_w = from.numbers();
            node.rotation_wb = from.rows();
            node.velocity_b = from.numbers();
        } else {
            from.skip(4 * (3 + 9 + 6));
        }
        if PARTS & parts::JOINTS != 0 {
            node.joints = from.numbers();
            node.joint_velocities = from.numbers();
            node.torques = from.numbers();
        } else {
            from.skip(4 * 3 * N);
        }
        if PARTS & parts::FORCES != 0 {
            node.forces_w = from.rows();
        }
        node
    }

    pub(super) fn write(&self, to: &mut Writer<'_>) {
        to.put([self.phase, 0, 0, 0]);
        to.numbers(&[self.time]);
        to.numbers(&self.position_w);
        to.numbers(self.rotation_wb.as_flattened());
        to.numbers(&self.velocity_b);
        to.numbers(&self.joints);
        to.numbers(&self.joint_velocities);
        to.numbers(&self.torques);
        for vectors in [&self.forces_w, &self.feet_b, &self.foot_velocities_b] {
            to.numbers(vectors.as_flattened());
        }
    }

    /// As the sampler takes it.
    #[must_use]
    #[inline]
    pub fn node<T: Scalar>(&self) -> Node<T, N, F> {
        let node = self.node_f64();
        let vector = |x: Vector3<f64>| x.map(T::of);
        let rotation = node.base.rotation.matrix().map(T::of);
        Node {
            time: T::of(node.time),
            base: Transform::new(
                Rotation3::from_matrix_unchecked(rotation),
                vector(node.base.translation),
            ),
            base_velocity: Motion::new(
                vector(node.base_velocity.linear),
                vector(node.base_velocity.angular),
            ),
            joints: node.joints.map(T::of),
            joint_velocities: node.joint_velocities.map(T::of),
            torques: node.torques.map(T::of),
            forces_w: node.forces_w.map(vector),
        }
    }
}

/// The rows of no turn.
const LEVEL: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Whether these are the rows of a rotation: of unit length, at right angles, and right-handed.
pub(super) const fn is_rotation([x, y, z]: &[[f32; 3]; 3]) -> bool {
    let cross = [
        x[1] as f64 * y[2] as f64 - x[2] as f64 * y[1] as f64,
        x[2] as f64 * y[0] as f64 - x[0] as f64 * y[2] as f64,
        x[0] as f64 * y[1] as f64 - x[1] as f64 * y[0] as f64,
    ];
    let volume = cross[0] * z[0] as f64 + cross[1] * z[1] as f64 + cross[2] * z[2] as f64;
    is_near(dot(x, x), 1.0)
        && is_near(dot(y, y), 1.0)
        && is_near(dot(z, z), 1.0)
        && is_near(dot(x, y), 0.0)
        && is_near(dot(y, z), 0.0)
        && is_near(dot(z, x), 0.0)
        && volume > 0.0
}

const fn dot(a: &[f32; 3], b: &[f32; 3]) -> f64 {
    a[0] as f64 * b[0] as f64 + a[1] as f64 * b[1] as f64 + a[2] as f64 * b[2] as f64
}

/// Not for NaN.
const fn is_near(x: f64, y: f64) -> bool {
    (x - y).abs() <= ORTHONORMAL
}

/// One conversion for both scalars: single precision is exact in either.
macro_rules! conversion {
    ($T:ident $name:ident $doc:literal) => {
        impl<const N: usize, const F: usize> PlanNode<N, F> {
            #[doc = $doc]
            #[must_use]
            #[inline]
            pub const fn $name(&self) -> Node<$T, N, F> {
                const fn vector(x: &[f32; 3]) -> Vector3<$T> {
                    Vector3::new(x[0] as $T, x[1] as $T, x[2] as $T)
                }
                // No rotation at all can only come from a writer that went wrong: level is the safe reading.
                let rows = if is_rotation(&self.rotation_wb) {
                    &self.rotation_wb
                } else {
                    &LEVEL
                };
                let [x, y, z] = rows;
                let matrix = Matrix3::new(
                    x[0] as $T, x[1] as $T, x[2] as $T, //
                    y[0] as $T, y[1] as $T, y[2] as $T, //
                    z[0] as $T, z[1] as $T, z[2] as $T,
                );
                let [vx, vy, vz, wx, wy, wz] = self.velocity_b;
                let mut node = Node::ZERO;
                node.time = self.time as $T;
                node.base = Transform::new(
                    Rotation3::from_matrix_unchecked(matrix),
                    vector(&self.position_w),
                );
                node.base_velocity = Motion::new(vector(&[vx, vy, vz]), vector(&[wx, wy, wz]));
                let mut i = 0;
                while i < N {
                    node.joints[i] = self.joints[i] as $T;
                    node.joint_velocities[i] = self.joint_velocities[i] as $T;
                    node.torques[i] = self.torques[i] as $T;
                    i += 1;
                }
                let mut foot = 0;
                while foot < F {
                    node.forces_w[foot] = vector(&self.forces_w[foot]);
                    foot += 1;
                }
                node
            }
        }
    };
}

conversion!(f64 node_f64 "As the sampler takes it, in double precision; `const`, for plans in flash.");
conversion!(f32 node_f32 "As the sampler takes it, in single precision; `const`, for plans in flash.");
