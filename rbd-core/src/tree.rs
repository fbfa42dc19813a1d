//! How algorithms walk a robot: every one is a fold over the tree.
//!
//! A [`Fold`] says what happens at *one* body: [`Fold::down`] goes from parent to child, and
//! [`Fold::up`] returns from the children to the parent. A model says in which order bodies come:
//! a const model by [`tree!`](macro@crate::tree), which writes the walk with joint kinds resolved and
//! identical limbs as one loop or abreast, a run-time model by [`walk`], which looks the kinds up. Both call the
//! same per-body code, so there is one RNEA, not one per robot or per kind of model.

use core::ops::Add;

use heapless::Vec;
use so3::Scalar;

use crate::abreast::Abreast;
use crate::algo::at;
use crate::joint::{
    JointKind, Kind, PrismaticTilted, PrismaticX, PrismaticY, PrismaticZ, RevoluteTilted,
    RevoluteX, RevoluteY, RevoluteZ,
};
use crate::model::{BaseBody, BaseKind, Body, Link};

/// One body as a fold meets it.
#[derive(Clone, Copy, Debug)]
pub struct At<'a, T> {
    /// Index of the body and of its joint.
    pub index: usize,
    /// One past the last body of its subtree.
    pub end: usize,
    /// Its table row.
    pub body: &'a Body<T>,
}

/// Nothing, as a value that adds up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Nothing;

impl Add for Nothing {
    type Output = Self;
    #[inline(always)]
    fn add(self, _: Self) -> Self {
        self
    }
}

/// What an algorithm does at each body.
pub trait Fold<T: Scalar> {
    /// Whether it pays to walk identical limbs abreast ([`crate::abreast`]).
    const ABREAST: bool = true;
    /// Whether the code for one body is so long that a walk should call it instead of repeating it for every joint: what
    /// does not fit a processor's cache of decoded instructions runs at two thirds of the speed.
    const LONG: bool = false;
    /// What a parent hands to its children.
    type Down: Abreast;
    /// What a body remembers between the way down and the way up.
    type Keep: Abreast + Default;
    /// What children hand back; siblings add up. The default is what a leaf receives.
    type Up: Abreast + Default + Add<Output = Self::Up>;

    /// From the parent to this body.
    fn down<J: JointKind>(
        &mut self,
        at: At<'_, T>,
        parent: &Self::Down,
    ) -> (Self::Down, Self::Keep);

    /// From this body's children, already summed, to its parent, in the parent's frame.
    fn up<J: JointKind>(
        &mut self,
        at: At<'_, T>,
        keep: &Self::Keep,
        children: Self::Up,
    ) -> Self::Up;
}

/// A robot with `N` joints: its tables and the order in which to walk them.
///
/// Robots made by [`tree!`](macro@crate::tree) have exactly `N` joints; a run-time model may have fewer, and
/// leaves the rest at zero.
pub trait Tree<T: Scalar, const N: usize> {
    /// Whether the base moves.
    fn base_kind(&self) -> BaseKind;

    /// The base body.
    fn base(&self) -> &BaseBody<T>;

    /// The bodies in depth-first order.
    fn bodies(&self) -> &[Body<T>; N];

    /// Number of joints, at most `N`.
    #[inline(always)]
    fn joint_count(&self) -> usize {
        N
    }

    /// Runs `fold` over the tree, starting from what the base hands down; returns what the base's
    /// children hand back.
    fn fold<F: Fold<T>>(&self, fold: &mut F, base: &F::Down) -> F::Up;

    /// Whether the joint `joint` moves `link`.
    #[inline]
    fn moves(&self, joint: usize, link: Link) -> bool {
        match (link, self.bodies().get(joint)) {
            (Link::Joint(i), Some(body)) => joint <= i && i < body.subtree_end,
            _ => false,
        }
    }
}

macro_rules! by_kind {
    ($kind:expr, $J:ident => $body:block) => {
        match $kind {
            Kind::RevoluteX => {
                type $J = RevoluteX;
                $body
            }
            Kind::RevoluteY => {
                type $J = RevoluteY;
                $body
            }
            Kind::RevoluteZ => {
                type $J = RevoluteZ;
                $body
            }
            Kind::RevoluteTilted => {
                type $J = RevoluteTilted;
                $body
            }
            Kind::PrismaticX => {
                type $J = PrismaticX;
                $body
            }
            Kind::PrismaticY => {
                type $J = PrismaticY;
                $body
            }
            Kind::PrismaticZ => {
                type $J = PrismaticZ;
                $body
            }
            Kind::PrismaticTilted => {
                type $J = PrismaticTilted;
                $body
            }
        }
    };
}

/// Runs a fold over a table of bodies whose joint kinds are known only at run time.
///
/// Children of one body are visited in order on the way down and in reverse on the way up.
#[inline]
pub fn walk<T: Scalar, F: Fold<T>, const N: usize>(
    bodies: &[Body<T>; N],
    count: usize,
    fold: &mut F,
    base: &F::Down,
) -> F::Up {
    // Nothing is written before it is known: on the way down the two grow, on the way up the second shrinks.
    let mut downs: Vec<F::Down, N> = Vec::new();
    let mut keeps: Vec<F::Keep, N> = Vec::new();
    let mut ups = [F::Up::default(); N];
    let mut total = F::Up::default();
    let mut last = *base;
    for (index, body) in bodies.iter().enumerate().take(count) {
        let parent = match body.parent {
            Link::Base => *base,
            // Most bodies hang from the one before: that need not go through memory.
            Link::Joint(p) if p + 1 == index => last,
            Link::Joint(p) => downs.get(p).copied().unwrap_or(*base),
        };
        let (down, keep) = by_kind!(body.kind, J => {
            fold.down::<J>(At { index, end: body.subtree_end, body }, &parent)
        });
        last = down;
        // There is room for every body.
        let _ = (downs.push(down), keeps.push(keep));
    }
    // What goes to the body before: that need not go through memory either.
    let mut carried = F::Up::default();
    for (index, body) in bodies.iter().enumerate().take(count).rev() {
        let keep = keeps.pop().unwrap_or_default();
        let children = at(&ups, index) + carried;
        carried = F::Up::default();
        let up = by_kind!(body.kind, J => {
            fold.up::<J>(At { index, end: body.subtree_end, body }, &keep, children)
        });
        match body.parent {
            Link::Base => total = total + up,
            Link::Joint(p) if p + 1 == index => carried = up,
            Link::Joint(p) => {
                if let Some(slot) = ups.get_mut(p) {
                    *slot = *slot + up;
                }
            }
        }
    }
    total
}

/// Writes the walk of a const model: limbs as chains of joint kinds, identical limbs as one loop, or
/// [`abreast`](crate::abreast) where there are vector registers for them.
///
/// `count * [Kind, Kind, …]` is that many chains one after the other in the table; a chain may end in
/// `{ … }`, the branches that its last body carries.
///
/// ```
/// use rbd_core::model::{BaseBody, Body};
/// use rbd_core::joint::{Kind, RevoluteX, RevoluteY};
/// # use rbd_core::tree::Tree;
/// /// Two legs of a hip and a knee.
/// pub struct Biped;
/// static BODIES: [Body<f64>; 4] = [Body::<f64>::EMPTY; 4];
/// static BASE: BaseBody<f64> = BaseBody::<f64>::EMPTY;
/// rbd_core::tree! {
///     impl Tree<f64, 4> for Biped { floating, BASE, BODIES, 2 * [RevoluteX, RevoluteY] }
/// }
/// assert_eq!(Biped.joint_count(), 4);
/// ```
#[macro_export]
macro_rules! tree {
    (impl Tree<$T:ty, $N:literal> for $Robot:ty {
        floating, $base:path, $bodies:path, $($branches:tt)*
    }) => {
        $crate::tree!(@impl $T, $N, $Robot, $crate::model::BaseKind::Floating, $base, $bodies, $($branches)*);
    };
    (impl Tree<$T:ty, $N:literal> for $Robot:ty {
        fixed, $base:path, $bodies:path, $($branches:tt)*
    }) => {
        $crate::tree!(@impl $T, $N, $Robot, $crate::model::BaseKind::Fixed, $base, $bodies, $($branches)*);
    };
    (@impl $T:ty, $N:literal, $Robot:ty, $kind:expr, $base:path, $bodies:path, $($branches:tt)*) => {
        impl $crate::tree::Tree<$T, $N> for $Robot {
            #[inline(always)]
            fn base_kind(&self) -> $crate::model::BaseKind {
                $kind
            }
            #[inline(always)]
            fn base(&self) -> &$crate::model::BaseBody<$T> {
                &$base
            }
            #[inline(always)]
            fn bodies(&self) -> &[$crate::model::Body<$T>; $N] {
                &$bodies
            }
            #[inline(always)]
            #[allow(unused_assignments, reason = "the first limb is last for some robots")]
            fn fold<F: $crate::tree::Fold<$T>>(&self, fold: &mut F, base: &F::Down) -> F::Up {
                $crate::tree!(@branches fold, (&$bodies), 0, base, $($branches)*)
            }
        }
    };
    // Branches of one body, first limb at index $first: identical limbs abreast, or one after the other.
    (@branches $fold:ident, $bodies:tt, $first:expr, $parent:expr, $($count:literal * [$($chain:tt)*]),* $(,)?) => {{
        let mut sum = F::Up::default();
        let mut first = $first;
        $({
            const LENGTH: usize = $crate::tree!(@len $($chain)*);
            const ABREAST: usize = $crate::abreast::limbs_abreast($count);
            if F::ABREAST && ABREAST > 1 {
                for group in 0..$count / ABREAST {
                    let start = first + group * ABREAST * LENGTH;
                    let parents = $crate::abreast::repeat::<F::Down, ABREAST>($parent);
                    let limbs = $crate::tree!(@abreast $fold, $bodies, start, LENGTH, ABREAST, parents, $($chain)*);
                    for limb in 0..ABREAST {
                        sum = sum + $crate::abreast::of::<F::Up, ABREAST>(&limbs, limb);
                    }
                }
            } else {
                for limb in 0..$count {
                    let start = first + limb * LENGTH;
                    sum = sum + $crate::tree!(@chain $fold, $bodies, start, $parent, $($chain)*);
                }
            }
            first += $count * LENGTH;
        })*
        sum
    }};
    // A chain: joint after joint, then branches or nothing.
    (@chain $fold:ident, $bodies:tt, $i:expr, $parent:expr,) => { F::Up::default() };
    (@chain $fold:ident, $bodies:tt, $i:expr, $parent:expr, { $($branches:tt)* }) => {
        $crate::tree!(@branches $fold, $bodies, $i, $parent, $($branches)*)
    };
    (@chain $fold:ident, $bodies:tt, $i:expr, $parent:expr, $J:ident $(, $($rest:tt)*)?) => {{
        let index = $i;
        let at = $crate::tree::At {
            index,
            end: index + 1 $(+ $crate::tree!(@len $($rest)*))?,
            body: $crate::tree::row($bodies, index),
        };
        let passed = $crate::tree::down::<$crate::joint::$J, F, _>($fold, at, $parent);
        let children = $crate::tree!(@chain $fold, $bodies, index + 1, &passed.0, $($($rest)*)?);
        let _ = &passed.0;
        $crate::tree::up::<$crate::joint::$J, F, _>($fold, at, &passed.1, children)
    }};
    // The same chain of $count limbs, each $length bodies after the one before.
    (@abreast $fold:ident, $bodies:tt, $i:expr, $length:ident, $count:ident, $parents:expr,) => {
        $crate::abreast::repeat::<F::Up, $count>(&F::Up::default())
    };
    (@abreast $fold:ident, $bodies:tt, $i:expr, $length:ident, $count:ident, $parents:expr, { $($branches:tt)* }) => {{
        let parents = $parents;
        let mut ups = $crate::abreast::repeat::<F::Up, $count>(&F::Up::default());
        for limb in 0..$count {
            let parent = &$crate::abreast::of::<F::Down, $count>(&parents, limb);
            let up = $crate::tree!(@branches $fold, $bodies, $i + limb * $length, parent, $($branches)*);
            $crate::abreast::set::<F::Up, $count>(&mut ups, limb, up);
        }
        ups
    }};
    (@abreast $fold:ident, $bodies:tt, $i:expr, $length:ident, $count:ident, $parents:expr, $J:ident $(, $($rest:tt)*)?) => {{
        let joints = $crate::abreast::Joints {
            bodies: $bodies,
            first: $i,
            end: $i + 1 $(+ $crate::tree!(@len $($rest)*))?,
            length: $length,
        };
        let (downs, keeps) = joints.down::<$crate::joint::$J, F, $count>($fold, &$parents);
        let children = $crate::tree!(@abreast $fold, $bodies, $i + 1, $length, $count, downs, $($($rest)*)?);
        let _ = &downs;
        joints.up::<$crate::joint::$J, F, $count>($fold, &keeps, &children)
    }};
    // Number of bodies in a chain.
    (@len) => { 0 };
    (@len { $($count:literal * [$($chain:tt)*]),* $(,)? }) => {
        (0 $(+ $count * $crate::tree!(@len $($chain)*))*)
    };
    (@len $J:ident $(, $($rest:tt)*)?) => { (1 $(+ $crate::tree!(@len $($rest)*))?) };
}

/// Row `index` of a table; the first row stands in for one that does not exist, so that no panic path
/// remains where the compiler cannot see the bound.
#[doc(hidden)]
#[inline(always)]
pub fn row<T, const N: usize>(bodies: &[Body<T>; N], index: usize) -> &Body<T> {
    match bodies.get(index) {
        Some(body) => body,
        None => &bodies[0],
    }
}

/// [`Fold::down`], repeated here or called.
#[doc(hidden)]
#[inline(always)]
pub fn down<J: JointKind, F: Fold<T>, T: Scalar>(
    fold: &mut F,
    at: At<'_, T>,
    parent: &F::Down,
) -> (F::Down, F::Keep) {
    if F::LONG && HAS_DECODED_CACHE {
        called_down::<J, F, T>(fold, at, parent)
    } else {
        fold.down::<J>(at, parent)
    }
}

/// [`Fold::up`], repeated here or called.
#[doc(hidden)]
#[inline(always)]
pub fn up<J: JointKind, F: Fold<T>, T: Scalar>(
    fold: &mut F,
    at: At<'_, T>,
    keep: &F::Keep,
    children: F::Up,
) -> F::Up {
    if F::LONG && HAS_DECODED_CACHE {
        called_up::<J, F, T>(fold, at, keep, children)
    } else {
        fold.up::<J>(at, keep, children)
    }
}

/// Firmware's processors decode what they fetch, and there a call costs more than it saves.
const HAS_DECODED_CACHE: bool = cfg!(target_arch = "x86_64");

#[inline(never)]
fn called_down<J: JointKind, F: Fold<T>, T: Scalar>(
    fold: &mut F,
    at: At<'_, T>,
    parent: &F::Down,
) -> (F::Down, F::Keep) {
    fold.down::<J>(at, parent)
}

#[inline(never)]
fn called_up<J: JointKind, F: Fold<T>, T: Scalar>(
    fold: &mut F,
    at: At<'_, T>,
    keep: &F::Keep,
    children: F::Up,
) -> F::Up {
    fold.up::<J>(at, keep, children)
}
