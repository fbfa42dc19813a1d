//! How the time of a plan is cut into intervals: short ones where the motion is fast.

use super::FOOT_COUNT;
use super::task::{SrbPlan, Task};
use wb_opt::Phase;

/// Length of the intervals that the weights of tasks are for, s, and the longest one where the motion is fast. With twice the length throughout,
/// plans pass their audit, but fewer of them survive the lab.
const FAST_DT: f64 = 0.005;
/// Longest interval where forces hardly change, s: in the crouch and in flight.
const SLOW_DT: f64 = 0.01;
/// Share of the first phase, at its end, in which the robot pushes off.
const PUSHING: f64 = 0.4;
/// Share of the flight, at its beginning, in which the legs are drawn up: in long intervals a light shank would turn faster between nodes than
/// it may.
const LEAVING: f64 = 0.3;
/// Farthest that a plan turns in a long interval of its flight, rad: what its end is wrong by grows with the square of that, to 1 degree of
/// two turns.
const MOST_TURN: f64 = 0.08;

/// How long the intervals of a plan are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lengths {
    /// At most this many times as long as they are where the motion is fast, throughout.
    Even(f64),
    /// The first phase and the last one are in two parts each, of which the slow one has longer intervals: the robot crouches and pushes
    /// off, draws up its legs and flies.
    Graded,
}

/// A part of a task's time with intervals of one length.
struct Part {
    contacts: [bool; FOOT_COUNT],
    duration: f64,
    /// Longest interval, s.
    longest: f64,
}

impl Part {
    /// On this many intervals.
    fn phase(&self, intervals: usize) -> Phase<f64, FOOT_COUNT> {
        let dt = self.duration / intervals as f64;
        Phase {
            contacts: self.contacts,
            intervals,
            dt,
            weight: dt / FAST_DT,
        }
    }
}

impl Lengths {
    /// The phases of a task, or their parts, in order.
    pub(crate) fn phases(self, task: &Task, srb: &SrbPlan) -> Vec<Phase<f64, FOOT_COUNT>> {
        let parts = self.parts(task, srb).into_iter().map(|part| {
            let intervals = (part.duration / part.longest).ceil().max(1.0);
            part.phase(intervals as usize)
        });
        parts.collect()
    }

    /// As [`Lengths::phases`], with so many intervals in every part.
    pub(crate) fn phases_of(
        self,
        task: &Task,
        srb: &SrbPlan,
        intervals: &[usize],
    ) -> Vec<Phase<f64, FOOT_COUNT>> {
        let parts = self.parts(task, srb);
        let phases = parts.iter().zip(intervals);
        phases.map(|(part, count)| part.phase(*count)).collect()
    }

    fn parts(self, task: &Task, srb: &SrbPlan) -> Vec<Part> {
        let phases = task.problem.used_phases();
        let durations = srb.stages.first().map(|stage| stage.state.durations);
        let last = phases.len().saturating_sub(1);
        let phases = phases.iter().zip(durations.into_iter().flatten());
        let parts = phases.enumerate().flat_map(|(i, (phase, duration))| {
            let part = |share: f64, longest: f64| Part {
                contacts: phase.contacts,
                duration: share * duration,
                longest,
            };
            match self {
                Self::Even(times) => vec![part(1.0, times * FAST_DT)],
                Self::Graded if i == 0 => {
                    vec![part(1.0 - PUSHING, SLOW_DT), part(PUSHING, FAST_DT)]
                }
                Self::Graded if i == last => {
                    let flying = SLOW_DT.min(MOST_TURN * duration / task.problem.angle.abs());
                    let leaving = part(LEAVING, FAST_DT.min(flying));
                    vec![leaving, part(1.0 - LEAVING, flying)]
                }
                Self::Graded => vec![part(1.0, FAST_DT)],
            }
        });
        parts.collect()
    }

    /// The phases of a task that these parts are of, with the mean length of their intervals.
    pub(crate) fn whole(
        self,
        task: &Task,
        parts: &[Phase<f64, FOOT_COUNT>],
    ) -> Vec<Phase<f64, FOOT_COUNT>> {
        let count = task.problem.used_phases().len();
        let mut rest = parts;
        let phases = (0..count).map(|i| {
            let is_split = self == Self::Graded && (i == 0 || i + 1 == count);
            let (parts, others) = rest.split_at(if is_split { 2 } else { 1 });
            rest = others;
            let intervals = parts.iter().map(|part| part.intervals).sum();
            let duration: f64 = parts.iter().map(|p| p.dt * p.intervals as f64).sum();
            Phase {
                intervals,
                dt: duration / intervals as f64,
                ..parts[0]
            }
        });
        phases.collect()
    }
}
