//! Reads the dynamic content of an MJCF, MuJoCo's format: bodies with inertias, hinges, slides and a free base.
//!
//! What comes out is the same intermediate form as a URDF's ([`Urdf`]), so everything that follows is shared:
//!
//! - A body with several joints is a chain of massless links, one joint each, in MuJoCo's order; a joint with a `pos` has its
//!   own link there, called `body:joint`, and the body hangs on it. The reference `ref` moves the zero of the coordinate.
//! - A `free` joint makes its body the floating base; without one, or on demand, the base is the world. Ball joints are refused.
//! - Masses come from `<inertial>`, else from `mass` or `density` of spheres, capsules, cylinders, boxes and ellipsoids, as
//!   `inertiafromgeom` says; a mesh that would have to give its mass is refused by name.
//! - Default classes, `childclass`, `<frame>`, `angle`, `eulerseq`, `autolimits`, `settotalmass` and `inertiagrouprange` are
//!   heeded; `armature` becomes the rotor's inertia, `damping` and `frictionloss` the losses, `actuatorfrcrange` the effort.
//! - Springs, tendons, equalities, actuators, fluids and gravity other than the crate's are named as
//!   [`Warning::NotKept`].
//!
//! `cargo xtask import-check --mjcf` compares mass matrix, bias, centre of mass, momentum and energies with MuJoCo's.

mod attributes;
mod geometry;
mod include;

use nalgebra::{Rotation3, Unit, Vector3};
use rbd_core::BaseKind;
use rbd_core::model::JointLimits;
use rbd_core::spatial::{Inertia, Symmetric3, Transform};
use roxmltree::{Document, Node};

use crate::error::{ImportError, Warning};
use crate::urdf::{JointType, Urdf, UrdfJoint, UrdfLink, not_negative};
use attributes::{Attributes, Compiler, Defaults, element_of};
pub use include::read;

/// Name of the link that the world is.
const WORLD: &str = "world";
/// Sections that change how the robot moves and have no counterpart in a tree of rigid bodies.
const LOST: [&str; 5] = ["equality", "tendon", "actuator", "deformable", "extension"];

/// Reads the text of an MJCF without `<include>` (see [`read`]); `base` fixed welds a free body to the world. Says which base
/// the robot has.
///
/// # Errors
/// The first element that is not what this module can keep.
pub fn parse(text: &str, base: BaseKind) -> Result<(Urdf, BaseKind), ImportError> {
    let document = Document::parse(text).map_err(|e| ImportError::Xml {
        line: e.pos().row,
        column: e.pos().col,
        message: e.to_string(),
    })?;
    crate::size::check(&document)?;
    let root = document.root_element();
    if root.tag_name().name() != "mujoco" {
        let found = root.tag_name().name().to_owned();
        return Err(ImportError::NotARobot { found });
    }
    let mut reader = Reader {
        urdf: Urdf {
            name: root.attribute("model").unwrap_or("MuJoCo Model").to_owned(),
            links: Vec::new(),
            joints: Vec::new(),
            warnings: Vec::new(),
            sorted: false,
        },
        compiler: Compiler::read(root)?,
        defaults: Defaults::read(root),
        bodies: 0,
        free: Vec::new(),
    };
    reader.sections(root)?;
    reader.link(WORLD.to_owned(), "the world".to_owned(), None);
    for node in sections(root, "worldbody") {
        let inside = reader.contents(node, &Transform::IDENTITY, None)?;
        for part in inside.iter().filter(|p| p.node.has_tag_name("body")) {
            reader.body(part, WORLD)?;
        }
    }
    reader.scale()?;
    let base = reader.settle(base)?;
    Ok((reader.urdf, base))
}

fn sections<'a, 'i>(root: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    root.children().filter(move |n| n.has_tag_name(name))
}

/// An element of a body, `<frame>`s around it resolved.
struct Part<'a, 'i> {
    node: Node<'a, 'i>,
    frame: Transform<f64>,
    class: Option<&'a str>,
}

struct Reader {
    urdf: Urdf,
    compiler: Compiler,
    defaults: Defaults,
    bodies: usize,
    /// Names of the bodies with a free joint.
    free: Vec<String>,
}

impl Reader {
    /// Names what is lost, by section.
    fn sections(&mut self, root: Node<'_, '_>) -> Result<(), ImportError> {
        for name in LOST {
            for node in sections(root, name) {
                let count = node.children().filter(Node::is_element).count();
                if count > 0 {
                    self.lost(format!("<{name}> with {count} elements"));
                }
            }
        }
        for node in sections(root, "option") {
            let option = Attributes::plain(node);
            for what in ["density", "viscosity"] {
                if option.number(what)?.is_some_and(|x| x != 0.0) {
                    self.lost(format!("<option> {what}: forces of a fluid"));
                }
            }
            let flags = node.children().filter(|n| n.has_tag_name("flag"));
            if flags
                .clone()
                .any(|f| f.attribute("gravity") == Some("disable"))
            {
                self.lost("<flag> gravity=\"disable\": taken as 9.81 m/s² downwards".to_owned());
            }
            if let Some(gravity) = option.numbers("gravity")?
                && gravity != rbd_core::GRAVITY
            {
                self.lost(format!(
                    "<option> gravity {gravity:?}: taken as 9.81 m/s² downwards"
                ));
            }
        }
        Ok(())
    }

    fn lost(&mut self, what: String) {
        self.urdf.warnings.push(Warning::NotKept { what });
    }

    /// The elements of a body, through its `<frame>`s.
    fn contents<'a, 'i>(
        &self,
        node: Node<'a, 'i>,
        frame: &Transform<f64>,
        class: Option<&'a str>,
    ) -> Result<Vec<Part<'a, 'i>>, ImportError> {
        let mut out = Vec::new();
        for node in node.children().filter(Node::is_element) {
            match node.tag_name().name() {
                "frame" => {
                    let pose = self.compiler.pose(&Attributes::plain(node))?;
                    let class = node.attribute("childclass").or(class);
                    out.append(&mut self.contents(node, &frame.compose(&pose), class)?);
                }
                name @ ("replicate" | "attach" | "composite" | "flexcomp" | "include") => {
                    return Err(ImportError::Unsupported {
                        element: element_of(node),
                        what: format!("<{name}> is not expanded: save the compiled model as XML"),
                    });
                }
                _ => out.push(Part {
                    node,
                    frame: *frame,
                    class,
                }),
            }
        }
        Ok(out)
    }

    fn attributes<'a>(&self, part: &Part<'a, '_>) -> Attributes<'a> {
        self.defaults.of(part.node, part.class)
    }

    fn link(&mut self, name: String, element: String, inertia: Option<Inertia<f64>>) {
        let violation =
            inertia.and_then(|i| crate::urdf::violation(&i.rotational_com().to_matrix()));
        self.urdf.links.push(UrdfLink {
            name,
            element,
            inertia,
            violation,
        });
    }

    fn body(&mut self, part: &Part<'_, '_>, parent: &str) -> Result<(), ImportError> {
        let node = part.node;
        self.bodies += 1;
        let name = match node.attribute("name") {
            Some(name) => name.to_owned(),
            None => format!("body_{}", self.bodies),
        };
        let element = element_of(node);
        if self.urdf.links.iter().any(|l| l.name == name) {
            return Err(ImportError::DuplicateName { element });
        }
        let plain = Attributes::plain(node);
        if plain.number("gravcomp")?.is_some_and(|x| x != 0.0) {
            self.lost(format!("{element}: gravcomp"));
        }
        let pose = part.frame.compose(&self.compiler.pose(&plain)?);
        let class = node.attribute("childclass").or(part.class);
        let inside = self.contents(node, &Transform::IDENTITY, class)?;
        let above = self.joints(&name, &inside, parent, pose)?;
        let inertia = self.inertia(&element, &inside)?;
        if let Some((above, pose)) = above {
            self.weld(&name, &element, &above, pose);
        }
        self.link(name.clone(), element, inertia);
        for part in inside.iter().filter(|p| p.node.has_tag_name("body")) {
            self.body(part, &name)?;
        }
        Ok(())
    }

    fn weld(&mut self, name: &str, element: &str, parent: &str, origin: Transform<f64>) {
        self.urdf.joints.push(UrdfJoint {
            name: format!("{name}:weld"),
            element: element.to_owned(),
            kind: JointType::Fixed,
            parent: parent.to_owned(),
            child: name.to_owned(),
            origin,
            axis: Vector3::x(),
            limits: JointLimits::NONE,
            rotor_inertia: 0.0,
            mimic: None,
        });
    }

    /// The joints of a body, each with a link of its own but the last, if the body's frame is on it. Otherwise returns the link
    /// that the body is to be welded to, and where.
    fn joints(
        &mut self,
        body: &str,
        inside: &[Part<'_, '_>],
        parent: &str,
        pose: Transform<f64>,
    ) -> Result<Option<(String, Transform<f64>)>, ImportError> {
        let is_joint =
            |p: &&Part<'_, '_>| p.node.has_tag_name("joint") || p.node.has_tag_name("freejoint");
        let joints: Vec<&Part<'_, '_>> = inside.iter().filter(is_joint).collect();
        let (mut above, mut at) = (parent.to_owned(), pose);
        for (i, part) in joints.iter().enumerate() {
            let attributes = self.attributes(part);
            let element = element_of(part.node);
            let free = part.node.has_tag_name("freejoint");
            let kind = match attributes.text("type").unwrap_or("hinge") {
                _ if free => "free",
                kind => kind,
            };
            if kind == "free" && parent == WORLD && joints.len() == 1 {
                self.free.push(body.to_owned());
                return Ok(Some((above, at)));
            }
            if kind != "hinge" && kind != "slide" {
                return Err(ImportError::Unsupported {
                    element,
                    what: format!(
                        "a {kind} joint here: kept are hinges, slides, and one free joint alone on a body in the world"
                    ),
                });
            }
            let name = match part.node.attribute("name") {
                Some(name) => name.to_owned(),
                None => format!("{body}:{i}"),
            };
            if self.urdf.joints.iter().any(|j| j.name == name) {
                return Err(ImportError::DuplicateName { element });
            }
            let anchor = part
                .frame
                .point(&attributes.vector("pos")?.unwrap_or_else(Vector3::zeros));
            let last = i + 1 == joints.len() && anchor == Vector3::zeros();
            let child = if last {
                body.to_owned()
            } else {
                format!("{body}:{name}")
            };
            let slides = kind == "slide";
            let joint = self.joint(&attributes, part, slides, element)?;
            let origin = Transform::new(Rotation3::identity(), anchor).compose(&joint.origin);
            self.urdf.joints.push(UrdfJoint {
                name,
                parent: above,
                child: child.clone(),
                origin: at.compose(&origin),
                ..joint
            });
            if last {
                return Ok(None);
            }
            let element = format!("the link of {}", element_of(part.node));
            self.link(child.clone(), element, None);
            (above, at) = (child, Transform::new(Rotation3::identity(), -anchor));
        }
        Ok(Some((above, at)))
    }

    /// A hinge or slide without its place in the tree; its origin is the displacement by −`ref`.
    fn joint(
        &mut self,
        attributes: &Attributes<'_>,
        part: &Part<'_, '_>,
        slides: bool,
        element: String,
    ) -> Result<UrdfJoint, ImportError> {
        let axis = attributes.vector("axis")?.unwrap_or_else(Vector3::z);
        let Some(axis) = Unit::try_new(part.frame.rotation * axis, 1e-12) else {
            return Err(ImportError::ZeroAxis { element });
        };
        let unit = if slides { 1.0 } else { self.compiler.radians };
        if attributes.number("stiffness")?.is_some_and(|x| x != 0.0) {
            self.lost(format!("{element}: its spring"));
        }
        let mut limits = JointLimits::<f64>::NONE;
        limits.damping = attributes
            .numbers_up_to::<3>("damping")?
            .first()
            .copied()
            .unwrap_or(0.0);
        limits.friction = attributes.number("frictionloss")?.unwrap_or(0.0);
        let rotor_inertia = attributes.number("armature")?.unwrap_or(0.0);
        for (what, value) in [
            ("damping", limits.damping),
            ("frictionloss", limits.friction),
            ("armature", rotor_inertia),
        ] {
            not_negative(value, &element, what)?;
        }
        let range = attributes.numbers::<2>("range")?;
        if let Some([lower, upper]) = self.compiler.limited(attributes.text("limited"), range) {
            (limits.lower, limits.upper) = (lower * unit, upper * unit);
        }
        let force = attributes.numbers::<2>("actuatorfrcrange")?;
        if let Some([low, high]) = self
            .compiler
            .limited(attributes.text("actuatorfrclimited"), force)
        {
            limits.effort = f64::min(-low, high);
        }
        if limits.lower > limits.upper {
            return Err(ImportError::InvertedLimits {
                element,
                lower: limits.lower,
                upper: limits.upper,
            });
        }
        let reference = attributes.number("ref")?.unwrap_or(0.0) * unit;
        let endless = limits.lower == f64::NEG_INFINITY;
        let (kind, origin) = if slides {
            let back = Transform::new(Rotation3::identity(), *axis * -reference);
            (JointType::Prismatic, back)
        } else {
            let back = attributes::turn(&axis, -reference);
            let kind = if endless {
                JointType::Continuous
            } else {
                JointType::Revolute
            };
            (kind, Transform::new(back, Vector3::zeros()))
        };
        Ok(UrdfJoint {
            name: String::new(),
            element,
            kind,
            parent: String::new(),
            child: String::new(),
            origin,
            axis: *axis,
            limits,
            rotor_inertia,
            mimic: None,
        })
    }

    /// `<inertial>`, or what the shapes weigh.
    fn inertia(
        &mut self,
        element: &str,
        inside: &[Part<'_, '_>],
    ) -> Result<Option<Inertia<f64>>, ImportError> {
        let explicit = inside.iter().find(|p| p.node.has_tag_name("inertial"));
        if let (Some(part), false) = (explicit, self.compiler.from_geometry == Some(true)) {
            return geometry::inertial(&self.compiler, part.node, element).map(Some);
        }
        if self.compiler.from_geometry == Some(false) {
            return Ok(None);
        }
        let mut sum = None;
        for part in inside.iter().filter(|p| p.node.has_tag_name("geom")) {
            let attributes = self.attributes(part);
            if let Some(shape) = geometry::shape(&self.compiler, &attributes, element)? {
                let shape = shape.transformed(&part.frame);
                sum = Some(sum.map_or(shape, |sum: Inertia<f64>| sum + shape));
            }
        }
        Ok(sum)
    }

    /// `settotalmass`.
    fn scale(&mut self) -> Result<(), ImportError> {
        for what in self.compiler.ignored.clone() {
            self.lost(format!("<compiler> {what}"));
        }
        let Some(wanted) = self.compiler.total_mass else {
            return Ok(());
        };
        let masses = self.urdf.links.iter().filter_map(|l| l.inertia);
        let mass: f64 = masses.map(|i| i.mass).sum();
        if mass <= 0.0 {
            return Err(ImportError::NoMass);
        }
        for inertia in self
            .urdf
            .links
            .iter_mut()
            .filter_map(|l| l.inertia.as_mut())
        {
            let factor = wanted / mass;
            *inertia = Inertia {
                mass: inertia.mass * factor,
                first: inertia.first * factor,
                second: Symmetric3::new(inertia.second.to_array().map(|x| x * factor)),
            };
        }
        Ok(())
    }

    /// Makes the free body the root, or the world if there is none or the base shall be fixed.
    fn settle(&mut self, base: BaseKind) -> Result<BaseKind, ImportError> {
        let root = match &self.free[..] {
            [root] if base == BaseKind::Floating => root.clone(),
            [] => return Ok(BaseKind::Fixed),
            [_, second, ..] if base == BaseKind::Floating => {
                return Err(ImportError::Unsupported {
                    element: format!("body `{second}`"),
                    what: "a second free body: a model has one base; remove one".to_owned(),
                });
            }
            welded => {
                let names = welded.join("`, `");
                self.lost(format!("the free joint of `{names}`: welded to the world"));
                return Ok(BaseKind::Fixed);
            }
        };
        // Links come after their parents, so that one pass finds all that hang on the base.
        let mut kept = vec![root.clone()];
        for link in &self.urdf.links {
            let above = self.urdf.joints.iter().find(|j| j.child == link.name);
            if above.is_some_and(|j| kept.contains(&j.parent)) {
                kept.push(link.name.clone());
            }
        }
        let stays = |link: &String| kept.contains(link);
        if let Some(other) =
            (self.urdf.joints.iter()).find(|j| j.kind != JointType::Fixed && !stays(&j.child))
        {
            return Err(ImportError::Unsupported {
                element: other.element.clone(),
                what: format!("it does not hang on the free body `{root}`: a model is one tree"),
            });
        }
        let dropped = self
            .urdf
            .links
            .iter()
            .filter(|l| l.name != WORLD && !stays(&l.name));
        let dropped: Vec<String> = dropped
            .map(|l| format!("{}: part of the world", l.element))
            .collect();
        dropped.into_iter().for_each(|what| self.lost(what));
        self.urdf.links.retain(|l| kept.contains(&l.name));
        self.urdf
            .joints
            .retain(|j| kept.contains(&j.child) && j.child != root);
        Ok(BaseKind::Floating)
    }
}
