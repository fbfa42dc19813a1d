//! The tables of a robot as one module of Rust.

use core::fmt::{self, Write};

use rbd_core::model::{BaseKind, Body, Frame, JointLimits, Link};
use sha2::{Digest, Sha256};

use super::names::distinct;
use crate::limbs::{expression, structure};
use crate::robot::Robot;

/// Where the numbers of a model come from; stands at the head of what is written.
#[derive(Clone, Debug)]
pub struct Provenance {
    /// Name of the source file, without folders.
    pub source: String,
    /// SHA-256 of the source file, in hexadecimal.
    pub sha256: String,
    /// Licence of the source file, as an SPDX expression if there is one.
    pub licence: String,
}

impl Provenance {
    /// For a source file with this name, text and licence.
    #[must_use]
    pub fn new(source: &str, text: &str, licence: &str) -> Self {
        let digest = Sha256::digest(text.as_bytes());
        Self {
            source: source.to_owned(),
            sha256: digest.iter().map(|b| format!("{b:02x}")).collect(),
            licence: licence.to_owned(),
        }
    }
}

/// Name and version of this tool, as written into models.
pub(super) const TOOL: &str = concat!("model-import ", env!("CARGO_PKG_VERSION"));

/// The module that makes the type `type_name` the robot, for f64 and f32.
#[must_use]
pub fn module(robot: &Robot, type_name: &str, provenance: &Provenance) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_module(&mut text, robot, type_name, provenance);
    text
}

fn write_module(
    w: &mut String,
    robot: &Robot,
    type_name: &str,
    provenance: &Provenance,
) -> fmt::Result {
    let n = robot.bodies.len();
    let joints = distinct(robot.joints.iter().map(|j| j.name.as_str()));
    let frames = distinct(robot.frames.iter().map(|f| f.name.as_str()));
    header(w, robot, provenance)?;
    let base = match robot.base_kind {
        BaseKind::Floating => "floating",
        BaseKind::Fixed => "fixed",
    };
    let limbs = expression(&structure(&robot.bodies));
    writeln!(
        w,
        "/// {} on a {base} base, {n} joints, {} kg.",
        robot.name,
        kilograms(robot)
    )?;
    writeln!(w, "#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]")?;
    writeln!(w, "pub struct {type_name};\n")?;
    for (scalar, suffix) in [("f64", ""), ("f32", "_F32")] {
        writeln!(w, "rbd_core::tree! {{")?;
        writeln!(
            w,
            "    impl Tree<{scalar}, {n}> for {type_name} {{ {base}, BASE{suffix}, BODIES{suffix}, {limbs} }}"
        )?;
        writeln!(w, "}}\n")?;
    }
    for (scalar, suffix) in [("f64", ""), ("f32", "_F32")] {
        writeln!(w, "rbd_core::model! {{")?;
        writeln!(
            w,
            "    impl Model<{scalar}, {n}> for {type_name} {{ NAME, JOINT_NAMES, LIMITS{suffix}, FRAME_NAMES, FRAMES{suffix} }}"
        )?;
        writeln!(w, "}}\n")?;
    }
    writeln!(
        w,
        "/// Name of the robot in the source file.\npub const NAME: &str = {:?};\n",
        robot.name
    )?;
    writeln!(w, "/// Number of joints.\npub const JOINTS: usize = {n};\n")?;
    names(
        w,
        "JOINT_NAMES",
        "Names of the joints, in the order of the joint coordinates",
        robot.joints.iter().map(|j| &j.name),
    )?;
    writeln!(w, "/// Index of each joint.\npub mod joint {{")?;
    for (i, (id, joint)) in joints.iter().zip(&robot.joints).enumerate() {
        writeln!(
            w,
            "    /// `{}`, which moves the link `{}`.\n    pub const {id}: usize = {i};",
            joint.name, joint.link
        )?;
    }
    writeln!(w, "}}\n")?;
    tables(w, robot)?;
    reduction(w, robot)?;
    frame_tables(w, robot, &frames)
}

/// How joints follow others, where any do.
fn reduction(w: &mut String, robot: &Robot) -> fmt::Result {
    if robot.couplings.iter().all(Option::is_none) {
        return Ok(());
    }
    let (n, independent) = (robot.joints.len(), robot.independent());
    let r = independent.len();
    names(
        w,
        "INDEPENDENT_NAMES",
        "Names of the joints that follow no other, in the order of the coordinates of [`REDUCTION`]",
        (independent.iter().map(|&i| &robot.joints[i].name))
            .collect::<Vec<_>>()
            .into_iter(),
    )?;
    writeln!(
        w,
        "/// How the joints follow the independent ones, as their `<mimic>` says.\npub static REDUCTION: Reduction<f64, {n}, {r}> = Reduction {{\n    rows: ["
    )?;
    for (i, (joint, coupling)) in robot.joints.iter().zip(&robot.couplings).enumerate() {
        let (leader, ratio, offset) =
            coupling.map_or((i, 1.0, 0.0), |c| (c.leader, c.ratio, c.offset));
        let coordinate = independent.partition_point(|&j| j < leader);
        writeln!(w, "        // {}", joint.name)?;
        writeln!(
            w,
            "        Coupling {{ coordinate: {coordinate}, ratio: {}, offset: {} }},",
            number(ratio),
            number(offset)
        )?;
    }
    writeln!(w, "    ],\n}};\n")?;
    writeln!(
        w,
        "/// [`REDUCTION`] in single precision.\npub static REDUCTION_F32: Reduction<f32, {n}, {r}> = REDUCTION.to_f32();\n"
    )
}

fn header(w: &mut String, robot: &Robot, provenance: &Provenance) -> fmt::Result {
    let locked: Vec<String> = robot
        .locked
        .iter()
        .map(|(j, x)| format!("{j}={x:?}"))
        .collect();
    let locked = if locked.is_empty() {
        "none".to_owned()
    } else {
        locked.join(" ")
    };
    writeln!(
        w,
        "//! Tables of the robot `{}` in canonical frames; generated, do not edit.\n//!",
        robot.name
    )?;
    writeln!(
        w,
        "//! - source: `{}`, sha256 {}",
        provenance.source, provenance.sha256
    )?;
    writeln!(w, "//! - licence of the source: {}", provenance.licence)?;
    writeln!(w, "//! - joints locked: {locked}\n//! - tool: {TOOL}\n")?;
    writeln!(
        w,
        "#![allow(clippy::approx_constant, clippy::excessive_precision, reason = \"numbers of the source file\")]\n"
    )?;
    writeln!(w, "use rbd_core::joint::Kind;")?;
    writeln!(
        w,
        "use rbd_core::model::{{BaseBody, Body, Frame, JointLimits, Link, bodies_f32, frames_f32, limits_f32}};"
    )?;
    if robot.couplings.iter().any(Option::is_some) {
        writeln!(w, "use rbd_core::reduction::{{Coupling, Reduction}};")?;
    }
    writeln!(w)
}

fn kilograms(robot: &Robot) -> String {
    format!("{:.6}", robot.mass())
        .trim_end_matches('0')
        .trim_end_matches('.')
        .to_owned()
}

fn names<'a>(
    w: &mut String,
    id: &str,
    doc: &str,
    names: impl ExactSizeIterator<Item = &'a String>,
) -> fmt::Result {
    writeln!(
        w,
        "/// {doc}.\npub static {id}: [&str; {}] = [",
        names.len()
    )?;
    for name in names {
        writeln!(w, "    {name:?},")?;
    }
    writeln!(w, "];\n")
}

fn tables(w: &mut String, robot: &Robot) -> fmt::Result {
    let n = robot.bodies.len();
    let base = &robot.base;
    writeln!(
        w,
        "/// The base: mass, first and second moments of mass.\npub static BASE: BaseBody<f64> = BaseBody {{"
    )?;
    writeln!(
        w,
        "    mass: {},\n    first: {},\n    second: {},\n}};\n",
        number(base.mass),
        list(&base.first),
        list(&base.second)
    )?;
    writeln!(
        w,
        "/// [`BASE`] in single precision.\npub static BASE_F32: BaseBody<f32> = BASE.to_f32();\n"
    )?;
    writeln!(
        w,
        "/// The bodies, depth first.\npub static BODIES: [Body<f64>; {n}] = ["
    )?;
    for (i, (body, joint)) in robot.bodies.iter().zip(&robot.joints).enumerate() {
        writeln!(w, "    // {i}: {}", joint.name)?;
        write_body(w, body)?;
    }
    writeln!(w, "];\n")?;
    writeln!(
        w,
        "/// [`BODIES`] in single precision.\npub static BODIES_F32: [Body<f32>; {n}] = bodies_f32(&BODIES);\n"
    )?;
    writeln!(
        w,
        "/// Limits and losses of the joints, as the source file has them.\npub static LIMITS: [JointLimits<f64>; {n}] = ["
    )?;
    for joint in &robot.joints {
        writeln!(w, "    // {}", joint.name)?;
        write_limits(w, &joint.limits)?;
    }
    writeln!(w, "];\n")?;
    writeln!(
        w,
        "/// [`LIMITS`] in single precision.\npub static LIMITS_F32: [JointLimits<f32>; {n}] = limits_f32(&LIMITS);\n"
    )
}

fn write_body(w: &mut String, body: &Body<f64>) -> fmt::Result {
    writeln!(w, "    Body {{")?;
    writeln!(w, "        kind: Kind::{:?},", body.kind)?;
    writeln!(w, "        parent: {},", link(body.parent))?;
    writeln!(w, "        subtree_end: {},", body.subtree_end)?;
    writeln!(w, "        sign: {},", number(body.sign))?;
    writeln!(w, "        offset: {},", list(&body.offset))?;
    writeln!(w, "        tilt: {},", matrix(&body.tilt))?;
    writeln!(w, "        mass: {},", number(body.mass))?;
    writeln!(w, "        first: {},", list(&body.first))?;
    writeln!(w, "        second: {},", list(&body.second))?;
    writeln!(w, "        rotor_inertia: {},", number(body.rotor_inertia))?;
    writeln!(w, "    }},")
}

fn write_limits(w: &mut String, limits: &JointLimits<f64>) -> fmt::Result {
    writeln!(w, "    JointLimits {{")?;
    for (name, value) in [
        ("lower", limits.lower),
        ("upper", limits.upper),
        ("speed", limits.speed),
        ("effort", limits.effort),
        ("damping", limits.damping),
        ("friction", limits.friction),
    ] {
        writeln!(w, "        {name}: {},", number(value))?;
    }
    writeln!(w, "    }},")
}

fn frame_tables(w: &mut String, robot: &Robot, ids: &[String]) -> fmt::Result {
    let n = robot.frames.len();
    writeln!(
        w,
        "/// The frame of each link, which is also that of the joint above it."
    )?;
    writeln!(w, "pub mod frame {{\n    use super::{{Frame, Link}};\n")?;
    for (id, frame) in ids.iter().zip(&robot.frames) {
        match &frame.joint {
            Some(joint) => writeln!(w, "    /// Link `{}`, joint `{joint}`.", frame.name)?,
            None => writeln!(w, "    /// Link `{}`, the root.", frame.name)?,
        }
        write_frame(w, id, &frame.frame)?;
    }
    writeln!(w, "}}\n")?;
    names(
        w,
        "FRAME_NAMES",
        "Names of the links, depth first",
        robot.frames.iter().map(|f| &f.name),
    )?;
    writeln!(
        w,
        "/// The frame of each link, in the order of [`FRAME_NAMES`].\npub static FRAMES: [Frame<f64>; {n}] = ["
    )?;
    for id in ids {
        writeln!(w, "    frame::{id},")?;
    }
    writeln!(w, "];\n")?;
    writeln!(
        w,
        "/// [`FRAMES`] in single precision.\npub static FRAMES_F32: [Frame<f32>; {n}] = frames_f32(&FRAMES);"
    )
}

fn write_frame(w: &mut String, id: &str, frame: &Frame<f64>) -> fmt::Result {
    writeln!(w, "    pub const {id}: Frame<f64> = Frame {{")?;
    writeln!(w, "        link: {},", link(frame.link))?;
    writeln!(w, "        offset: {},", list(&frame.offset))?;
    writeln!(w, "        rotation: {},\n    }};", matrix(&frame.rotation))
}

fn link(link: Link) -> String {
    match link {
        Link::Base => "Link::Base".to_owned(),
        Link::Joint(i) => format!("Link::Joint({i})"),
    }
}

/// The shortest decimal that reads back as the same number.
fn number(x: f64) -> String {
    if x == f64::INFINITY {
        "f64::INFINITY".to_owned()
    } else if x == f64::NEG_INFINITY {
        "f64::NEG_INFINITY".to_owned()
    } else {
        format!("{:?}", x + 0.0)
    }
}

fn list(x: &[f64]) -> String {
    let numbers: Vec<String> = x.iter().map(|&x| number(x)).collect();
    format!("[{}]", numbers.join(", "))
}

fn matrix(m: &[[f64; 3]; 3]) -> String {
    let rows: Vec<String> = m.iter().map(|row| list(row)).collect();
    format!("[{}]", rows.join(", "))
}
