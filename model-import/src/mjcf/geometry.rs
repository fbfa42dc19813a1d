//! What bodies weigh: `<inertial>`, and solid shapes of uniform density.

use core::f64::consts::PI;

use nalgebra::Vector3;
use rbd_core::spatial::{Inertia, Symmetric3, Transform};
use roxmltree::Node;

use super::attributes::{Attributes, Compiler, z_to};
use crate::error::ImportError;

/// Density of a shape that says nothing, kg/m³.
const WATER: f64 = 1000.0;

/// An `<inertial>`: mass, centre, and moments about it, diagonal in its own axes or full.
pub(super) fn inertial(
    compiler: &Compiler,
    node: Node<'_, '_>,
    body: &str,
) -> Result<Inertia<f64>, ImportError> {
    let attributes = Attributes::plain(node);
    let missing = |what| ImportError::Missing {
        element: format!("the <inertial> of {body}"),
        what,
    };
    let mass = attributes.number("mass")?.ok_or_else(|| missing("mass"))?;
    if mass < 0.0 {
        let element = body.to_owned();
        return Err(ImportError::NegativeMass { element, mass });
    }
    let pose = compiler.pose(&attributes)?;
    let moments = match attributes.numbers::<6>("fullinertia")? {
        Some(full) => Symmetric3::new(full),
        None => {
            let diagonal = attributes.numbers::<3>("diaginertia")?;
            let [x, y, z] = diagonal.ok_or_else(|| missing("diaginertia or fullinertia"))?;
            Symmetric3::new([x, y, z, 0.0, 0.0, 0.0])
        }
    };
    Ok(at(&pose, mass, moments))
}

fn at(pose: &Transform<f64>, mass: f64, moments: Symmetric3<f64>) -> Inertia<f64> {
    let turned = moments.rotated(pose.rotation.matrix());
    Inertia::from_com(mass, pose.translation, turned)
}

/// The inertia of a shape in its body's frame; `None` if it weighs nothing.
pub(super) fn shape(
    compiler: &Compiler,
    geom: &Attributes<'_>,
    body: &str,
) -> Result<Option<Inertia<f64>>, ImportError> {
    let kind = match geom.text("type") {
        _ if geom.text("mesh").is_some() => "mesh",
        Some(kind) => kind,
        None => "sphere",
    };
    let mass = geom.number("mass")?;
    let density = geom.number("density")?.unwrap_or(WATER);
    let group = geom.number("group")?.unwrap_or(0.0);
    let [first, last] = compiler.groups;
    let weightless = mass.unwrap_or(density) == 0.0 || group < first || group > last;
    if weightless || kind == "plane" || kind == "hfield" {
        return Ok(None);
    }
    let unsupported = |what: &str| ImportError::Unsupported {
        element: geom.element(),
        what: format!("{what}: give {body} an <inertial>"),
    };
    if geom.text("shellinertia") == Some("true") {
        return Err(unsupported("the inertia of a shell"));
    }
    let (pose, size) = place(compiler, geom, kind)?;
    let solid = match (kind, &size[..]) {
        ("sphere", &[r, ..]) => Solid::ellipsoid(r, r, r),
        ("ellipsoid", &[x, y, z]) => Solid::ellipsoid(x, y, z),
        ("capsule", &[r, half, ..]) => Solid::capsule(r, 2.0 * half),
        ("cylinder", &[r, half, ..]) => Solid::cylinder(r, 2.0 * half),
        ("box", &[x, y, z]) => Solid::cuboid(x, y, z),
        ("mesh" | "sdf", _) => return Err(unsupported("the mass of a mesh")),
        _ => return Err(unsupported(&format!("a {kind} of sizes {size:?}"))),
    };
    let mass = mass.unwrap_or(density * solid.volume);
    if mass < 0.0 {
        let element = geom.element();
        return Err(ImportError::NegativeMass { element, mass });
    }
    let [x, y, z] = solid.moments.map(|per_mass| per_mass * mass);
    let moments = Symmetric3::new([x, y, z, 0.0, 0.0, 0.0]);
    Ok(Some(at(&pose, mass, moments)))
}

/// Pose and sizes; `fromto` replaces the pose and the length.
fn place(
    compiler: &Compiler,
    geom: &Attributes<'_>,
    kind: &str,
) -> Result<(Transform<f64>, Vec<f64>), ImportError> {
    let mut size = geom.numbers_up_to::<3>("size")?;
    let Some([a, b, c, d, e, f]) = geom.numbers("fromto")? else {
        return Ok((compiler.pose(geom)?, size));
    };
    let (from, to) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
    let half = (from - to).norm() / 2.0;
    let radius = size.first().copied().unwrap_or(0.0);
    size = match kind {
        "box" | "ellipsoid" => vec![radius, radius, half],
        _ => vec![radius, half],
    };
    let pose = Transform::new(z_to(&(from - to)), (from + to) / 2.0);
    Ok((pose, size))
}

/// A solid of uniform density about its centre, z along its length.
struct Solid {
    /// m³.
    volume: f64,
    /// Principal moments per mass, m².
    moments: [f64; 3],
}

impl Solid {
    /// m (b² + c²) / 5 about the first axis.
    fn ellipsoid(x: f64, y: f64, z: f64) -> Self {
        let [x2, y2, z2] = [x * x, y * y, z * z];
        Self {
            volume: 4.0 / 3.0 * PI * x * y * z,
            moments: [(y2 + z2) / 5.0, (x2 + z2) / 5.0, (x2 + y2) / 5.0],
        }
    }

    /// Half sizes x, y, z: m (y² + z²) / 3 about the first axis.
    fn cuboid(x: f64, y: f64, z: f64) -> Self {
        let [x2, y2, z2] = [x * x, y * y, z * z];
        Self {
            volume: 8.0 * x * y * z,
            moments: [(y2 + z2) / 3.0, (x2 + z2) / 3.0, (x2 + y2) / 3.0],
        }
    }

    /// Across m (3 r² + h²) / 12, along m r² / 2.
    fn cylinder(r: f64, h: f64) -> Self {
        let across = (3.0 * r * r + h * h) / 12.0;
        Self {
            volume: PI * r * r * h,
            moments: [across, across, r * r / 2.0],
        }
    }

    /// A cylinder of height h between two half spheres, whose centres of mass are h/2 + 3r/8 from the middle:
    /// across, a half sphere pair has 2/5 r² + h (3 r + 2 h) / 8 per its mass.
    fn capsule(r: f64, h: f64) -> Self {
        let tube = Self::cylinder(r, h);
        let ball = Self::ellipsoid(r, r, r);
        let volume = tube.volume + ball.volume;
        let (in_tube, in_ball) = (tube.volume / volume, ball.volume / volume);
        let [across, _, along] = tube.moments;
        let round = 2.0 * r * r / 5.0;
        let across = across * in_tube + (round + h * (3.0 * r + 2.0 * h) / 8.0) * in_ball;
        Self {
            volume,
            moments: [across, across, along * in_tube + round * in_ball],
        }
    }
}
