//! Links that passed through each other in a plan, which the next plan keeps apart.
//!
//! A robot's links are hundreds of pairs of shapes, of which hardly any come near each other in a jump. So plans are made without them, and the
//! audit, which looks at all of them between the nodes too, finds the few that count: those are rows of the next plan.

use crate::audit::Overlap;
use crate::robot::{Quadruped, State};
use crate::setup::{N, PAIRS};
use rbd_core::{Frame, Shape};
use wb_opt::{Apart, Robot, Segment};

/// How much farther apart than touching, m: between nodes legs come nearer than on them.
const MARGIN: f64 = 5e-3;

/// Pairs of shapes, at most [`PAIRS`], and how far apart they are to be, m.
#[derive(Clone, Default)]
pub(crate) struct Separation(Vec<([usize; 2], f64)>);

impl Separation {
    /// How many pairs there are.
    pub(crate) const fn count(&self) -> usize {
        self.0.len()
    }

    /// Keeps apart what overlaps; farther than before if it was kept apart, and passed through each other between two nodes. Whether there was
    /// room for it.
    pub(crate) fn keep(&mut self, overlap: &Overlap) -> bool {
        let mut known = self.0.iter_mut();
        if let Some((_, margin)) = known.find(|(shapes, _)| *shapes == overlap.shapes) {
            *margin += MARGIN - overlap.gap;
            return true;
        }
        let has_room = self.0.len() < PAIRS;
        if has_room {
            self.0.push((overlap.shapes, MARGIN));
        }
        has_room
    }

    /// The pairs as rows: not farther apart than the robot has them in these postures, which no plan can choose: where it starts, and as it lands.
    pub(crate) fn rows(&self, robot: &Quadruped, given: [State; 2]) -> Vec<Apart<f64>> {
        let given = given.map(|posture| robot.poses(&posture));
        let row = |(shapes, margin): &([usize; 2], f64)| {
            let pair = shapes.map(|i| &robot.shapes[i]);
            let gaps = given.iter().map(|at| contact_sim::gap(at, pair));
            Apart {
                segments: pair.map(axis),
                distance: pair[0].radius + pair[1].radius + gaps.fold(*margin, f64::min),
            }
        };
        self.0.iter().map(row).collect()
    }
}

/// The axis of a shape.
fn axis(shape: &Shape<f64>) -> Segment<f64> {
    let end = |offset| {
        Robot::<f64, N>::point(&Frame {
            link: shape.link,
            offset,
            ..Frame::IDENTITY
        })
    };
    Segment {
        ends: [shape.from, shape.to].map(end),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{MARGIN, Separation};
    use crate::audit::Overlap;
    use crate::setup::PAIRS;
    use crate::task::Task;

    /// Shapes of A1: the front left foot, and the shanks of the legs on its right and behind it.
    const FOOT: usize = 0;
    const SHANKS: [usize; 2] = [5, 6];

    fn overlap(shapes: [usize; 2], gap: f64) -> Overlap {
        Overlap { shapes, gap }
    }

    /// Least distances of the pairs that keep apart, m, over those at which they touch.
    fn margins(separation: &Separation) -> Vec<f64> {
        let task = Task::load("a1/lateral").unwrap();
        let radius = |i: usize| task.robot.shapes[i].radius;
        let touching = separation
            .0
            .iter()
            .map(|([a, b], _)| radius(*a) + radius(*b));
        let rows = separation.rows(&task.robot, [task.start; 2]);
        let pairs = rows.iter().zip(touching);
        pairs
            .map(|(row, touching)| row.distance - touching)
            .collect()
    }

    #[test]
    fn what_passed_between_two_nodes_is_kept_farther_apart() {
        let mut separation = Separation::default();
        // How deep it was before it was kept apart says nothing about how far it has to be.
        assert!(separation.keep(&overlap([FOOT, SHANKS[0]], -0.02)));
        assert!(separation.keep(&overlap([FOOT, SHANKS[1]], -0.01)));
        assert!(separation.keep(&overlap([FOOT, SHANKS[0]], -0.007)));
        let margins = margins(&separation);
        assert_eq!(separation.count(), 2);
        assert!(
            (margins[0] - (2.0 * MARGIN + 0.007)).abs() < 1e-15,
            "{margins:?}"
        );
        assert!((margins[1] - MARGIN).abs() < 1e-15, "{margins:?}");
    }

    #[test]
    fn no_pair_is_kept_farther_apart_than_the_robot_stands() {
        let mut separation = Separation::default();
        for _ in 0..10 {
            assert!(separation.keep(&overlap([FOOT, SHANKS[0]], -0.1)));
        }
        let task = Task::load("a1/lateral").unwrap();
        let standing = task.robot.poses(&task.start);
        let pair = [FOOT, SHANKS[0]].map(|i| &task.robot.shapes[i]);
        let most = contact_sim::gap(&standing, pair);
        let margin = margins(&separation)[0];
        assert!(margin > MARGIN && margin <= most, "{margin} {most}");
    }

    #[test]
    fn there_are_as_many_rows_as_the_problem_has_room_for() {
        let mut separation = Separation::default();
        let kept = (0..2 * PAIRS).map(|i| separation.keep(&overlap([0, i + 1], -0.01)));
        assert_eq!(kept.filter(|kept| *kept).count(), PAIRS);
        assert_eq!(separation.count(), PAIRS);
        assert!(separation.keep(&overlap([0, 1], -0.01)));
    }
}
