//! The verdict on a run: was it flown as planned, does the robot stand where it should, and did its hardware stay whole.
//!
//! It is the only judge: exit codes, tables, studies and tests ask nothing else. Limits stand here and in the robot's
//! [`Budgets`](rbd_core::Budgets), and were fixed before anything was measured by them. What failed is listed in the order in which it
//! happened, since what comes later is often its consequence.

mod hardware;
mod json;

pub use hardware::{Found, Hardware, Stage, Tick};

/// Largest distance of the centre of mass from the plan at the planned touchdown, and of the feet's middle from the goal's, m.
const PLACE: f64 = 0.10;
/// Largest angle from the plan at the planned touchdown, and from the goal in the end, degrees.
const ANGLE: f64 = 10.0;
/// Largest difference of the base's height from the goal's in the end, m.
const HEIGHT: f64 = 0.05;

/// How far a run may be from its plan and its goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Of the centre of mass at the planned touchdown, m.
    pub position: f64,
    /// Of the feet's middle in the end, m.
    pub feet: f64,
    /// Of the base's height in the end, m.
    pub height: f64,
    /// Of every angle, degrees.
    pub angle: f64,
}

impl Limits {
    /// For jumps of decimetres from place to place.
    pub const GENERAL: Self = Self {
        position: PLACE,
        feet: PLACE,
        height: HEIGHT,
        angle: ANGLE,
    };
}

/// Tilt from which the robot lies, degrees.
pub const FALLEN: f64 = 45.0;

/// At the planned touchdown, beside the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// When, s.
    pub time: f64,
    /// Distance of the centre of mass, m.
    pub position: f64,
    /// Angle of the whole rotation, degrees.
    pub rotation: f64,
    /// Largest difference of a joint, degrees; not judged, since legs reach for the ground by the capture point.
    pub joints: f64,
}

/// Two seconds after the touchdown, beside the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// When, s.
    pub time: f64,
    /// Horizontal distance of the feet's middle, m.
    pub feet: f64,
    /// Angle of the heading, degrees.
    pub heading: f64,
    /// Difference of the base's height, m.
    pub height: f64,
    /// Angle of the whole rotation, degrees.
    pub rotation: f64,
    /// On its feet, by the machine's word and the body's tilt.
    pub upright: bool,
}

/// Something that is not as it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// When it was so for the first time, s.
    pub time: f64,
    /// What, as in the verdict's JSON: `flight.rotation_deg`.
    pub name: String,
    /// What was found, for people.
    pub found: String,
}

impl Failure {
    /// A failure.
    pub fn new(time: f64, name: impl Into<String>, found: impl Into<String>) -> Self {
        Self {
            time,
            name: name.into(),
            found: found.into(),
        }
    }
}

/// The verdict on one run.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// `None` where the run ended before.
    pub flight: Option<Flight>,
    /// `None` where the run ended before.
    pub stand: Option<Stand>,
    /// What was asked of the hardware.
    pub hardware: hardware::Found,
    /// Everything that fails, first things first; nothing on target.
    pub failures: Vec<Failure>,
}

impl Verdict {
    /// Judges; `gravest` are failures that the caller knows of, such as a fault of the machine or a ground that never came.
    #[must_use]
    pub fn new(
        flight: Option<Flight>,
        stand: Option<Stand>,
        hardware: hardware::Found,
        gravest: Vec<Failure>,
    ) -> Self {
        Self::within(&Limits::GENERAL, flight, stand, hardware, gravest)
    }

    /// As [`new`](Self::new), with the limits of another kind of jump.
    #[must_use]
    pub fn within(
        limits: &Limits,
        flight: Option<Flight>,
        stand: Option<Stand>,
        hardware: hardware::Found,
        gravest: Vec<Failure>,
    ) -> Self {
        let mut failures = gravest;
        failures.extend(hardware.exceeded.iter().cloned());
        let mut judge = |time: f64, name: &str, value: f64, most: f64, unit: &str| {
            if value > most || value.is_nan() {
                failures.push(Failure::new(
                    time,
                    name,
                    format!("{value:.3} of {most} {unit}"),
                ));
            }
        };
        if let Some(f) = &flight {
            judge(
                f.time,
                "flight.position_m",
                f.position,
                limits.position,
                "m",
            );
            judge(
                f.time,
                "flight.rotation_deg",
                f.rotation,
                limits.angle,
                "deg",
            );
        }
        if let Some(s) = &stand {
            judge(s.time, "stand.feet_m", s.feet, limits.feet, "m");
            judge(s.time, "stand.heading_deg", s.heading, limits.angle, "deg");
            judge(s.time, "stand.height_m", s.height, limits.height, "m");
            judge(
                s.time,
                "stand.rotation_deg",
                s.rotation,
                limits.angle,
                "deg",
            );
        }
        if let Some(fallen) = stand.filter(|stand| !stand.upright) {
            failures.push(Failure::new(fallen.time, "stand.upright", "fell"));
        }
        failures.sort_by(|a, b| a.time.total_cmp(&b.time));
        Self {
            flight,
            stand,
            hardware,
            failures,
        }
    }

    /// Nothing failed.
    #[must_use]
    pub fn on_target(&self) -> bool {
        self.failures.is_empty()
    }

    /// What failed first, in a word: `stand.feet_m`, or `target` where nothing did.
    #[must_use]
    pub fn outcome(&self) -> &str {
        self.failures
            .first()
            .map_or(TARGET, |failure| &failure.name)
    }

    /// On target, or what failed first.
    #[must_use]
    pub fn first(&self) -> String {
        self.failures.first().map_or_else(
            || "on target".to_owned(),
            |x| format!("NO: {}: {} at {:.3} s", x.name, x.found, x.time),
        )
    }

    /// The robot stands in the end, wherever that is.
    #[must_use]
    pub fn stands(&self) -> bool {
        self.stand.is_some_and(|stand| stand.upright)
    }
}

/// The outcome where nothing failed.
pub const TARGET: &str = "target";

#[cfg(test)]
mod tests {
    use super::hardware::Found;
    use super::{Failure, Flight, Stand, Verdict};

    const FLIGHT: Flight = Flight {
        time: 0.7,
        position: 0.05,
        rotation: 5.0,
        joints: 90.0,
    };
    const STAND: Stand = Stand {
        time: 2.7,
        feet: 0.05,
        heading: 5.0,
        height: 0.01,
        rotation: 5.0,
        upright: true,
    };

    fn outcome(flight: Flight, stand: Stand, gravest: &[Failure]) -> String {
        let verdict = Verdict::new(
            Some(flight),
            Some(stand),
            Found::default(),
            gravest.to_vec(),
        );
        assert_eq!(verdict.on_target(), verdict.outcome() == "target");
        verdict.outcome().to_owned()
    }

    /// Each limit fails on its own, and what is not a number fails.
    #[test]
    fn every_measure_can_say_no() {
        assert_eq!(outcome(FLIGHT, STAND, &[]), "target");
        let bad = [0.11, f64::NAN];
        for x in bad {
            assert_eq!(
                outcome(
                    Flight {
                        position: x,
                        ..FLIGHT
                    },
                    STAND,
                    &[]
                ),
                "flight.position_m"
            );
            assert_eq!(
                outcome(FLIGHT, Stand { feet: x, ..STAND }, &[]),
                "stand.feet_m"
            );
            assert_eq!(
                outcome(FLIGHT, Stand { height: x, ..STAND }, &[]),
                "stand.height_m"
            );
            let angle = 100.0 * x;
            assert_eq!(
                outcome(
                    Flight {
                        rotation: angle,
                        ..FLIGHT
                    },
                    STAND,
                    &[]
                ),
                "flight.rotation_deg"
            );
            assert_eq!(
                outcome(
                    FLIGHT,
                    Stand {
                        heading: angle,
                        ..STAND
                    },
                    &[]
                ),
                "stand.heading_deg"
            );
            assert_eq!(
                outcome(
                    FLIGHT,
                    Stand {
                        rotation: angle,
                        ..STAND
                    },
                    &[]
                ),
                "stand.rotation_deg"
            );
        }
        assert_eq!(
            outcome(
                FLIGHT,
                Stand {
                    upright: false,
                    ..STAND
                },
                &[]
            ),
            "stand.upright"
        );
    }

    #[test]
    fn what_happened_first_is_named_first() {
        let fault = Failure::new(1.0, "fault", "stale");
        let off = Flight {
            rotation: 20.0,
            ..FLIGHT
        };
        let far = Stand { feet: 1.0, ..STAND };
        assert_eq!(
            outcome(off, far, core::slice::from_ref(&fault)),
            "flight.rotation_deg"
        );
        assert_eq!(outcome(FLIGHT, far, &[fault]), "fault");
    }
}
