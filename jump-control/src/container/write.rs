//! From a plan to bytes.

use super::bytes::Writer;
use super::record::{LONGEST_ROBOT, LONGEST_TASK};
use super::{
    CHECKSUM, Container, ContainerError, Header, MAGIC, PREFIX, PlanNode, VERSION, checksum,
};

/// Writes a container for the robot with this [`model_hash`](super::model_hash) into `out` and returns its length,
/// [`Container::size`]. `header.nodes` is set from `nodes`.
///
/// # Errors
/// [`ContainerError::Buffer`] if `out` is too short, [`ContainerError::Name`] for a name longer than its field, [`ContainerError::Header`]
/// for more than 65535 nodes, or more than 255 joints or feet.
pub fn write<const N: usize, const F: usize>(
    out: &mut [u8],
    robot: u64,
    header: &Header<'_, N>,
    nodes: &[PlanNode<N, F>],
) -> Result<usize, ContainerError> {
    for (what, name, room) in [
        ("task", header.task, LONGEST_TASK),
        ("robot", header.robot, LONGEST_ROBOT),
    ] {
        let given = name.len();
        if given > room {
            return Err(ContainerError::Name { what, given, room });
        }
    }
    let header = Header {
        nodes: u16::try_from(nodes.len()).map_err(|_| ContainerError::Header)?,
        ..*header
    };
    let size = |x: usize| u8::try_from(x).map_err(|_| ContainerError::Header);
    let sizes = [size(N)?, size(F)?];
    let given = out.len();
    let needed = Container::<N, F>::size(nodes.len());
    let too_short = ContainerError::Buffer { needed, given };
    let length = u32::try_from(needed).map_err(|_| ContainerError::Header)?;
    let whole = out.get_mut(..needed).ok_or(too_short)?;
    let mut to = Writer::new(whole);
    to.put(MAGIC);
    to.put(VERSION.to_le_bytes());
    to.put(sizes);
    to.put(robot.to_le_bytes());
    to.put(length.to_le_bytes());
    // In the place of the checksum, which does not count itself.
    to.put([0; PREFIX - CHECKSUM]);
    header.write(&mut to);
    for node in nodes {
        node.write(&mut to);
    }
    let sum = checksum(whole);
    Writer::new(whole.get_mut(CHECKSUM..).unwrap_or_default()).put(sum.to_le_bytes());
    Ok(needed)
}
