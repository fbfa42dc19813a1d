//! Why a quadruped from a URDF cannot be planned for: each names the culprit and the remedy.

use super::JOINTS;
use crate::range::Unusable;
use model_import::ImportError;
use rbd_core::TableError;
use std::path::PathBuf;

/// Why a robot cannot be planned for.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// Neither the built-in quadruped nor a file.
    #[error("no built-in quadruped has this name: write \"a1\", or the path of a URDF or profile")]
    Unknown,
    /// The file cannot be read.
    #[error("{}", crate::file::told(.0))]
    File(#[from] std::io::Error),
    /// The URDF of a profile cannot be read.
    #[error("urdf: {path}: {error}: the path is seen from the profile")]
    Urdf {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The profile is none.
    #[error("{0}")]
    Toml(#[from] Box<toml::de::Error>),
    /// A value of the profile that no robot has.
    #[error("{key}: {what}")]
    Profile {
        /// Its key in the file.
        key: String,
        /// What it must be.
        what: String,
    },
    /// The URDF is not a robot.
    #[error("{0}")]
    Import(#[from] ImportError),
    /// It is something else than a URDF.
    #[error("the root element is <{0}>, not <robot>: give a URDF{remedy}", remedy = urdf_remedy(.0))]
    NotAUrdf(String),
    /// A moved body has a negative moment of inertia, because of this link.
    #[error(
        "{element} has principal moments {moments:?} kg m²: none may be negative; correct them"
    )]
    NegativeInertia {
        /// The link.
        element: String,
        /// Its principal moments, kg m², ascending.
        moments: [f64; 3],
    },
    /// Its tables are no model.
    #[error("{0}")]
    Table(#[from] TableError),
    /// The URDF is not XML.
    #[error("{0}")]
    Xml(#[from] roxmltree::Error),
    /// Not twelve joints.
    #[error("a quadruped has 12 movable joints, this robot has {count}: {names}; {}", joints_remedy(*.count))]
    Joints {
        /// Movable joints.
        count: usize,
        /// Their names.
        names: String,
    },
    /// The joints are not four legs of three.
    #[error(
        "joint {0} does not belong to a leg: four legs of three revolute joints must hang from the base"
    )]
    NotALeg(String),
    /// A joint without a motor of its own.
    #[error(
        "joint {0} follows another one (<mimic>): every joint of a leg needs a motor of its own"
    )]
    Follows(String),
    /// Nothing tells how long a shank is.
    #[error(
        "joint {0}: nothing on the link that it moves tells where the foot is; give the foot a link of its own, fixed to it, or a sphere in the <collision> of the link"
    )]
    NoFoot(String),
    /// Two legs in one quadrant.
    #[error(
        "no leg stands at {place}: legs must be in four quadrants around the root link's frame, x forwards and y to the left; their feet stand at {feet} m: give the robot a root frame between them"
    )]
    Quadrant {
        /// The quadrant.
        place: &'static str,
        /// Where the legs hang, base axes, m.
        feet: String,
    },
    /// A joint without a limit that a plan can keep to.
    #[error(
        "joint {joint}: its {what} limit is {value}: a quadruped's joints have finite limits above 0; write it into the <limit> of the URDF, or [motors] into a profile, a TOML file beside the URDF"
    )]
    Limit {
        /// The joint.
        joint: String,
        /// Which limit.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// A joint that has no place to be.
    #[error("joint {joint}: its range is {lower} to {upper}: the first must be below the second")]
    Range {
        /// The joint.
        joint: String,
        /// Its lower limit.
        lower: f64,
        /// Its upper limit.
        upper: f64,
    },
    /// A collision shape that plans are made with, and that no body has.
    #[error(
        "link {link}: the {what} of its collision is `{value}`: must be finite numbers above 0, m"
    )]
    Shape {
        /// The link.
        link: String,
        /// Which measure.
        what: &'static str,
        /// What it is.
        value: String,
    },
    /// No size of a quadruped.
    #[error("its {what}: {error}")]
    Size {
        /// What is measured.
        what: &'static str,
        /// What it must be, and what it is.
        error: String,
    },
    /// No posture stands.
    #[error("no standing posture: leg {0} cannot reach below its hip within its joint limits")]
    Posture(&'static str),
}

/// What a robot with another number of joints needs.
const fn joints_remedy(count: usize) -> &'static str {
    if count > JOINTS {
        "lock those that are no leg's with --lock JOINT=VALUE"
    } else {
        "each of its four legs needs three revolute joints that are not locked"
    }
}

/// What another root element is, where that is known.
fn urdf_remedy(found: &str) -> &'static str {
    match found {
        "mujoco" => {
            "; this is an MJCF, which `saltus import` reads and plans do not: it does not say how fast joints turn"
        }
        _ => " (run xacro first if it is a macro file)",
    }
}

impl From<Unusable> for RobotError {
    fn from((key, what): Unusable) -> Self {
        Self::Profile { key, what }
    }
}
