//! The robot's end: what its motor boards do, and when they stop doing it.

use jump_control::JointCommand;

use crate::command::Command;
use crate::packet::Refusal;
use crate::peer::{Heard, Peer, Tally};
use crate::state::State;

/// The robot's end of the link with its watchdog.
///
/// Joints are damped until the first command. A robot that was commanded and hears nothing in force for [`LIMIT`](crate::LIMIT), 10 ms, damps them
/// again, says so in its states, and goes on damping whatever comes until it is [reset](Board::reset): a jump that was interrupted is not gone on
/// with from wherever the robot has fallen to.
#[derive(Clone, Debug)]
pub struct Board<const N: usize> {
    peer: Peer<Command<N>>,
    /// Damping of the safe command, N m s/rad.
    damping: f32,
    tripped: bool,
    commanded: bool,
}

impl<const N: usize> Board<N> {
    /// Nothing heard yet; `damping` is that of the safe command, N m s/rad.
    #[must_use]
    pub const fn new(damping: f32) -> Self {
        Self {
            peer: Peer::new(),
            damping,
            tripped: false,
            commanded: false,
        }
    }

    /// Takes bytes that came at the time `now`, ns.
    ///
    /// # Errors
    /// As of [`Peer::hear`].
    pub fn hear(&mut self, bytes: &[u8], now: u64) -> Result<&Heard<Command<N>>, Refusal> {
        // A silence counts also where nobody has asked for a command in it.
        let _ = self.command(now);
        let heard = self.peer.hear(bytes, now)?;
        self.commanded = true;
        Ok(heard)
    }

    /// What the joints are to do at the time `now`, ns.
    pub fn command(&mut self, now: u64) -> JointCommand<f32, N> {
        let in_force = self.peer.in_force(now);
        self.tripped |= self.commanded && in_force.is_none();
        match in_force {
            Some(heard) if self.commanded && !self.tripped => heard.packet.0,
            _ => JointCommand::damp(self.damping),
        }
    }

    /// Writes the robot's state to the beginning of `out`, with whether it has tripped; returns the length, or `None` if there is no room for it.
    pub fn say<const F: usize>(
        &mut self,
        state: &State<N, F>,
        now: u64,
        out: &mut [u8],
    ) -> Option<usize> {
        let tripped = self.tripped;
        self.peer.say(&State { tripped, ..*state }, now, out)
    }

    /// Whether a command has ever been in force.
    #[must_use]
    pub const fn is_commanded(&self) -> bool {
        self.commanded
    }

    /// Whether it has heard nothing for too long since it was reset.
    #[must_use]
    pub const fn has_tripped(&self) -> bool {
        self.tripped
    }

    /// Waits for a first command again: what an operator does beside the robot.
    pub const fn reset(&mut self) {
        (self.tripped, self.commanded) = (false, false);
    }

    /// What was said and heard so far.
    #[must_use]
    pub const fn tally(&self) -> &Tally {
        self.peer.tally()
    }
}
