//! Numbers of a problem that several bounds need.

use super::Body;
use crate::FOOT_COUNT;
use nalgebra::Vector3;
use srb_opt::Foot;

/// Numbers that several bounds need.
pub(super) struct Facts {
    /// Names of the feet.
    pub(super) places: [&'static str; FOOT_COUNT],
    /// Share of the ground's friction that the problem has.
    pub(super) friction_share: f64,
    /// Longest plan, s.
    pub(super) total: f64,
    /// Longest time with feet on the ground, s.
    pub(super) stance: f64,
    /// Shortest and longest flight at the end, s.
    pub(super) flight: [f64; 2],
    /// Longest interval with feet on the ground, s.
    pub(super) interval: f64,
    /// Most feet on the ground.
    pub(super) feet: f64,
    /// Highest and lowest centre of mass over standing feet, m.
    pub(super) heights: [f64; 2],
    /// Whether feet stand again after a flight: the last rest may then be in the air.
    pub(super) hops: bool,
}

impl Facts {
    /// Of a problem whose feet have these names.
    pub(super) fn of<const P: usize>(
        problem: &Body<P>,
        places: [&'static str; FOOT_COUNT],
    ) -> Self {
        let used = problem.used_phases();
        let stands = |contacts: &[bool; FOOT_COUNT]| contacts.contains(&true);
        let all: f64 = used.iter().map(|phase| phase.max_duration).sum();
        let standing = used.iter().filter(|phase| stands(&phase.contacts));
        let air: f64 = (used.iter().filter(|phase| !stands(&phase.contacts)))
            .map(|phase| phase.min_duration)
            .sum();
        let total = all.min(problem.max_total);
        let stance: f64 = standing.clone().map(|phase| phase.max_duration).sum();
        let last = used
            .iter()
            .rev()
            .take_while(|phase| !stands(&phase.contacts));
        let intervals = standing
            .clone()
            .map(|phase| phase.max_duration / phase.intervals as f64);
        let flags = used.iter().map(|phase| stands(&phase.contacts));
        let hops = flags.skip_while(|on| *on).any(|on| on);
        let heights = standing
            .clone()
            .map(|phase| height(problem, &phase.contacts));
        let high = heights.fold(0.0, f64::max);
        // Over level ground, or jumping up, the trunk stays above the ground, and its centre of mass is inside it.
        let corners = &problem.corners;
        let inside = (0..3)
            .all(|i| corners.iter().any(|c| c[i] > 0.0) && corners.iter().any(|c| c[i] < 0.0));
        let level = problem.edge.is_none_or(|edge| edge.drop <= 0.0);
        let low = if inside && level {
            problem.clearance.max(-high)
        } else {
            -high
        };
        Self {
            places,
            friction_share: 1.0,
            total,
            stance: stance.min(total - air).max(0.0),
            flight: last.fold([0.0, 0.0], |[least, most], phase| {
                [least + phase.min_duration, most + phase.max_duration]
            }),
            interval: intervals.fold(0.0, f64::max),
            feet: standing
                .map(|phase| phase.contacts.iter().filter(|on| **on).count() as f64)
                .fold(0.0, f64::max),
            heights: [high, low],
            hops,
        }
    }
}

/// Largest height of the centre of mass while these feet stand: it is within the longest leg of each, wherever the body is turned, so
/// over the middle of the two that are farthest apart.
fn height<const P: usize>(problem: &Body<P>, contacts: &[bool; FOOT_COUNT]) -> f64 {
    let standing = || {
        problem
            .feet
            .iter()
            .zip(contacts)
            .filter(|(_, on)| **on)
            .map(|(foot, _)| foot)
    };
    let longest = standing().map(|foot| longest_leg(problem, foot));
    let longest = longest.fold(0.0, f64::max);
    let apart = standing()
        .flat_map(|a| standing().map(move |b| (a.pos_wf - b.pos_wf).norm()))
        .fold(0.0, f64::max);
    so3::math::sqrt((longest * longest - 0.25 * apart * apart).max(0.0))
}

/// Farthest that the centre of mass can be from a foot that stands, wherever the body is turned, m.
pub(super) fn longest_leg<const P: usize>(problem: &Body<P>, foot: &Foot<f64>) -> f64 {
    let corner = |bits: usize| {
        Vector3::from_fn(|i, _| {
            let bound = if (bits >> i) & 1 == 0 {
                problem.reach_lower[i]
            } else {
                problem.reach_upper[i]
            };
            foot.nominal_b[i] + bound
        })
    };
    (0..8).map(|bits| corner(bits).norm()).fold(0.0, f64::max)
}
