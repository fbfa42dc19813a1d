//! A jump of a quadruped, measured for its verdict.

use super::execute::{Run, SETTLE};
use super::log::Sample;
use super::{FOOT_COUNT, JOINTS, State, state};
use crate::verdict::{FALLEN, Failure, Flight, Stand, Verdict};
use jump_control::Phase;
use jump_planner::reference::{Reference, heading_matrix};
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use nalgebra::{Rotation3, Vector3};
use rbd_core::Transform;

/// A run with its verdict and what else is told of it.
pub struct Judged {
    /// The verdict.
    pub verdict: Verdict,
    /// Touched down on its feet and never lost them to a fault.
    pub landed: bool,
    /// Time from touchdown until the tilt stays below that of a fallen robot, s.
    pub upright_after: Option<f64>,
    /// Angle between the base and its goal at the first contact, degrees.
    pub touchdown_rotation: Option<f64>,
    /// Largest height of the centre of mass, m.
    pub apex: f64,
}

/// Tilt of the body, degrees.
#[must_use]
pub fn tilt(s: &Sample) -> f64 {
    let up = s.orientation * Vector3::z();
    so3::math::atan2(so3::math::hypot(up.x, up.y), up.z).to_degrees()
}

/// Angle between two rotations, degrees.
fn between(a: &Rotation3<f64>, b: &Rotation3<f64>) -> f64 {
    so3::log(&(a.inverse() * b)).norm().to_degrees()
}

/// Middle of the feet, world axes.
pub(super) fn middle_of_feet(
    robot: &Quadruped,
    base: &Transform<f64>,
    joints: &[f64; JOINTS],
) -> Vector3<f64> {
    let q = State {
        base: *base,
        joints: *joints,
    };
    let poses = robot.poses(&q);
    let sum: Vector3<f64> = robot
        .feet
        .iter()
        .map(|foot| poses.frame(foot).translation)
        .sum();
    sum / FOOT_COUNT as f64
}

/// Beside the plan at its touchdown; `None` for a run that ended before.
fn flight(robot: &Quadruped, reference: &Reference, samples: &[Sample]) -> Option<Flight> {
    let sample = samples.iter().find(|s| s.time >= reference.touchdown)?;
    let (q, _) = state(reference.nodes.last()?);
    let pairs = sample.joints.iter().zip(&q.joints);
    let joints = pairs.fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()));
    Some(Flight {
        time: sample.time,
        position: (sample.com - robot.com(&q)).norm(),
        rotation: between(&q.base.rotation, &sample.orientation.to_rotation_matrix()),
        joints: joints.to_degrees(),
    })
}

/// Beside the goal at `time`.
fn stand(task: &Task, run: &Run, time: f64) -> Option<Stand> {
    let sample = run.samples.iter().find(|s| s.time >= time)?;
    let start = &task.start;
    let turned = heading_matrix(task.heading);
    let rotation = sample.orientation.to_rotation_matrix();
    // The goal is where the start's base goes. Feet turn with its heading, and are to stand as below the hips of a robot that waits, wherever
    // these began.
    let hips: Vector3<f64> = task.robot.hips.iter().sum();
    let below = hips / FOOT_COUNT as f64 - start.base.translation;
    let goal = start.base.translation + task.goal;
    let here = Transform::new(rotation, sample.position);
    let feet = middle_of_feet(&task.robot, &here, &sample.joints) - (goal + turned * below);
    let heading = |r: &Rotation3<f64>| {
        let ahead = r * Vector3::x();
        so3::math::atan2(ahead.y, ahead.x)
    };
    let off = heading(&(turned.inverse() * rotation));
    Some(Stand {
        time: sample.time,
        feet: so3::math::hypot(feet.x, feet.y),
        heading: off.abs().to_degrees(),
        // Over the ground that is there, which may be another than the plan's.
        height: (sample.position.z - goal.z - run.ground_height).abs(),
        rotation: between(&task.rot_goal, &rotation),
        upright: tilt(sample) < FALLEN && stands(run.final_phase),
    })
}

/// The machine says that the robot is on its feet.
const fn stands(phase: Phase) -> bool {
    matches!(phase, Phase::Landing | Phase::Stand)
}

impl Judged {
    /// Measures and judges a run.
    pub fn of(task: &Task, reference: &Reference, run: &Run) -> Self {
        let end = run.samples.last().map_or(0.0, |s| s.time);
        let mut gravest = Vec::new();
        if let Some(fault) = run.fault {
            let aborted = run.samples.iter().find(|s| s.phase == Phase::Abort);
            gravest.push(Failure::new(
                aborted.map_or(end, |s| s.time),
                "fault",
                fault.to_string(),
            ));
        } else if !run.took_off {
            let found = "the feet did not leave the ground";
            gravest.push(Failure::new(end, "no_takeoff", found));
        } else if run.first_contact.is_none() {
            let found = "no foot touched the ground after the flight";
            gravest.push(Failure::new(end, "no_touchdown", found));
        }
        let allowed: &[&str] = if task.trunk_may_touch {
            &["trunk"]
        } else {
            &[]
        };
        let stand = run.first_contact.and_then(|t| stand(task, run, t + SETTLE));
        let after = |time: f64| run.samples.iter().filter(move |s| s.time >= time);
        let upright_after =
            run.first_contact
                .and_then(|t| match after(t).rfind(|s| tilt(s) >= FALLEN) {
                    None => Some(0.0),
                    Some(s) => (s.time < end - 0.2).then_some(s.time - t),
                });
        let touched = run.first_contact.and_then(|t| after(t).next());
        let turned = |s: &Sample| between(&task.rot_goal, &s.orientation.to_rotation_matrix());
        Self {
            verdict: Verdict::new(
                // Of a run that ended before its flight there is none to tell of.
                flight(&task.robot, reference, &run.samples).filter(|_| run.took_off),
                stand,
                run.hardware.found(allowed),
                gravest,
            ),
            landed: run.first_contact.is_some() && stands(run.final_phase),
            upright_after,
            touchdown_rotation: touched.map(turned),
            apex: run
                .samples
                .iter()
                .map(|s| s.com.z)
                .fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{Judged, Quadruped, Run, SETTLE, Sample, State, Task, middle_of_feet, stand};
    use crate::quadruped::{OWNERS, Planned};
    use crate::verdict::{Found, Verdict};
    use jump_control::Phase;
    use nalgebra::Vector3;
    use rbd_core::{Configuration, Transform};

    fn sample(task: &Task, q: &State, time: f64) -> Sample {
        Sample {
            time,
            phase: Phase::Stand,
            position: q.base.translation,
            orientation: so3::quat::from_rotation(&q.base.rotation),
            velocity_w: Vector3::zeros(),
            omega_b: Vector3::zeros(),
            com: task.robot.com(q),
            joints: q.joints,
            joint_velocities: [0.0; 12],
            torques: [0.0; 12],
            forces_w: [Vector3::zeros(); OWNERS],
            floor: 0.0,
            planned_position: Vector3::zeros(),
            planned_joints: [0.0; 12],
            planned_torques: [0.0; 12],
            planned_forces_w: [Vector3::zeros(); 4],
            commanded_forces_w: [Vector3::zeros(); 4],
        }
    }

    /// A body that leans over its goal while its feet stand 11 cm beside it: the base was judged (7769727), and was on target.
    #[test]
    fn a_lean_towards_the_goal_does_not_count() {
        let task = Task::load("a1/lateral").unwrap();
        let mut run = Run::new(&task, 0, 1e-4);
        run.final_phase = Phase::Stand;
        let mut there = task.start;
        there.base.translation += task.goal;
        run.samples.push(sample(&task, &there, SETTLE));
        let good = stand(&task, &run, SETTLE).unwrap();
        assert!(good.feet < 1e-12 && good.height < 1e-12 && good.upright);
        // On ground that is 6 cm higher than known it stands as high over it; over known ground it floats.
        let mut raised = there;
        raised.base.translation.z += 0.06;
        run.samples = vec![sample(&task, &raised, SETTLE)];
        assert!((stand(&task, &run, SETTLE).unwrap().height - 0.06).abs() < 1e-12);
        run.ground_height = 0.06;
        assert!(stand(&task, &run, SETTLE).unwrap().height < 1e-12);
        run.ground_height = 0.0;
        // Legs turned at the hips, base where it was: the feet move aside.
        let leaning: State = Configuration {
            joints: core::array::from_fn(|i| there.joints[i] + if i % 3 == 0 { 0.5 } else { 0.0 }),
            ..there
        };
        run.samples = vec![sample(&task, &leaning, SETTLE)];
        let bad = stand(&task, &run, SETTLE).unwrap();
        assert!((leaning.base.translation - there.base.translation).norm() < 1e-12);
        let verdict = Verdict::new(None, Some(bad), Found::default(), Vec::new());
        assert_eq!(verdict.outcome(), "stand.feet_m", "{}", bad.feet);
    }

    /// A push-off too weak to lift the feet is no jump, and one that nobody lands has no stand; of neither a flight is told that there was not.
    #[test]
    fn a_robot_that_stays_on_the_ground_has_not_landed() {
        const PLAN: &[u8] = include_bytes!("../../../firmware/probe/plans/a1-double-backflip.bin");
        let planned = Planned::open(&Quadruped::a1().unwrap(), PLAN, Task::load).unwrap();
        let (task, reference) = (&planned.task, &planned.reference);
        let mut run = Run::new(task, 0, 1e-4);
        run.final_phase = Phase::Stand;
        run.samples = vec![sample(task, &task.start, reference.touchdown + SETTLE)];
        let stays = Judged::of(task, reference, &run);
        assert_eq!(stays.verdict.outcome(), "no_takeoff");
        assert!(!stays.landed && stays.verdict.flight.is_none());
        run.took_off = true;
        let lost = Judged::of(task, reference, &run).verdict;
        assert!(lost.flight.is_some() && lost.stand.is_none());
        assert!(
            lost.failures
                .iter()
                .any(|failure| failure.name == "no_touchdown")
        );
    }

    #[test]
    fn the_middle_of_the_feet_moves_with_the_base() {
        let task = Task::load("a1/lateral").unwrap();
        let here = middle_of_feet(&task.robot, &task.start.base, &task.start.joints);
        let shift = Vector3::new(0.1, -0.2, 0.3);
        let base = Transform::new(
            task.start.base.rotation,
            task.start.base.translation + shift,
        );
        let there = middle_of_feet(&task.robot, &base, &task.start.joints);
        assert!((there - here - shift).norm() < 1e-12);
    }
}
