//! A robot whose base is a chain of joints, for dynamics; how the base turns is [`BaseCoordinates`].

use nalgebra::{Matrix3, Vector3};
use rbd_core::joint::Kind;
use rbd_core::model::{Body, Frame, JointLimits, Link};
use rbd_core::{Model, Motor};
use so3::Scalar;

/// Coordinates of the base: its position and how it turns.
pub const BASE: usize = 6;
/// First of the base's coordinates that turn it.
pub(crate) const TURN: usize = 3;

/// How the base turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseCoordinates {
    /// On SO(3), without singularity: steps are `R Exp(θ)`, rates the angular velocity, both in base axes.
    Rotation,
    /// By three angles, as in paper A: singular at ±90° of the middle one.
    Angles(EulerOrder),
}

impl BaseCoordinates {
    const fn kinds(self) -> [Kind; BASE] {
        let turns = match self {
            Self::Rotation => [Kind::RevoluteX, Kind::RevoluteY, Kind::RevoluteZ],
            Self::Angles(EulerOrder::Zyx) => [Kind::RevoluteZ, Kind::RevoluteY, Kind::RevoluteX],
            Self::Angles(EulerOrder::Zxy) => [Kind::RevoluteZ, Kind::RevoluteX, Kind::RevoluteY],
        };
        let [first, second, third] = turns;
        [
            Kind::PrismaticX,
            Kind::PrismaticY,
            Kind::PrismaticZ,
            first,
            second,
            third,
        ]
    }
}

/// Which angle turns first, seen from the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EulerOrder {
    /// R = Rz(yaw) Ry(pitch) Rx(roll); coordinates x, y, z, yaw, pitch, roll. Singular at pitch ±90°.
    Zyx,
    /// R = Rz(yaw) Rx(roll) Ry(pitch); coordinates x, y, z, yaw, roll, pitch. Singular at roll ±90°.
    Zxy,
}

impl EulerOrder {
    /// For each coordinate of the chain, its index in x, y, z, roll, pitch, yaw.
    #[must_use]
    pub const fn columns(self) -> [usize; BASE] {
        match self {
            Self::Zyx => [0, 1, 2, 5, 4, 3],
            Self::Zxy => [0, 1, 2, 5, 3, 4],
        }
    }

    /// The angles `[yaw, second, third]` of a rotation from base to world, each within its principal range.
    #[must_use]
    pub fn angles<T: Scalar>(self, rot_wb: &Matrix3<T>) -> [T; 3] {
        let r = rot_wb;
        let clamped = |x: T| so3::math::min(so3::math::max(x, -T::ONE), T::ONE);
        match self {
            Self::Zyx => [
                so3::math::atan2(r.m21, r.m11),
                -so3::math::asin(clamped(r.m31)),
                so3::math::atan2(r.m32, r.m33),
            ],
            Self::Zxy => [
                so3::math::atan2(-r.m12, r.m22),
                so3::math::asin(clamped(r.m32)),
                so3::math::atan2(-r.m31, r.m33),
            ],
        }
    }
}

/// A robot of `N` coordinates as one chain of joints per limb: base first (x, y, z and its turn), then
/// the joints of the model it was made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robot<T, const N: usize> {
    /// How the base turns.
    pub base: BaseCoordinates,
    /// Bodies in depth-first order; the sixth is the trunk, the five before it have no mass.
    pub bodies: [Body<T>; N],
    /// Limits and losses; none on the base.
    pub limits: [JointLimits<T>; N],
    /// Motors, where their torque-speed lines bound the efforts.
    pub motors: [Option<Motor<T>>; N],
}

impl<T: Scalar, const N: usize> Robot<T, N> {
    /// The robot of a floating-base model with `J` joints, its base on SO(3); `N` must be `J + 6`, other sizes do
    /// not compile.
    #[must_use]
    pub fn on_free_base<M: Model<T, J>, const J: usize>(model: &M) -> Self {
        Self::on(BaseCoordinates::Rotation, model)
    }

    /// As [`Self::on_free_base`], with the base coordinates of paper A: three prismatic and three revolute joints.
    #[must_use]
    pub fn on_euler_base<M: Model<T, J>, const J: usize>(model: &M, order: EulerOrder) -> Self {
        Self::on(BaseCoordinates::Angles(order), model)
    }

    fn on<M: Model<T, J>, const J: usize>(base: BaseCoordinates, model: &M) -> Self {
        const { assert!(N == J + BASE, "a floating base adds six coordinates") };
        let mut bodies = [Body::EMPTY; N];
        let mut limits = [JointLimits::NONE; N];
        for (i, (body, kind)) in bodies.iter_mut().zip(base.kinds()).enumerate() {
            body.kind = kind;
            body.parent = i.checked_sub(1).map_or(Link::Base, Link::Joint);
            body.subtree_end = N;
        }
        if let Some(trunk) = bodies.get_mut(BASE - 1) {
            let from = model.base();
            (trunk.mass, trunk.first, trunk.second) = (from.mass, from.first, from.second);
        }
        let joints = model.bodies().iter().zip(model.limits());
        let slots = bodies.iter_mut().zip(&mut limits).skip(BASE);
        for ((slot, limit), (body, from)) in slots.zip(joints) {
            *slot = *body;
            slot.parent = Self::link(body.parent);
            slot.subtree_end = body.subtree_end.saturating_add(BASE);
            *limit = *from;
        }
        let mut motors = [None; N];
        let known = model.motors().into_iter().flatten();
        for (slot, motor) in motors.iter_mut().skip(BASE).zip(known) {
            *slot = Some(*motor);
        }
        Self {
            base,
            bodies,
            limits,
            motors,
        }
    }

    /// Whether the base is on SO(3).
    #[inline(always)]
    pub(crate) const fn turns_freely(&self) -> bool {
        matches!(self.base, BaseCoordinates::Rotation)
    }

    /// Where a link of the model is in this robot.
    #[must_use]
    pub const fn link(link: Link) -> Link {
        match link {
            Link::Base => Link::Joint(BASE - 1),
            Link::Joint(i) => Link::Joint(i.saturating_add(BASE)),
        }
    }

    /// The point at the origin of a frame of the model.
    #[must_use]
    pub fn point(frame: &Frame<T>) -> Point<T> {
        Point {
            link: match Self::link(frame.link) {
                Link::Joint(i) => i,
                Link::Base => 0,
            },
            offset_l: Vector3::from(frame.offset),
        }
    }
}

/// A point fixed to a body of a [`Robot`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<T: Scalar> {
    /// Index of the body.
    pub link: usize,
    /// Where it is in the body's frame, m.
    pub offset_l: Vector3<T>,
}
