//! A flight again, on a host, from what the flight recorder wrote.

use std::fmt;

use a1_model::A1Geared;
use jump_machine::Inputs;
use landing::Workspace;
use nalgebra::{Matrix3, Rotation3, Vector3};
use rbd_core::{Model, Motion, Transform};
use saltus_probe::flight::{Planned, digest};

use crate::control::Control;
use crate::joints::Joints;
use crate::recorder::HEARD;

/// What a replay found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Replayed {
    /// Ticks at 1 kHz and at 10 kHz whose answers had the recorded bits.
    pub ticks: [u32; 2],
}

/// Why a recording does not replay.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// The bytes end inside a record, or without the last one.
    CutOff(usize),
    /// No record begins here.
    Unknown(usize),
    /// The recorder had no room for so many records.
    Lost(u32),
    /// The plan in flash is refused.
    Plan,
    /// A control (`c`) or joint (`j`) tick answered other bits than on the board.
    Different(char, u32),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CutOff(at) => write!(f, "the recording is cut off at byte {at}"),
            Self::Unknown(at) => write!(f, "no record begins at byte {at}"),
            Self::Lost(count) => write!(f, "{count} records were lost: empty the recorder faster"),
            Self::Plan => f.write_str("the plan in flash is refused"),
            Self::Different(kind, number) => {
                write!(f, "tick {kind} {number} differs from the recording")
            }
        }
    }
}

impl std::error::Error for Error {}

/// Reads records.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn take<const K: usize>(&mut self) -> Result<[u8; K], Error> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let taken = rest.first_chunk::<K>().ok_or(Error::CutOff(self.at))?;
        self.at += K;
        Ok(*taken)
    }

    fn numbers<T: Planned, const K: usize>(&mut self) -> Result<[T; K], Error> {
        let mut out = [T::ZERO; K];
        for x in &mut out {
            *x = T::of(f64::from_bits(u64::from_le_bytes(self.take()?)));
        }
        Ok(out)
    }
}

fn part<T: Copy, const K: usize>(from: &[T], first: usize, zero: T) -> [T; K] {
    let rest = from.get(first..).unwrap_or_default();
    rest.first_chunk().copied().unwrap_or([zero; K])
}

fn inputs<T: Planned>(x: &[T; HEARD]) -> Inputs<T, 12, 4> {
    // Matrices are listed by columns.
    let matrix = Matrix3::from_column_slice(&part::<_, 9>(x, 0, T::ZERO));
    Inputs {
        measured: jump_control::Measurement {
            base: Transform::new(
                Rotation3::from_matrix_unchecked(matrix),
                Vector3::from(part::<_, 3>(x, 9, T::ZERO)),
            ),
            base_velocity: Motion::from_array(part(x, 12, T::ZERO)),
            joints: part(x, 18, T::ZERO),
            joint_velocities: part(x, 30, T::ZERO),
            foot_forces: part(x, 42, T::ZERO),
            age: x[46],
        },
        felt: part(x, 47, T::ZERO),
    }
}

/// Runs the loops on what they heard, and compares what they answer.
///
/// # Errors
/// [`Error`] names the first record that is not as on the board.
pub fn replay<T: Planned>(bytes: &[u8]) -> Result<Replayed, Error>
where
    A1Geared: Model<T, 12>,
{
    let mut workspace = Workspace::new();
    let mut control = Control::<T>::new(&mut workspace).ok_or(Error::Plan)?;
    let mut joints = Joints::<T>::new();
    let mut reader = Reader { bytes, at: 0 };
    let mut found = Replayed::default();
    loop {
        let start = reader.at;
        let [kind] = reader.take()?;
        let number = u32::from_le_bytes(reader.take()?);
        let [control_ticks, joint_ticks] = &mut found.ticks;
        match kind {
            b'c' => {
                control.tick(&inputs(&reader.numbers::<T, HEARD>()?));
                let same = u64::from_le_bytes(reader.take()?) == digest(control.command());
                if !same || number != joints.number {
                    return Err(Error::Different('c', number));
                }
                joints.give(control.command());
                *control_ticks += 1;
            }
            b'j' => {
                let (q, qd) = (reader.numbers()?, reader.numbers()?);
                let same = u64::from_le_bytes(reader.take()?) == digest(&joints.tick(&q, &qd));
                if !same || number != joints.number {
                    return Err(Error::Different('j', *joint_ticks));
                }
                *joint_ticks += 1;
            }
            b'e' if number == 0 => return Ok(found),
            b'e' => return Err(Error::Lost(number)),
            _ => return Err(Error::Unknown(start)),
        }
    }
}
