//! The landings that paper A shows: Fig. 10 and 11 with the forces that the landing's program commands, and Remark 2.

use super::Row;
use super::quadruped::outcome;
use crate::Sim;
use crate::quadruped::execute::Run;
use crate::quadruped::judge::{Judged, tilt};
use crate::quadruped::log::Sample;
use crate::quadruped::{FOOT_COUNT, Planned};
use jump_planner::task::Task;
use landing::Settings;

/// Largest joint error that counts as tracked, degrees.
const TRACKED: f64 = 10.0;
/// Time after the first contact at which the body must be where it stays, s.
const RECOVERED: f64 = 1.0;
/// Largest tilt and error of the height then: degrees, m.
const UP: [f64; 2] = [10.0, 0.05];
/// How far rounding leaves a cone, N.
const ROUNDING: f64 = 1e-6;

/// What the landing's program commanded over a run.
struct Commands {
    /// Ticks with a command, and those whose forces leave the pyramid of friction or the limit of a foot.
    ticks: [usize; 2],
    /// Largest total force, N.
    peak: f64,
    failures: u64,
}

impl Commands {
    fn of(task: &Task, run: &Run) -> Self {
        let settings = Settings::<f64>::new(&task.robot.build(&task.start));
        let (mut ticks, mut peak) = ([0; 2], 0.0);
        for s in &run.samples {
            let total: f64 = s.commanded_forces_w.iter().map(|f| f.z).sum();
            if total <= 0.0 {
                continue;
            }
            peak = f64::max(peak, total);
            let inside = s.commanded_forces_w.iter().all(|f| {
                let cone = settings.friction * f.z + ROUNDING;
                f.x.abs() <= cone
                    && f.y.abs() <= cone
                    && (-ROUNDING..=settings.max_normal_force + ROUNDING).contains(&f.z)
            });
            ticks = [ticks[0] + 1, ticks[1] + usize::from(!inside)];
        }
        Self {
            ticks,
            peak,
            failures: run.qp_failures,
        }
    }

    /// Every command could be given.
    fn are_reasonable(&self) -> bool {
        self.ticks[0] > 0 && self.ticks[1] == 0 && self.failures == 0
    }

    fn words(&self) -> String {
        let [ticks, outside] = self.ticks;
        format!(
            "{ticks} ticks of force commands up to {:.0} N, {outside} outside of their limits, {} failed",
            self.peak, self.failures
        )
    }
}

/// Fig. 10: how joints follow through the diagonal jump, and what the landing commands.
pub(super) fn tracked(task: &Task, run: &Run, sim: Sim) -> Row {
    let (error, commands) = (tracking(run), Commands::of(task, run));
    Row::new(
        'A',
        "Fig. 10: diagonal jump, joint errors and force commands",
        "high tracking performance; the landing handles the impact",
    )
    .simulated(sim)
    .ours(
        format!("joints within {error:.1}° before contact; {}", commands.words()),
        error <= TRACKED && commands.are_reasonable(),
        "holds when no joint is more than 10° off its plan before the first contact and every force command is inside friction and limits",
    )
}

/// Fig. 11: what the landing commands after the barrel roll, and how the body recovers.
pub(super) fn recovered(task: &Task, run: &Run, sim: Sim) -> Row {
    let commands = Commands::of(task, run);
    let row = Row::new(
        'A',
        "Fig. 11: barrel roll off 0.4 m, force commands and recovery",
        "reasonable force command; position and orientation recover",
    )
    .simulated(sim);
    let later = |s: &&Sample| run.first_contact.is_some_and(|t| s.time >= t + RECOVERED);
    let height = task.start.base.translation.z + task.goal.z;
    let after = run.samples.iter().filter(later);
    let worst = after.fold([0.0; 2], |[tilted, off], s| {
        [
            f64::max(tilted, tilt(s)),
            f64::max(off, (s.position.z - height).abs()),
        ]
    });
    let landed = run.first_contact.is_some();
    row.ours(
        format!(
            "{}; from 1 s after the contact on tilted by at most {:.1}°, {:.3} m off its height",
            commands.words(),
            worst[0],
            worst[1]
        ),
        landed && commands.are_reasonable() && worst[0] <= UP[0] && worst[1] <= UP[1],
        "holds when every force command is inside friction and limits, and from 1 s after the contact on the body stays within 10° of level and 0.05 m of its height",
    )
}

/// Remark 2: feet that land at different times.
pub(super) fn swing_legs(jump: &Planned, run: &Run, judged: &Judged, sim: Sim) -> Row {
    let after = run
        .samples
        .iter()
        .filter(|s| s.time > jump.reference.takeoff + 0.1);
    let lands = |foot: usize| {
        after
            .clone()
            .find(|s| s.forces_w[foot].norm() > 1.0)
            .map(|s| s.time)
    };
    let times: Vec<f64> = (0..FOOT_COUNT).filter_map(lands).collect();
    let first = times.iter().copied().fold(f64::INFINITY, f64::min);
    let last = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Row::new(
        'A',
        "Remark 2: legs in the air wait in their posture while others have landed, double backflip",
        "feet do not land at once",
    )
    .simulated(sim)
    .ours(
        format!(
            "{} feet land within {:.0} ms; {}",
            times.len(),
            (last - first) * 1e3,
            outcome(judged)
        ),
        judged.verdict.stands() && times.len() == FOOT_COUNT,
        "holds when all feet land and the robot stays upright",
    )
}

/// Largest error of a joint between take-off's start and the first contact, degrees.
pub(super) fn tracking(run: &Run) -> f64 {
    let end = run.first_contact.unwrap_or(f64::INFINITY);
    let jump = run.samples.iter().filter(|s| s.time >= 0.0 && s.time < end);
    let error = |s: &Sample| {
        let pairs = s.joints.iter().zip(&s.planned_joints);
        pairs.fold(0.0, |m, (q, plan)| f64::max(m, (q - plan).abs()))
    };
    jump.map(error).fold(0.0, f64::max).to_degrees()
}
