//! Identical limbs abreast: four legs take every step of a fold together, one in each lane of a vector instruction.
//!
//! A limb's values are kept by *quantity*, `[[T; L]; K]` as in the tables of the derivatives, and every joint is a loop
//! over the limbs that compilers turn into vector code. Each limb computes the same bits as it would alone. Processors
//! without vectors of floating-point numbers, the firmware's, keep one limb in registers instead and walk limb after limb.

use core::array::from_fn;

use nalgebra::{Matrix3, Rotation3, Vector3};
use so3::Scalar;

use crate::algo::{at, put};
use crate::joint::JointKind;
use crate::model::Body;
use crate::spatial::{ArticulatedInertia, Force, Inertia, Motion, Symmetric3, Transform};
use crate::tree::{At, Fold, Nothing, row};

/// Limbs that take a step together, of `count` identical ones; fewer do not fill a vector and go one after the other.
#[doc(hidden)]
#[must_use]
pub const fn limbs_abreast(count: usize) -> usize {
    if cfg!(target_arch = "x86_64") && count.is_multiple_of(4) {
        4
    } else {
        1
    }
}

/// What a fold carries along a limb, and how `L` limbs keep it together.
pub trait Abreast: Copy {
    /// The values of `L` limbs: a row for each number.
    type Rows<const L: usize>: Copy;

    /// The same value for every limb.
    fn repeat<const L: usize>(&self) -> Self::Rows<L>;

    /// The value of one limb.
    fn of<const L: usize>(rows: &Self::Rows<L>, limb: usize) -> Self;

    /// Writes the value of one limb.
    fn set<const L: usize>(&self, rows: &mut Self::Rows<L>, limb: usize);
}

/// [`Abreast::repeat`], for the macro.
#[doc(hidden)]
#[inline(always)]
pub fn repeat<X: Abreast, const L: usize>(x: &X) -> X::Rows<L> {
    x.repeat::<L>()
}

/// [`Abreast::of`], for the macro.
#[doc(hidden)]
#[inline(always)]
pub fn of<X: Abreast, const L: usize>(rows: &X::Rows<L>, limb: usize) -> X {
    X::of::<L>(rows, limb)
}

/// [`Abreast::set`], for the macro.
#[doc(hidden)]
#[inline(always)]
pub fn set<X: Abreast, const L: usize>(rows: &mut X::Rows<L>, limb: usize, x: X) {
    x.set::<L>(rows, limb);
}

/// One joint of several identical limbs.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Joints<'a, T, const N: usize> {
    /// The table.
    pub bodies: &'a [Body<T>; N],
    /// Index in the first limb.
    pub first: usize,
    /// One past the last body of its subtree there.
    pub end: usize,
    /// Bodies of a limb.
    pub length: usize,
}

impl<T: Scalar, const N: usize> Joints<'_, T, N> {
    #[inline(always)]
    fn at(&self, limb: usize) -> At<'_, T> {
        let index = self.first + limb * self.length;
        At {
            index,
            end: self.end + limb * self.length,
            body: row(self.bodies, index),
        }
    }

    /// [`Fold::down`] for each limb.
    #[inline(always)]
    pub fn down<J: JointKind, F: Fold<T>, const L: usize>(
        &self,
        fold: &mut F,
        parents: &<F::Down as Abreast>::Rows<L>,
    ) -> (<F::Down as Abreast>::Rows<L>, <F::Keep as Abreast>::Rows<L>) {
        let mut downs = *parents;
        let mut keeps = F::Keep::default().repeat::<L>();
        for limb in 0..L {
            let parent = F::Down::of::<L>(parents, limb);
            let (down, keep) = fold.down::<J>(self.at(limb), &parent);
            down.set::<L>(&mut downs, limb);
            keep.set::<L>(&mut keeps, limb);
        }
        (downs, keeps)
    }

    /// [`Fold::up`] for each limb.
    #[inline(always)]
    pub fn up<J: JointKind, F: Fold<T>, const L: usize>(
        &self,
        fold: &mut F,
        keeps: &<F::Keep as Abreast>::Rows<L>,
        children: &<F::Up as Abreast>::Rows<L>,
    ) -> <F::Up as Abreast>::Rows<L> {
        let mut ups = *children;
        for limb in 0..L {
            let keep = F::Keep::of::<L>(keeps, limb);
            let children = F::Up::of::<L>(children, limb);
            let up = fold.up::<J>(self.at(limb), &keep, children);
            up.set::<L>(&mut ups, limb);
        }
        ups
    }
}

impl<T: Scalar, const K: usize> Abreast for [T; K] {
    type Rows<const L: usize> = [[T; L]; K];

    #[inline(always)]
    fn repeat<const L: usize>(&self) -> Self::Rows<L> {
        self.map(|x| [x; L])
    }

    #[inline(always)]
    fn of<const L: usize>(rows: &Self::Rows<L>, limb: usize) -> Self {
        from_fn(|k| at(&rows[k], limb))
    }

    #[inline(always)]
    fn set<const L: usize>(&self, rows: &mut Self::Rows<L>, limb: usize) {
        for (row, &x) in rows.iter_mut().zip(self) {
            put(row, limb, x);
        }
    }
}

impl Abreast for Nothing {
    type Rows<const L: usize> = Self;

    #[inline(always)]
    fn repeat<const L: usize>(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn of<const L: usize>(rows: &Self, _: usize) -> Self {
        *rows
    }

    #[inline(always)]
    fn set<const L: usize>(&self, _: &mut Self, _: usize) {}
}

impl<A: Abreast, B: Abreast> Abreast for (A, B) {
    type Rows<const L: usize> = (A::Rows<L>, B::Rows<L>);

    #[inline(always)]
    fn repeat<const L: usize>(&self) -> Self::Rows<L> {
        (self.0.repeat::<L>(), self.1.repeat::<L>())
    }

    #[inline(always)]
    fn of<const L: usize>(rows: &Self::Rows<L>, limb: usize) -> Self {
        (A::of::<L>(&rows.0, limb), B::of::<L>(&rows.1, limb))
    }

    #[inline(always)]
    fn set<const L: usize>(&self, rows: &mut Self::Rows<L>, limb: usize) {
        self.0.set::<L>(&mut rows.0, limb);
        self.1.set::<L>(&mut rows.1, limb);
    }
}

/// `abreast_as!(X => Parts, |x| parts of x, |parts| x)`: X goes abreast as arrays and pairs.
macro_rules! abreast_as {
    ($X:ty => $Parts:ty, |$x:ident| $parts_of:expr, |$parts:pat_param| $of_parts:expr) => {
        impl<T: so3::Scalar> $crate::abreast::Abreast for $X {
            type Rows<const L: usize> = <$Parts as $crate::abreast::Abreast>::Rows<L>;

            #[inline(always)]
            fn repeat<const L: usize>(&self) -> Self::Rows<L> {
                let $x = self;
                $crate::abreast::repeat::<$Parts, L>(&$parts_of)
            }

            #[inline(always)]
            fn of<const L: usize>(rows: &Self::Rows<L>, limb: usize) -> Self {
                let $parts = $crate::abreast::of::<$Parts, L>(rows, limb);
                $of_parts
            }

            #[inline(always)]
            fn set<const L: usize>(&self, rows: &mut Self::Rows<L>, limb: usize) {
                let $x = self;
                $crate::abreast::set::<$Parts, L>(rows, limb, $parts_of);
            }
        }
    };
}
pub(crate) use abreast_as;

abreast_as!(Vector3<T> => [T; 3], |v| [v.x, v.y, v.z], |[x, y, z]| Vector3::new(x, y, z));
abreast_as!(Symmetric3<T> => [T; 6], |s| s.to_array(), |x| Self::new(x));
abreast_as!(Force<T> => [T; 6], |f| f.to_array(), |x| Self::from_array(x));
abreast_as!(Motion<T> => [T; 6], |m| m.to_array(), |x| Self::from_array(x));
abreast_as!(
    Matrix3<T> => [T; 9],
    |m| [m.m11, m.m12, m.m13, m.m21, m.m22, m.m23, m.m31, m.m32, m.m33],
    |[a, b, c, d, e, f, g, h, i]| Self::new(a, b, c, d, e, f, g, h, i)
);
abreast_as!(
    Transform<T> => (Matrix3<T>, Vector3<T>),
    |x| (*x.rotation.matrix(), x.translation),
    |(rotation, translation)| Self::new(Rotation3::from_matrix_unchecked(rotation), translation)
);
abreast_as!(
    Inertia<T> => ([T; 1], (Vector3<T>, Symmetric3<T>)),
    |i| ([i.mass], (i.first, i.second)),
    |([mass], (first, second))| Self { mass, first, second }
);
abreast_as!(
    ArticulatedInertia<T> => (Symmetric3<T>, (Matrix3<T>, Symmetric3<T>)),
    |i| (i.linear, (i.cross, i.angular)),
    |(linear, (cross, angular))| Self { linear, cross, angular }
);
