//! A plan as bytes: what a planner writes and a controller reads from flash, without allocation.
//!
//! | bytes | content |
//! |---|---|
//! | 4 | `SLTS` |
//! | 2 | version |
//! | 1, 1 | joints, feet |
//! | 8 | [`model_hash`] of the robot |
//! | 4 | length of the whole container |
//! | 4 | CRC-32 (ISO-HDLC) of everything but these four bytes |
//! | | [`Header`] in `postcard` |
//! | | one [`PlanNode`] per node in `postcard`, all of equal length |
//! | | one [`NodeGains`] per node in `postcard`, if the header says so |
//!
//! Integers of the first rows are little-endian. Numbers are single precision: 10⁻⁷ of a joint's range is far below what an
//! encoder tells. A container is refused with the reason: not a plan, another version, cut off, damaged (CRC-32 detects every
//! burst of up to 32 bits), made for a robot of another size, or for another robot. [`Container::check`] looks at the values too.

mod check;
mod error;
mod hash;
mod record;
mod row;

pub use error::ContainerError;
pub use hash::model_hash;
pub use record::{GroundStep, Header, MOST_PHASES, Margins, NodeGains, PlanNode, PlanPhase};
pub use row::Row;

use crate::plan::Node;
use crc::{CRC_32_ISO_HDLC, Crc, Digest};
use so3::Scalar;

/// First bytes of every container.
pub const MAGIC: [u8; 4] = *b"SLTS";
/// The version that this code writes and reads.
pub const VERSION: u16 = 1;
/// Bytes before the header.
pub const PREFIX: usize = 24;
/// Where the checksum stands.
const CHECKSUM: usize = 20;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// A container that was checked: a view of its bytes, for a robot with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug)]
pub struct Container<'a, const N: usize, const F: usize> {
    header: Header<'a>,
    nodes: &'a [u8],
    gains: &'a [u8],
}

impl<'a, const N: usize, const F: usize> Container<'a, N, F> {
    /// Checks the bytes and reads the header. `robot` is the [`model_hash`] of the robot that is to execute the plan. Bytes
    /// after the container's own length are ignored: the rest of a page of flash.
    ///
    /// # Errors
    /// [`ContainerError`] says why the bytes are no plan for this robot.
    pub fn open(bytes: &'a [u8], robot: u64) -> Result<Self, ContainerError> {
        let prefix: &[u8; PREFIX] = bytes.first_chunk().ok_or(ContainerError::TooShort {
            needed: PREFIX,
            given: bytes.len(),
        })?;
        let [m0, m1, m2, m3, v0, v1, joints, feet, rest @ ..] = *prefix;
        let [
            h0,
            h1,
            h2,
            h3,
            h4,
            h5,
            h6,
            h7,
            l0,
            l1,
            l2,
            l3,
            c0,
            c1,
            c2,
            c3,
        ] = rest;
        if [m0, m1, m2, m3] != MAGIC {
            return Err(ContainerError::NotAPlan);
        }
        let version = u16::from_le_bytes([v0, v1]);
        if version != VERSION {
            return Err(ContainerError::Version { found: version });
        }
        let length = u32::from_le_bytes([l0, l1, l2, l3]) as usize;
        let whole = bytes.get(..length).ok_or(ContainerError::TooShort {
            needed: length,
            given: bytes.len(),
        })?;
        if checksum(whole) != Some(u32::from_le_bytes([c0, c1, c2, c3])) {
            return Err(ContainerError::Checksum);
        }
        if (usize::from(joints), usize::from(feet)) != (N, F) {
            return Err(ContainerError::Size { joints, feet });
        }
        let planned = u64::from_le_bytes([h0, h1, h2, h3, h4, h5, h6, h7]);
        if planned != robot {
            return Err(ContainerError::Robot {
                planned,
                given: robot,
            });
        }
        let body = whole.get(PREFIX..).unwrap_or_default();
        let (header, records): (Header<'a>, _) =
            postcard::take_from_bytes(body).map_err(|_| ContainerError::Header)?;
        let count = usize::from(header.nodes);
        let split = count.saturating_mul(Self::NODE_BYTES);
        let gain_bytes = if header.has_gains {
            count.saturating_mul(Self::GAIN_BYTES)
        } else {
            0
        };
        if records.len() != split.saturating_add(gain_bytes) {
            return Err(ContainerError::Header);
        }
        let (nodes, gains) = records.split_at_checked(split).unwrap_or_default();
        Ok(Self {
            header,
            nodes,
            gains,
        })
    }

    /// Bytes of a node: phase, time, pose and velocity of the base, joints, torques, and per foot force, place and velocity.
    pub const NODE_BYTES: usize = 1 + 4 * (1 + 3 + 4 + 6 + 3 * N + 9 * F);
    /// Bytes of a node's gains.
    pub const GAIN_BYTES: usize = 4 * N * (12 + 2 * N);

    /// What holds for the whole plan.
    #[must_use]
    pub const fn header(&self) -> &Header<'a> {
        &self.header
    }

    /// Node `i`; none beyond the last.
    #[must_use]
    pub fn node(&self, i: usize) -> Option<PlanNode<N, F>> {
        record(self.nodes, i, Self::NODE_BYTES)
    }

    /// Gains of node `i`; none beyond the last, or if the plan has none.
    #[must_use]
    pub fn gains(&self, i: usize) -> Option<NodeGains<N>> {
        record(self.gains, i, Self::GAIN_BYTES)
    }

    /// Nodes in order.
    pub fn nodes(&self) -> impl Iterator<Item = PlanNode<N, F>> + '_ {
        (0..usize::from(self.header.nodes)).map_while(|i| self.node(i))
    }

    /// Writes the nodes as the sampler takes them; returns the part of `out` that they fill.
    ///
    /// # Errors
    /// [`ContainerError::Buffer`] if `out` is too short.
    pub fn read_into<'b, T: Scalar>(
        &self,
        out: &'b mut [Node<T, N, F>],
    ) -> Result<&'b [Node<T, N, F>], ContainerError> {
        let needed = usize::from(self.header.nodes);
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

/// Record `i` of a run of records of equal length.
fn record<'a, R: serde::Deserialize<'a>>(records: &'a [u8], i: usize, bytes: usize) -> Option<R> {
    let begin = i.checked_mul(bytes)?;
    let bytes = records.get(begin..begin.checked_add(bytes)?)?;
    postcard::from_bytes(bytes).ok()
}

/// CRC of a container without its checksum.
fn checksum(whole: &[u8]) -> Option<u32> {
    let mut digest: Digest<'_, u32> = CRC.digest();
    digest.update(whole.get(..CHECKSUM)?);
    digest.update(whole.get(PREFIX..)?);
    Some(digest.finalize())
}

/// Writes a container into `out` and returns its length. `header.nodes` and `header.has_gains` are set from `nodes` and `gains`;
/// there must be as many gains as nodes, or none.
///
/// # Errors
/// [`ContainerError::Buffer`] if `out` is too short, [`ContainerError::Header`] for more than 65535 nodes, more than 255 joints or
/// feet, or another number of gains than nodes.
pub fn write<const N: usize, const F: usize>(
    out: &mut [u8],
    robot: u64,
    header: &Header<'_>,
    nodes: &[PlanNode<N, F>],
    gains: &[NodeGains<N>],
) -> Result<usize, ContainerError> {
    let given = out.len();
    let records = nodes
        .len()
        .saturating_mul(Container::<N, F>::NODE_BYTES)
        .saturating_add(gains.len().saturating_mul(Container::<N, F>::GAIN_BYTES));
    // Names, and fixed numbers of at most 4 bytes (5 as a varint), take less than this.
    let names = header.task.len().saturating_add(header.robot.len());
    let needed = records.saturating_add(names).saturating_add(PREFIX + 512);
    let too_short = ContainerError::Buffer { needed, given };
    let header = Header {
        nodes: u16::try_from(nodes.len()).map_err(|_| ContainerError::Header)?,
        has_gains: !gains.is_empty(),
        ..*header
    };
    if header.has_gains && gains.len() != nodes.len() {
        return Err(ContainerError::Header);
    }
    let size = |x: usize| u8::try_from(x).map_err(|_| ContainerError::Header);
    let sizes = [size(N)?, size(F)?];
    let mut at = PREFIX;
    put(out, &mut at, &header).ok_or(too_short)?;
    for node in nodes {
        put(out, &mut at, node).ok_or(too_short)?;
    }
    for node in gains {
        put(out, &mut at, node).ok_or(too_short)?;
    }
    let length = u32::try_from(at).map_err(|_| ContainerError::Header)?;
    let parts: [&[u8]; 5] = [
        &MAGIC,
        &VERSION.to_le_bytes(),
        &sizes,
        &robot.to_le_bytes(),
        &length.to_le_bytes(),
    ];
    let bytes = parts.into_iter().flatten();
    out.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    let sum = out.get(..at).and_then(checksum).ok_or(too_short)?;
    let slots = out.iter_mut().skip(CHECKSUM);
    slots
        .zip(sum.to_le_bytes())
        .for_each(|(to, from)| *to = from);
    Ok(at)
}

/// Serialises a value at `at` and moves on.
fn put<V: serde::Serialize>(out: &mut [u8], at: &mut usize, value: &V) -> Option<()> {
    let written = postcard::to_slice(value, out.get_mut(*at..)?).ok()?.len();
    *at = at.checked_add(written)?;
    Some(())
}

#[cfg(test)]
mod tests;
