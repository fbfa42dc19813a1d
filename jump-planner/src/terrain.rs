//! The ground of a task: a floor, and a box with an edge.

use crate::task::Task;
use contact_sim::{Block, Terrain};
use nalgebra::Vector3;

/// How far a box reaches from the middle of a robot on it, m.
const AROUND: f64 = 0.6;

/// The world of a task, whose landing is `higher` than known, m. The robot starts at height zero: on the floor, with or without a box
/// to jump onto, or on a box with the floor below. Without a box start and landing are on one floor, which the simulated lab moves.
#[must_use]
pub fn terrain(task: &Task, higher: f64) -> Terrain<f64> {
    let Some(mut edge) = task.edge.filter(|edge| edge.drop != 0.0) else {
        return Terrain::FLAT;
    };
    let onto = edge.drop < 0.0;
    edge.drop -= higher;
    // Around where the robot stands, or lands.
    let middle = if onto { task.goal } else { Vector3::zeros() };
    over_edge(
        onto,
        (edge.axis, edge.sign, edge.distance),
        edge.drop,
        &middle,
        AROUND,
    )
}

/// A floor, and a block that reaches so far `around` a middle and is cut at an edge: (axis across it, side of the landing, distance from the
/// origin). The robot stands at height zero and lands `drop` below; `onto` the block, or off it.
#[must_use]
pub fn over_edge(
    onto: bool,
    (axis, side, distance): (usize, f64, f64),
    drop: f64,
    middle: &Vector3<f64>,
    around: f64,
) -> Terrain<f64> {
    let floor = f64::min(-drop, 0.0);
    let mut lower = [middle.x - around, middle.y - around, floor];
    let mut upper = [middle.x + around, middle.y + around, f64::max(-drop, 0.0)];
    let cut = side * distance;
    if onto == (side > 0.0) {
        lower[axis] = cut;
    } else {
        upper[axis] = cut;
    }
    Terrain {
        floor,
        block: Some(Block { lower, upper }),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::terrain;
    use crate::task::Task;
    use contact_sim::Terrain;
    use nalgebra::Vector3;

    /// Height of the probes over the ground, m.
    const GAP: f64 = 5e-4;

    /// Off and onto boxes, over all four edges: the robot stands on the ground at zero and lands on ground at the height of its goal, and
    /// between them is the edge.
    #[test]
    fn the_robot_stands_and_lands_on_the_ground() {
        let mut task = Task::load("a1/lateral-down").unwrap();
        for drop in [0.3, -0.3] {
            for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
                let edge = task.problem.edge.as_mut().unwrap();
                (edge.drop, edge.axis, edge.sign) = (drop, axis, sign);
                let distance = edge.distance;
                task.edge = task.problem.edge;
                task.goal = Vector3::new(0.1, -0.1, -drop);
                task.goal[axis] = 0.7 * sign;
                let terrain = terrain(&task, 0.0);
                let mut beside = Vector3::zeros();
                beside[axis] = sign * (distance - 1e-3);
                let mut beyond = Vector3::zeros();
                beyond[axis] = sign * (distance + 1e-3);
                for (place, wanted) in [
                    (Vector3::zeros(), 0.0),
                    (beside, 0.0),
                    (beyond, -drop),
                    (task.goal, -drop),
                ] {
                    let probe = place.xy().push(wanted + GAP);
                    let found = terrain.touch(&probe, 0.0).depth;
                    assert!((found + GAP).abs() < 1e-12, "{drop} {axis} {sign} {place}");
                }
            }
        }
        task.edge.as_mut().unwrap().drop = 0.0;
        assert_eq!(terrain(&task, 0.0), Terrain::FLAT);
    }
}
