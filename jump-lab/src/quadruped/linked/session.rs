//! The controller's end: the jump machine behind a pilot, which is armed as soon as it knows of a robot.

use super::super::execute::{HOLD, Trial, feet};
use super::super::{FOOT_COUNT, JOINTS, Planned};
use super::{Glance, Linked};
use jump_machine::{Jump, Machine, Refusal, Settings};
use jump_planner::robot::Quadruped;
use jump_planner::stored::Stored;
use rbd_core::Transform;
use robot_link::{End, Pilot, Tally, pilot};
use state_est::Estimator;

/// The pilot of a quadruped.
type Quadrupeds<'a> = Pilot<
    'a,
    f64,
    Quadruped,
    Machine<'a, f64, Quadruped, JOINTS, FOOT_COUNT>,
    JOINTS,
    FOOT_COUNT,
    { FOOT_COUNT + 2 },
>;

/// A pilot with one jump.
pub struct Session<'a> {
    pilot: Quadrupeds<'a>,
    jump: Option<Jump<'a, f64, JOINTS, FOOT_COUNT>>,
    /// Time of standing still before the jump, s.
    hold: f64,
    /// When the plan begins, on the machine's clock, s.
    start: Option<f64>,
    refusal: Option<Refusal>,
}

impl Session<'_> {
    /// What a judge sees of it at the time `now`, ns.
    ///
    /// # Errors
    /// Why the machine has refused the jump.
    pub fn glance(&self, now: u64) -> Result<Glance, String> {
        if let Some(refusal) = self.refusal {
            return Err(refusal.to_string());
        }
        let ahead = |start: f64| (1e9 * (start - self.pilot.time(now))).round() as i64;
        Ok(Glance {
            phase: self.pilot.machine.phase(),
            start: self
                .start
                .map(|start| now.saturating_add_signed(ahead(start))),
            fault: self.pilot.machine.fault(),
        })
    }

    /// What was said and heard so far.
    #[must_use]
    pub const fn tally(&self) -> &Tally {
        self.pilot.tally()
    }

    /// Age of the newest state in force and its round trip at the time `now`, ns.
    #[must_use]
    pub fn age(&self, now: u64) -> Option<[u64; 2]> {
        let heard = self.pilot.peer().in_force(now)?;
        Some([heard.age(now), heard.round_trip])
    }
}

impl End for Session<'_> {
    fn hear(&mut self, bytes: &[u8], now: u64) {
        self.pilot.hear(bytes, now);
        if let (true, Some(jump)) = (self.pilot.is_told(), self.jump) {
            let start = self.pilot.time(now) + self.hold;
            match self.pilot.machine.arm(jump, start) {
                Ok(()) => self.start = Some(start),
                Err(refusal) => self.refusal = Some(refusal),
            }
            self.jump = None;
        }
    }

    fn turn(&mut self, now: u64, out: &mut [u8]) -> Option<usize> {
        self.pilot.turn(now, out)
    }
}

/// Prepares the controller of a planned jump, and lends it to `work`.
///
/// # Errors
/// A sentence: the bytes of the plan are refused, or what `work` says.
pub fn prepared(
    planned: &Planned,
    trial: &Trial<'_>,
    linked: Linked,
    work: impl FnOnce(&mut Session<'_>) -> Result<(), String>,
) -> Result<(), String> {
    let (task, robot) = (&planned.task, planned.task.robot);
    let build = robot.build(&task.start);
    let mut settings = Settings::new(&build, robot.feet, robot.drives(), task.start.joints);
    for measure in trial.without {
        measure.leave(&mut settings);
    }
    let stored = Stored::read(&planned.reference.bytes).map_err(|error| error.to_string())?;
    let jump = Jump::stored(&stored).map_err(|error| error.to_string())?;
    let hold = HOLD.max(settings.least_hold(&jump.plan));
    let sensed = feet(&robot);
    let estimator = Estimator {
        feet: sensed.feet,
        imu: Transform::IDENTITY,
        settings: state_est::Settings::new(),
    };
    let mut workspace = jump_machine::Workspace::new();
    let machine = Machine::new(&robot, settings, &mut workspace);
    let known = pilot::Settings {
        base: task.start.base,
        loaded: sensed.loaded,
        turns_per_command: linked.period_ms,
    };
    work(&mut Session {
        pilot: Pilot::new(&robot, estimator, machine, known),
        jump: Some(jump),
        hold,
        start: None,
        refusal: None,
    })
}
