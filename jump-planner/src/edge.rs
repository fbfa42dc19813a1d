//! The edge of a box as plans have it: moved, so that feet in the air keep away from it.

use super::reference::heading_matrix;
use super::task::Task;
use nalgebra::Vector3;
use srb_opt::Edge;

/// How much farther than it is a box edge is taken to be at most, m; that of a box to jump onto, nearer.
const EDGE_MARGIN: f64 = 0.12;
/// At most this share of the way from the feet that stand to a box to jump onto is taken from them: with less, feet meet its edge in simulation.
const ONTO_SHARE: f64 = 0.5;
/// The same where a plan is made again because a foot met it.
const ONTO_MOST: f64 = 0.8;
/// At most this share of the way from the edge to the feet that land is taken from them, off a box: with half of it legs swing over an edge that is
/// hardly there, with four fifths feet cannot come down.
const OFF_SHARE: f64 = 0.65;
/// The way that is left to feet that stand or land, in widths of the smoothed edge at least: the ground under them is then a 400th of the box's height
/// too high. With much more, feet that stand before a box cannot lift off, since none is over it an instant later.
const WIDTHS: f64 = 3.0;
/// Least width of a smoothed edge, m.
const NARROWEST: f64 = 1e-3;
/// The edge of the task's box, moved so that feet in the air keep away from it, but neither to the feet that stand nor to where they land.
///
/// A box to jump onto is nearer by `rise` as well: what the audit finds in the ground is then often a foot in its edge, which no height keeps out.
///
/// Feet land where [`Quadruped::landing_feet`](crate::robot::Quadruped::landing_feet) has them, farther apart than they stand.
pub(crate) fn cautious(task: &Task, rise: f64) -> Option<Edge<f64>> {
    let mut edge = task.problem.edge?;
    let across = |place: Vector3<f64>| edge.sign * place[edge.axis] - edge.distance;
    let (way, taken) = if edge.drop < 0.0 {
        let feet = task.problem.feet.map(|foot| across(foot.pos_wf));
        let way = -feet.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0);
        let first = EDGE_MARGIN.min(ONTO_SHARE * way);
        let most = (ONTO_MOST * way).min(way - WIDTHS * NARROWEST);
        let taken = (first + rise).min(most.max(first));
        edge.distance -= taken;
        (way, taken)
    } else {
        let end = task.start.base.translation + task.goal;
        let turn = heading_matrix(task.heading);
        let feet = task.robot.landing_feet();
        let feet = feet.map(|foot| across(end + turn * foot));
        let way = feet.into_iter().fold(f64::INFINITY, f64::min).max(0.0);
        let taken = EDGE_MARGIN.min(OFF_SHARE * way);
        edge.distance += taken;
        (way, taken)
    };
    // Feet at the edge itself are no jump, but a width is positive.
    edge.width = edge.width.min(((way - taken) / WIDTHS).max(NARROWEST));
    Some(edge)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{EDGE_MARGIN, OFF_SHARE, cautious};
    use crate::task::Task;
    use nalgebra::Vector3;

    /// How much farther the edge of `a1/lateral-down` is taken to be, m, with a goal aside, a drop and heights drawn in.
    fn moved(aside: f64, drop: f64, rise: f64) -> f64 {
        let mut task = Task::load("a1/lateral-down").unwrap();
        task.goal.y = aside;
        task.problem.edge.as_mut().unwrap().drop = drop;
        cautious(&task, rise).unwrap().distance - task.problem.edge.unwrap().distance
    }

    #[test]
    fn edges_are_moved_away_from_feet_in_the_air_and_not_into_others() {
        assert!((moved(0.6, 0.3, 0.0) - EDGE_MARGIN).abs() < 1e-12);
        // The right feet land 0.17 m right of the goal, the edge is 0.18 m left of the start.
        let near = moved(0.4, 0.3, 0.0);
        assert!(near > 0.02 && near < 0.04, "{near}");
        assert!((moved(0.5, 0.3, 0.0) - near - 0.1 * OFF_SHARE).abs() < 1e-12);
        assert_eq!(moved(0.32, 0.3, 0.0), 0.0);
        // Onto a box: towards the left feet, 0.05 m before it, and not as far as they are.
        let onto = moved(0.5, -0.3, 0.0);
        assert!(onto < -0.01 && onto > -0.03, "{onto}");
        // Nearer where a foot met it; off a box that is no remedy.
        assert!((moved(0.5, -0.3, 0.005) - onto + 0.005).abs() < 1e-12);
        assert_eq!(moved(0.4, 0.3, 0.005), near);
    }

    #[test]
    fn the_ground_off_a_box_is_low_where_feet_land() {
        let mut task = Task::load("a1/lateral-down").unwrap();
        for aside in [0.36, 0.4, 0.5, 0.8] {
            task.goal.y = aside;
            let cautious = cautious(&task, 0.0).unwrap();
            let feet = task.robot.landing_feet().map(|foot| foot + task.goal);
            let most = feet.map(|foot| cautious.ground(&foot).height + cautious.drop);
            assert!(
                most.iter().all(|m| *m < cautious.drop / 350.0),
                "{aside}: {most:?}"
            );
        }
    }

    #[test]
    fn a_box_to_jump_onto_does_not_begin_under_feet_that_stand() {
        let cases =
            [0.01, 0.03, 0.1, 0.5].map(|beyond| [0.0, 0.01, 1.0].map(|rise| (beyond, rise)));
        for (beyond, rise) in cases.into_iter().flatten() {
            let file = concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/tasks/extra/forward-onto-box.toml"
            );
            let mut task = Task::load(file).unwrap();
            let feet = task.problem.feet.map(|foot| foot.pos_wf);
            let front = feet.iter().map(|foot| foot.x).fold(f64::MIN, f64::max);
            let edge = task.problem.edge.as_mut().unwrap();
            edge.distance = front + beyond;
            let height = -edge.drop;
            let cautious = cautious(&task, rise).unwrap();
            assert!(cautious.distance > front && cautious.distance < front + beyond);
            let under = feet.map(|foot| cautious.ground(&foot).height / height);
            assert!(under.iter().all(|share| *share < 1.0 / 350.0), "{under:?}");
            // Where the box begins, all of it is there but a twentieth.
            let begin = Vector3::new(front + beyond, 0.0, 0.0);
            let there = cautious.ground(&begin).height / height;
            assert!(there > 0.95, "{beyond}: {there}");
        }
    }
}
