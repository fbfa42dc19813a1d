//! Why bytes are no plan.

use super::VERSION;
use core::fmt;

/// Why bytes are no plan for a robot, or a plan does not become bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ContainerError {
    /// The bytes end before the container does.
    TooShort {
        /// Bytes that there must be.
        needed: usize,
        /// Bytes that there are.
        given: usize,
    },
    /// The first bytes are not those of a plan.
    NotAPlan,
    /// Written by another version of the format.
    Version {
        /// The container's version.
        found: u16,
    },
    /// The checksum does not fit: bytes have changed.
    Checksum,
    /// The plan is for a robot with other numbers of joints and feet.
    Size {
        /// Joints of the plan's robot.
        joints: u8,
        /// Its feet.
        feet: u8,
    },
    /// The plan is for another robot of the same size.
    Robot {
        /// Hash of the robot that was planned for.
        planned: u64,
        /// Hash of the robot that is there.
        given: u64,
    },
    /// The header is not what its writer should have written.
    Header,
    /// A value that no plan has, though the checksum fits.
    Value {
        /// The node, none for the header.
        node: Option<u16>,
        /// Which value.
        what: &'static str,
    },
    /// A name is longer than its field.
    Name {
        /// Whose: `task` or `robot`.
        what: &'static str,
        /// Bytes of the name.
        given: usize,
        /// Bytes of the field.
        room: usize,
    },
    /// The caller's storage is too short.
    Buffer {
        /// Bytes or nodes that are needed.
        needed: usize,
        /// Those that there are.
        given: usize,
    },
}

impl ContainerError {
    /// The reason without its numbers, which the compiler cannot write.
    #[must_use]
    pub const fn reason(&self) -> &'static str {
        match self {
            Self::TooShort { .. } => "the plan is cut off: copy it again",
            Self::NotAPlan => "not a plan: it does not begin with SLTS",
            Self::Version { .. } => "a plan of another version of the format: plan again",
            Self::Checksum => "the plan is damaged: its checksum does not fit; copy it again",
            Self::Size { .. } => "a plan for another robot, with other numbers of joints and feet",
            Self::Robot { .. } => "a plan for another robot of the same size",
            Self::Header => "the plan's header contradicts its length",
            Self::Value { what, .. } => what,
            Self::Name { .. } => "a name is longer than its field",
            Self::Buffer { .. } => "the storage is too short",
        }
    }
}

impl fmt::Display for ContainerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort { needed, given } => {
                write!(f, "cut off: {given} bytes of {needed}; copy the plan again")
            }
            Self::NotAPlan => f.write_str("not a plan: it does not begin with SLTS"),
            Self::Version { found } => {
                write!(
                    f,
                    "a plan of version {found}; this reads version {VERSION}: plan again"
                )
            }
            Self::Checksum => {
                f.write_str("damaged: its checksum does not fit; copy the plan again")
            }
            Self::Size { joints, feet } => {
                write!(
                    f,
                    "a plan for another robot, with {joints} joints and {feet} feet"
                )
            }
            Self::Robot { planned, given } => write!(
                f,
                "a plan for another robot: model {planned:016x}, this robot is {given:016x}"
            ),
            Self::Header => f.write_str("its header contradicts its length"),
            Self::Value {
                node: Some(node),
                what,
            } => write!(
                f,
                "damaged, though its checksum fits: node {node}: {what} cannot be; plan again"
            ),
            Self::Value { node: None, what } => {
                write!(
                    f,
                    "damaged, though its checksum fits: {what} cannot be; plan again"
                )
            }
            Self::Name { what, given, room } => write!(
                f,
                "the {what}'s name has {given} bytes, a plan has room for {room}: shorten it"
            ),
            Self::Buffer { needed, given } => {
                write!(f, "storage for {given} bytes or nodes, {needed} are needed")
            }
        }
    }
}

impl core::error::Error for ContainerError {}
