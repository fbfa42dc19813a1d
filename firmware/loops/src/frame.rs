//! Frames between this board and the robot's: one of each kind per joint tick, at the same time, in both directions.
//!
//! | bytes | [`Report`]: what the robot says | [`Order`]: what it is told |
//! |---|---|---|
//! | 0..2 | `0x5e45` | `0x0e4d` |
//! | 2..4 | number of the frame | number of the frame |
//! | 4..6 | bit 0: the operator wants the jump | bytes of the flight recorder in this frame |
//! | 6..8 | | |
//! | 8.. | joint positions, velocities, torques (12 each), specific force, angular velocity (3 each), foot forces (4) | torques (12), bytes of the recorder |
//! | last 4 | CRC-32 of all before | the same |
//!
//! Integers and single-precision numbers are little-endian, CRC-32 is that of Ethernet. Both frames have [`FRAME`] bytes on the
//! wire; a report's end at [`REPORT`].

use robot_link::wire::{Reader, Writer, is_sealed};

/// Bytes on the wire in each direction.
pub const FRAME: usize = BODY + 12 * 4 + LUGGAGE + 4;
/// Bytes of a report.
pub const REPORT: usize = BODY + 46 * 4 + 4;
/// Bytes of the flight recorder that an order carries at most: more than the loops write in a joint tick.
pub const LUGGAGE: usize = 264;

/// Where the numbers begin.
const BODY: usize = 8;
const REPORT_MARK: u16 = 0x5e45;
const ORDER_MARK: u16 = 0x0e4d;

/// What the robot says, SI units; in the axes of the IMU, which are those of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Number of the frame: another one than the last report's if it is new.
    pub number: u16,
    /// Whether the operator wants the jump.
    pub jump: bool,
    /// Joint positions, rad.
    pub joints: [f32; 12],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f32; 12],
    /// Torques at the joints, friction included, N m.
    pub torques: [f32; 12],
    /// Accelerometer, m/s².
    pub specific_force: [f32; 3],
    /// Gyroscope, rad/s.
    pub angular_velocity: [f32; 3],
    /// Normal forces on the feet, N.
    pub foot_forces: [f32; 4],
}

/// What the robot is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// Number of the frame.
    pub number: u16,
    /// Torques of the motors, N m. A robot that hears nothing for 5 ms is to damp its joints by itself.
    pub torques: [f32; 12],
    /// The flight recorder's bytes, and how many of them.
    pub luggage: ([u8; LUGGAGE], usize),
}

/// Why bytes are no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Too few.
    CutOff,
    /// Of another kind, or not where a frame begins.
    Mark,
    /// A bit is not as it was sent.
    Checksum,
    /// More luggage than a frame has.
    Luggage,
}

/// The contents of a frame of `length` bytes after its mark, if nobody has touched it.
fn open(bytes: &[u8], length: usize, mark: u16) -> Result<Reader<'_>, Refusal> {
    let frame = bytes.get(..length).ok_or(Refusal::CutOff)?;
    let mut from = Reader::new(frame);
    if word(&mut from) != mark {
        return Err(Refusal::Mark);
    }
    if !is_sealed(frame) {
        return Err(Refusal::Checksum);
    }
    Ok(from)
}

fn word(from: &mut Reader<'_>) -> u16 {
    u16::from_le_bytes(from.take())
}

impl Report {
    /// As it goes over the wire.
    #[must_use]
    pub fn encode(&self) -> [u8; REPORT] {
        let mut bytes = [0; REPORT];
        let mut to = Writer::new(&mut bytes);
        for word in [REPORT_MARK, self.number, u16::from(self.jump), 0] {
            to.put(&word.to_le_bytes());
        }
        to.numbers(&self.joints);
        to.numbers(&self.joint_velocities);
        to.numbers(&self.torques);
        to.numbers(&self.specific_force);
        to.numbers(&self.angular_velocity);
        to.numbers(&self.foot_forces);
        to.seal();
        bytes
    }

    /// From the first bytes that came over the wire.
    ///
    /// # Errors
    /// [`Refusal`], if any bit is not as it was sent.
    pub fn decode(bytes: &[u8]) -> Result<Self, Refusal> {
        let mut from = open(bytes, REPORT, REPORT_MARK)?;
        let (number, flags, _) = (word(&mut from), word(&mut from), word(&mut from));
        Ok(Self {
            number,
            jump: flags & 1 != 0,
            joints: from.numbers(),
            joint_velocities: from.numbers(),
            torques: from.numbers(),
            specific_force: from.numbers(),
            angular_velocity: from.numbers(),
            foot_forces: from.numbers(),
        })
    }
}

impl Order {
    /// As it goes over the wire.
    #[must_use]
    pub fn encode(&self) -> [u8; FRAME] {
        let mut bytes = [0; FRAME];
        let mut to = Writer::new(&mut bytes);
        let (luggage, count) = &self.luggage;
        let count = (*count).min(LUGGAGE) as u16;
        for word in [ORDER_MARK, self.number, count, 0] {
            to.put(&word.to_le_bytes());
        }
        to.numbers(&self.torques);
        to.put(luggage);
        to.seal();
        bytes
    }

    /// From the bytes that came over the wire: what the robot's side does.
    ///
    /// # Errors
    /// [`Refusal`], if any bit is not as it was sent.
    pub fn decode(bytes: &[u8]) -> Result<Self, Refusal> {
        let mut from = open(bytes, FRAME, ORDER_MARK)?;
        let (number, count, _) = (
            word(&mut from),
            usize::from(word(&mut from)),
            word(&mut from),
        );
        let torques = from.numbers();
        if count > LUGGAGE {
            return Err(Refusal::Luggage);
        }
        Ok(Self {
            number,
            torques,
            luggage: (from.take(), count),
        })
    }
}
