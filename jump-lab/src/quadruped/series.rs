//! One jump of a quadruped, or several in a row: each begins where the last one has left the robot.
//!
//! Between two of them happens what a program on the robot does: the estimator is told that the robot stands where the next plan begins
//! ([`state_est::State::stand_at`]), and the machine is armed again. Nothing is put right: legs, ground, motors and sensors go on as they are.

use super::execute::{Closed, HOLD, Keeper, Run, SETTLE, Tamper, Trial, Watch, closed, feet};
use super::judge::middle_of_feet;
use super::plant::plant;
use super::{FOOT_COUNT, JOINTS, Planned, State};
use jump_control::Phase;
use jump_machine::{Jump, Machine, Settings, Workspace};
use jump_planner::reference::{Reference, heading_matrix};
use jump_planner::stored::Stored;
use jump_planner::task::Task;
use nalgebra::Vector3;
use rbd_core::Transform;

/// Runs the jumps of one robot one after the other. Each has a run of its own, in the world of its plan, for [`Planned::judge`]; the last one is that
/// after which the robot does not stand.
///
/// # Errors
/// A sentence: a jump needs an edge, which the ground of the next one would lack; the machine refuses one, this build lacks the simulator, or that fails.
pub fn run_in_a_row(jumps: &[Planned], trial: &Trial<'_>) -> Result<Vec<Run>, String> {
    if let Some(Planned { task, .. }) = jumps.iter().find(|jump| jump.task.edge.is_some()) {
        return Err(format!(
            "{}: jumps in a row are on flat ground, and this one is off or onto an edge",
            task.name
        ));
    }
    let jumps = jumps.iter().map(|jump| (&jump.task, &jump.reference));
    let jumps: Vec<_> = jumps.collect();
    run_all(&jumps, trial, (&mut |_, _| {}, &mut |_| {}), &mut |_, _| {})
}

/// [`run_in_a_row`], watched as in [`run_watched`](super::execute::run_watched), and compiled once and here: robot, simulators and controllers are large.
pub(super) fn run_all(
    jumps: &[(&Task, &Reference)],
    trial: &Trial<'_>,
    (tamper, watch): (&mut Tamper<'_>, &mut Watch<'_>),
    progress: &mut dyn FnMut(f64, Phase),
) -> Result<Vec<Run>, String> {
    let Some((first, _)) = jumps.first() else {
        return Ok(Vec::new());
    };
    let robot = first.robot;
    let (drives, build) = (robot.drives(), robot.build(&first.start));
    let mut settings = Settings::new(&build, robot.feet, drives, first.start.joints);
    for measure in trial.without {
        measure.leave(&mut settings);
    }
    let read = jumps
        .iter()
        .map(|(_, reference)| Stored::read(&reference.bytes));
    let stored: Result<Vec<_>, _> = read.collect();
    let stored = stored.map_err(|error| error.to_string())?;
    let mut workspace = Workspace::new();
    let mut closed = closed(
        (robot, feet(&robot)),
        Machine::<_, _, JOINTS, FOOT_COUNT>::new(&robot, settings, &mut workspace),
        plant(trial.sim, first, &trial.disturbance)?,
        trial,
    );
    let mut runs = Vec::new();
    for ((task, reference), stored) in jumps.iter().zip(&stored) {
        let jump = Jump::stored(stored).map_err(|error| error.to_string())?;
        let hold = HOLD.max(settings.least_hold(&jump.plan));
        let mut frame = Transform::IDENTITY;
        if runs.is_empty() {
            closed.begin(-hold);
        } else {
            match begin_anew(&mut closed, task) {
                Some(here) => frame = here,
                None => break,
            }
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
        run.final_phase = closed.machine.phase();
        run.fault = closed.machine.fault();
        run.estimate_errors = closed.sensors.worst;
        runs.push(run);
        if closed.machine.phase() != Phase::Stand {
            break;
        }
    }
    Ok(runs)
}

/// The robot stands, and begins the task where it does: pose of the simulator's world in that of the task. None where a foot is in the air.
fn begin_anew(closed: &mut Closed<'_>, task: &Task) -> Option<Transform<f64>> {
    let (middle, heading) = place(task, &closed.world.configuration());
    let (first_middle, first_heading) = place(task, &task.start);
    let turned = heading_matrix(first_heading - heading);
    let world = Transform::new(turned, first_middle - turned * middle);
    let stands = closed.sensors.stand_at(&first_middle, first_heading, world);
    stands.then_some(world)
}

/// Middle of the feet in the world, and the heading, rad.
fn place(task: &Task, q: &State) -> (Vector3<f64>, f64) {
    let ahead = q.base.rotation * Vector3::x();
    (
        middle_of_feet(&task.robot, &q.base, &q.joints),
        so3::math::atan2(ahead.y, ahead.x),
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{Planned, Trial, run_in_a_row};
    use crate::Sim;
    use core::ops::ControlFlow;
    use jump_planner::task::Task;
    use jump_planner::{Options, plan};

    fn planned(name: &str) -> Planned {
        let task = Task::load(name).unwrap();
        let found = plan(&task, &Options::default(), |_, _| ControlFlow::Continue(()));
        Planned::open(&task.robot, &found.unwrap().bytes, Task::load).unwrap()
    }

    /// Of jumps that each move and turn the robot: the first is the one that it is alone, and each is on target from where the last one has ended.
    #[test]
    fn each_jump_begins_where_the_last_has_ended() {
        let jumps = ["a1/lateral", "a1/spin-90", "a1/lateral"].map(planned);
        let trial = Trial::nominal(Sim::Native);
        let runs = run_in_a_row(&jumps, &trial).unwrap();
        assert_eq!(runs.len(), 3);
        for (jump, run) in jumps.iter().zip(&runs) {
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
        assert_eq!(way(&runs[0]), way(&alone));
    }

    #[test]
    fn an_edge_is_refused_by_name() {
        let jumps = ["a1/lateral", "a1/lateral-down"].map(planned);
        let refused = run_in_a_row(&jumps, &Trial::nominal(Sim::Native));
        assert!(refused.is_err_and(|why| why.contains("a1/lateral-down")));
    }
}
