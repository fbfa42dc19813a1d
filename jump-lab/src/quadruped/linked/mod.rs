//! A jump over a [`robot_link`]: the robot's end simulated ([`RobotEnd`]), the controller's end as it would be beside a real one ([`Session`]), and
//! between them nothing but datagrams.
//!
//! Neither end knows what carries them or what time it is: [`fly`] carries them itself in simulated time, and `examples/real_time.rs` over UDP
//! by the clock of the machine it runs on.

mod robot_end;
mod session;
#[cfg(test)]
mod tests;

pub use robot_end::RobotEnd;
pub use session::{Session, prepared};

use super::Planned;
use super::execute::{Run, SETTLE, Trial};
use core::cell::Cell;
use jump_control::{Fault, Phase};
use robot_link::recording::{Error, Recorded, replay};
use robot_link::{End, Tally};
use std::collections::VecDeque;

/// Nanoseconds of a turn of the controller: 1 kHz.
pub const TURN: u64 = 1_000_000;
/// Nanoseconds of a tick of the plant.
const TICK: u64 = 100_000;

/// What a judge of the run sees of the controller, over its shoulder.
#[derive(Clone, Copy, Debug)]
pub struct Glance {
    /// Where the jump is.
    pub phase: Phase,
    /// When its plan begins, on the clock of both ends, ns; none before it is armed.
    pub start: Option<u64>,
    /// Why the machine gave up.
    pub fault: Option<Fault>,
}

impl Glance {
    /// Before the first turn.
    pub const FIRST: Self = Self {
        phase: Phase::Stand,
        start: None,
        fault: None,
    };
}

/// How a link is used, and how it fails.
#[derive(Clone, Copy, Debug)]
pub struct Linked {
    /// Milliseconds between two commands and between two states.
    pub period_ms: u32,
    /// When nothing gets through any more, s of the plan.
    pub cut: Option<f64>,
}

/// A run over a link.
pub struct Flown {
    /// As of any other run.
    pub run: Run,
    /// What the controller's end heard and said.
    pub recording: Vec<u8>,
    /// Of the controller's end and of the robot's.
    pub tallies: [Tally; 2],
    /// Whether the robot's watchdog has tripped.
    pub has_tripped: bool,
}

/// Flies a jump in simulated time; the controller's turns come a third of a millisecond after the robot's.
///
/// # Errors
/// A sentence: the machine refuses the jump, this build lacks the simulator, or that fails.
pub fn fly(planned: &Planned, trial: Trial<'_>, linked: Linked) -> Result<Flown, String> {
    let glance = Cell::new(Glance::FIRST);
    let mut robot = RobotEnd::new(planned, trial, linked)?;
    let end = robot.duration();
    let mut flown = None;
    prepared(planned, &trial, linked, |session| {
        let mut session = Recorded::new(session, 0);
        let (mut up, mut down) = (VecDeque::<Vec<u8>>::new(), VecDeque::<Vec<u8>>::new());
        let mut out = [0; 512];
        for tick in 0..end / TICK {
            let now = tick * TICK;
            while let Some(bytes) = down.pop_front() {
                robot.hear(&bytes, now, &glance.get());
            }
            robot.advance(now, &glance.get(), |bytes| up.push_back(bytes.to_vec()))?;
            if now % TURN == 3 * TICK {
                while let Some(bytes) = up.pop_front() {
                    session.hear(&bytes, now);
                }
                if let Some(length) = session.turn(now, &mut out) {
                    down.push_back(out[..length].to_vec());
                }
                glance.set(session.end().glance(now)?);
            }
        }
        let tally = *session.end().tally();
        flown = Some((session.finish(), tally));
        Ok(())
    })?;
    let (recording, tally) = flown.ok_or("the session was not run")?;
    let (tallies, has_tripped) = ([tally, *robot.tally()], robot.has_tripped());
    Ok(Flown {
        run: robot.finish(),
        recording,
        tallies,
        has_tripped,
    })
}

/// Lets a controller hear again what was recorded of one with the same plan, measures and link; returns how many turns it said the recorded
/// bits in.
///
/// # Errors
/// A sentence: the machine refuses the jump, or what differs first.
pub fn flown_again(
    planned: &Planned,
    trial: &Trial<'_>,
    linked: Linked,
    recording: &[u8],
) -> Result<u32, String> {
    let mut turns = Err(Error::CutOff(0));
    prepared(planned, trial, linked, |session| {
        turns = replay(recording, session);
        Ok(())
    })?;
    turns.map_err(|error| error.to_string())
}

/// How long after its touchdown a jump is looked at, s.
const AFTER: f64 = SETTLE + 0.5;
