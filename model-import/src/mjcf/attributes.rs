//! Attributes with their defaults and units, and the poses that they give.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};
use rbd_core::spatial::Transform;
use roxmltree::Node;
use so3::math;

use crate::error::ImportError;

/// How messages call an element.
pub(super) fn element_of(node: Node<'_, '_>) -> String {
    let line = crate::urdf::line_of(node);
    let tag = node.tag_name().name();
    match node.attribute("name") {
        Some(name) => format!("{tag} `{name}` (line {line})"),
        None => format!("{tag} in line {line}"),
    }
}

/// The attributes of one element, those of its class where it has none of its own.
pub(super) struct Attributes<'a> {
    node: Node<'a, 'a>,
    class: Option<BTreeMap<String, String>>,
}

impl<'a> Attributes<'a> {
    /// Without a class.
    pub(super) fn plain<'i: 'a>(node: Node<'a, 'i>) -> Self {
        Self { node, class: None }
    }

    pub(super) fn text(&self, name: &str) -> Option<&str> {
        let class = || self.class.as_ref().and_then(|c| c.get(name));
        self.node
            .attribute(name)
            .or_else(|| class().map(String::as_str))
    }

    /// At most `K` numbers; none without the attribute.
    pub(super) fn numbers_up_to<const K: usize>(
        &self,
        name: &str,
    ) -> Result<Vec<f64>, ImportError> {
        let text = self.text(name).unwrap_or_default();
        let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
        match numbers {
            Ok(numbers) if numbers.len() <= K && numbers.iter().all(|x| x.is_finite()) => {
                Ok(numbers)
            }
            _ => Err(ImportError::BadNumber {
                element: element_of(self.node),
                what: "an attribute",
                text: format!("{name}=\"{text}\""),
                expected: "finite numbers, as many as it takes",
            }),
        }
    }

    /// Exactly `K` numbers, if the attribute is there.
    pub(super) fn numbers<const K: usize>(
        &self,
        name: &str,
    ) -> Result<Option<[f64; K]>, ImportError> {
        if self.text(name).is_none() {
            return Ok(None);
        }
        let numbers = self.numbers_up_to::<K>(name)?;
        numbers
            .try_into()
            .map(Some)
            .map_err(|short: Vec<f64>| ImportError::BadNumber {
                element: element_of(self.node),
                what: "an attribute",
                text: format!("{name}: {short:?}"),
                expected: "as many numbers as it takes",
            })
    }

    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, ImportError> {
        Ok(self.numbers::<1>(name)?.map(|[x]| x))
    }

    pub(super) fn vector(&self, name: &str) -> Result<Option<Vector3<f64>>, ImportError> {
        Ok(self.numbers::<3>(name)?.map(Vector3::from))
    }

    /// How messages call the element.
    pub(super) fn element(&self) -> String {
        element_of(self.node)
    }
}

/// The classes of `<default>`: per class and tag, attributes with those of the classes around already in.
pub(super) struct Defaults(BTreeMap<String, BTreeMap<String, BTreeMap<String, String>>>);

/// The class of elements that name none.
const MAIN: &str = "main";

impl Defaults {
    pub(super) fn read(root: Node<'_, '_>) -> Self {
        let mut out = Self(BTreeMap::new());
        for node in root.children().filter(|n| n.has_tag_name("default")) {
            let name = node.attribute("class").unwrap_or(MAIN);
            let around = out.0.get(MAIN).cloned().unwrap_or_default();
            out.add(node, name, around.clone());
            if name != MAIN {
                // The first class is the one of elements that name none, whatever it is called.
                let first = out.0.get(name).cloned().unwrap_or_default();
                out.0.entry(MAIN.to_owned()).or_insert(first);
            }
        }
        out
    }

    fn add(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        mut class: BTreeMap<String, BTreeMap<String, String>>,
    ) {
        let (inner, tags): (Vec<_>, Vec<_>) =
            (node.children().filter(Node::is_element)).partition(|n| n.has_tag_name("default"));
        for tag in tags {
            let values = class.entry(tag.tag_name().name().to_owned()).or_default();
            let own = tag
                .attributes()
                .map(|a| (a.name().to_owned(), a.value().to_owned()));
            values.extend(own);
        }
        for node in inner {
            let name = node.attribute("class").unwrap_or_default().to_owned();
            self.add(node, &name, class.clone());
        }
        self.0.insert(name.to_owned(), class);
    }

    /// The attributes of an element of a body whose children are of class `class`.
    pub(super) fn of<'a, 'i: 'a>(&self, node: Node<'a, 'i>, class: Option<&str>) -> Attributes<'a> {
        let class = node.attribute("class").or(class).unwrap_or(MAIN);
        let tags = self.0.get(class);
        Attributes {
            node,
            class: tags.and_then(|t| t.get(node.tag_name().name())).cloned(),
        }
    }
}

/// What `<compiler>` says about units, limits and masses.
pub(super) struct Compiler {
    /// Radians per unit of angle.
    pub(super) radians: f64,
    sequence: Vec<char>,
    auto_limits: bool,
    /// `inertiafromgeom`; `None` is auto.
    pub(super) from_geometry: Option<bool>,
    pub(super) total_mass: Option<f64>,
    /// Groups of shapes that weigh.
    pub(super) groups: [f64; 2],
    /// Settings that are not heeded.
    pub(super) ignored: Vec<String>,
}

impl Compiler {
    pub(super) fn read(root: Node<'_, '_>) -> Result<Self, ImportError> {
        let mut out = Self {
            radians: core::f64::consts::PI / 180.0,
            sequence: "xyz".chars().collect(),
            auto_limits: true,
            from_geometry: None,
            total_mass: None,
            groups: [0.0, 5.0],
            ignored: Vec::new(),
        };
        for node in root.children().filter(|n| n.has_tag_name("compiler")) {
            out.add(&Attributes::plain(node))?;
        }
        Ok(out)
    }

    fn add(&mut self, compiler: &Attributes<'_>) -> Result<(), ImportError> {
        if compiler.text("coordinate") == Some("global") {
            return Err(ImportError::Unsupported {
                element: compiler.element(),
                what: "coordinate=\"global\": save the model with local coordinates".to_owned(),
            });
        }
        if compiler.text("angle") == Some("radian") {
            self.radians = 1.0;
        }
        if let Some(sequence) = compiler.text("eulerseq") {
            self.sequence = sequence.chars().collect();
        }
        if let Some(text) = compiler.text("autolimits") {
            self.auto_limits = text == "true";
        }
        if let Some(text) = compiler.text("inertiafromgeom") {
            self.from_geometry = match text {
                "true" => Some(true),
                "false" => Some(false),
                _ => None,
            };
        }
        self.total_mass = compiler
            .number("settotalmass")?
            .filter(|m| *m > 0.0)
            .or(self.total_mass);
        self.groups = compiler
            .numbers("inertiagrouprange")?
            .unwrap_or(self.groups);
        for name in ["boundmass", "boundinertia"] {
            if compiler.number(name)?.is_some_and(|x| x > 0.0) {
                self.ignored
                    .push(format!("{name}: masses and inertias stay as they are"));
            }
        }
        if compiler.text("balanceinertia") == Some("true") {
            self.ignored
                .push("balanceinertia: inertias stay as they are".to_owned());
        }
        Ok(())
    }

    /// A range that holds, by `limited` and `autolimits`.
    pub(super) fn limited(
        &self,
        limited: Option<&str>,
        range: Option<[f64; 2]>,
    ) -> Option<[f64; 2]> {
        match limited {
            Some("true") => range,
            Some("false") => None,
            _ => range.filter(|_| self.auto_limits),
        }
    }

    /// `pos`, and `quat`, `axisangle`, `xyaxes`, `zaxis` or `euler`; the identity without.
    pub(super) fn pose(&self, attributes: &Attributes<'_>) -> Result<Transform<f64>, ImportError> {
        let position = attributes.vector("pos")?.unwrap_or_else(Vector3::zeros);
        let rotation = self.rotation(attributes)?;
        if rotation.matrix().iter().any(|x| !x.is_finite()) {
            return Err(ImportError::BadNumber {
                element: attributes.element(),
                what: "its orientation",
                text: "of length zero".to_owned(),
                expected: "a direction",
            });
        }
        Ok(Transform::new(rotation, position))
    }

    fn rotation(&self, attributes: &Attributes<'_>) -> Result<Rotation3<f64>, ImportError> {
        if let Some([w, x, y, z]) = attributes.numbers("quat")? {
            let quat = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
            return Ok(quat.to_rotation_matrix());
        }
        if let Some([x, y, z, angle]) = attributes.numbers("axisangle")? {
            let axis = Unit::new_normalize(Vector3::new(x, y, z));
            return Ok(turn(&axis, angle * self.radians));
        }
        if let Some([a, b, c, d, e, f]) = attributes.numbers("xyaxes")? {
            let x = Vector3::new(a, b, c).normalize();
            let y = Vector3::new(d, e, f);
            let y = (y - x * x.dot(&y)).normalize();
            let m = Matrix3::from_columns(&[x, y, x.cross(&y)]);
            return Ok(Rotation3::from_matrix_unchecked(m));
        }
        if let Some(z) = attributes.vector("zaxis")? {
            return Ok(z_to(&z));
        }
        let Some(angles) = attributes.numbers::<3>("euler")? else {
            return Ok(Rotation3::identity());
        };
        let mut out = Rotation3::identity();
        for (axis, angle) in self.sequence.iter().zip(angles) {
            let unit = match axis.to_ascii_lowercase() {
                'x' => Vector3::x_axis(),
                'y' => Vector3::y_axis(),
                _ => Vector3::z_axis(),
            };
            let next = turn(&unit, angle * self.radians);
            // Lower case turns with the axes, upper case about the fixed ones.
            out = if axis.is_lowercase() {
                out * next
            } else {
                next * out
            };
        }
        Ok(out)
    }
}

/// Rodrigues: 1 + sin hat(a) + (1 − cos) hat(a)².
pub(super) fn turn(axis: &Unit<Vector3<f64>>, angle: f64) -> Rotation3<f64> {
    let (sin, cos) = math::sin_cos(angle);
    let k = axis.cross_matrix();
    Rotation3::from_matrix_unchecked(Matrix3::identity() + k * sin + k * k * (1.0 - cos))
}

/// The least rotation that takes z to the direction `to`; a half turn about x if it is −z, none if it is zero.
pub(super) fn z_to(to: &Vector3<f64>) -> Rotation3<f64> {
    let Some(to) = Unit::try_new(*to, 1e-14) else {
        return Rotation3::identity();
    };
    let across = Vector3::z().cross(&to);
    let angle = math::atan2(across.norm(), to.z);
    let axis = Unit::try_new(across, 1e-14).unwrap_or_else(Vector3::x_axis);
    turn(&axis, angle)
}
