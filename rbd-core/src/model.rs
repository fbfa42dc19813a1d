//! What a robot is: bodies on joints, frames, and limits, as plain tables.

use nalgebra::{Matrix3, Rotation3, Vector3};
use so3::Scalar;

use crate::joint::Kind;
use crate::spatial::{Inertia, Symmetric3, Transform};

/// Where something is attached: to the base, or to the body that a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// The base body: the floating base, or the ground of a fixed-base robot.
    Base,
    /// The body moved by the joint with this index.
    Joint(usize),
}

/// Whether the base moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseKind {
    /// Six degrees of freedom: nv = 6 + n.
    Floating,
    /// None: nv = n; the base is part of the world, and its inertia is not the robot's (see [`algo`](crate::algo)).
    Fixed,
}

/// One body and the joint that moves it, in canonical frames (see [`crate::joint`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body<T> {
    /// Kind of the joint.
    pub kind: Kind,
    /// The body that carries the joint.
    pub parent: Link,
    /// One past the last body of the subtree that starts here: bodies are in depth-first order, so
    /// the subtree of body i is i..`subtree_end`.
    pub subtree_end: usize,
    /// +1, or −1 where the robot's own joint coordinate runs against the canonical axis.
    pub sign: T,
    /// Origin of the body's frame in the parent's at zero position, m.
    pub offset: [T; 3],
    /// Fixed rotation before a tilted joint, body to parent, by rows; identity for aligned kinds.
    pub tilt: [[T; 3]; 3],
    /// Mass, kg.
    pub mass: T,
    /// First moment of mass in the body's frame, kg m.
    pub first: [T; 3],
    /// Second moments of mass about the body's origin, [xx, yy, zz, xy, xz, yz], kg m².
    pub second: [T; 6],
    /// Inertia of the rotor as the joint feels it: gear ratio² × rotor inertia, kg m² (kg if prismatic).
    pub rotor_inertia: T,
}

impl<T: Scalar> Body<T> {
    /// A massless body on a joint about x at the base's origin.
    pub const EMPTY: Self = Self {
        kind: Kind::RevoluteX,
        parent: Link::Base,
        subtree_end: 0,
        sign: T::ONE,
        offset: [T::ZERO; 3],
        tilt: [
            [T::ONE, T::ZERO, T::ZERO],
            [T::ZERO, T::ONE, T::ZERO],
            [T::ZERO, T::ZERO, T::ONE],
        ],
        mass: T::ZERO,
        first: [T::ZERO; 3],
        second: [T::ZERO; 6],
        rotor_inertia: T::ZERO,
    };

    /// Inertia about the body's origin.
    #[inline(always)]
    #[must_use]
    pub fn inertia(&self) -> Inertia<T> {
        Inertia {
            mass: self.mass,
            first: Vector3::from(self.first),
            second: Symmetric3::new(self.second),
        }
    }

    /// The tilt as a matrix.
    #[inline(always)]
    #[must_use]
    pub fn tilt_matrix(&self) -> Matrix3<T> {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.tilt;
        Matrix3::new(a, b, c, d, e, f, g, h, i)
    }
}

impl Body<f64> {
    /// The same body in single precision.
    #[must_use]
    pub const fn to_f32(&self) -> Body<f32> {
        Body {
            kind: self.kind,
            parent: self.parent,
            subtree_end: self.subtree_end,
            sign: self.sign as f32,
            offset: cast(self.offset),
            tilt: [cast(self.tilt[0]), cast(self.tilt[1]), cast(self.tilt[2])],
            mass: self.mass as f32,
            first: cast(self.first),
            second: cast(self.second),
            rotor_inertia: self.rotor_inertia as f32,
        }
    }
}

/// A named place on a link, such as a foot, a sole or an IMU, or any link's own URDF frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<T> {
    /// The link it is fixed to.
    pub link: Link,
    /// Its origin in the link's canonical frame, m.
    pub offset: [T; 3],
    /// Its rotation, frame to link, by rows.
    pub rotation: [[T; 3]; 3],
}

impl<T: Scalar> Frame<T> {
    /// The base's own frame.
    pub const IDENTITY: Self = Self {
        link: Link::Base,
        offset: [T::ZERO; 3],
        rotation: [
            [T::ONE, T::ZERO, T::ZERO],
            [T::ZERO, T::ONE, T::ZERO],
            [T::ZERO, T::ZERO, T::ONE],
        ],
    };

    /// Pose of the frame in its link.
    #[inline(always)]
    #[must_use]
    pub fn placement(&self) -> Transform<T> {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.rotation;
        let m = Matrix3::new(a, b, c, d, e, f, g, h, i);
        Transform::new(
            Rotation3::from_matrix_unchecked(m),
            Vector3::from(self.offset),
        )
    }
}

impl Frame<f64> {
    /// The same frame in single precision.
    #[must_use]
    pub const fn to_f32(&self) -> Frame<f32> {
        Frame {
            link: self.link,
            offset: cast(self.offset),
            rotation: [
                cast(self.rotation[0]),
                cast(self.rotation[1]),
                cast(self.rotation[2]),
            ],
        }
    }
}

/// Inertia of the base about the base frame's origin, as numbers. That of a fixed base is part of the world: only the
/// reaction of the ground knows it, see [`algo`](crate::algo).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseBody<T> {
    /// Mass, kg.
    pub mass: T,
    /// First moment of mass, kg m.
    pub first: [T; 3],
    /// Second moments of mass, [xx, yy, zz, xy, xz, yz], kg m².
    pub second: [T; 6],
}

impl<T: Scalar> BaseBody<T> {
    /// No mass.
    pub const EMPTY: Self = Self {
        mass: T::ZERO,
        first: [T::ZERO; 3],
        second: [T::ZERO; 6],
    };

    /// Inertia about the base frame's origin.
    #[inline(always)]
    #[must_use]
    pub fn inertia(&self) -> Inertia<T> {
        Inertia {
            mass: self.mass,
            first: Vector3::from(self.first),
            second: Symmetric3::new(self.second),
        }
    }
}

impl BaseBody<f64> {
    /// The same base in single precision.
    #[must_use]
    pub const fn to_f32(&self) -> BaseBody<f32> {
        BaseBody {
            mass: self.mass as f32,
            first: cast(self.first),
            second: cast(self.second),
        }
    }
}

/// What a joint can do and what it loses, in the robot's own joint coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits<T> {
    /// Lowest position, rad or m; −∞ for a continuous joint.
    pub lower: T,
    /// Highest position, rad or m; +∞ for a continuous joint.
    pub upper: T,
    /// Largest speed, rad/s or m/s.
    pub speed: T,
    /// Largest torque or force, N m or N.
    pub effort: T,
    /// Viscous friction, N m s/rad or N s/m.
    pub damping: T,
    /// Coulomb friction, N m or N.
    pub friction: T,
}

impl<T: Scalar> JointLimits<T> {
    /// No limit and no loss.
    pub const NONE: Self = Self {
        lower: T::NEG_INFINITY,
        upper: T::INFINITY,
        speed: T::INFINITY,
        effort: T::INFINITY,
        damping: T::ZERO,
        friction: T::ZERO,
    };
}

impl JointLimits<f64> {
    /// The same limits in single precision.
    #[must_use]
    pub const fn to_f32(&self) -> JointLimits<f32> {
        JointLimits {
            lower: self.lower as f32,
            upper: self.upper as f32,
            speed: self.speed as f32,
            effort: self.effort as f32,
            damping: self.damping as f32,
            friction: self.friction as f32,
        }
    }
}

const fn cast<const K: usize>(x: [f64; K]) -> [f32; K] {
    let mut y = [0.0; K];
    let mut i = 0;
    while i < K {
        y[i] = x[i] as f32;
        i += 1;
    }
    y
}

/// Every table of a model in single precision, for `static` items of model crates.
#[must_use]
pub const fn bodies_f32<const N: usize>(bodies: &[Body<f64>; N]) -> [Body<f32>; N] {
    let mut out = [Body::<f32>::EMPTY; N];
    let mut i = 0;
    while i < N {
        out[i] = bodies[i].to_f32();
        i += 1;
    }
    out
}

/// A table of frames in single precision, for `static` items of model crates.
#[must_use]
pub const fn frames_f32<const N: usize>(frames: &[Frame<f64>; N]) -> [Frame<f32>; N] {
    let mut out = [Frame::<f32>::IDENTITY; N];
    let mut i = 0;
    while i < N {
        out[i] = frames[i].to_f32();
        i += 1;
    }
    out
}

/// A table of limits in single precision, for `static` items of model crates.
#[must_use]
pub const fn limits_f32<const N: usize>(limits: &[JointLimits<f64>; N]) -> [JointLimits<f32>; N] {
    let mut out = [JointLimits::<f32>::NONE; N];
    let mut i = 0;
    while i < N {
        out[i] = limits[i].to_f32();
        i += 1;
    }
    out
}
