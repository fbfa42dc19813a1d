//! A plan as bytes: what a planner writes, what is audited, and what a controller flies, from a file, from memory or from flash; without
//! allocation. There is no other format. Numbers are little-endian, at fixed places, in single precision: 10⁻⁷ of a joint's range is far
//! below what an encoder tells. Unused bytes are written as zero.
//!
//! | byte | type | content |
//! |---|---|---|
//! | 0 | 4 bytes | `SLTS` |
//! | 4 | u16 | version, 2 |
//! | 6, 7 | u8, u8 | N joints, F feet |
//! | 8 | u64 | [`model_hash`] of the robot |
//! | 16 | u32 | length of the whole container |
//! | 20 | u32 | CRC-32 (ISO-HDLC) of everything but these four bytes |
//! | 24 | u8, 255 bytes | task: length of the name, name in UTF-8 |
//! | 280 | u8, 63 bytes | robot: the same |
//! | 344 | u8 | torques: 0 held from node to node, 1 linear ([`Torques`](crate::Torques)) |
//! | 345 | u8 | contact phases in use |
//! | 346 | u16 | nodes |
//! | 348 | 3 f32 | take-off, posing, touchdown, s |
//! | 360 | 8 × (u8, 3 zeros, f32) | phases: feet that stand as bits, duration in s |
//! | 424 | u8, i8, 2 zeros | box: axis across its edge, side of the landing (0 without a box) |
//! | 428 | 2 f32 | its drop and the distance of its edge, m |
//! | 436 | 6 f32 | [`Margins`]: friction, its share, largest force in N, shares of torque and speed, weight in N |
//! | 460 | 3 f32 | goal: displacement of the base, world axes, m |
//! | 472 | f32 | goal: heading, rad |
//! | 476 | N f32 | landing posture, rad |
//! | 476 + 4 N | | the nodes, each of [`PlanNode::BYTES`] = 4 (20 + 3 N + 9 F) |
//!
//! | byte of a node | type | content |
//! |---|---|---|
//! | 0 | u8, 3 zeros | contact phase |
//! | 4 | f32 | time, s |
//! | 8 | 3 f32 | position of the base, world, m |
//! | 20 | 9 f32 | rotation from base to world, by rows |
//! | 56 | 6 f32 | velocity of the base, linear then angular, base axes, m/s and rad/s |
//! | 80 | N f32 | joint positions, rad |
//! | 80 + 4 N | N f32 | joint velocities, rad/s |
//! | 80 + 8 N | N f32 | torques, N m |
//! | 80 + 12 N | 3 F f32 | forces of the ground on the feet, world axes, N |
//! | 80 + 12 (N + F) | 3 F f32 | feet seen from their hips, base axes, m |
//! | 80 + 12 (N + 2 F) | 3 F f32 | their velocities relative to the base, base axes, m/s |
//!
//! A container is refused with the reason: not a plan, another version, cut off, damaged (the CRC detects every burst of up to 32 bits),
//! made for a robot of another size, or for another robot. [`Container::check`] looks at the values too. [`flash_plan!`](crate::flash_plan)
//! has the compiler read it.

mod bytes;
mod check;
mod error;
mod flash;
mod hash;
mod record;
mod write;

pub use error::ContainerError;
pub use hash::model_hash;
pub(crate) use record::parts;
pub use record::{
    GroundStep, Header, LONGEST_ROBOT, LONGEST_TASK, MOST_PHASES, Margins, PlanNode, PlanPhase,
};
pub use write::write;

use crate::crc::Crc32;
use crate::plan::Node;
use bytes::Reader;
use so3::Scalar;

/// First bytes of every container.
pub const MAGIC: [u8; 4] = *b"SLTS";
/// The version that this code writes and reads.
pub const VERSION: u16 = 2;
/// Bytes before the header.
pub const PREFIX: usize = 24;
/// Where the checksum stands, the last of the prefix.
const CHECKSUM: usize = 20;

/// A container that was checked: a view of its bytes, for a robot with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug)]
pub struct Container<'a, const N: usize, const F: usize> {
    robot: u64,
    header: Header<'a, N>,
    /// All of it.
    bytes: &'a [u8],
}

impl<'a, const N: usize, const F: usize> Container<'a, N, F> {
    /// Checks the bytes and reads the header. `robot` is the [`model_hash`] of the robot that is to execute the plan. Bytes
    /// after the container's own length are ignored: the rest of a page of flash.
    ///
    /// # Errors
    /// [`ContainerError`] says why the bytes are no plan for this robot.
    pub const fn open(bytes: &'a [u8], robot: u64) -> Result<Self, ContainerError> {
        let plan = match Self::read(bytes) {
            Ok(plan) => plan,
            Err(error) => return Err(error),
        };
        if plan.robot == robot {
            Ok(plan)
        } else {
            Err(ContainerError::Robot {
                planned: plan.robot,
                given: robot,
            })
        }
    }

    /// The same for whichever robot of this size the plan was made, [`Self::robot`].
    ///
    /// # Errors
    /// [`ContainerError`] says why the bytes are no plan.
    pub const fn read(bytes: &'a [u8]) -> Result<Self, ContainerError> {
        let given = bytes.len();
        if given < PREFIX {
            return Err(ContainerError::TooShort {
                needed: PREFIX,
                given,
            });
        }
        let mut from = Reader::new(bytes);
        if u32::from_le_bytes(from.take()) != u32::from_le_bytes(MAGIC) {
            return Err(ContainerError::NotAPlan);
        }
        let version = u16::from_le_bytes(from.take());
        if version != VERSION {
            return Err(ContainerError::Version { found: version });
        }
        let [joints, feet] = from.take();
        let robot = u64::from_le_bytes(from.take());
        let needed = u32::from_le_bytes(from.take()) as usize;
        let Some((whole, _)) = bytes.split_at_checked(needed) else {
            return Err(ContainerError::TooShort { needed, given });
        };
        if checksum(whole) != u32::from_le_bytes(from.take()) {
            return Err(ContainerError::Checksum);
        }
        if joints as usize != N || feet as usize != F {
            return Err(ContainerError::Size { joints, feet });
        }
        let Some((_, body)) = whole.split_at_checked(PREFIX) else {
            return Err(ContainerError::Header);
        };
        let mut from = Reader::new(body);
        let Some(header) = Header::read(&mut from) else {
            return Err(ContainerError::Header);
        };
        if whole.len() != Self::size(header.nodes as usize) {
            return Err(ContainerError::Header);
        }
        Ok(Self {
            robot,
            header,
            bytes: whole,
        })
    }

    /// Bytes of a container with so many nodes.
    #[must_use]
    pub const fn size(nodes: usize) -> usize {
        (PREFIX + Header::<N>::BYTES).saturating_add(nodes.saturating_mul(PlanNode::<N, F>::BYTES))
    }

    /// The [`model_hash`] of the robot that the plan was made for.
    #[must_use]
    pub const fn robot(&self) -> u64 {
        self.robot
    }

    /// All its bytes, and no others.
    #[must_use]
    pub const fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// Its CRC-32: plans with different ones are different plans.
    #[must_use]
    pub const fn checksum(&self) -> u32 {
        checksum(self.bytes)
    }

    /// What holds for the whole plan.
    #[must_use]
    pub const fn header(&self) -> &Header<'a, N> {
        &self.header
    }

    /// Number of nodes.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.header.nodes as usize
    }

    /// Node `i`; none beyond the last.
    #[must_use]
    pub const fn node(&self, i: usize) -> Option<PlanNode<N, F>> {
        self.stored().get(i)
    }

    /// The bytes of the nodes.
    pub(crate) const fn stored(&self) -> StoredNodes<'a, N, F> {
        let header = PREFIX + Header::<N>::BYTES;
        let bytes = match self.bytes.split_at_checked(header) {
            Some((_, nodes)) => nodes,
            None => &[],
        };
        StoredNodes { bytes }
    }

    /// Nodes in order.
    pub fn nodes(&self) -> impl Iterator<Item = PlanNode<N, F>> + '_ {
        (0..self.count()).map_while(|i| self.node(i))
    }

    /// Writes the nodes as the sampler takes them; returns the part of `out` that they fill.
    ///
    /// # Errors
    /// [`ContainerError::Buffer`] if `out` is too short.
    pub fn read_into<'b, T: Scalar>(
        &self,
        out: &'b mut [Node<T, N, F>],
    ) -> Result<&'b [Node<T, N, F>], ContainerError> {
        let needed = self.count();
        let given = out.len();
        let filled = out
            .get_mut(..needed)
            .ok_or(ContainerError::Buffer { needed, given })?;
        for (slot, node) in filled.iter_mut().zip(self.nodes()) {
            *slot = node.node();
        }
        Ok(filled)
    }
}

/// The nodes of a container that was checked: a view of their bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StoredNodes<'a, const N: usize, const F: usize> {
    bytes: &'a [u8],
}

impl<'a, const N: usize, const F: usize> StoredNodes<'a, N, F> {
    /// How many there are.
    pub(crate) const fn count(&self) -> usize {
        self.bytes.len() / PlanNode::<N, F>::BYTES
    }

    /// The numbers of each node, each as its bytes.
    fn words(&self) -> impl Iterator<Item = &'a [[u8; 4]]> + use<'a, N, F> {
        self.bytes
            .as_chunks()
            .0
            .chunks_exact(PlanNode::<N, F>::BYTES / 4)
    }

    /// Bytes from node `i` on; none beyond the last.
    const fn from(&self, i: usize) -> Option<Reader<'a>> {
        let begin = i.saturating_mul(PlanNode::<N, F>::BYTES);
        let Some((_, rest)) = self.bytes.split_at_checked(begin) else {
            return None;
        };
        if rest.len() < PlanNode::<N, F>::BYTES {
            return None;
        }
        Some(Reader::new(rest))
    }

    /// Node `i`.
    pub(crate) const fn get(&self, i: usize) -> Option<PlanNode<N, F>> {
        match self.from(i) {
            Some(mut from) => Some(PlanNode::read(&mut from)),
            None => None,
        }
    }

    /// [`parts`] of node `i`, zeros elsewhere.
    #[inline(always)]
    pub(crate) const fn parts<const PARTS: u8>(&self, i: usize) -> Option<PlanNode<N, F>> {
        match self.from(i) {
            Some(mut from) => Some(PlanNode::read_parts::<PARTS>(&mut from)),
            None => None,
        }
    }

    /// Its time alone, s.
    pub(crate) const fn time(&self, i: usize) -> Option<f32> {
        match self.from(i) {
            Some(mut from) => Some(PlanNode::<N, F>::time(&mut from)),
            None => None,
        }
    }
}

/// CRC of a container without its checksum.
const fn checksum(whole: &[u8]) -> u32 {
    let (before, rest) = match whole.split_at_checked(CHECKSUM) {
        Some(parts) => parts,
        None => (whole, [].as_slice()),
    };
    let after = match rest.split_at_checked(PREFIX - CHECKSUM) {
        Some((_, after)) => after,
        None => &[],
    };
    Crc32::START.with(before).with(after).value()
}

#[cfg(test)]
mod tests;
