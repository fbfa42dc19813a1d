//! Layouts of robots as they are sold: their order of joints, signs, offsets, bytes and checksums, and nothing else.
//!
//! **None of these has met hardware.** Each says which public source it was read from, and its golden frames come from a program that was written from
//! that source alone (`tests/golden/generate.py`). Before a robot is told anything by one of them it belongs on a stand, with `damp` as its first
//! command.
//!
//! Left out is the datagram of Unitree's A1 and Go1: the published header of its SDK (`unitree_legged_sdk`, `comm.h`) says that what goes over the wire
//! is a shorter, compressed form of its structures, and the library that makes it is closed.

pub mod mini_cheetah;
pub mod unitree_go2;

/// Legs in the order FR FL RR RL, of a robot whose legs here are FL FR RL RR: the same permutation there and back.
const LEGS: [usize; 4] = [1, 0, 3, 2];

/// Joints of those legs, hip, thigh and calf of each.
fn reordered<T: Copy>(joints: &[T; 12]) -> [T; 12] {
    let (legs, _) = joints.as_chunks::<3>();
    let mut out = *joints;
    for (joints, leg) in out.as_chunks_mut::<3>().0.iter_mut().zip(LEGS) {
        if let Some(from) = legs.get(leg) {
            *joints = *from;
        }
    }
    out
}
