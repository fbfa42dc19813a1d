//! MIT Mini Cheetah: the SPI frames of its two SPIne boards, two legs each.
//!
//! **Has never met hardware.** Source: `mit-biomimetics/Cheetah-Software`, `robot/include/rt/rt_spi.h` (structures) and `robot/src/rt/rt_spi.cpp`
//! (order, signs, offsets, checksum, order of bytes), `common/src/Controllers/LegController.cpp` (sense of the joints) and
//! `common/include/Dynamics/Quadruped.h` (legs).
//!
//! Board 0 has the legs FR FL, board 1 RR RL. A frame has 66 words of 16 bits, each with its high byte first, which are the halves of little-endian
//! 32-bit words. A command is 15 pairs of numbers (a leg each): position of abad, hip and knee, then velocity, kp, kd and
//! torque of each; then a pair of flags (bit 0: enabled), and the exclusive or of these 32 words. An answer is 6 pairs, positions and velocities, a pair of
//! flags, and the exclusive or of these 14 words; its second half is not said.
//!
//! Joints at the board are q' = s q + o; at the knee q' = q/s + o, q̇' = q̇/s and τ' = s τ with a belt of s = ±0.6429. Hip and knee turn there
//! the other way than in a URDF whose axes are those of the body: there a positive angle brings the foot forward. Gains go as they are, as in the
//! source; whether the board takes the knee's for the joint's or the motor's is not in the source.

use crate::command::Command;
use crate::wire::{Reader, Writer};

use super::reordered;

/// Bytes of a frame, of which a command is the whole and an answer the beginning.
pub const FRAME: usize = 132;
/// Bytes of an answer before its checksum.
const ANSWER: usize = 56;

/// The belt of the knee, and its zero, rad.
const BELT: f32 = 0.6429;
const KNEE: f32 = 4.35;
/// A quarter of a turn, the zero of the hips, rad.
const QUARTER: f32 = core::f32::consts::FRAC_PI_2;

/// Factor and offset of a joint from the published software to the board, by leg FR FL RR RL and joint.
const JOINTS: [[(f32, f32); 3]; 4] = [
    [(-1.0, 0.0), (-1.0, QUARTER), (-1.0 / BELT, KNEE)],
    [(-1.0, 0.0), (1.0, -QUARTER), (1.0 / BELT, -KNEE)],
    [(1.0, 0.0), (-1.0, -QUARTER), (-1.0 / BELT, -KNEE)],
    [(1.0, 0.0), (1.0, QUARTER), (1.0 / BELT, KNEE)],
];

/// From this project's sense of abad, hip and knee to the published software's.
const SENSE: [f32; 3] = [1.0, -1.0, -1.0];

/// Kinds of joints, and legs of a board.
const KINDS: usize = 3;
const SIDES: usize = 2;

/// Where a board's frame has each joint of legs in the robot's order: pairs of legs by kind.
fn places(board: usize) -> impl Iterator<Item = usize> {
    let of_kind = move |kind| (0..SIDES).map(move |leg| KINDS * (SIDES * board + leg) + kind);
    (0..KINDS).flat_map(of_kind)
}

/// Factor and offset of every joint from this project to the boards, in the robot's order of legs.
fn scales() -> impl Iterator<Item = (f32, f32)> {
    let senses = SENSE.into_iter().cycle();
    let joints = JOINTS.into_iter().flatten().zip(senses);
    joints.map(|((factor, offset), sense)| (factor * sense, offset))
}

/// The frames that tell both boards a command; motors are enabled, or not.
#[must_use]
pub fn spine_commands(command: &Command<12>, is_enabled: bool) -> [[u8; FRAME]; 2] {
    let command = &command.0;
    let mut blocks = [
        command.position,
        command.velocity,
        command.gains.map(|gains| gains.stiffness),
        command.gains.map(|gains| gains.damping),
        command.feed_forward,
    ]
    .map(|numbers| reordered(&numbers));
    let [q, qd, _, _, tau] = &mut blocks;
    let moved = q.iter_mut().zip(qd).zip(tau);
    for (((q, qd), tau), (factor, offset)) in moved.zip(scales()) {
        *q = *q * factor + offset;
        *qd *= factor;
        *tau /= factor;
    }
    [0, 1].map(|board| {
        let mut frame = [0; FRAME];
        let mut to = Writer::new(&mut frame);
        for block in &blocks {
            for place in places(board) {
                to.numbers(block.get(place..=place).unwrap_or_default());
            }
        }
        for _ in 0..SIDES {
            to.put(&u32::from(is_enabled).to_le_bytes());
        }
        let sum = exclusive_or(to.written());
        to.put(&sum.to_le_bytes());
        swapped(frame)
    })
}

/// Positions, rad, and velocities, rad/s, of all joints from what both boards answered; `None` if a checksum is not as it should be. Torques are
/// not measured there, and the IMU is another device.
#[must_use]
pub fn joints(answers: [&[u8; FRAME]; 2]) -> Option<[[f32; 12]; 2]> {
    let mut blocks = [[0.0; 12]; 2];
    for (board, answer) in answers.into_iter().enumerate() {
        let words = swapped(*answer);
        let (said, sum) = words.split_at_checked(ANSWER)?;
        if exclusive_or(said) != u32::from_le_bytes(*sum.first_chunk()?) {
            return None;
        }
        let mut from = Reader::new(said);
        for block in &mut blocks {
            for place in places(board) {
                *block.get_mut(place)? = from.number();
            }
        }
    }
    let [q, qd] = &mut blocks;
    for ((q, qd), (factor, offset)) in q.iter_mut().zip(qd).zip(scales()) {
        *q = (*q - offset) / factor;
        *qd /= factor;
    }
    Some(blocks.map(|numbers| reordered(&numbers)))
}

/// Of all little-endian words.
fn exclusive_or(bytes: &[u8]) -> u32 {
    let words = bytes.as_chunks::<4>().0.iter();
    words.fold(0, |sum, word| sum ^ u32::from_le_bytes(*word))
}

/// With the two bytes of every 16-bit word exchanged.
fn swapped(mut bytes: [u8; FRAME]) -> [u8; FRAME] {
    for pair in bytes.as_chunks_mut::<2>().0 {
        pair.reverse();
    }
    bytes
}
