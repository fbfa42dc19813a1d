//! What can be wrong with a URDF or an MJCF, and what is only worth a word.

use thiserror::Error;

/// Why a file is no robot: each names the element and the remedy.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The text is not XML.
    #[error("not XML, at line {line} column {column}: {message}; is the file complete?")]
    Xml {
        /// Line, from 1.
        line: u32,
        /// Column, from 1.
        column: u32,
        /// The parser's words.
        message: String,
    },
    /// The root element is not `<robot>`, or not `<mujoco>` of an MJCF.
    #[error(
        "the root element is <{found}>, not <robot> or <mujoco>: give a URDF (run xacro first if it is a macro file) or an MJCF"
    )]
    NotARobot {
        /// Name of the root element.
        found: String,
    },
    /// No `<link>` at all.
    #[error("the robot has no <link>: give a URDF with at least one")]
    NoLinks,
    /// An element lacks an attribute or a child that has no default.
    #[error("{element} has no {what}: add it")]
    Missing {
        /// The element, by kind, name and line.
        element: String,
        /// What it lacks.
        what: &'static str,
    },
    /// A number cannot be read, is NaN or infinite, or there are too many or too few of them.
    #[error("{element}: {what} is `{text}`, which is not {expected}")]
    BadNumber {
        /// The element, by kind, name and line.
        element: String,
        /// The attribute.
        what: &'static str,
        /// Its text.
        text: String,
        /// What it should be.
        expected: &'static str,
    },
    /// Two links or two joints have the same name.
    #[error("{element} has a name that is already taken: rename one of them")]
    DuplicateName {
        /// The second of them.
        element: String,
    },
    /// A joint names a link that is not there.
    #[error(
        "{element} names the link `{link}`, which is not in the file: add it or correct the name"
    )]
    UnknownLink {
        /// The joint.
        element: String,
        /// The name without a link.
        link: String,
    },
    /// A mimic joint names a joint that is not there.
    #[error("{element} mimics the joint `{leader}`, which is not in the file: correct the name")]
    UnknownLeader {
        /// The joint.
        element: String,
        /// The name without a joint.
        leader: String,
    },
    /// A joint type that is not revolute, continuous, prismatic or fixed.
    #[error(
        "{element} is of type `{kind}`: supported are revolute, continuous, prismatic and fixed, and one floating joint from a root link that has no <inertial> and no other joint; replace it by several of those"
    )]
    UnsupportedJoint {
        /// The joint.
        element: String,
        /// Its type.
        kind: String,
    },
    /// Something in an MJCF that a tree of rigid bodies cannot keep, or this crate does not read.
    #[error("{element}: {what}")]
    Unsupported {
        /// The element, by kind, name and line.
        element: String,
        /// What it is, and the remedy.
        what: String,
    },
    /// A link is the child of two joints.
    #[error(
        "link `{link}` has two parents, joints `{first}` and `{second}`: a model is a tree, cut one of the joints"
    )]
    TwoParents {
        /// The link.
        link: String,
        /// First joint above it.
        first: String,
        /// Second joint above it.
        second: String,
    },
    /// Links form a ring.
    #[error("link `{link}` is above itself: a model is a tree, cut the loop at one of its joints")]
    Loop {
        /// A link of the ring.
        link: String,
    },
    /// More than one link has no parent.
    #[error(
        "links `{first}` and `{second}` both have no parent: join them, or remove one with its subtree"
    )]
    SeveralRoots {
        /// The first root.
        first: String,
        /// Another.
        second: String,
    },
    /// The joint axis is zero.
    #[error("{element} has the axis (0, 0, 0): give its direction")]
    ZeroAxis {
        /// The joint.
        element: String,
    },
    /// The joint axis is further from unit length than rounding explains.
    #[error("{element} has an axis of length {length}: make it a unit vector")]
    NonUnitAxis {
        /// The joint.
        element: String,
        /// Its length.
        length: f64,
    },
    /// Lower limit above the upper.
    #[error("{element} has its lower limit {lower} above its upper limit {upper}: swap them")]
    InvertedLimits {
        /// The joint.
        element: String,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// A mass below zero.
    #[error("{element} has the mass {mass} kg: it must not be negative")]
    NegativeMass {
        /// The link.
        element: String,
        /// Its mass, kg.
        mass: f64,
    },
    /// A moved body has an inertia that no body has, because of this link.
    #[error(
        "{element} has principal moments {moments:?} kg m²: none may be negative, and the largest may not exceed the sum of the others; correct them, or take them as they are with --inertia as-written"
    )]
    UnphysicalInertia {
        /// The link.
        element: String,
        /// Its principal moments, kg m², ascending.
        moments: [f64; 3],
    },
    /// A joint accelerates without effort, because nothing that it moves resists it.
    #[error(
        "joint `{joint}` moves no inertia (link `{link}` {state}): give the link an <inertial>, or lock the joint with --lock {joint}=0"
    )]
    MissingInertia {
        /// The joint.
        joint: String,
        /// The link that it moves.
        link: String,
        /// What is known of the link's inertia.
        state: &'static str,
    },
    /// A floating robot without mass.
    #[error("the robot has no mass: add <inertial> to its links, or give it a fixed base")]
    NoMass,
    /// A joint to be locked is not there.
    #[error("there is no joint `{joint}` to lock; the movable joints are: {known}")]
    UnknownLock {
        /// The name given.
        joint: String,
        /// Names that would do.
        known: String,
    },
    /// A joint is locked twice.
    #[error("joint `{joint}` is locked twice: give one value")]
    LockedTwice {
        /// The joint.
        joint: String,
    },
    /// A lock that is not `joint=value` with a finite value.
    #[error("lock `{text}` is not joint=value with a finite value in rad or m")]
    BadLock {
        /// The text given.
        text: String,
    },
    /// A mimic joint, and the caller has not said what to do with it.
    #[error(
        "{element} mimics `{leader}`: lock it (--lock {joint}=value or --mimic lock), or make it a joint of its own with the coupling beside the tree (--mimic free)"
    )]
    Mimic {
        /// The joint.
        element: String,
        /// Its name.
        joint: String,
        /// The joint it follows.
        leader: String,
    },
    /// More joints than the largest model this tool checks.
    #[error("the robot has {joints} movable joints; the tool handles {most}: lock some")]
    TooManyJoints {
        /// Joints of the robot.
        joints: usize,
        /// The most it handles.
        most: usize,
    },
    /// More than any robot has.
    #[error("there are more than {most} {what}: that is no robot; give the robot alone")]
    TooLarge {
        /// Of what there is too much.
        what: &'static str,
        /// The most that is read.
        most: usize,
    },
    /// The tables do not make a model.
    #[error("the tables do not make a model: {0}")]
    Table(#[from] rbd_core::TableError),
}

/// What was tolerated, and how it was read.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Warning {
    /// The axis was scaled to unit length.
    #[error("{element}: axis of length {length} scaled to 1")]
    AxisScaled {
        /// The joint.
        element: String,
        /// Length as written.
        length: f64,
    },
    /// The link's principal moments are those of no body; the moved body's as a whole are, or the caller wants
    /// them as written.
    #[error(
        "{element}: principal moments {moments:?} kg m² are those of no body, by {excess:.1e} of the largest; kept as written"
    )]
    UnphysicalLink {
        /// The link.
        element: String,
        /// Principal moments, kg m², ascending.
        moments: [f64; 3],
        /// Violation relative to the largest moment.
        excess: f64,
    },
    /// Moments of inertia without mass.
    #[error("{element}: moments of inertia on a mass of zero; kept as written")]
    InertiaWithoutMass {
        /// The link.
        element: String,
    },
    /// A revolute or prismatic joint without `<limit>`.
    #[error("{element}: no <limit>; taken as unlimited")]
    NoLimit {
        /// The joint.
        element: String,
    },
    /// Speed or effort limit of zero.
    #[error("{element}: {what} limit {value} kept as written; is it a placeholder?")]
    PlaceholderLimit {
        /// The joint.
        element: String,
        /// Which limit.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A joint was locked outside its range.
    #[error("joint `{joint}` is locked at {value}, outside its range {lower}..{upper}")]
    LockOutsideRange {
        /// The joint.
        joint: String,
        /// Where it is locked.
        value: f64,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// A mimic joint is a joint of its own in the tree; the coupling is kept in the reduction.
    #[error(
        "joint `{joint}` mimics `{leader}` in the file and is a joint of its own in the tree; the coupling stands in the reduction"
    )]
    MimicFreed {
        /// The joint.
        joint: String,
        /// The joint it follows.
        leader: String,
    },
    /// A mimic joint moves on its own, because what it follows does not move, is not there, or follows it.
    #[error(
        "joint `{joint}` mimics `{leader}` in the file and moves on its own here: `{leader}` {why}; lock it with --lock {joint}=value if it should stand"
    )]
    MimicLost {
        /// The joint.
        joint: String,
        /// The joint it should follow.
        leader: String,
        /// What is wrong with the leader.
        why: &'static str,
    },
    /// Something in an MJCF that changes how the robot moves and is not kept.
    #[error("not kept: {what}")]
    NotKept {
        /// What it is.
        what: String,
    },
    /// A joint axis that is nearly a coordinate axis of the body above, and kept as it is.
    #[error(
        "joint `{joint}`: its axis is {off:.1e} off a coordinate axis and kept so, as a tilted joint; more digits in the file, or --axis-rounding {suggest:.0e}, make it an aligned one, which computes faster"
    )]
    AxisNearlyAligned {
        /// The joint.
        joint: String,
        /// Largest deviation of an entry.
        off: f64,
        /// A tolerance that would align it.
        suggest: f64,
    },
    /// A mimic joint was locked.
    #[error("joint `{joint}` mimics `{leader}` in the file and is locked at {value} here")]
    MimicLocked {
        /// The joint.
        joint: String,
        /// The joint it should follow.
        leader: String,
        /// Where it is locked.
        value: f64,
    },
}
