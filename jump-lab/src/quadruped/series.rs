//! One jump of a quadruped, or several in a row: each begins where the last one has left the robot.
//!
//! Between two of them happens what a program on the robot does: the next jump is planned from where the feet stand ([`Task::from_feet`](jump_planner::task::Task::from_feet)), or taken as
//! it is stored, the estimator is told that the robot stands where that begins ([`state_est::State::stand_at`]), and the machine is armed again. Nothing is
//! put right: legs, ground, motors and sensors go on as they are.

use super::execute::{Closed, HOLD, Keeper, Run, SETTLE, Tamper, Trial, Watch, closed, feet};
use super::judge::middle_of_feet;
use super::plant::{height_error, plant};
use super::{FOOT_COUNT, JOINTS, Planned, State};
use core::cell::OnceCell;
use jump_control::Phase;
use jump_machine::{Jump, Machine, Settings, Workspace};
use jump_planner::reference::heading_matrix;
use jump_planner::robot::Quadruped;
use jump_planner::stored::Stored;
use nalgebra::Vector3;
use rbd_core::Transform;

/// What jumps next, by its number in the row, given where the feet stand as the robot knows it ([`state_est::State::feet`]): in a world in which their middle
/// and the heading are those of the first task's start, m. Nothing is given for the first jump, which begins where its plan does. None ends the row.
pub type Next<'n> =
    dyn FnMut(usize, Option<&[Vector3<f64>; FOOT_COUNT]>) -> Result<Option<Planned>, String> + 'n;

/// Runs jumps of one robot one after the other, at most so many. Each has a run of its own, in the world of its plan, for [`Planned::judge`]; the last one
/// is that after which the robot does not stand.
///
/// # Errors
/// A sentence: a jump needs an edge, which the ground of the next one would lack; the machine refuses one, this build lacks the simulator, or that fails;
/// or what `next` says.
pub fn run_in_a_row(
    next: &mut Next<'_>,
    most: usize,
    trial: &Trial<'_>,
) -> Result<Vec<(Planned, Run)>, String> {
    let mut flat = |i: usize, feet_w: Option<&[Vector3<f64>; FOOT_COUNT]>| {
        let planned = next(i, feet_w)?;
        match planned.as_ref().filter(|jump| jump.task.edge.is_some()) {
            None => Ok(planned),
            Some(Planned { task, .. }) => Err(format!(
                "{}: jumps in a row are on flat ground, and this one is off or onto an edge",
                task.name
            )),
        }
    };
    let watched: (&mut Tamper<'_>, &mut Watch<'_>) = (&mut |_, _| {}, &mut |_| {});
    run_all(&mut flat, most, trial, watched, &mut |_, _| {})
}

/// [`run_in_a_row`], watched as in [`run_watched`](super::execute::run_watched), and compiled once and here: robot, simulators and controllers are large.
pub(super) fn run_all(
    next: &mut Next<'_>,
    most: usize,
    trial: &Trial<'_>,
    (tamper, watch): (&mut Tamper<'_>, &mut Watch<'_>),
    progress: &mut dyn FnMut(f64, Phase),
) -> Result<Vec<(Planned, Run)>, String> {
    // The machine borrows plans for as long as it lives.
    let jumps: Vec<OnceCell<Planned>> = (0..most).map(|_| OnceCell::new()).collect();
    let Some(first) = next(0, None)? else {
        return Ok(Vec::new());
    };
    let (robot, start) = (first.task.robot, first.task.start);
    let (drives, build) = (robot.drives(), robot.build(&start));
    let mut settings = Settings::new(&build, robot.feet, drives, start.joints);
    for measure in trial.without {
        measure.leave(&mut settings);
    }
    let mut workspace = Workspace::new();
    let mut closed = closed(
        (robot, feet(&robot)),
        Machine::<_, _, JOINTS, FOOT_COUNT>::new(&robot, settings, &mut workspace),
        plant(trial.sim, &first.task, &trial.disturbance)?,
        trial,
    );
    let mut runs = Vec::new();
    let mut waiting = Some((first, Transform::IDENTITY));
    for (i, slot) in jumps.iter().enumerate() {
        if i > 0 {
            waiting =
                from_where_it_stands(&mut closed, (&robot, &start), |feet_w| next(i, feet_w))?;
        }
        let Some((planned, frame)) = waiting.take() else {
            break;
        };
        let Planned { task, reference } = slot.get_or_init(|| planned);
        let stored = Stored::read(&reference.bytes).map_err(|error| error.to_string())?;
        let jump = Jump::stored(&stored).map_err(|error| error.to_string())?;
        let hold = HOLD.max(settings.least_hold(&jump.plan));
        if i == 0 {
            closed.begin(-hold);
        }
        let start = closed.now + hold;
        let armed = closed.machine.arm(jump, start);
        armed.map_err(|refusal| refusal.to_string())?;
        let mut keeper = Keeper {
            run: Run::new(task, stored.checksum(), closed.world.plant().tick()),
            plan: &jump.plan,
            node: 0,
            frame,
            tamper: &mut *tamper,
            watch: &mut *watch,
        };
        let end = reference.touchdown + SETTLE + 0.5;
        closed.go_on((start, end), &mut keeper, &mut *progress)?;
        let mut run = keeper.run;
        if i == 0 {
            // The next ones begin on that ground.
            run.ground_height = height_error(&trial.disturbance);
        }
        run.final_phase = closed.machine.phase();
        run.fault = closed.machine.fault();
        run.estimate_errors = closed.sensors.worst;
        runs.push(run);
        if closed.machine.phase() != Phase::Stand {
            break;
        }
    }
    drop(closed);
    let flown = jumps.into_iter().filter_map(OnceCell::into_inner);
    Ok(flown.zip(runs).collect())
}

/// What jumps next, and the pose of the simulator's world in that of its task. None where a foot is in the air, or nothing jumps.
fn from_where_it_stands(
    closed: &mut Closed<'_>,
    (robot, start): (&Quadruped, &State),
    next: impl FnOnce(Option<&[Vector3<f64>; FOOT_COUNT]>) -> Result<Option<Planned>, String>,
) -> Result<Option<(Planned, Transform<f64>)>, String> {
    if begin_anew(closed, robot, start).is_none() {
        return Ok(None);
    }
    let feet_w = closed.sensors.feet_w();
    Ok(next(feet_w.as_ref())?.and_then(|planned| {
        // A task of one's own may have its feet elsewhere in its world.
        let world = begin_anew(closed, robot, &planned.task.start)?;
        Some((planned, world))
    }))
}

/// The robot stands, and begins a task that starts like this where it does: pose of the simulator's world in that of the task. None where a foot is in the air.
fn begin_anew(closed: &mut Closed<'_>, robot: &Quadruped, start: &State) -> Option<Transform<f64>> {
    let (middle, heading) = place(robot, &closed.world.configuration());
    let (first_middle, first_heading) = place(robot, start);
    let turned = heading_matrix(first_heading - heading);
    let world = Transform::new(turned, first_middle - turned * middle);
    let stands = closed.sensors.stand_at(&first_middle, first_heading, world);
    stands.then_some(world)
}

/// Middle of the feet in the world, and the heading, rad.
fn place(robot: &Quadruped, q: &State) -> (Vector3<f64>, f64) {
    let ahead = q.base.rotation * Vector3::x();
    (
        middle_of_feet(robot, &q.base, &q.joints),
        so3::math::atan2(ahead.y, ahead.x),
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{FOOT_COUNT, Planned, State, Transform, Trial, Vector3, run_in_a_row};
    use crate::Sim;
    use core::ops::ControlFlow;
    use jump_planner::task::Task;
    use jump_planner::{Options, plan};

    fn planned(task: Task) -> Planned {
        let found = plan(&task, &Options::default(), |_, _| ControlFlow::Continue(()));
        let robot = task.robot;
        Planned::open(&robot, &found.unwrap().bytes, |_| Ok::<_, String>(task)).unwrap()
    }

    fn built_in(name: &str) -> Planned {
        planned(Task::load(name).unwrap())
    }

    /// Of jumps that each move and turn the robot: the first is the one that it is alone, and each is on target from where the last one has ended.
    #[test]
    fn each_jump_begins_where_the_last_has_ended() {
        let jumps = ["a1/lateral", "a1/spin-90", "a1/lateral"].map(built_in);
        let trial = Trial::nominal(Sim::Native);
        let runs = run_in_a_row(&mut |i, _| Ok(jumps.get(i).cloned()), 3, &trial).unwrap();
        assert_eq!(runs.len(), 3);
        for (jump, run) in &runs {
            let verdict = jump.judge(run).verdict;
            assert!(
                verdict.on_target(),
                "{}: {}",
                jump.task.name,
                verdict.first()
            );
        }
        let alone = jumps[0].run(trial).unwrap();
        let way = |run: &super::Run| -> Vec<_> {
            run.samples.iter().map(|s| (s.time, s.joints)).collect()
        };
        assert_eq!(way(&runs[0].1), way(&alone));
    }

    /// It is planned from where they are, what is armed moves the trunk over them and not them, and it is on target.
    #[test]
    fn feet_of_a_robot_that_has_landed_stay_until_it_jumps() {
        let stored = built_in("a1/lateral");
        let mut next = |_: usize, feet_w: Option<&[Vector3<f64>; FOOT_COUNT]>| {
            Ok(Some(match feet_w {
                Some(feet_w) => planned(stored.task.from_feet(feet_w)?),
                None => stored.clone(),
            }))
        };
        let runs = run_in_a_row(&mut next, 2, &Trial::nominal(Sim::Native)).unwrap();
        let (jump, run) = runs.get(1).unwrap();
        let feet = |q: &State| {
            let poses = jump.task.robot.poses(q);
            jump.task
                .robot
                .feet
                .map(|foot| poses.frame(&foot).translation)
        };
        let (planned, below_hips) = (feet(&jump.task.start), feet(&stored.task.start));
        let farthest = |feet_w: [Vector3<f64>; FOOT_COUNT], from: &[Vector3<f64>; FOOT_COUNT]| {
            let ways = feet_w
                .iter()
                .zip(from)
                .map(|(foot, from)| (foot - from).xy().norm());
            ways.fold(0.0, f64::max)
        };
        // Where it has landed it stands on wider feet.
        assert!(farthest(planned, &below_hips) > 0.02);
        for sample in run.samples.iter().filter(|sample| sample.time < 0.0) {
            let base = Transform::new(so3::quat::to_rotation(&sample.orientation), sample.position);
            let joints = sample.joints;
            let off = farthest(feet(&State { base, joints }), &planned);
            assert!(off < 0.003, "{:.3} s: {off}", sample.time);
        }
        let verdict = jump.judge(run).verdict;
        assert!(verdict.on_target(), "{}", verdict.first());
    }

    #[test]
    fn an_edge_is_refused_by_name() {
        let jumps = ["a1/lateral", "a1/lateral-down"].map(built_in);
        let refused = run_in_a_row(
            &mut |i, _| Ok(jumps.get(i).cloned()),
            2,
            &Trial::nominal(Sim::Native),
        );
        assert!(refused.is_err_and(|why| why.contains("a1/lateral-down")));
    }
}
