//! A flight again, on a host, from what the flight recorder wrote.

use std::fmt;

use saltus_probe::Real;
use saltus_probe::flight::digest;

use crate::control::{Control, Heard};

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

impl core::error::Error for Error {}

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

    /// What `make` makes of the numbers that follow.
    fn numbers<T: Real, O>(
        &mut self,
        make: impl FnOnce(&mut dyn FnMut() -> T) -> O,
    ) -> Result<O, Error> {
        let mut failure = None;
        let made = make(&mut || match self.take() {
            Ok(bytes) => T::of(f64::from_bits(u64::from_le_bytes(bytes))),
            Err(error) => {
                failure.get_or_insert(error);
                T::ZERO
            }
        });
        failure.map_or(Ok(made), Err)
    }
}

/// Runs the loops on what they heard, and compares what they answer.
///
/// # Errors
/// [`Error`] names the first record that is not as on the board.
pub fn replay<T: Real, C: Control<T, N>, const N: usize>(bytes: &[u8]) -> Result<Replayed, Error> {
    let mut control = C::new(Box::leak(Box::new(C::memory()))).ok_or(Error::Plan)?;
    let mut joints = C::joints();
    let mut reader = Reader { bytes, at: 0 };
    let mut found = Replayed::default();
    loop {
        let start = reader.at;
        let [kind] = reader.take()?;
        let number = u32::from_le_bytes(reader.take()?);
        let [control_ticks, joint_ticks] = &mut found.ticks;
        match kind {
            b'c' => {
                control.tick(&reader.numbers(|next| C::Heard::read(next))?);
                let same = u64::from_le_bytes(reader.take()?) == digest(control.command());
                if !same || number != joints.number {
                    return Err(Error::Different('c', number));
                }
                joints.give(control.command());
                *control_ticks += 1;
            }
            b'j' => {
                let mut numbers = || reader.numbers(|next| core::array::from_fn(|_| next()));
                let (q, qd): ([T; N], [T; N]) = (numbers()?, numbers()?);
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
