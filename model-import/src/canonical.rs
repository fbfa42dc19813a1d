//! Puts a tree of links into rbd-core's canonical frames.
//!
//! Every movable joint carries one body; links on fixed and locked joints are lumped into the body above.
//! The frame of a body has its origin at the joint, and at zero position the axes of the frame above
//! wherever the joint axis is ± one of these, up to `Options::axis_rounding`. Otherwise the joint is tilted: its z axis is the joint axis,
//! and its x axis is the first joint axis further out that is perpendicular to it, so that the joints of
//! an inclined limb are aligned again from its second one on.

use nalgebra::{Matrix3, Rotation3, Vector3};
use rbd_core::joint::Kind;
use rbd_core::model::{BaseBody, Body, Frame, Link};
use rbd_core::spatial::{Inertia, Transform};
use so3::math;

use crate::error::Warning;
use crate::robot::{JointInfo, LinkFrame};

use crate::tree::LinkTree;
use crate::urdf::{JointType, Urdf, UrdfJoint};

/// Cosine below which an axis is a good guide for the x axis of a tilted frame; the frame is made orthogonal all the same.
const PERPENDICULAR: f64 = 1e-9;
/// Deviation from a coordinate axis below which its author may have meant that axis.
const NEARLY_ALIGNED: f64 = 1e-6;
/// Largest deviation of a number from 0, 1 or −1 in a rotation or offset that counts as round-off.
const ROUND_OFF: f64 = 1e-14;

/// The tables of a robot.
pub(crate) struct Tables {
    pub(crate) base: BaseBody<f64>,
    pub(crate) bodies: Vec<Body<f64>>,
    pub(crate) joints: Vec<JointInfo>,
    pub(crate) frames: Vec<LinkFrame>,
    /// What each link of the file is lumped into.
    pub(crate) body_of: Vec<Link>,
    /// Axes that are nearly aligned.
    pub(crate) warnings: Vec<Warning>,
}

/// A link to visit: what it is lumped into, and where it is there.
struct Visit {
    link: usize,
    body: Link,
    placement: Transform<f64>,
    joint: Option<usize>,
}

/// Walks the tree depth first and fills the tables.
pub(crate) fn tables(
    urdf: &Urdf,
    tree: &LinkTree,
    locked: &[Option<f64>],
    axis_rounding: f64,
) -> Tables {
    let mut out = Tables {
        base: BaseBody::EMPTY,
        bodies: Vec::new(),
        joints: Vec::new(),
        frames: Vec::new(),
        body_of: vec![Link::Base; urdf.links.len()],
        warnings: Vec::new(),
    };
    let mut base = Inertia::ZERO;
    let mut inertias: Vec<Inertia<f64>> = Vec::new();
    let mut stack = vec![Visit {
        link: tree.root,
        body: Link::Base,
        placement: Transform::IDENTITY,
        joint: None,
    }];
    while let Some(mut at) = stack.pop() {
        if let Some(j) = at.joint {
            let joint = &urdf.joints[j];
            at.placement = at.placement.compose(&joint.origin);
            if is_still(joint, locked[j]) {
                at.placement = at
                    .placement
                    .compose(&displaced(joint, locked[j].unwrap_or(0.0)));
            } else {
                let axes = descendant_axes(urdf, tree, locked, j, &at.placement);
                let axis = at.placement.rotation * joint.axis;
                let aligned = aligned(&joint.name, &axis, axis_rounding, &mut out.warnings);
                let (body, placement) =
                    canonical_body(joint, at.body, &at.placement, &axes, aligned);
                at.body = Link::Joint(out.bodies.len());
                at.placement = placement;
                out.bodies.push(body);
                inertias.push(Inertia::ZERO);
                out.joints.push(JointInfo {
                    name: joint.name.clone(),
                    link: joint.child.clone(),
                    continuous: joint.kind == JointType::Continuous,
                    limits: joint.limits,
                });
            }
        }
        let link = &urdf.links[at.link];
        at.placement = cleaned(&at.placement);
        if let Some(inertia) = link.inertia {
            let lumped = inertia.transformed(&at.placement);
            match at.body {
                Link::Base => base += lumped,
                Link::Joint(i) => inertias[i] += lumped,
            }
        }
        out.body_of[at.link] = at.body;
        out.frames.push(LinkFrame {
            name: link.name.clone(),
            joint: at.joint.map(|j| urdf.joints[j].name.clone()),
            frame: frame(at.body, &at.placement),
        });
        for &j in tree.joints_below[at.link].iter().rev() {
            stack.push(Visit {
                link: tree.child[j],
                body: at.body,
                placement: at.placement,
                joint: Some(j),
            });
        }
    }
    fill(&mut out, &base, &inertias);
    out
}

/// Writes the lumped moments and the extents of the subtrees.
fn fill(out: &mut Tables, base: &Inertia<f64>, inertias: &[Inertia<f64>]) {
    (out.base.mass, out.base.first, out.base.second) = moments(base);
    for (i, inertia) in inertias.iter().enumerate() {
        let end = subtree_end(&out.bodies, i);
        let body = &mut out.bodies[i];
        (body.mass, body.first, body.second) = moments(inertia);
        body.subtree_end = end;
    }
}

fn is_still(joint: &UrdfJoint, locked: Option<f64>) -> bool {
    joint.kind == JointType::Fixed || locked.is_some()
}

/// Displacement of a joint from zero, in its child's frame at zero.
fn displaced(joint: &UrdfJoint, value: f64) -> Transform<f64> {
    match joint.kind {
        JointType::Fixed => Transform::IDENTITY,
        JointType::Prismatic => Transform::new(Rotation3::identity(), joint.axis * value),
        JointType::Revolute | JointType::Continuous => {
            // Rodrigues: 1 + sin [a]× + (1 − cos) [a]×².
            let (sin, cos) = math::sin_cos(value);
            let k = joint.axis.cross_matrix();
            let m = Matrix3::identity() + k * sin + k * k * (1.0 - cos);
            Transform::new(Rotation3::from_matrix_unchecked(m), Vector3::zeros())
        }
    }
}

/// Axes of the movable joints beyond joint `j`, in the axes that `placement` (of its child at zero) is
/// given in, with every joint at zero; nearest first.
fn descendant_axes(
    urdf: &Urdf,
    tree: &LinkTree,
    locked: &[Option<f64>],
    j: usize,
    placement: &Transform<f64>,
) -> Vec<Vector3<f64>> {
    let mut axes = Vec::new();
    let mut stack = vec![(tree.child[j], placement.rotation)];
    while let Some((link, rotation)) = stack.pop() {
        for &below in tree.joints_below[link].iter().rev() {
            let joint = &urdf.joints[below];
            let here = rotation * joint.origin.rotation;
            if is_still(joint, locked[below]) {
                let still = displaced(joint, locked[below].unwrap_or(0.0));
                stack.push((tree.child[below], here * still.rotation));
            } else {
                axes.push(here * joint.axis);
                stack.push((tree.child[below], here));
            }
        }
    }
    axes
}

/// The body of a movable joint whose child frame at zero is `placement` in the parent's canonical frame;
/// and that child frame in the body's canonical frame.
fn canonical_body(
    joint: &UrdfJoint,
    parent: Link,
    placement: &Transform<f64>,
    axes_beyond: &[Vector3<f64>],
    aligned: Option<(usize, f64)>,
) -> (Body<f64>, Transform<f64>) {
    let revolute = joint.kind != JointType::Prismatic;
    let axis = placement.rotation * joint.axis;
    let mut body = Body::<f64> {
        parent,
        offset: placement.translation.map(clean).into(),
        rotor_inertia: joint.rotor_inertia,
        ..Body::EMPTY
    };
    if let Some((k, sign)) = aligned {
        let [turn, slide] = [
            [Kind::RevoluteX, Kind::PrismaticX],
            [Kind::RevoluteY, Kind::PrismaticY],
            [Kind::RevoluteZ, Kind::PrismaticZ],
        ][k];
        body.kind = if revolute { turn } else { slide };
        body.sign = sign;
        return (body, Transform::new(placement.rotation, Vector3::zeros()));
    }
    body.kind = if revolute {
        Kind::RevoluteTilted
    } else {
        Kind::PrismaticTilted
    };
    let tilt = tilt(&axis, axes_beyond, &placement.rotation);
    body.tilt = rows(&tilt);
    let rotation = Rotation3::from_matrix_unchecked(tilt.transpose() * placement.rotation.matrix());
    (body, Transform::new(rotation, Vector3::zeros()))
}

/// Index and sign of the coordinate axis that `axis` is, up to `rounding`; one that is nearly missed is said.
fn aligned(
    joint: &str,
    axis: &Vector3<f64>,
    rounding: f64,
    warnings: &mut Vec<Warning>,
) -> Option<(usize, f64)> {
    let k = axis.iamax();
    let unit = Vector3::ith(k, math::copysign(1.0, axis[k]));
    let off = (axis - unit).amax();
    if off < rounding {
        return Some((k, unit[k]));
    }
    if off < NEARLY_ALIGNED {
        warnings.push(Warning::AxisNearlyAligned {
            joint: joint.to_owned(),
            off,
            suggest: 2.0 * off,
        });
    }
    None
}

/// A rotation whose third column is `axis`; see the module's text for the others.
fn tilt(axis: &Vector3<f64>, axes_beyond: &[Vector3<f64>], own: &Rotation3<f64>) -> Matrix3<f64> {
    let z = axis.normalize();
    let own_axes = [0, 1, 2].map(|k| own.matrix().column(k).into_owned());
    let perpendicular = |x: &&Vector3<f64>| math::abs(x.dot(&z)) < PERPENDICULAR;
    let nearest = |x: &&Vector3<f64>, y: &&Vector3<f64>| {
        math::abs(x.dot(&z)).total_cmp(&math::abs(y.dot(&z)))
    };
    let guide = (axes_beyond.iter().find(perpendicular))
        .or_else(|| own_axes.iter().min_by(nearest))
        .copied()
        .unwrap_or_else(Vector3::x);
    let x = (guide - z * guide.dot(&z)).normalize();
    Matrix3::from_columns(&[x, z.cross(&x), z]).map(clean)
}

/// One past the last body of the subtree that starts at body `i`.
fn subtree_end(bodies: &[Body<f64>], i: usize) -> usize {
    let inside = |b: &&Body<f64>| matches!(b.parent, Link::Joint(p) if p >= i);
    i + 1 + bodies[i + 1..].iter().take_while(inside).count()
}

fn moments(inertia: &Inertia<f64>) -> (f64, [f64; 3], [f64; 6]) {
    let positive_zero = |x: f64| x + 0.0;
    (
        inertia.mass,
        inertia.first.map(positive_zero).into(),
        inertia.second.to_array().map(positive_zero),
    )
}

fn frame(link: Link, placement: &Transform<f64>) -> Frame<f64> {
    Frame {
        link,
        offset: placement.translation.into(),
        rotation: rows(placement.rotation.matrix()),
    }
}

fn rows(m: &Matrix3<f64>) -> [[f64; 3]; 3] {
    m.transpose().into()
}

/// Takes round-off for what it is, so that right angles stay right.
fn cleaned(placement: &Transform<f64>) -> Transform<f64> {
    let m = placement.rotation.matrix().map(clean);
    Transform::new(
        Rotation3::from_matrix_unchecked(m),
        placement.translation.map(clean),
    )
}

fn clean(x: f64) -> f64 {
    let near = |y: f64| math::abs(x - y) < ROUND_OFF;
    [0.0, 1.0, -1.0].into_iter().find(|&y| near(y)).unwrap_or(x)
}
