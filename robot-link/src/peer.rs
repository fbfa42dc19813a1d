//! One end of the link: what it says is numbered, stamped and echoes what it has heard; what it hears is put in order, timed and counted.

use crate::packet::{Echo, Header, Packet, Refusal, decode, encode};

/// The oldest that anything may be, ns: a packet that took longer on its round trip is refused, and after so long a silence nothing is in force.
/// It is the age beyond which the machine does not act on a measurement (`jump_machine::Settings::max_age`): five packets in a row at
/// 500 Hz, ten at 1 kHz.
pub const LIMIT: u64 = 10_000_000;

/// A packet that was heard, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heard<Q> {
    /// What it says.
    pub packet: Q,
    /// Its number.
    pub number: u32,
    /// When it was sent, on the sender's clock, ns.
    pub stamp: u64,
    /// When it came, on this end's clock, ns.
    pub arrived: u64,
    /// Time of the last packet there and of this one back, ns.
    pub round_trip: u64,
}

impl<Q> Heard<Q> {
    /// Its age at the time `now`, ns: the time since it came, and half of the round trip, which is wrong by no more than as much.
    #[must_use]
    pub const fn age(&self, now: u64) -> u64 {
        now.saturating_sub(self.arrived)
            .saturating_add(self.round_trip / 2)
    }
}

/// How many packets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Said.
    pub said: u32,
    /// Heard, new, and in force.
    pub heard: u32,
    /// Numbers that were left out: lost, or to come later and out of order.
    pub missed: u32,
    /// The same once more.
    pub repeated: u32,
    /// Came behind a newer one.
    pub overtaken: u32,
    /// Too long on the way.
    pub late: u32,
    /// Not proven to be an answer to this end: [`Refusal::Unproven`] and [`Refusal::Foreign`].
    pub unproven: u32,
    /// Not a packet of the other end, or not as it was sent.
    pub damaged: u32,
}

/// The newest packet in the sender's order, in force or not: what this end echoes.
#[derive(Clone, Copy, Debug)]
struct Newest {
    number: u32,
    stamp: u64,
    arrived: u64,
}

/// One end of the link, which hears packets `Q`. Times are ns on a clock of its own that only goes forward and does not begin anew with
/// the program; nothing is known of the other end's.
#[derive(Clone, Debug)]
pub struct Peer<Q> {
    newest: Option<Newest>,
    heard: Option<Heard<Q>>,
    tally: Tally,
}

impl<Q: Packet> Peer<Q> {
    /// Nothing heard and nothing said.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            newest: None,
            heard: None,
            tally: Tally {
                said: 0,
                heard: 0,
                missed: 0,
                repeated: 0,
                overtaken: 0,
                late: 0,
                unproven: 0,
                damaged: 0,
            },
        }
    }

    /// Takes bytes that came at the time `now`, ns. What is in force afterwards is [`Peer::in_force`].
    ///
    /// In force is only what echoes a packet of this end, since only that has an age; a packet without an echo is answered with one. After
    /// a silence of [`LIMIT`] numbers may begin anew, as those of a robot do that was switched off and on.
    ///
    /// # Errors
    /// Why these bytes are not in force, which the [tally](Peer::tally) counts.
    pub fn hear(&mut self, bytes: &[u8], now: u64) -> Result<&Heard<Q>, Refusal> {
        let taken = self.take(bytes, now);
        let tally = &mut self.tally;
        let count = match &taken {
            Ok(_) => &mut tally.heard,
            Err(Refusal::Repeated) => &mut tally.repeated,
            Err(Refusal::Overtaken) => &mut tally.overtaken,
            Err(Refusal::Late) => &mut tally.late,
            Err(Refusal::Unproven | Refusal::Foreign) => &mut tally.unproven,
            Err(_) => &mut tally.damaged,
        };
        *count = count.saturating_add(1);
        taken.map(|heard| &*self.heard.insert(heard))
    }

    fn take(&mut self, bytes: &[u8], now: u64) -> Result<Heard<Q>, Refusal> {
        let (header, packet) = decode::<Q>(bytes)?;
        if !packet.is_usable() {
            return Err(Refusal::Number);
        }
        let round_trip = header.echo.map(|echo| round_trip(&echo, now));
        let round_trip = round_trip.transpose()?;
        if round_trip.is_some_and(|time| time > LIMIT) {
            return Err(Refusal::Late);
        }
        if let Some(newest) = &self.newest {
            let silent = now.saturating_sub(newest.arrived) > LIMIT;
            // Numbers go round: what is less than half of them ahead is newer.
            match header.number.wrapping_sub(newest.number).cast_signed() {
                0 if !silent => return Err(Refusal::Repeated),
                ..0 if !silent => return Err(Refusal::Overtaken),
                ..=0 => {}
                ahead => {
                    let missed = ahead.unsigned_abs().saturating_sub(1);
                    self.tally.missed = self.tally.missed.saturating_add(missed);
                }
            }
        }
        let Header { number, stamp, .. } = header;
        self.newest = Some(Newest {
            number,
            stamp,
            arrived: now,
        });
        Ok(Heard {
            packet,
            number,
            stamp,
            arrived: now,
            round_trip: round_trip.ok_or(Refusal::Unproven)?,
        })
    }

    /// The newest packet that was heard, unless that is longer ago than [`LIMIT`].
    #[must_use]
    pub fn in_force(&self, now: u64) -> Option<&Heard<Q>> {
        let fresh = |heard: &&Heard<Q>| now.saturating_sub(heard.arrived) <= LIMIT;
        self.heard.as_ref().filter(fresh)
    }

    /// Writes a packet to the beginning of `out`, with number, stamp and echo; returns its length, or `None` if there is no room for it.
    pub fn say<P: Packet>(&mut self, packet: &P, now: u64, out: &mut [u8]) -> Option<usize> {
        let echo = self.newest.map(|newest| Echo {
            number: newest.number,
            // Rounded down, so that no round trip seems shorter than it is.
            held_us: u32::try_from(now.saturating_sub(newest.arrived) / 1000).unwrap_or(u32::MAX),
            stamp: newest.stamp,
        });
        let header = Header {
            number: self.tally.said,
            stamp: now,
            echo,
        };
        let length = encode(&header, packet, out)?;
        self.tally.said = self.tally.said.wrapping_add(1);
        Some(length)
    }

    /// What was said and heard so far.
    #[must_use]
    pub const fn tally(&self) -> &Tally {
        &self.tally
    }
}

impl<Q: Packet> Default for Peer<Q> {
    fn default() -> Self {
        Self::new()
    }
}

/// Time of what is echoed there and of the echo back, ns.
fn round_trip(echo: &Echo, now: u64) -> Result<u64, Refusal> {
    let held = u64::from(echo.held_us) * 1000;
    let since = now.checked_sub(echo.stamp).ok_or(Refusal::Foreign)?;
    since.checked_sub(held).ok_or(Refusal::Foreign)
}
