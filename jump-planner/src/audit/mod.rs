//! Whether a plan is one: an independent check of a stored plan.
//!
//! The planner's rows hold at the middle of its intervals, in its own transcription. Here the robot moves by the forward dynamics of
//! `rbd-core` instead, in steps of 0.5 ms and the fourth order under the plan's torques as they are held, with the feet that stand rolling on
//! their balls, and every limit is looked at every 0.25 ms. Two integrations:
//!
//! - the flight, from the planned take-off to the touchdown in one piece: nothing corrects it, as nothing can in the air;
//! - every interval from its own node, for the limits: an open-loop stance on two feet is unstable, and what is asked is whether a robot
//!   that is on the plan keeps its limits between nodes.

mod clearance;
mod forward;
mod interval;
mod limits;
mod motion;
mod values;

use crate::robot::{JOINTS, LEGS, Quadruped, State};
use crate::stored::Stored;
pub(crate) use clearance::Overlap;
use forward::{Forward, Velocity};
use interval::{Interval, Watched};
use jump_control::container::PlanNode;
use limits::Limits;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use serde_json::{Value, json};
pub use values::check as check_values;

/// Step of the integration, s.
const STEP: f64 = 5e-4;
/// More than rounding makes of a time that is stored in single precision, and less than any interval, s.
const ROUNDING: f64 = 5e-5;
/// Largest orientation error after the flight, rad.
const ORIENTATION: f64 = 2.0 * core::f64::consts::PI / 180.0;
/// Largest position error after the flight, m.
const POSITION: f64 = 0.01;
/// Largest difference of an integrated interval from the next node, m or rad, and m/s or rad/s: transcriptions differ by a tenth of that.
const DEFECT: [f64; 2] = [5e-3, 0.5];
/// Largest difference of a force from that of the robot on its feet in the middle of the interval, as a share of the largest normal force.
const FORCE: f64 = 0.02;
/// How far a limit may be exceeded between nodes, as a share of its range.
const BEYOND: f64 = 0.01;
/// How deep links may be in the ground or in each other between nodes, m.
const DEEPEST: f64 = 1e-3;

/// What a margin is one of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// Range of a joint.
    Position,
    /// Speed of a joint.
    Speed,
    /// Torque of a joint at its speed.
    Torque,
    /// Friction cone of a foot.
    Friction,
    /// A foot that stands pushes.
    NormalForce,
    /// Height over the ground of a foot, a knee or the trunk.
    Height,
    /// Gap of a link to the ground.
    Ground,
    /// Gap of a link to the rest of the robot.
    Robot,
}

impl Limit {
    /// Whether it is a gap between shapes, which a plan may lack and be a motion all the same.
    pub(crate) const fn is_gap(self) -> bool {
        matches!(self, Self::Ground | Self::Robot)
    }
}

/// The smallest distance from one limit over the whole plan.
#[derive(Clone, Debug)]
pub struct Margin {
    /// Its kind.
    pub limit: Limit,
    /// Which limit, of which joint or foot.
    pub name: String,
    /// Distance as a share of the limit's range; negative beyond it.
    pub value: f64,
    /// When, s.
    pub time: f64,
}

/// What an audit found.
#[derive(Clone, Debug)]
pub struct Audit {
    /// Checksum of the container that was audited.
    pub checksum: u32,
    /// Angle between the planned and the integrated base at touchdown, rad.
    pub flight_orientation_error: f64,
    /// Distance between them, m.
    pub flight_position_error: f64,
    /// Time for which each joint's torque is at its limit, s.
    pub saturation: [f64; JOINTS],
    /// Time for which any joint's is, s.
    pub any_saturation: f64,
    /// Largest difference of an integrated interval from the next node: base or joint position, m or rad, and velocity.
    pub defect: [f64; 2],
    /// Largest difference of a stored force from that of the robot under the stored torques, as a share of the largest normal force.
    pub force_error: f64,
    /// All limits, the worst first.
    pub margins: Vec<Margin>,
    /// Shapes of the robot that pass through each other by more than a plan may, the deepest first.
    pub(crate) overlaps: Vec<Overlap>,
    /// What heights and gaps are shares of, m.
    leg_length: f64,
}

impl Audit {
    /// Audits a stored plan of this robot.
    ///
    /// # Errors
    /// A plan without nodes, without a flight, or with an interval that is none.
    pub fn of(robot: &Quadruped, plan: &Stored<'_>) -> Result<Self, String> {
        let nodes: Vec<_> = plan.nodes().filter(|node| node.time >= 0.0).collect();
        let takeoff = f64::from(plan.header().takeoff);
        let start = nodes.first().map(|node| state(node).0).ok_or("no nodes")?;
        let limits = Limits::new(robot, plan.header(), &start);
        let intervals = Interval::all(plan, &nodes)?;
        let in_flight = |interval: &&Interval<'_>| interval.time() >= takeoff - ROUNDING;
        // No interval knows of another, so that as many are watched at once as the machine has cores.
        let (landed, watched) = rayon::join(
            || flown(robot, intervals.iter().filter(in_flight)),
            || {
                let watch = |forward: &mut Forward<'_>, interval: &Interval<'_>| {
                    interval.watch(forward, &limits)
                };
                let all = intervals.par_iter();
                all.map_init(|| Forward::new(robot), watch)
                    .collect::<Vec<_>>()
            },
        );
        let landed = landed.ok_or("the plan has no flight")?;
        let mut found = Watched::new(&limits);
        watched.iter().for_each(|interval| found.merge(interval));
        let end = nodes.last().map(|node| state(node).0).ok_or("no nodes")?;
        let turn = end.base.rotation.inverse() * landed.base.rotation;
        let mut margins = limits.margins(&found);
        margins.retain(|margin| margin.value.is_finite());
        margins.sort_by(|a, b| a.value.total_cmp(&b.value));
        let mut overlaps = found.overlaps;
        overlaps.retain(|overlap| overlap.gap < -DEEPEST);
        overlaps.sort_by(|a, b| a.gap.total_cmp(&b.gap));
        Ok(Self {
            checksum: plan.checksum(),
            flight_orientation_error: so3::log(&turn).norm(),
            flight_position_error: (end.base.translation - landed.base.translation).norm(),
            saturation: found.saturation,
            any_saturation: found.any_saturation,
            defect: found.defect,
            force_error: found.force_error,
            margins,
            overlaps,
            leg_length: robot.leg_length,
        })
    }

    /// Of a true motion with these margins.
    #[cfg(test)]
    pub(crate) fn with_margins(margins: Vec<Margin>) -> Self {
        Self {
            checksum: 0,
            flight_orientation_error: 0.0,
            flight_position_error: 0.0,
            saturation: [0.0; JOINTS],
            any_saturation: 0.0,
            defect: [0.0; 2],
            force_error: 0.0,
            margins,
            overlaps: Vec::new(),
            leg_length: 1.0,
        }
    }

    /// Whether the plan may be called solved.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.exceeded()
            .is_some_and(|mut beyond| beyond.next().is_none())
    }

    /// Whether the robot could move so if its links passed through the ground and each other. A plan that only fails there is worth a
    /// simulation, which shows what comes of it.
    #[must_use]
    pub fn is_a_motion(&self) -> bool {
        self.exceeded()
            .is_some_and(|mut beyond| beyond.all(|margin| margin.limit.is_gap()))
    }

    /// The limits that are exceeded; none is told of a plan that is not true to the dynamics.
    pub(crate) fn exceeded(&self) -> Option<impl Iterator<Item = &Margin>> {
        let is_true = self.flight_orientation_error <= ORIENTATION
            && self.flight_position_error <= POSITION
            && self.agrees();
        is_true.then(|| self.beyond())
    }

    /// The margins that are too far below zero.
    fn beyond(&self) -> impl Iterator<Item = &Margin> {
        let deepest = DEEPEST / self.leg_length;
        self.margins.iter().filter(move |margin| {
            let most = if margin.limit.is_gap() {
                deepest
            } else {
                BEYOND
            };
            margin.value < -most
        })
    }

    /// Whether the nodes are those of one motion, and the forces those that move it.
    fn agrees(&self) -> bool {
        self.defect[0] <= DEFECT[0] && self.defect[1] <= DEFECT[1] && self.force_error <= FORCE
    }

    /// What was found, in a line.
    pub fn summary(&self) -> String {
        let worst = self.margins.first().map_or_else(String::new, |m| {
            format!(
                ", worst margin {} {:.4} at {:.3} s",
                m.name, m.value, m.time
            )
        });
        format!(
            "flight error {:.2} deg and {:.1} mm, torque saturation {:.1} ms{worst}",
            self.flight_orientation_error.to_degrees(),
            self.flight_position_error * 1e3,
            self.any_saturation * 1e3
        )
    }

    /// Why the plan does not pass.
    #[must_use]
    pub fn complaint(&self) -> String {
        let mut told = Vec::new();
        // Not <=: NaN is no agreement either.
        if !(self.flight_orientation_error <= ORIENTATION && self.flight_position_error <= POSITION)
        {
            told.push(format!(
                "the flight ends {:.2} deg and {:.1} mm off",
                self.flight_orientation_error.to_degrees(),
                self.flight_position_error * 1e3
            ));
        }
        if !self.agrees() {
            told.push(format!(
                "nodes and forces are not those of one motion: they differ by {:.1e} m or rad, {:.1e} m/s or rad/s and {:.0} % of the largest force",
                self.defect[0],
                self.defect[1],
                100.0 * self.force_error
            ));
        }
        told.extend(self.beyond().map(|m| {
            if m.limit.is_gap() {
                let deep = -1e3 * m.value * self.leg_length;
                let through = m.name.replace(" to ", " passes through ");
                return format!("{through} by {deep:.0} mm at {:.3} s", m.time);
            }
            format!(
                "{} exceeds its limit by {:.1} % of its range at {:.3} s",
                m.name,
                -100.0 * m.value,
                m.time
            )
        }));
        told.join("; ")
    }

    /// The object of `--json`.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "crc32": self.checksum,
            "flight_orientation_error_deg": self.flight_orientation_error.to_degrees(),
            "flight_position_error_m": self.flight_position_error,
            "torque_saturation_ms": self.any_saturation * 1e3,
            "worst_margin": self.margins.first().map(|m| json!({ "name": m.name, "value": m.value })),
        })
    }

    /// Everything that was found.
    #[must_use]
    pub fn details(&self, robot: &Quadruped) -> Value {
        let mut details = self.json();
        let names = (0..JOINTS).map(|i| crate::stored::joint_name(robot, i));
        let saturation = names.zip(self.saturation.map(|t| json!(t * 1e3)));
        details["torque_saturation_by_joint_ms"] = Value::Object(saturation.collect());
        details["interval_defect"] = json!({
            "position": self.defect[0],
            "velocity": self.defect[1],
        });
        details["force_error"] = json!(self.force_error);
        let row = |m: &Margin| json!({ "name": m.name, "value": m.value, "time_s": m.time });
        details["margins"] = self.margins.iter().map(row).collect();
        details
    }
}

/// Where the robot is after these intervals in one piece, from the first one's node on; none if there are none.
fn flown<'a>(
    robot: &Quadruped,
    intervals: impl Iterator<Item = &'a Interval<'a>>,
) -> Option<State> {
    let mut forward = Forward::new(robot);
    let mut at = None;
    for interval in intervals {
        let (q, v) = at.get_or_insert_with(|| interval.start());
        for _ in 0..interval.held.steps {
            interval.held.step(&mut forward, q, v);
        }
    }
    at.map(|(q, _)| q)
}

/// Configuration and velocity at a node.
fn state(node: &PlanNode<JOINTS, LEGS>) -> (State, Velocity) {
    crate::state(&node.node())
}
