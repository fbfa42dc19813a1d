//! A robot as imported: tables, names and what was tolerated.

use rbd_core::algo::crba::{MassMatrix, crba};
use rbd_core::model::{BaseBody, BaseKind, Body, Frame, JointLimits, Link};
use rbd_core::state::{Configuration, Posture};
use rbd_core::{TableError, TableModel};
use so3::Scalar;

use crate::canonical;
use crate::couplings::{JointCoupling, couplings};
use crate::error::{ImportError, Warning};
use crate::locks::locked_positions;
use crate::mjcf;
use crate::options::{InertiaPolicy, Options};
use crate::tree::LinkTree;
use crate::urdf::Urdf;

/// Most movable joints of a robot that this crate imports.
pub const MOST_JOINTS: usize = 128;

/// A pivot of the mass matrix this small beside its row is round-off.
const ROUND_OFF: f64 = 1e-14;

/// Names and limits of a movable joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointInfo {
    /// Its name in the URDF.
    pub name: String,
    /// The link that it moves.
    pub link: String,
    /// It turns without end.
    pub continuous: bool,
    /// Limits and losses, in the URDF's joint coordinate.
    pub limits: JointLimits<f64>,
}

/// A link's own URDF frame. It is also the frame of the joint above the link.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkFrame {
    /// Name of the link.
    pub name: String,
    /// Name of the joint above it, of any type; `None` for the root.
    pub joint: Option<String>,
    /// Where it is.
    pub frame: Frame<f64>,
}

/// A robot in canonical frames.
#[derive(Clone, Debug)]
pub struct Robot {
    /// Its name in the URDF.
    pub name: String,
    /// Whether the base moves.
    pub base_kind: BaseKind,
    /// The base.
    pub base: BaseBody<f64>,
    /// Bodies in depth-first order.
    pub bodies: Vec<Body<f64>>,
    /// The joint of each body.
    pub joints: Vec<JointInfo>,
    /// How each joint follows another, if its `<mimic>` says so: the tree does not know, [`Robot::reduction`] does.
    pub couplings: Vec<Option<JointCoupling>>,
    /// Every link's frame, depth first.
    pub frames: Vec<LinkFrame>,
    /// Joints locked, with their positions.
    pub locked: Vec<(String, f64)>,
    /// What was tolerated.
    pub warnings: Vec<Warning>,
    /// What was decided about moments of inertia that no body has.
    pub inertia: InertiaPolicy,
}

impl Robot {
    /// Imports the text of a URDF.
    ///
    /// # Errors
    /// Names the first element that does not make a robot, and what to do about it.
    pub fn from_urdf(text: &str, options: &Options) -> Result<Self, ImportError> {
        Self::of(Urdf::parse(text)?, options.base, options)
    }

    /// Imports the text of an MJCF, its includes resolved by [`mjcf::read`].
    ///
    /// The file says whether the base floats: by a free joint, which `options.base` fixed welds to the world.
    ///
    /// # Errors
    /// Names the first element that does not make a robot, and what to do about it.
    pub fn from_mjcf(text: &str, options: &Options) -> Result<Self, ImportError> {
        let (urdf, base) = mjcf::parse(text, options.base)?;
        Self::of(urdf, base, options)
    }

    fn of(mut urdf: Urdf, base: BaseKind, options: &Options) -> Result<Self, ImportError> {
        let tree = LinkTree::new(&urdf)?;
        let mut warnings = core::mem::take(&mut urdf.warnings);
        let at = locked_positions(&urdf, options, &mut warnings)?;
        let mut tables = canonical::tables(&urdf, &tree, &at, options.axis_rounding);
        warnings.append(&mut tables.warnings);
        let couplings = couplings(&urdf, &tables.joints, &mut warnings);
        let locked = urdf.joints.iter().zip(&at);
        let mut robot = Self {
            name: urdf.name.clone(),
            base_kind: base,
            base: tables.base,
            bodies: tables.bodies,
            joints: tables.joints,
            couplings,
            frames: tables.frames,
            locked: locked
                .filter_map(|(j, at)| at.map(|x| (j.name.clone(), x)))
                .collect(),
            warnings,
            inertia: options.inertia,
        };
        robot.check(&urdf, &tables.body_of)?;
        Ok(robot)
    }

    /// Mass of the whole robot, kg; of a fixed base too, which the algorithms of rbd-core take for a part of the world.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.base.mass + self.bodies.iter().map(|b| b.mass).sum::<f64>()
    }

    /// The robot as a run-time model.
    ///
    /// # Errors
    /// [`TableError::TooManyBodies`] if `CAP` is too small.
    pub fn model<T: Scalar, const CAP: usize>(&self) -> Result<TableModel<T, CAP>, TableError> {
        let bodies: Vec<Body<T>> = self.bodies.iter().map(cast_body).collect();
        let base = BaseBody {
            mass: T::of(self.base.mass),
            first: self.base.first.map(T::of),
            second: self.base.second.map(T::of),
        };
        match self.inertia {
            InertiaPolicy::Physical => TableModel::new(self.base_kind, base, &bodies),
            InertiaPolicy::AsWritten => TableModel::with_any_inertia(self.base_kind, base, &bodies),
        }
    }

    /// The frame of a link, by the link's name.
    #[must_use]
    pub fn frame(&self, link: &str) -> Option<Frame<f64>> {
        let found = self.frames.iter().find(|f| f.name == link);
        found.map(|f| f.frame)
    }

    /// The tables make a model, and its mass matrix can be inverted: every joint feels inertia with the others
    /// free, where no two axes need coincide.
    fn check(&mut self, urdf: &Urdf, body_of: &[Link]) -> Result<(), ImportError> {
        let joints = self.bodies.len();
        if joints > MOST_JOINTS {
            return Err(ImportError::TooManyJoints {
                joints,
                most: MOST_JOINTS,
            });
        }
        let model: TableModel<f64, MOST_JOINTS> = match self.model() {
            Ok(model) => model,
            Err(TableError::BadInertia { body }) => {
                let moved = if body == joints {
                    Link::Base
                } else {
                    Link::Joint(body)
                };
                return Err(worst_link(urdf, body_of, moved));
            }
            Err(error) => return Err(error.into()),
        };
        self.warnings.extend(urdf.links.iter().filter_map(|link| {
            link.violation.map(|v| Warning::UnphysicalLink {
                element: link.element.clone(),
                moments: v.moments,
                excess: v.excess,
            })
        }));
        if self.base_kind == BaseKind::Floating && self.mass() <= 0.0 {
            return Err(ImportError::NoMass);
        }
        let mut configuration = Configuration::<f64, MOST_JOINTS>::NEUTRAL;
        for (i, x) in configuration.joints.iter_mut().enumerate() {
            *x = 0.3 + 0.1 * (i % 7) as f64;
        }
        let mut mass = Box::new(MassMatrix::ZERO);
        crba(&model, &Posture::new(&model, &configuration), &mut mass);
        let Some(i) = first_weightless(&mut mass.joints, joints) else {
            return Ok(());
        };
        let mut links = urdf.links.iter().zip(body_of);
        let weighed = links.any(|(l, body)| *body == Link::Joint(i) && l.inertia.is_some());
        Err(ImportError::MissingInertia {
            joint: self.joints[i].name.clone(),
            link: self.joints[i].link.clone(),
            state: if weighed {
                "has an <inertial> that does not resist the joint"
            } else {
                "has no <inertial>"
            },
        })
    }
}

/// The link that makes the moved body `moved` unphysical, as an error.
fn worst_link(urdf: &Urdf, body_of: &[Link], moved: Link) -> ImportError {
    let links = urdf.links.iter().zip(body_of);
    let bad = links.filter(|(_, body)| **body == moved);
    let bad = bad.filter_map(|(link, _)| link.violation.map(|v| (link, v)));
    match bad.max_by(|(_, a), (_, b)| a.moments[2].total_cmp(&b.moments[2])) {
        Some((link, violation)) => ImportError::UnphysicalInertia {
            element: link.element.clone(),
            moments: violation.moments,
        },
        None => ImportError::Table(TableError::BadInertia { body: 0 }),
    }
}

/// Eliminates joints from the leaves inwards (M = Lᵀ D L); the first whose pivot vanishes.
fn first_weightless<const N: usize>(m: &mut [[f64; N]; N], count: usize) -> Option<usize> {
    for k in (0..count).rev() {
        let row = m[k];
        let largest = row[..count].iter().fold(0.0, |a: f64, x| a.max(x.abs()));
        if row[k] <= ROUND_OFF * largest || row[k] <= 0.0 {
            return Some(k);
        }
        for above in &mut m[..k] {
            let factor = above[k] / row[k];
            for (x, y) in above.iter_mut().zip(&row[..k]) {
                *x -= factor * y;
            }
        }
    }
    None
}

fn cast_body<T: Scalar>(body: &Body<f64>) -> Body<T> {
    Body {
        kind: body.kind,
        parent: body.parent,
        subtree_end: body.subtree_end,
        sign: T::of(body.sign),
        offset: body.offset.map(T::of),
        tilt: body.tilt.map(|row| row.map(T::of)),
        mass: T::of(body.mass),
        first: body.first.map(T::of),
        second: body.second.map(T::of),
        rotor_inertia: T::of(body.rotor_inertia),
    }
}
