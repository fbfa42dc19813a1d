//! A robot and its world in MuJoCo's format (MJCF), written from the same tables as everything else.
//!
//! Bodies keep the canonical frames of `rbd-core`, so joint coordinates mean the same on both sides; the base is
//! a free joint, whose coordinates `rbd_core::convert` translates. The robot's shapes touch the world and not
//! each other.

use core::fmt::Write as _;
use std::string::String;
use std::vec::Vec;

use nalgebra::{Matrix3, Vector3};
use rbd_core::{BaseKind, Contact, ContactShape, Frame, GRAVITY, Inertia, JointLimits, Link, Tree};

use crate::{ContactSphere, Settings, Terrain};

/// Thickness given to a sole, which is a plane in the tables, m.
const SOLE_THICKNESS: f64 = 0.01;

/// A shape on the robot that may touch the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geom {
    /// Where it is: centre and axes of the shape.
    pub frame: Frame<f64>,
    /// What it is.
    pub shape: GeomShape,
    /// The contact to which its forces are added; several shapes may share one.
    pub contact: usize,
}

/// Kinds of shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GeomShape {
    /// A ball of this radius, m.
    Sphere(f64),
    /// A box of these half sizes, m.
    Box([f64; 3]),
}

impl Geom {
    /// A contact sphere of the native simulator.
    #[must_use]
    pub const fn sphere(sphere: &ContactSphere<f64>, contact: usize) -> Self {
        let mut frame = Frame::IDENTITY;
        frame.link = sphere.link;
        frame.offset = sphere.offset;
        Self {
            frame,
            shape: GeomShape::Sphere(sphere.radius),
            contact,
        }
    }

    /// A robot's contact: a ball, or a sole as a box of 10 mm above the sole's plane.
    #[must_use]
    pub fn of(robot: &Contact<f64>, contact: usize) -> Self {
        match robot.shape {
            ContactShape::Sphere { radius } => Self {
                frame: robot.frame,
                shape: GeomShape::Sphere(radius),
                contact,
            },
            ContactShape::Rectangle { x, y } => {
                let center = Vector3::new(
                    0.5 * (x[0] + x[1]),
                    0.5 * (y[0] + y[1]),
                    0.5 * SOLE_THICKNESS,
                );
                let mut frame = robot.frame;
                frame.offset = robot.frame.placement().point(&center).into();
                let half = [
                    0.5 * (x[1] - x[0]),
                    0.5 * (y[1] - y[0]),
                    0.5 * SOLE_THICKNESS,
                ];
                Self {
                    frame,
                    shape: GeomShape::Box(half),
                    contact,
                }
            }
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
    geoms: &[Geom],
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
        if limits.lower.is_finite() && limits.upper.is_finite() {
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
    out.push_str("</body>\n</worldbody>\n</mujoco>\n");
    out
}

/// Options. Contacts and stops are stiff (time constant 2 ms) and damped critically, friction is a true cone.
fn header<const N: usize>(out: &mut String, settings: &Settings<f64, N>) {
    let _ = writeln!(
        out,
        "<compiler angle=\"radian\" inertiafromgeom=\"false\" autolimits=\"false\"/>\n\
         <option timestep=\"{}\" gravity=\"{}\" integrator=\"implicitfast\" cone=\"elliptic\" impratio=\"10\" \
         tolerance=\"1e-12\"><flag autoreset=\"disable\"/></option>\n\
         <default><geom condim=\"3\" friction=\"{} 0 0\" solref=\"0.002 1\" solimp=\"0.95 0.99 0.001\"/>\
         <joint solreflimit=\"0.004 1\" solreffriction=\"0.004 1\"/></default>",
        settings.tick / f64::from(settings.substeps.max(1)),
        numbers(&GRAVITY),
        settings.contact.friction,
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
        .filter(|(_, geom)| geom.frame.link == link);
    for (index, geom) in here {
        let (kind, size) = match geom.shape {
            GeomShape::Sphere(radius) => ("sphere", numbers(&[radius])),
            GeomShape::Box(half) => ("box", numbers(&half)),
        };
        let _ = writeln!(
            out,
            "<geom name=\"{}\" type=\"{kind}\" size=\"{size}\" pos=\"{}\" {} contype=\"1\" conaffinity=\"0\"/>",
            geom_name(index),
            numbers(&geom.frame.offset),
            axes(geom.frame.placement().rotation.matrix()),
        );
    }
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
