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

use crc::{CRC_32_ISO_HDLC, Crc};

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

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

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

/// Bytes that are put or taken one after the other; beyond the end nothing happens, and zeros come.
struct Cursor<B> {
    bytes: B,
    at: usize,
}

impl Cursor<&mut [u8]> {
    fn put(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if let Some(slot) = self.bytes.get_mut(self.at) {
                *slot = *byte;
            }
            self.at += 1;
        }
    }

    fn numbers(&mut self, numbers: &[f32]) {
        for x in numbers {
            self.put(&x.to_le_bytes());
        }
    }

    /// CRC-32 of everything before.
    fn seal(&mut self) {
        let sum = CRC.checksum(self.bytes.get(..self.at).unwrap_or_default());
        self.put(&sum.to_le_bytes());
    }
}

impl Cursor<&[u8]> {
    fn take<const K: usize>(&mut self) -> [u8; K] {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        self.at += K;
        rest.first_chunk().copied().unwrap_or([0; K])
    }

    fn word(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    fn numbers<const K: usize>(&mut self) -> [f32; K] {
        core::array::from_fn(|_| f32::from_le_bytes(self.take()))
    }
}

/// The contents of a frame of `length` bytes after its mark, if nobody has touched it.
fn open(bytes: &[u8], length: usize, mark: u16) -> Result<Cursor<&[u8]>, Refusal> {
    let frame = bytes.get(..length).ok_or(Refusal::CutOff)?;
    let mut cursor = Cursor {
        bytes: frame,
        at: 0,
    };
    if cursor.word() != mark {
        return Err(Refusal::Mark);
    }
    let (body, sum) = frame.split_last_chunk::<4>().ok_or(Refusal::CutOff)?;
    if CRC.checksum(body) != u32::from_le_bytes(*sum) {
        return Err(Refusal::Checksum);
    }
    Ok(cursor)
}

impl Report {
    /// As it goes over the wire.
    #[must_use]
    pub fn encode(&self) -> [u8; REPORT] {
        let mut bytes = [0; REPORT];
        let mut to = Cursor {
            bytes: bytes.as_mut_slice(),
            at: 0,
        };
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
        let (number, flags, _) = (from.word(), from.word(), from.word());
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
        let mut to = Cursor {
            bytes: bytes.as_mut_slice(),
            at: 0,
        };
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
        let (number, count, _) = (from.word(), usize::from(from.word()), from.word());
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
