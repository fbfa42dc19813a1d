//! Which shapes of a robot may touch each other, and how hard it is to push a link.

use nalgebra::Vector3;
use rbd_core::{
    AbaWorkspace, Axes, Configuration, Force, Frame, FrameJacobian, Kinematics, Link, Posture,
    Tree, forward_kinematics, frame_jacobian, mass_solve,
};
use so3::{Scalar, math};

use crate::shape::Swept;
use crate::{ContactMass, Shape, Terrain};

/// Most shapes of one robot: a bit each.
pub const MOST_SHAPES: usize = 64;

/// Where a shape is.
pub(crate) fn place<T: Scalar, const N: usize>(
    kinematics: &Kinematics<T, N>,
    shape: &Shape<T>,
) -> Swept<T> {
    let xf_wl = kinematics.link(shape.link);
    Swept {
        from_w: xf_wl.point(&Vector3::from(shape.from)),
        to_w: xf_wl.point(&Vector3::from(shape.to)),
        radius: shape.radius,
    }
}

/// Whether one link hangs from the other, or they are one.
fn are_neighbours<T: Scalar, M: Tree<T, N>, const N: usize>(model: &M, a: Link, b: Link) -> bool {
    let hangs = |link: Link, from: Link| match link {
        Link::Base => false,
        Link::Joint(i) => model
            .bodies()
            .get(i)
            .is_some_and(|body| body.parent == from),
    };
    a == b || hangs(a, b) || hangs(b, a)
}

/// Pairs of shapes that may touch each other: bit j of number i stands for the pair i < j. Left out are shapes of one link, of links that
/// hang from each other, and those that overlap in the `reference` posture, where the robot is known to stand free ([`overlaps`]). Shapes
/// beyond [`MOST_SHAPES`] touch the ground only.
#[must_use]
pub fn self_contacts<T: Scalar, M: Tree<T, N>, const N: usize, const S: usize>(
    model: &M,
    shapes: &[Shape<T>; S],
    reference: &Configuration<T, N>,
) -> [u64; S] {
    pairs(model, shapes, reference, |gap| gap > T::ZERO)
}

/// Pairs that [`self_contacts`] leaves out although their links do not hang from each other: they overlap in the `reference` posture, and
/// pass through each other unseen.
#[must_use]
pub fn overlaps<T: Scalar, M: Tree<T, N>, const N: usize, const S: usize>(
    model: &M,
    shapes: &[Shape<T>; S],
    reference: &Configuration<T, N>,
) -> [u64; S] {
    pairs(model, shapes, reference, |gap| gap <= T::ZERO)
}

/// Pairs of shapes of links that do not hang from each other, whose gap in a posture is `wanted`.
fn pairs<T: Scalar, M: Tree<T, N>, const N: usize, const S: usize>(
    model: &M,
    shapes: &[Shape<T>; S],
    reference: &Configuration<T, N>,
    wanted: impl Fn(T) -> bool,
) -> [u64; S] {
    let mut kinematics = Kinematics::IDENTITY;
    forward_kinematics(model, &Posture::new(model, reference), &mut kinematics);
    let mut pairs = [0; S];
    for (i, (bits, a)) in pairs.iter_mut().zip(shapes).enumerate() {
        for (j, b) in shapes.iter().enumerate().take(MOST_SHAPES).skip(i + 1) {
            let gap = place(&kinematics, a).gap(&place(&kinematics, b));
            if wanted(gap) && !are_neighbours(model, a.link, b.link) {
                *bits |= 1_u64 << j;
            }
        }
    }
    pairs
}

/// How near a robot's shapes are to the world and to each other: `each` gets a shape's index, the other's, or `None` for the world, and the
/// gap between them, m, which is negative where they overlap. Of the world only what is nearest, of the others those in `pairs`, as
/// [`self_contacts`] finds them.
pub fn gaps<T: Scalar, const N: usize, const S: usize>(
    kinematics: &Kinematics<T, N>,
    shapes: &[Shape<T>; S],
    pairs: &[u64; S],
    terrain: &Terrain<T>,
    mut each: impl FnMut(usize, Option<usize>, T),
) {
    for (i, (shape, others)) in shapes.iter().zip(pairs).enumerate() {
        let swept = place(kinematics, shape);
        let depths = swept.touches(terrain).map(|(touch, _)| touch.depth);
        each(i, None, -depths.into_iter().fold(-T::INFINITY, math::max));
        for (j, other) in shapes.iter().enumerate().take(MOST_SHAPES) {
            if (others >> j) & 1 == 1 {
                each(i, Some(j), swept.gap(&place(kinematics, other)));
            }
        }
    }
}

/// The gap between two shapes of a robot, m, which is negative where they overlap.
#[must_use]
pub fn gap<T: Scalar, const N: usize>(kinematics: &Kinematics<T, N>, [a, b]: [&Shape<T>; 2]) -> T {
    place(kinematics, a).gap(&place(kinematics, b))
}

/// How hard it is to push a shape: its link at its centre of mass, and the shape's ends, of which the lighter counts.
pub(crate) fn contact_mass<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    shape: &Shape<T>,
) -> ContactMass<T> {
    let inertia = match shape.link {
        Link::Base => Some(model.base().inertia()),
        Link::Joint(i) => model.bodies().get(i).map(rbd_core::Body::inertia),
    };
    let com = inertia
        .filter(|i| i.mass > T::ZERO)
        .map(|i| i.first / i.mass);
    let com = com.unwrap_or_else(Vector3::zeros).into();
    let [from, to] = [shape.from, shape.to].map(|end| effective_mass(model, shape.link, end));
    ContactMass {
        link: effective_mass(model, shape.link, com),
        point: math::min(from, to),
    }
}

/// Effective mass of a link's point with the joints at zero, mean of three directions, kg: 3/tr(J M⁻¹ Jᵀ). At the link's centre of mass it
/// is the inverse of what MuJoCo calls `body_invweight0`.
#[must_use]
pub fn effective_mass<T: Scalar, M: Tree<T, N>, const N: usize>(
    model: &M,
    link: Link,
    point: [T; 3],
) -> T {
    let neutral = Configuration::NEUTRAL;
    let posture = Posture::new(model, &neutral);
    let mut kinematics = Kinematics::IDENTITY;
    forward_kinematics(model, &posture, &mut kinematics);
    let mut frame = Frame::IDENTITY;
    frame.link = link;
    frame.offset = point;
    let mut jac = FrameJacobian::ZERO;
    frame_jacobian(
        model,
        &kinematics,
        &frame,
        Axes::LocalWorldAligned,
        &mut jac,
    );
    let mut workspace = AbaWorkspace::new();
    let mut mobility = T::ZERO;
    for axis in 0..3 {
        let unit = Vector3::from_fn(|row, _| if row == axis { T::ONE } else { T::ZERO });
        let effort = jac.tr_mul(&Force::new(unit, Vector3::zeros()));
        let motion = mass_solve(model, &posture, &effort, &mut workspace);
        let joints = effort.joints.iter().zip(&motion.joints);
        mobility +=
            motion.base.dot(&effort.base) + joints.fold(T::ZERO, |sum, (a, b)| sum + *a * *b);
    }
    T::of(3.0) / math::max(mobility, T::of(1e-9))
}
