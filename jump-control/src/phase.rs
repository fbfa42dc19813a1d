//! The phases of a jump and what leads from one to the next, as one table.

/// Where a jump is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Standing at the first node of the plan, before the start.
    Hold,
    /// Pushing off: the stance phases of the plan.
    Stance,
    /// In the air, on the way to the pre-landing posture; contact is not looked for.
    Flight,
    /// In the air, holding the pre-landing posture and waiting for the ground.
    PreLanding,
    /// On the ground again, taking up the impact.
    Landing,
    /// At rest.
    Stand,
    /// Something is wrong: joints are damped and nothing else.
    Abort,
}

impl Phase {
    /// All phases, in the order of a jump.
    pub const ALL: [Self; 7] = [
        Self::Hold,
        Self::Stance,
        Self::Flight,
        Self::PreLanding,
        Self::Landing,
        Self::Stand,
        Self::Abort,
    ];
}

/// What may happen in one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A plan has been accepted.
    Armed,
    /// The robot is not where the plan begins.
    Misplaced,
    /// The order to jump.
    Start,
    /// The plan's last stance phase is over.
    Takeoff,
    /// The pre-landing posture begins (`T_posing`).
    Posing,
    /// A foot touches the ground at or after `T_posing`.
    Touchdown,
    /// The body is not tilted, low in speed, and has been so for a while.
    Settled,
    /// A stood robot was pushed.
    Disturbed,
    /// No ground long after the planned touchdown.
    Overdue,
    /// A measurement or a command is unusable.
    Fault,
}

/// Every transition there is: in this phase, upon this event, go there. Other events change nothing.
pub const TRANSITIONS: [(Phase, Event, Phase); 16] = [
    (Phase::Stand, Event::Armed, Phase::Hold),
    (Phase::Hold, Event::Misplaced, Phase::Stand),
    (Phase::Hold, Event::Start, Phase::Stance),
    (Phase::Stance, Event::Takeoff, Phase::Flight),
    (Phase::Flight, Event::Posing, Phase::PreLanding),
    (Phase::PreLanding, Event::Touchdown, Phase::Landing),
    (Phase::PreLanding, Event::Overdue, Phase::Abort),
    (Phase::Landing, Event::Settled, Phase::Stand),
    (Phase::Landing, Event::Overdue, Phase::Abort),
    (Phase::Stand, Event::Disturbed, Phase::Landing),
    (Phase::Hold, Event::Fault, Phase::Abort),
    (Phase::Stance, Event::Fault, Phase::Abort),
    (Phase::Flight, Event::Fault, Phase::Abort),
    (Phase::PreLanding, Event::Fault, Phase::Abort),
    (Phase::Landing, Event::Fault, Phase::Abort),
    (Phase::Stand, Event::Fault, Phase::Abort),
];

/// The phase after an event.
#[must_use]
pub fn next_phase(phase: Phase, event: Event) -> Phase {
    let row = TRANSITIONS
        .iter()
        .find(|(from, on, _)| *from == phase && *on == event);
    row.map_or(phase, |(_, _, to)| *to)
}

#[cfg(test)]
mod tests {
    use super::{Event, Phase, TRANSITIONS, next_phase};

    #[test]
    fn a_jump_walks_through_its_phases() {
        let events = [
            Event::Start,
            Event::Takeoff,
            Event::Posing,
            Event::Touchdown,
            Event::Settled,
        ];
        let end =
            events
                .iter()
                .zip(Phase::ALL.iter().skip(1))
                .fold(Phase::Hold, |phase, (e, to)| {
                    assert_eq!(next_phase(phase, *e), *to);
                    *to
                });
        assert_eq!(end, Phase::Stand);
    }

    #[test]
    fn the_table_has_no_two_answers_every_fault_aborts_and_abort_is_final() {
        for (i, (from, event, _)) in TRANSITIONS.iter().enumerate() {
            assert!(
                !TRANSITIONS
                    .iter()
                    .skip(i + 1)
                    .any(|(f, e, _)| f == from && e == event)
            );
            assert_ne!(*from, Phase::Abort);
        }
        for phase in Phase::ALL {
            assert_eq!(next_phase(phase, Event::Fault), Phase::Abort);
        }
        // Contact during the push-off or the early flight is no landing.
        for phase in [Phase::Stance, Phase::Flight] {
            assert_eq!(next_phase(phase, Event::Touchdown), phase);
        }
    }
}
