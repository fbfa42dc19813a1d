//! The joint kinds, each resolved at compile time so that zeros and ones cost nothing.
//!
//! A joint places its body's frame in its parent's. Models are canonical: the frame of a body has its
//! origin on the joint axis and, for the *aligned* kinds, the axes of the parent's frame at zero angle;
//! only a joint whose axis is no coordinate axis of its parent is *tilted*: a fixed rotation, then a
//! joint about or along z. The names of the URDF's own frames are kept as [`Frame`](crate::Frame)s.

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;
use so3::math::mul_add;

use crate::model::Body;
use crate::spatial::Symmetric3;

/// The kind of a joint as data, for tables and run-time models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Revolute about the parent's x axis.
    RevoluteX,
    /// Revolute about the parent's y axis.
    RevoluteY,
    /// Revolute about the parent's z axis.
    RevoluteZ,
    /// Revolute about the z axis of a tilted frame.
    RevoluteTilted,
    /// Prismatic along the parent's x axis.
    PrismaticX,
    /// Prismatic along the parent's y axis.
    PrismaticY,
    /// Prismatic along the parent's z axis.
    PrismaticZ,
    /// Prismatic along the z axis of a tilted frame.
    PrismaticTilted,
}

impl Kind {
    /// Turns rather than slides.
    #[must_use]
    pub const fn is_revolute(self) -> bool {
        matches!(
            self,
            Self::RevoluteX | Self::RevoluteY | Self::RevoluteZ | Self::RevoluteTilted
        )
    }

    /// Index of the joint's coordinate axis in the body frame: 0, 1 or 2.
    #[must_use]
    pub const fn axis(self) -> usize {
        match self {
            Self::RevoluteX | Self::PrismaticX => 0,
            Self::RevoluteY | Self::PrismaticY => 1,
            _ => 2,
        }
    }

    /// Has a fixed rotation before the joint.
    #[must_use]
    pub const fn is_tilted(self) -> bool {
        matches!(self, Self::RevoluteTilted | Self::PrismaticTilted)
    }
}

/// A rotation from a body's frame to its parent's, as cheap as the joint allows.
pub trait JointRotation<T: Scalar>: Copy {
    /// R v: body to parent.
    fn up(&self, v: &Vector3<T>) -> Vector3<T>;
    /// Rᵀ v: parent to body.
    fn down(&self, v: &Vector3<T>) -> Vector3<T>;
    /// R S Rᵀ.
    fn up_symmetric(&self, s: &Symmetric3<T>) -> Symmetric3<T>;
    /// R M Rᵀ.
    fn up_matrix(&self, m: &Matrix3<T>) -> Matrix3<T>;
    /// P R: the body's rotation in the frame that `p` maps the parent to.
    fn after(&self, p: &Matrix3<T>) -> Matrix3<T>;
}

/// A joint kind at compile time. `axis` below is the unit vector of the joint in the body's frame.
pub trait JointKind: Copy {
    /// The rotation type of this kind.
    type Rotation<T: Scalar>: JointRotation<T>;
    /// This kind as data.
    const KIND: Kind;

    /// Body-to-parent rotation at a joint position with the given sine and cosine.
    fn rotation<T: Scalar>(body: &Body<T>, sin: T, cos: T) -> Self::Rotation<T>;

    /// The body's origin in the parent's frame at joint position `q`, m.
    #[inline(always)]
    fn offset<T: Scalar>(body: &Body<T>, q: T) -> Vector3<T> {
        let fixed = Vector3::from(body.offset);
        if Self::KIND.is_revolute() {
            fixed
        } else {
            Self::slide(body, fixed, q)
        }
    }

    /// The fixed offset moved along the joint axis by q (prismatic kinds).
    #[inline(always)]
    fn slide<T: Scalar>(body: &Body<T>, fixed: Vector3<T>, q: T) -> Vector3<T> {
        if Self::KIND.is_tilted() {
            let z = body.tilt;
            fixed + Vector3::new(z[0][2], z[1][2], z[2][2]) * q
        } else {
            Self::along_axis(fixed, q)
        }
    }

    /// v + axis · x.
    #[inline(always)]
    fn along_axis<T: Scalar>(v: Vector3<T>, x: T) -> Vector3<T> {
        match Self::KIND.axis() {
            0 => Vector3::new(v.x + x, v.y, v.z),
            1 => Vector3::new(v.x, v.y + x, v.z),
            _ => Vector3::new(v.x, v.y, v.z + x),
        }
    }

    /// axis · v.
    #[inline(always)]
    fn component<T: Scalar>(v: &Vector3<T>) -> T {
        match Self::KIND.axis() {
            0 => v.x,
            1 => v.y,
            _ => v.z,
        }
    }

    /// v + w × (axis · x).
    #[inline(always)]
    fn add_cross_axis<T: Scalar>(v: Vector3<T>, w: &Vector3<T>, x: T) -> Vector3<T> {
        match Self::KIND.axis() {
            0 => Vector3::new(v.x, mul_add(w.z, x, v.y), mul_add(-w.y, x, v.z)),
            1 => Vector3::new(mul_add(-w.z, x, v.x), v.y, mul_add(w.x, x, v.z)),
            _ => Vector3::new(mul_add(w.y, x, v.x), mul_add(-w.x, x, v.y), v.z),
        }
    }

    /// axis × v.
    #[inline(always)]
    fn axis_cross<T: Scalar>(v: &Vector3<T>) -> Vector3<T> {
        match Self::KIND.axis() {
            0 => Vector3::new(T::ZERO, -v.z, v.y),
            1 => Vector3::new(v.z, T::ZERO, -v.x),
            _ => Vector3::new(-v.y, v.x, T::ZERO),
        }
    }

    /// S · axis for a symmetric S.
    #[inline(always)]
    fn column<T: Scalar>(s: &Symmetric3<T>) -> Vector3<T> {
        match Self::KIND.axis() {
            0 => Vector3::new(s.xx, s.xy, s.xz),
            1 => Vector3::new(s.xy, s.yy, s.yz),
            _ => Vector3::new(s.xz, s.yz, s.zz),
        }
    }

    /// M · axis.
    #[inline(always)]
    fn matrix_column<T: Scalar>(m: &Matrix3<T>) -> Vector3<T> {
        match Self::KIND.axis() {
            0 => Vector3::new(m.m11, m.m21, m.m31),
            1 => Vector3::new(m.m12, m.m22, m.m32),
            _ => Vector3::new(m.m13, m.m23, m.m33),
        }
    }

    /// Mᵀ · axis.
    #[inline(always)]
    fn matrix_row<T: Scalar>(m: &Matrix3<T>) -> Vector3<T> {
        match Self::KIND.axis() {
            0 => Vector3::new(m.m11, m.m12, m.m13),
            1 => Vector3::new(m.m21, m.m22, m.m23),
            _ => Vector3::new(m.m31, m.m32, m.m33),
        }
    }
}

/// Rotation about coordinate axis `AXIS` of the parent.
#[derive(Clone, Copy, Debug)]
pub struct AxisRotation<T, const AXIS: usize> {
    sin: T,
    cos: T,
}

impl<T: Scalar, const AXIS: usize> AxisRotation<T, AXIS> {
    /// (x, y) in the plane of the rotation, turned.
    #[inline(always)]
    fn turned(&self, x: T, y: T) -> (T, T) {
        let (s, c) = (self.sin, self.cos);
        (mul_add(-s, y, c * x), mul_add(s, x, c * y))
    }
}

impl<T: Scalar, const AXIS: usize> JointRotation<T> for AxisRotation<T, AXIS> {
    #[inline(always)]
    fn up(&self, v: &Vector3<T>) -> Vector3<T> {
        match AXIS {
            0 => {
                let (y, z) = self.turned(v.y, v.z);
                Vector3::new(v.x, y, z)
            }
            1 => {
                let (z, x) = self.turned(v.z, v.x);
                Vector3::new(x, v.y, z)
            }
            _ => {
                let (x, y) = self.turned(v.x, v.y);
                Vector3::new(x, y, v.z)
            }
        }
    }

    #[inline(always)]
    fn down(&self, v: &Vector3<T>) -> Vector3<T> {
        Self {
            sin: -self.sin,
            cos: self.cos,
        }
        .up(v)
    }

    #[inline(always)]
    fn up_symmetric(&self, m: &Symmetric3<T>) -> Symmetric3<T> {
        // In the plane (a, b) of the rotation: aa' = c² aa − 2cs ab + s² bb and so on, through
        // d = s (aa − bb) + 2c ab: aa' = aa − s d, bb' = bb + s d, ab' = c d − ab.
        let (s, c) = (self.sin, self.cos);
        let plane = |aa: T, bb: T, ab: T| {
            let d = mul_add(s, aa - bb, T::TWO * c * ab);
            (mul_add(-s, d, aa), mul_add(s, d, bb), mul_add(c, d, -ab))
        };
        match AXIS {
            0 => {
                let (yy, zz, yz) = plane(m.yy, m.zz, m.yz);
                let (xy, xz) = self.turned(m.xy, m.xz);
                Symmetric3 {
                    xx: m.xx,
                    yy,
                    zz,
                    xy,
                    xz,
                    yz,
                }
            }
            1 => {
                let (zz, xx, xz) = plane(m.zz, m.xx, m.xz);
                let (yz, xy) = self.turned(m.yz, m.xy);
                Symmetric3 {
                    xx,
                    yy: m.yy,
                    zz,
                    xy,
                    xz,
                    yz,
                }
            }
            _ => {
                let (xx, yy, xy) = plane(m.xx, m.yy, m.xy);
                let (xz, yz) = self.turned(m.xz, m.yz);
                Symmetric3 {
                    xx,
                    yy,
                    zz: m.zz,
                    xy,
                    xz,
                    yz,
                }
            }
        }
    }

    #[inline(always)]
    fn up_matrix(&self, m: &Matrix3<T>) -> Matrix3<T> {
        // Columns of R M, then rows of (R M) Rᵀ.
        let x = self.up(&Vector3::new(m.m11, m.m21, m.m31));
        let y = self.up(&Vector3::new(m.m12, m.m22, m.m32));
        let z = self.up(&Vector3::new(m.m13, m.m23, m.m33));
        let a = self.up(&Vector3::new(x.x, y.x, z.x));
        let b = self.up(&Vector3::new(x.y, y.y, z.y));
        let c = self.up(&Vector3::new(x.z, y.z, z.z));
        Matrix3::new(a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z)
    }

    #[inline(always)]
    fn after(&self, p: &Matrix3<T>) -> Matrix3<T> {
        // Rows of P R are Rᵀ applied to the rows of P.
        let a = self.down(&Vector3::new(p.m11, p.m12, p.m13));
        let b = self.down(&Vector3::new(p.m21, p.m22, p.m23));
        let c = self.down(&Vector3::new(p.m31, p.m32, p.m33));
        Matrix3::new(a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z)
    }
}

/// A rotation without structure.
#[derive(Clone, Copy, Debug)]
pub struct DenseRotation<T: Scalar>(Matrix3<T>);

impl<T: Scalar> JointRotation<T> for DenseRotation<T> {
    #[inline(always)]
    fn up(&self, v: &Vector3<T>) -> Vector3<T> {
        self.0 * v
    }
    #[inline(always)]
    fn down(&self, v: &Vector3<T>) -> Vector3<T> {
        self.0.tr_mul(v)
    }
    #[inline(always)]
    fn up_symmetric(&self, s: &Symmetric3<T>) -> Symmetric3<T> {
        s.rotated(&self.0)
    }
    #[inline(always)]
    fn up_matrix(&self, m: &Matrix3<T>) -> Matrix3<T> {
        self.0 * m * self.0.transpose()
    }
    #[inline(always)]
    fn after(&self, p: &Matrix3<T>) -> Matrix3<T> {
        p * self.0
    }
}

/// No rotation.
#[derive(Clone, Copy, Debug)]
pub struct NoRotation;

impl<T: Scalar> JointRotation<T> for NoRotation {
    #[inline(always)]
    fn up(&self, v: &Vector3<T>) -> Vector3<T> {
        *v
    }
    #[inline(always)]
    fn down(&self, v: &Vector3<T>) -> Vector3<T> {
        *v
    }
    #[inline(always)]
    fn up_symmetric(&self, s: &Symmetric3<T>) -> Symmetric3<T> {
        *s
    }
    #[inline(always)]
    fn up_matrix(&self, m: &Matrix3<T>) -> Matrix3<T> {
        *m
    }
    #[inline(always)]
    fn after(&self, p: &Matrix3<T>) -> Matrix3<T> {
        *p
    }
}

macro_rules! aligned_kinds {
    ($($revolute:ident $prismatic:ident $axis:literal $name:literal;)*) => { $(
        #[doc = concat!("Revolute about the parent's ", $name, " axis.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $revolute;

        impl JointKind for $revolute {
            type Rotation<T: Scalar> = AxisRotation<T, $axis>;
            const KIND: Kind = Kind::$revolute;

            #[inline(always)]
            fn rotation<T: Scalar>(_: &Body<T>, sin: T, cos: T) -> Self::Rotation<T> {
                AxisRotation { sin, cos }
            }
        }

        #[doc = concat!("Prismatic along the parent's ", $name, " axis.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $prismatic;

        impl JointKind for $prismatic {
            type Rotation<T: Scalar> = NoRotation;
            const KIND: Kind = Kind::$prismatic;

            #[inline(always)]
            fn rotation<T: Scalar>(_: &Body<T>, _: T, _: T) -> NoRotation {
                NoRotation
            }
        }
    )* };
}

aligned_kinds! {
    RevoluteX PrismaticX 0 "x";
    RevoluteY PrismaticY 1 "y";
    RevoluteZ PrismaticZ 2 "z";
}

/// Revolute about the z axis of a tilted frame.
#[derive(Clone, Copy, Debug)]
pub struct RevoluteTilted;

impl JointKind for RevoluteTilted {
    type Rotation<T: Scalar> = DenseRotation<T>;
    const KIND: Kind = Kind::RevoluteTilted;

    #[inline(always)]
    fn rotation<T: Scalar>(body: &Body<T>, sin: T, cos: T) -> DenseRotation<T> {
        DenseRotation(AxisRotation::<T, 2> { sin, cos }.after(&body.tilt_matrix()))
    }
}

/// Prismatic along the z axis of a tilted frame.
#[derive(Clone, Copy, Debug)]
pub struct PrismaticTilted;

impl JointKind for PrismaticTilted {
    type Rotation<T: Scalar> = DenseRotation<T>;
    const KIND: Kind = Kind::PrismaticTilted;

    #[inline(always)]
    fn rotation<T: Scalar>(body: &Body<T>, _: T, _: T) -> DenseRotation<T> {
        DenseRotation(body.tilt_matrix())
    }
}
