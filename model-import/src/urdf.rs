//! Reads the dynamic content of a URDF: links with inertias, joints with axes and limits.
//!
//! Meshes, collisions, transmissions and simulator tags are skipped. Every element is checked by itself
//! here; what they form together is checked in the module `tree`.

use nalgebra::{Matrix3, Vector3};
use rbd_core::model::JointLimits;
use rbd_core::spatial::{Inertia, Symmetric3, Transform};
use roxmltree::{Document, Node};
use so3::euler::RollPitchYaw;
use so3::math;

use crate::error::{ImportError, Warning};
use crate::size::{self, LARGEST};

/// Largest deviation of an axis from unit length that is taken for rounding.
const AXIS_ROUNDING: f64 = 1e-2;
/// Deviation of an axis from unit length below which nothing is said.
const AXIS_SILENT: f64 = 1e-6;
/// Violation of the triangle inequality, relative to the largest moment, below which nothing is said.
const INERTIA_SILENT: f64 = 1e-9;

/// A robot as its file describes it.
#[derive(Clone, Debug)]
pub struct Urdf {
    /// Name of the robot.
    pub name: String,
    /// Links in file order.
    pub links: Vec<UrdfLink>,
    /// Joints in file order.
    pub joints: Vec<UrdfJoint>,
    /// What was tolerated.
    pub warnings: Vec<Warning>,
    /// Joints of one link are numbered by their names, as Pinocchio does with a URDF, and not as they stand in the file.
    pub sorted: bool,
}

/// A link.
#[derive(Clone, Debug)]
pub struct UrdfLink {
    /// Its name.
    pub name: String,
    /// Kind, name and line, for messages.
    pub element: String,
    /// Inertia in the link's own frame; `None` without `<inertial>`.
    pub inertia: Option<Inertia<f64>>,
    /// How the inertia is none that a body can have, if so.
    pub violation: Option<Violation>,
}

/// Principal moments of inertia that no body has: one is negative, or more than the sum of the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// The principal moments about the centre of mass, ascending, kg m².
    pub moments: [f64; 3],
    /// By how much, relative to the largest.
    pub excess: f64,
}

/// What a joint lets happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointType {
    /// Turns between limits.
    Revolute,
    /// Turns without limits.
    Continuous,
    /// Slides between limits.
    Prismatic,
    /// Nothing.
    Fixed,
}

/// Follows another joint: position = `multiplier` × leader + `offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    /// Name of the joint that is followed.
    pub leader: String,
    /// Ratio.
    pub multiplier: f64,
    /// Position when the leader is at zero, rad or m.
    pub offset: f64,
}

/// A joint.
#[derive(Clone, Debug)]
pub struct UrdfJoint {
    /// Its name.
    pub name: String,
    /// Kind, name and line, for messages.
    pub element: String,
    /// What it lets happen.
    pub kind: JointType,
    /// Name of the link above.
    pub parent: String,
    /// Name of the link below.
    pub child: String,
    /// Child link in parent link at zero position.
    pub origin: Transform<f64>,
    /// Unit axis in the child's frame.
    pub axis: Vector3<f64>,
    /// Limits and losses.
    pub limits: JointLimits<f64>,
    /// What its rotor adds to the inertia that it feels, kg m² or kg; a URDF has none.
    pub rotor_inertia: f64,
    /// The joint it follows, if any.
    pub mimic: Option<Mimic>,
}

impl Urdf {
    /// Reads the text of a URDF.
    ///
    /// # Errors
    /// The first element that is not what a URDF may say.
    pub fn parse(text: &str) -> Result<Self, ImportError> {
        let document = Document::parse(text).map_err(|e| ImportError::Xml {
            line: e.pos().row,
            column: e.pos().col,
            message: e.to_string(),
        })?;
        size::check(&document)?;
        let robot = document.root_element();
        if robot.tag_name().name() != "robot" {
            let found = robot.tag_name().name().to_owned();
            return Err(ImportError::NotARobot { found });
        }
        let mut urdf = Self {
            name: robot.attribute("name").unwrap_or("robot").to_owned(),
            links: Vec::new(),
            joints: Vec::new(),
            warnings: Vec::new(),
            sorted: true,
        };
        let mut floating = Vec::new();
        for node in robot.children() {
            match node.tag_name().name() {
                "link" => urdf.add_link(node)?,
                "joint" if node.attribute("type") == Some("floating") => floating.push(node),
                "joint" => urdf.add_joint(node)?,
                _ => {}
            }
        }
        if urdf.links.is_empty() {
            return Err(ImportError::NoLinks);
        }
        crate::floating::settle(&mut urdf, &floating)?;
        Ok(urdf)
    }

    fn add_link(&mut self, node: Node<'_, '_>) -> Result<(), ImportError> {
        let (name, element) = named(node)?;
        if self.links.iter().any(|l| l.name == name) {
            return Err(ImportError::DuplicateName { element });
        }
        let inertia = match child(node, "inertial") {
            Some(inertial) => Some(self.inertia(inertial, &element)?),
            None => None,
        };
        let (inertia, violation) = inertia.unzip();
        let violation = violation.flatten();
        self.links.push(UrdfLink {
            name,
            element,
            inertia,
            violation,
        });
        Ok(())
    }

    /// Mass, first and second moments in the link's frame.
    fn inertia(
        &mut self,
        node: Node<'_, '_>,
        element: &str,
    ) -> Result<(Inertia<f64>, Option<Violation>), ImportError> {
        let mass_node = required(node, "mass", element, "<mass> in its <inertial>")?;
        let mass = moderate(mass_node, "value", element, "mass")?;
        if mass < 0.0 {
            let element = element.to_owned();
            return Err(ImportError::NegativeMass { element, mass });
        }
        let tensor = required(node, "inertia", element, "<inertia> in its <inertial>")?;
        let mut entries = [0.0; 6];
        for (x, name) in entries
            .iter_mut()
            .zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"])
        {
            *x = moderate(tensor, name, element, name)?;
        }
        let origin = pose(child(node, "origin"), element)?;
        let rotational = Symmetric3::new(entries);
        let violation = violation(&rotational.to_matrix());
        if mass == 0.0 && entries.iter().any(|x| *x != 0.0) {
            let element = element.to_owned();
            self.warnings.push(Warning::InertiaWithoutMass { element });
        }
        let rotated = rotational.rotated(origin.rotation.matrix());
        let inertia = Inertia::from_com(mass, origin.translation, rotated);
        Ok((inertia, violation))
    }

    fn add_joint(&mut self, node: Node<'_, '_>) -> Result<(), ImportError> {
        let (name, element) = named(node)?;
        if self.joints.iter().any(|j| j.name == name) {
            return Err(ImportError::DuplicateName { element });
        }
        let kind = match attribute(node, "type", &element, "type")? {
            "revolute" => JointType::Revolute,
            "continuous" => JointType::Continuous,
            "prismatic" => JointType::Prismatic,
            "fixed" => JointType::Fixed,
            other => {
                let kind = other.to_owned();
                return Err(ImportError::UnsupportedJoint { element, kind });
            }
        };
        let link_of = |tag: &'static str| -> Result<String, ImportError> {
            let end = required(node, tag, &element, tag)?;
            Ok(attribute(end, "link", &element, tag)?.to_owned())
        };
        let (parent, below) = (link_of("parent")?, link_of("child")?);
        let origin = pose(child(node, "origin"), &element)?;
        let (axis, limits) = if kind == JointType::Fixed {
            (Vector3::x(), JointLimits::NONE)
        } else {
            (
                self.axis(node, &element)?,
                self.limits(node, kind, &element)?,
            )
        };
        let mimic = child(node, "mimic")
            .map(|m| mimic(m, &element))
            .transpose()?;
        self.joints.push(UrdfJoint {
            name,
            element,
            kind,
            parent,
            child: below,
            origin,
            axis,
            limits,
            rotor_inertia: 0.0,
            mimic,
        });
        Ok(())
    }

    fn axis(&mut self, node: Node<'_, '_>, element: &str) -> Result<Vector3<f64>, ImportError> {
        let Some(axis) = child(node, "axis") else {
            return Ok(Vector3::x());
        };
        let text = attribute(axis, "xyz", element, "axis xyz")?;
        let axis = triple(text, element, "axis xyz")?;
        let length = axis.norm();
        let element = element.to_owned();
        if length == 0.0 {
            return Err(ImportError::ZeroAxis { element });
        }
        let off = math::abs(length - 1.0);
        if off > AXIS_ROUNDING {
            return Err(ImportError::NonUnitAxis { element, length });
        }
        if off > AXIS_SILENT {
            self.warnings.push(Warning::AxisScaled { element, length });
        }
        Ok(axis / length)
    }

    fn limits(
        &mut self,
        node: Node<'_, '_>,
        kind: JointType,
        element: &str,
    ) -> Result<JointLimits<f64>, ImportError> {
        let mut limits = JointLimits::<f64>::NONE;
        if let Some(dynamics) = child(node, "dynamics") {
            let loss = |name| from_zero(dynamics, name, element, name);
            limits.damping = loss("damping")?.unwrap_or(0.0);
            limits.friction = loss("friction")?.unwrap_or(0.0);
        }
        let Some(limit) = child(node, "limit") else {
            if kind != JointType::Continuous {
                let element = element.to_owned();
                self.warnings.push(Warning::NoLimit { element });
            }
            return Ok(limits);
        };
        if kind != JointType::Continuous {
            limits.lower = optional(limit, "lower", element, "lower limit")?.unwrap_or(0.0);
            limits.upper = optional(limit, "upper", element, "upper limit")?.unwrap_or(0.0);
        }
        if limits.lower > limits.upper {
            return Err(ImportError::InvertedLimits {
                element: element.to_owned(),
                lower: limits.lower,
                upper: limits.upper,
            });
        }
        let mut positive = |name, what| -> Result<f64, ImportError> {
            let value = from_zero(limit, name, element, what)?;
            if let Some(value) = value
                && value == 0.0
            {
                self.warnings.push(Warning::PlaceholderLimit {
                    element: element.to_owned(),
                    what,
                    value,
                });
            }
            Ok(value.unwrap_or(f64::INFINITY))
        };
        limits.speed = positive("velocity", "speed")?;
        limits.effort = positive("effort", "effort")?;
        Ok(limits)
    }
}

pub(crate) fn violation(rotational: &Matrix3<f64>) -> Option<Violation> {
    let mut moments: [f64; 3] = rotational.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    let [low, middle, high] = moments;
    let largest = math::max(math::abs(low), math::abs(high));
    let excess = math::max(-low, high - middle - low);
    (excess > INERTIA_SILENT * largest).then(|| Violation {
        moments,
        excess: excess / largest,
    })
}

fn mimic(node: Node<'_, '_>, element: &str) -> Result<Mimic, ImportError> {
    Ok(Mimic {
        leader: attribute(node, "joint", element, "joint in its <mimic>")?.to_owned(),
        multiplier: optional(node, "multiplier", element, "mimic multiplier")?.unwrap_or(1.0),
        offset: optional(node, "offset", element, "mimic offset")?.unwrap_or(0.0),
    })
}

/// The line in which an element begins, from 1. The library's own way takes far longer on long files.
pub(crate) fn line_of(node: Node<'_, '_>) -> usize {
    let before = node.document().input_text().as_bytes();
    let before = before.get(..node.range().start).unwrap_or_default();
    1 + before.iter().filter(|byte| **byte == b'\n').count()
}

/// Name of a link or joint, and how messages call it.
pub(crate) fn named(node: Node<'_, '_>) -> Result<(String, String), ImportError> {
    let tag = node.tag_name().name();
    let line = line_of(node);
    match node.attribute("name") {
        Some(name) if !name.is_empty() => {
            Ok((name.to_owned(), format!("{tag} `{name}` (line {line})")))
        }
        _ => Err(ImportError::Missing {
            element: format!("the {tag} in line {line}"),
            what: "name",
        }),
    }
}

fn child<'a, 'i>(node: Node<'a, 'i>, tag: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|c| c.tag_name().name() == tag)
}

pub(crate) fn required<'a, 'i>(
    node: Node<'a, 'i>,
    tag: &str,
    element: &str,
    what: &'static str,
) -> Result<Node<'a, 'i>, ImportError> {
    child(node, tag).ok_or_else(|| ImportError::Missing {
        element: element.to_owned(),
        what,
    })
}

pub(crate) fn attribute<'a>(
    node: Node<'a, '_>,
    name: &str,
    element: &str,
    what: &'static str,
) -> Result<&'a str, ImportError> {
    node.attribute(name).ok_or_else(|| ImportError::Missing {
        element: element.to_owned(),
        what,
    })
}

/// A number as large as robots have: squares and sums of more would be infinite.
fn moderate(
    node: Node<'_, '_>,
    name: &str,
    element: &str,
    what: &'static str,
) -> Result<f64, ImportError> {
    let text = attribute(node, name, element, what)?;
    let x = finite(text, element, what)?;
    if math::abs(x) > LARGEST {
        return Err(too_much(text, element, what));
    }
    Ok(x)
}

fn too_much(text: &str, element: &str, what: &'static str) -> ImportError {
    ImportError::BadNumber {
        element: element.to_owned(),
        what,
        text: text.to_owned(),
        expected: "at most 1e9",
    }
}

fn optional(
    node: Node<'_, '_>,
    name: &str,
    element: &str,
    what: &'static str,
) -> Result<Option<f64>, ImportError> {
    node.attribute(name)
        .map(|text| finite(text, element, what))
        .transpose()
}

/// What no joint has less of than nothing.
fn from_zero(
    node: Node<'_, '_>,
    name: &str,
    element: &str,
    what: &'static str,
) -> Result<Option<f64>, ImportError> {
    let value = optional(node, name, element, what)?;
    value.map_or(Ok(()), |x| not_negative(x, element, what))?;
    Ok(value)
}

pub(crate) fn not_negative(x: f64, element: &str, what: &'static str) -> Result<(), ImportError> {
    if x >= 0.0 {
        return Ok(());
    }
    Err(ImportError::BadNumber {
        element: element.to_owned(),
        what,
        text: x.to_string(),
        expected: "at least 0",
    })
}

fn finite(text: &str, element: &str, what: &'static str) -> Result<f64, ImportError> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(ImportError::BadNumber {
            element: element.to_owned(),
            what,
            text: text.to_owned(),
            expected: "a finite number",
        }),
    }
}

fn triple(text: &str, element: &str, what: &'static str) -> Result<Vector3<f64>, ImportError> {
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map(|x| finite(x, element, what))
        .collect::<Result<_, _>>()?;
    match numbers[..] {
        [x, y, z] => Ok(Vector3::new(x, y, z)),
        _ => Err(ImportError::BadNumber {
            element: element.to_owned(),
            what,
            text: text.to_owned(),
            expected: "three numbers",
        }),
    }
}

/// The pose of an `<origin>`: R = Rz(yaw) Ry(pitch) Rx(roll); the identity without one.
fn pose(origin: Option<Node<'_, '_>>, element: &str) -> Result<Transform<f64>, ImportError> {
    let Some(origin) = origin else {
        return Ok(Transform::IDENTITY);
    };
    let read = |name, what| match origin.attribute(name) {
        Some(text) => {
            let numbers = triple(text, element, what)?;
            if numbers.amax() > LARGEST {
                return Err(too_much(text, element, what));
            }
            Ok(numbers)
        }
        None => Ok(Vector3::zeros()),
    };
    let rpy = read("rpy", "origin rpy")?;
    Ok(Transform::new(
        RollPitchYaw::Zyx.rotation(&rpy),
        read("xyz", "origin xyz")?,
    ))
}
