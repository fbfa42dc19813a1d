//! Where the robot stands at the start: with its feet below its hips, or where they are.

use super::Task;
use super::file::TaskFile;
use super::values::LENGTH;
use crate::FOOT_COUNT;
use crate::range::{Unusable, within};
use crate::robot::{PLACES, Quadruped, State};
use nalgebra::{Rotation3, Vector3};
use rbd_core::Transform;
use srb_opt::Foot;

/// Height of the hips, or of the centre of mass, over the ground of a standing robot, as a share of its leg.
const STAND: f64 = 0.625;

/// Places of the feet on the ground, in the order of the robot's legs.
pub(super) fn points(
    file: &TaskFile,
    robot: &Quadruped,
) -> Result<[Vector3<f64>; FOOT_COUNT], Unusable> {
    let mut points_w = robot.hips.map(|hip| Vector3::new(hip.x, hip.y, 0.0));
    for (place, [x, y]) in PLACES.iter().zip(file.feet_m.iter().flatten()) {
        for number in [x, y] {
            within(*number, LENGTH, "feet_m")?;
        }
        if let Some(point) = robot.leg(place).and_then(|leg| points_w.get_mut(leg)) {
            *point = Vector3::new(*x, *y, 0.0);
        }
    }
    let culprit = file.feet_m.map_or("robot", |_| "feet_m");
    apart(robot, &points_w).map_err(|what| (culprit.to_owned(), what))?;
    Ok(points_w)
}

/// Refuses feet that stand in each other: a simulator would take them for free.
fn apart(robot: &Quadruped, points_w: &[Vector3<f64>; FOOT_COUNT]) -> Result<(), String> {
    let wide = 2.0 * robot.foot_radius;
    for (i, one) in points_w.iter().enumerate() {
        for (j, other) in points_w.iter().enumerate().skip(i + 1) {
            let far = (one - other).norm();
            if far < wide {
                return Err(format!(
                    "{} and {} would stand {far:.3} m apart, and their feet are {wide:.3} m wide: put them farther apart",
                    robot.place(i),
                    robot.place(j)
                ));
            }
        }
    }
    Ok(())
}

/// The robot standing on its feet, its centre of mass over the origin, and that.
pub(super) fn standing(
    robot: &Quadruped,
    points_w: &[Vector3<f64>; FOOT_COUNT],
) -> Result<(State, Vector3<f64>), String> {
    // Paper A's robot stands with its centre of mass, not its hips, at this height; there the two are 2 mm apart.
    let mut com_w = Vector3::z() * (STAND * robot.leg_length);
    if !robot.stands_by_com() {
        let hip = robot.hips.iter().map(|hip| hip.z).sum::<f64>() / robot.hips.len() as f64;
        let height = STAND * robot.leg_length + robot.foot_radius - hip;
        let base = Transform::new(Rotation3::identity(), Vector3::new(0.0, 0.0, height));
        com_w.z = robot.com(&robot.near(base)).z;
    }
    Ok((robot.stand(&com_w, points_w)?, com_w))
}

/// The feet of the rigid body, whose centre of mass is at `com_b` on the robot: each leg reaches as far to every side from where its foot stands as from
/// below its hip.
pub(super) fn feet(
    robot: &Quadruped,
    points_w: &[Vector3<f64>; FOOT_COUNT],
    com_b: &Vector3<f64>,
) -> [Foot<f64>; FOOT_COUNT] {
    core::array::from_fn(|i| {
        let point_w = points_w[i];
        Foot {
            pos_wf: point_w,
            nominal_b: Vector3::new(point_w.x, point_w.y, robot.hips[i].z) - com_b,
        }
    })
}

impl Task {
    /// The same jump from where the feet stand, `feet_w` in the order of the robot's legs, m: as by the key `feet_m`, whatever their heights. The centre of
    /// mass begins and ends where it did.
    ///
    /// # Errors
    /// A sentence: feet in each other, a foot that no leg reaches, or a joint beyond its limit.
    pub fn from_feet(&self, feet_w: &[Vector3<f64>; FOOT_COUNT]) -> Result<Self, String> {
        let mut task = self.clone();
        let points_w = feet_w.map(|foot| Vector3::new(foot.x, foot.y, 0.0));
        apart(&self.robot, &points_w)?;
        let (robot, problem) = (&self.robot, &mut task.problem);
        task.start = robot.stand(&problem.start_w, &points_w)?;
        let com_b = problem.start_w - task.start.base.translation;
        problem.inertia_b = robot.locked_inertia(&task.start);
        problem.feet = feet(robot, &points_w, &com_b);
        problem.corners = robot.corners.map(|corner| corner - com_b);
        Ok(task)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{FOOT_COUNT, Quadruped, State, Task, TaskFile, Vector3};

    fn feet(robot: &Quadruped, q: &State) -> [Vector3<f64>; FOOT_COUNT] {
        let poses = robot.poses(q);
        robot.feet.map(|foot| poses.frame(&foot).translation)
    }

    /// The file and the call make the same task, which stands on those feet with its centre of mass where it was.
    #[test]
    fn a_task_begins_where_the_feet_are() {
        let (mut file, _) = TaskFile::load("a1/diagonal").unwrap();
        let robot = Quadruped::a1().unwrap();
        let below_hips = Task::from_file("below", &file, robot).unwrap();
        let wide = [[0.19, 0.17], [0.16, -0.15], [-0.18, 0.14], [-0.2, -0.16]];
        file.feet_m = Some(wide);
        let by_file = Task::from_file("wide", &file, robot).unwrap();
        let feet_w = wide.map(|[x, y]| Vector3::new(x, y, 0.3));
        let by_call = below_hips.from_feet(&feet_w).unwrap();
        assert_eq!(by_file.start, by_call.start);
        for task in [&by_file, &by_call] {
            for (foot, [x, y]) in feet(&robot, &task.start).iter().zip(wide) {
                assert!((foot - Vector3::new(x, y, robot.foot_radius)).norm() < 1e-8);
            }
            assert!((robot.com(&task.start) - below_hips.problem.start_w).norm() < 1e-8);
            assert_eq!(task.problem.goal_w, below_hips.problem.goal_w);
            // What the rigid body holds over its feet are the trunk's corners, wherever the trunk is over the centre of mass.
            let base = task.start.base.translation;
            for (corner, on_trunk) in task.problem.corners.iter().zip(robot.corners) {
                let corner_w = task.problem.start_w + corner;
                assert!((corner_w - (base + on_trunk)).norm() < 1e-12);
            }
        }
        for (one, other) in by_file.problem.feet.iter().zip(&by_call.problem.feet) {
            assert_eq!(one, other);
        }
        // Below the hips it is the task without the key.
        let again = by_file.from_feet(&feet(&robot, &below_hips.start)).unwrap();
        let pairs = again.start.joints.iter().zip(&below_hips.start.joints);
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn feet_that_no_leg_reaches_are_refused_by_name() {
        let (mut file, _) = TaskFile::load("a1/lateral").unwrap();
        let robot = Quadruped::a1().unwrap();
        for far in [0.8, 1e9, f64::NAN] {
            file.feet_m = Some([[0.18, 0.13], [0.18, -0.13], [-0.18, far], [-0.18, -0.13]]);
            let refused = Task::from_file("mine", &file, robot).err().unwrap();
            assert!(refused.to_string().contains("feet_m"), "{refused}");
        }
    }

    #[test]
    fn feet_in_each_other_are_refused_by_name() {
        let (mut file, _) = TaskFile::load("a1/lateral").unwrap();
        let robot = Quadruped::a1().unwrap();
        let task = Task::from_file("below", &file, robot).unwrap();
        for (gap, stands) in [(0.041, true), (0.039, false), (0.0, false)] {
            let feet = [
                [0.18, 0.13],
                [0.18, -0.13],
                [-0.18, 0.5 * gap],
                [-0.18, -0.5 * gap],
            ];
            file.feet_m = Some(feet);
            let by_file = Task::from_file("mine", &file, robot);
            let by_call = task.from_feet(&feet.map(|[x, y]| Vector3::new(x, y, 0.0)));
            assert_eq!(
                (by_file.is_ok(), by_call.is_ok()),
                (stands, stands),
                "{gap}"
            );
            if let Err(refused) = by_file {
                assert!(refused.to_string().contains("RL and RR"), "{refused}");
            }
        }
    }

    /// A box is as far from the feet that stand nearest as the file says.
    #[test]
    fn the_edge_is_beyond_the_feet() {
        let (mut file, _) = TaskFile::load("a1/lateral-down").unwrap();
        let robot = Quadruped::a1().unwrap();
        let distance = |file: &TaskFile| -> f64 {
            let task = Task::from_file("down", file, robot).unwrap();
            task.edge.unwrap().distance
        };
        let before = distance(&file);
        let wider = robot.hips.map(|hip| [hip.x, hip.y + 0.02 * hip.y.signum()]);
        file.feet_m = Some(wider);
        assert!((distance(&file) - before - 0.02).abs() < 1e-12);
    }
}
