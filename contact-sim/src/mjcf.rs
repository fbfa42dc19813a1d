//! A robot and its world in MuJoCo's format (MJCF), written from the same tables as everything else.
//!
//! Bodies keep the canonical frames of `rbd-core`, so joint coordinates mean the same on both sides; the base is
//! a free joint, whose coordinates `rbd_core::convert` translates. Of the robot's shapes those
//! pairs touch each other that are listed.

use core::fmt::Write as _;
use std::string::String;
use std::vec::Vec;

use nalgebra::{Matrix3, Vector3};
use rbd_core::{BaseKind, Contact, ContactShape, Frame, GRAVITY, Inertia, JointLimits, Link, Tree};

use crate::contact::{FRICTION_RATIO, WIDTH};
use crate::{ContactLaw, MOST_SHAPES, Settings, Shape, Terrain};

/// Thickness given to a sole, which is a plane in the tables, m.
const SOLE_THICKNESS: f64 = 0.01;

/// A shape on the robot that may touch the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Geom {
    /// A swept ball, as the native simulator has it.
    Swept(Shape<f64>),
    /// A box: centre and axes, half sizes, m, and what its forces count for.
    Box {
        /// Centre and axes.
        frame: Frame<f64>,
        /// Half sizes, m.
        half: [f64; 3],
        /// What its forces count for.
        owner: usize,
    },
}

impl Geom {
    /// A robot's contact: a ball, or a sole as a box of 10 mm above the sole's plane.
    #[must_use]
    pub fn of(contact: &Contact<f64>, owner: usize) -> Self {
        match contact.shape {
            ContactShape::Sphere { radius } => {
                let frame = &contact.frame;
                Self::Swept(Shape::ball(frame.link, frame.offset, radius, owner))
            }
            ContactShape::Rectangle { x, y } => {
                let middle = [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])];
                let center = Vector3::new(middle[0], middle[1], 0.5 * SOLE_THICKNESS);
                let mut frame = contact.frame;
                frame.offset = contact.frame.placement().point(&center).into();
                let half = [
                    0.5 * (x[1] - x[0]),
                    0.5 * (y[1] - y[0]),
                    0.5 * SOLE_THICKNESS,
                ];
                Self::Box { frame, half, owner }
            }
        }
    }

    /// The link that it is fixed to.
    #[must_use]
    pub const fn link(&self) -> Link {
        match self {
            Self::Swept(shape) => shape.link,
            Self::Box { frame, .. } => frame.link,
        }
    }

    /// What its forces count for.
    #[must_use]
    pub const fn owner(&self) -> usize {
        match self {
            Self::Swept(shape) => shape.owner,
            Self::Box { owner, .. } => *owner,
        }
    }
}

/// Name of the shape with this index.
pub(crate) fn geom_name(index: usize) -> String {
    std::format!("touch{index}")
}

/// The model as MJCF: inertias, joints with ranges, damping, Coulomb friction and rotor inertia, shapes, floor and
/// block. Motors are not in it: torques come from outside.
#[must_use]
pub fn mjcf<M: Tree<f64, N>, const N: usize>(
    model: &M,
    (geoms, pairs): (&[Geom], &[u64]),
    terrain: &Terrain<f64>,
    settings: &Settings<f64, N>,
) -> String {
    let mut out = String::from("<mujoco>\n");
    header(&mut out, settings);
    out.push_str("<worldbody>\n");
    let _ = writeln!(
        out,
        "<geom type=\"plane\" size=\"0 0 1\" pos=\"0 0 {}\" contype=\"0\" conaffinity=\"1\"/>",
        terrain.floor
    );
    if let Some(block) = &terrain.block {
        let (l, u) = (Vector3::from(block.lower), Vector3::from(block.upper));
        let _ = writeln!(
            out,
            "<geom type=\"box\" size=\"{}\" pos=\"{}\" contype=\"0\" conaffinity=\"1\"/>",
            numbers(((u - l) * 0.5).as_slice()),
            numbers(((u + l) * 0.5).as_slice()),
        );
    }
    out.push_str("<body>\n");
    if model.base_kind() == BaseKind::Floating {
        out.push_str("<freejoint/>\n");
        inertial(&mut out, &model.base().inertia());
    }
    shapes(&mut out, geoms, Link::Base);
    let mut open: Vec<usize> = Vec::new();
    for (i, body) in model.bodies().iter().take(model.joint_count()).enumerate() {
        while open.last().is_some_and(|end| *end <= i) {
            open.pop();
            out.push_str("</body>\n");
        }
        open.push(body.subtree_end);
        let _ = writeln!(
            out,
            "<body pos=\"{}\" {}>",
            numbers(&body.offset),
            axes(&body.tilt_matrix())
        );
        let mut axis = [0.0; 3];
        if let Some(x) = axis.get_mut(body.kind.axis()) {
            *x = body.sign;
        }
        let kind = if body.kind.is_revolute() {
            "hinge"
        } else {
            "slide"
        };
        let limits = settings.limits.get(i).unwrap_or(&JointLimits::NONE);
        let _ = write!(
            out,
            "<joint name=\"joint{i}\" type=\"{kind}\" axis=\"{}\" damping=\"{}\" frictionloss=\"{}\" armature=\"{}\"",
            numbers(&axis),
            limits.damping,
            limits.friction,
            body.rotor_inertia
        );
        if has_stops(limits) {
            let _ = write!(
                out,
                " limited=\"true\" range=\"{} {}\"",
                limits.lower, limits.upper
            );
        }
        out.push_str("/>\n");
        inertial(&mut out, &body.inertia());
        shapes(&mut out, geoms, Link::Joint(i));
    }
    for _ in &open {
        out.push_str("</body>\n");
    }
    out.push_str("</body>\n</worldbody>\n");
    let stops: Vec<usize> = stopped(model.joint_count(), settings).collect();
    pairs_and_stops(&mut out, pairs, &settings.contact, &stops);
    out.push_str("</mujoco>\n");
    out
}

fn has_stops(limits: &JointLimits<f64>) -> bool {
    limits.lower.is_finite() && limits.upper.is_finite()
}

/// Joints that have stops, of so many: in the order of the sensors that tell the stops' torques.
pub(crate) fn stopped<const N: usize>(
    count: usize,
    settings: &Settings<f64, N>,
) -> impl Iterator<Item = usize> {
    let joints = settings.limits.iter().enumerate().take(count);
    joints
        .filter(|(_, limits)| has_stops(limits))
        .map(|(i, _)| i)
}

/// Options. Contacts are damped critically, friction is a true cone, stops are stiff (time constant 4 ms).
fn header<const N: usize>(out: &mut String, settings: &Settings<f64, N>) {
    let _ = writeln!(
        out,
        "<compiler angle=\"radian\" inertiafromgeom=\"false\" autolimits=\"false\"/>\n\
         <option timestep=\"{}\" gravity=\"{}\" integrator=\"implicitfast\" cone=\"elliptic\" impratio=\"{FRICTION_RATIO}\" \
         tolerance=\"1e-12\"><flag autoreset=\"disable\"/></option>\n\
         <default><geom condim=\"3\" friction=\"{} 0 0\" {}/>\
         <joint solreflimit=\"0.004 1\" solreffriction=\"0.004 1\"/></default>",
        settings.tick / f64::from(settings.substeps.max(1)),
        numbers(&GRAVITY),
        settings.contact.friction,
        softness(&settings.contact),
    );
}

/// Mass, centre of mass and rotational inertia about it: I = (tr S) 1 − S of the central second moments S.
fn inertial(out: &mut String, inertia: &Inertia<f64>) {
    if inertia.mass <= 0.0 {
        return;
    }
    let com = inertia.first / inertia.mass;
    let central = inertia.second.to_matrix() - com * com.transpose() * inertia.mass;
    let i = Matrix3::identity() * central.trace() - central;
    let _ = writeln!(
        out,
        "<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>",
        numbers(com.as_slice()),
        inertia.mass,
        numbers(&[
            i[(0, 0)],
            i[(1, 1)],
            i[(2, 2)],
            i[(0, 1)],
            i[(0, 2)],
            i[(1, 2)]
        ]),
    );
}

fn shapes(out: &mut String, geoms: &[Geom], link: Link) {
    let here = geoms
        .iter()
        .enumerate()
        .filter(|(_, geom)| geom.link() == link);
    for (index, geom) in here {
        let shape = match geom {
            Geom::Swept(ball) if ball.is_ball() => std::format!(
                "type=\"sphere\" size=\"{:?}\" pos=\"{}\"",
                ball.radius,
                numbers(&ball.from)
            ),
            Geom::Swept(shape) => std::format!(
                "type=\"capsule\" size=\"{:?}\" fromto=\"{} {}\"",
                shape.radius,
                numbers(&shape.from),
                numbers(&shape.to)
            ),
            Geom::Box { frame, half, .. } => std::format!(
                "type=\"box\" size=\"{}\" pos=\"{}\" {}",
                numbers(half),
                numbers(&frame.offset),
                axes(frame.placement().rotation.matrix())
            ),
        };
        let name = geom_name(index);
        let _ = writeln!(
            out,
            "<geom name=\"{name}\" {shape} contype=\"1\" conaffinity=\"0\"/>"
        );
    }
}

/// Pairs of shapes that touch each other, and a sensor of each joint's stop.
fn pairs_and_stops(out: &mut String, pairs: &[u64], settings: &ContactLaw<f64>, stops: &[usize]) {
    out.push_str("<contact>\n");
    for (i, bits) in pairs.iter().enumerate() {
        for j in (0..MOST_SHAPES).filter(|j| bits >> j & 1 == 1) {
            let _ = writeln!(
                out,
                "<pair geom1=\"{}\" geom2=\"{}\" condim=\"3\" friction=\"{mu} {mu} 0 0 0\" {}/>",
                geom_name(i),
                geom_name(j),
                softness(settings),
                mu = settings.friction,
            );
        }
    }
    out.push_str("</contact>\n<sensor>\n");
    for joint in stops {
        let _ = writeln!(out, "<jointlimitfrc joint=\"joint{joint}\"/>");
    }
    out.push_str("</sensor>\n");
}

/// `solref` and `solimp` of the ground.
fn softness(law: &ContactLaw<f64>) -> String {
    let [d0, d1] = law.impedance();
    std::format!(
        "solref=\"{:?} 1\" solimp=\"{d0:?} {d1:?} {WIDTH:?}\"",
        law.time_constant
    )
}

/// A rotation by its first two columns.
fn axes(rotation: &Matrix3<f64>) -> String {
    std::format!(
        "xyaxes=\"{}\"",
        numbers(rotation.fixed_columns::<2>(0).as_slice())
    )
}

/// Numbers with all their digits.
fn numbers(values: &[f64]) -> String {
    let mut out = String::new();
    for (i, x) in values.iter().enumerate() {
        let _ = write!(out, "{}{x:?}", if i == 0 { "" } else { " " });
    }
    out
}
