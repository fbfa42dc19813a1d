//! A jump of paper A: planned, or read from a container, and executed.

use super::{Args, Files, code};
use crate::cmd::failure::Failure;
use crate::cmd::folder::{check_file, check_new, describe, write_file};
use crate::cmd::no_plan::refuse;
use crate::quadruped::{json as result_json, report, strip};
use crate::report::{About, Line, words};
use crate::verdict;
use indicatif::ProgressBar;
use jump_lab::lab::Lab;
use jump_lab::quadruped::execute::Trial;
use jump_lab::quadruped::judge::Judged;
use jump_lab::quadruped::programs::Programs;
use jump_lab::quadruped::{Planned, execute, log};
use jump_planner::NoPlan;
use jump_planner::audit::Audit;
use jump_planner::planned::{Origin, Planner, body};
use jump_planner::reference::Reference;
use jump_planner::robot::{JOINTS, Quadruped};
use jump_planner::stored::{Stored, joint_name, open_for};
use jump_planner::task::{SrbPlan, Task};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

/// What is executed; a stored plan comes without its single rigid body.
struct Made {
    task: Task,
    srb: Option<SrbPlan>,
    reference: Reference,
    /// What the audit has against a plan that is flown all the same: its links pass through the ground or one another.
    complaint: Option<String>,
}

/// Runs the jump.
pub(super) fn run(args: &Args) -> Result<ExitCode, Failure> {
    check_new(args.out.as_deref())?;
    args.programs.as_deref().map_or(Ok(()), check_file)?;
    let bar = args.output.bar(1000, "{msg:28} [{bar:40}] {elapsed}")?;
    let path = Path::new(&args.what);
    let made = if !args.what.ends_with(".toml") && path.is_file() {
        if args.planner.is_some() {
            return Err("--planner is for tasks: a stored plan is executed as it is".into());
        }
        read(path, args)?
    } else if args.task.is_some() {
        return Err("--task is for stored plans: give the task alone".into());
    } else {
        let task = Task::load_for(&args.what, args.robot.as_deref(), &args.lock)?;
        args.output.warn_of(&task);
        match plan(args, &task, &bar) {
            Ok((srb, reference, complaint)) => Made {
                task,
                srb: Some(srb),
                reference,
                complaint,
            },
            Err(why) => {
                bar.finish_and_clear();
                return refuse(args.output, &task.name, why);
            }
        }
    };
    let (task, reference) = (&made.task, &made.reference);
    let clock = Instant::now();
    let end = execute::HOLD + reference.touchdown + execute::SETTLE;
    let progress = |t, phase| {
        bar.set_message(format!("simulating: {phase:?}"));
        bar.set_position(100 + (900.0 * (t + execute::HOLD) / end) as u64);
    };
    let trial = Trial {
        sim: args.sim,
        disturbance: args.disturbance(Lab::A1),
        seed: args.seed,
        interface: args.interface,
        without: &[],
    };
    let mut programs = Programs::default();
    let watch = |memory: &_| {
        if args.programs.is_some() {
            programs.add(memory);
        }
    };
    let run = execute::run_watched(task, reference, trial, |_, _| {}, progress, watch)?;
    if let Some(path) = args.programs.as_deref() {
        write_file(path, &programs.bytes())?;
    }
    let wall = clock.elapsed().as_secs_f64();
    bar.finish_and_clear();
    let judged = Judged::of(task, reference, &run);
    let result = result_json::json(&judged, task, made.srb.as_ref(), reference, &run, &trial);
    let table = table(&made, &run, &judged, &trial, wall);
    if args.output.is_text() {
        for (name, value, _) in &table {
            say!("{name:18} {value}");
        }
    }
    let log = log::table(&task.robot, &run.samples);
    let about = About {
        disturbance: &trial.disturbance,
        verdict: words(&judged.verdict),
        result: result.clone(),
        table: &table,
    };
    let files = Files {
        task: &task.name,
        mcap: report::mcap(task, &run, &trial.disturbance, &log).map_err(Failure::Outside)?,
        log: &log,
        report: report::html(task, reference, &run, about)?,
        result: &result,
        strip: strip::svg(task, &run, &trial.disturbance, reference.takeoff),
    };
    files.publish(args)?;
    Ok(code(judged.verdict.on_target()))
}

/// Plans the task; with the plans what the audit has against a plan that is flown all the same.
fn plan(
    args: &Args,
    task: &Task,
    bar: &ProgressBar,
) -> Result<(SrbPlan, Reference, Option<String>), NoPlan> {
    bar.set_message("planning the body's motion");
    let srb = body(task)?;
    bar.set_message("planning the legs");
    bar.set_position(50);
    let planner = args.planner.unwrap_or(Planner::WholeBody);
    let reference = planner.plan(task, &srb)?;
    let complaint = match reference.origin {
        Origin::WholeBody(_) => refusal(&task.robot, &reference)?,
        _ => None,
    };
    Ok((srb, reference, complaint))
}

/// Why `saltus plan` would refuse this plan, if it does.
fn refusal(robot: &Quadruped, reference: &Reference) -> Result<Option<String>, String> {
    let plan = open_for(&reference.bytes, robot)?;
    let audit = Audit::of(robot, &plan)?;
    Ok((!audit.passes()).then(|| audit.complaint()))
}

/// Reads a stored plan, and the task by which its run is judged.
fn read(path: &Path, args: &Args) -> Result<Made, String> {
    let bytes = jump_planner::file::read(path).map_err(|error| describe(path, &error))?;
    let show = |error: &dyn core::fmt::Display| format!("{}: {error}", path.display());
    let robot = match &args.robot {
        Some(urdf) => Quadruped::load(urdf, &args.lock)
            .map_err(|error| format!("{}: {error}", urdf.display()))?,
        None => own_robot(&bytes, args)?,
    };
    let planned = Planned::open(&robot, &bytes, |stored| {
        let name = args.task.as_deref().unwrap_or(stored);
        Task::load_for(name, args.robot.as_deref(), &args.lock)
            .map_err(|error| format!("its task cannot be read, give it with --task: {error}"))
    });
    let Planned { task, reference } = planned.map_err(|error| show(&error))?;
    Ok(Made {
        task,
        srb: None,
        reference,
        complaint: None,
    })
}

/// The robot of a stored plan's task, where that can be read, and A1 where not.
fn own_robot(bytes: &[u8], args: &Args) -> Result<Quadruped, String> {
    let stored = Stored::read(bytes).ok();
    let stored = stored.as_ref().map(|plan| plan.header().task);
    let name = args.task.as_deref().or(stored);
    let task = name.and_then(|name| Task::load_for(name, None, &args.lock).ok());
    match task {
        Some(task) => Ok(task.robot),
        None => Quadruped::a1().map_err(|error| error.to_string()),
    }
}

/// The result for people.
fn table(
    made: &Made,
    run: &execute::Run,
    judged: &Judged,
    trial: &Trial<'_>,
    wall: f64,
) -> Vec<Line> {
    let plain = |name, value| (name, value, None);
    let seconds = |x: Option<f64>| x.map_or("never".to_owned(), |x| format!("{x:.3} s"));
    let span = run.samples.len() as f64 * 1e-3;
    let mut lines = vec![plain("task", made.task.name.clone())];
    lines.extend(verdict::lines(&judged.verdict));
    lines.extend(plan_lines(made));
    if let Some(complaint) = &made.complaint {
        let refused = format!("refuses the plan, which is flown all the same: {complaint}");
        lines.push(("audit", refused, Some(false)));
    }
    lines.extend([
        plain(
            "simulated",
            format!(
                "{span:.1} s in {wall:.1} s, {} simulator, interface {}",
                trial.sim.name(),
                trial.interface
            ),
        ),
        plain(
            "plant",
            format!(
                "{}{}",
                trial.disturbance,
                if trial.is_nominal() { "nominal" } else { "" }
            ),
        ),
        plain("first contact", seconds(run.first_contact)),
        plain("apex of the CoM", format!("{:.3} m", judged.apex)),
        plain("peak torque", format!("{:.1} N m", run.peak_torque)),
        plain("peak foot force", format!("{:.0} N", run.peak_foot_force)),
        plain(
            "landing QP",
            format!(
                "{} solves, {} failures, at most {} iterations",
                run.qp_solves, run.qp_failures, run.qp_max_iterations
            ),
        ),
    ]);
    lines
}

/// What was planned, for people.
fn plan_lines(made: &Made) -> [Line; 2] {
    let Made { srb, reference, .. } = made;
    let body = srb.as_ref().map_or_else(
        || format!("stored, phases {:.3?} s", reference.durations),
        |plan| {
            format!(
                "solved in {:.0} ms, {} iterations, phases {:.3?} s",
                plan.wall_ms, plan.iterations, reference.durations
            )
        },
    );
    let legs = match reference.origin {
        Origin::Kinematics => "leg kinematics, not a whole-body optimum".to_owned(),
        Origin::RigidBody(solved) => format!(
            "legs without mass under a rigid body solved in {:.0} ms, {} iterations",
            solved.wall_ms, solved.iterations
        ),
        Origin::WholeBody(solved) => format!(
            "whole body solved in {:.0} ms, {} iterations",
            solved.wall_ms, solved.iterations
        ),
        Origin::Stored => "stored".to_owned(),
    };
    let (joint, torque, limit) = hardest(&made.task.robot, reference);
    let most = made.task.limits.friction;
    let peaks = format!(
        "{legs}; torque {torque:.1} of {limit:.1} N m ({}), friction {:.2} of {most:.2}",
        joint_name(&made.task.robot, joint),
        reference.peak_friction
    );
    let good = torque <= limit && reference.peak_friction <= most;
    [("body plan", body, None), ("leg plan", peaks, Some(good))]
}

/// The joint that the push-off takes nearest to its limit of torque, with its largest torque and the limit, N m.
fn hardest(robot: &Quadruped, reference: &Reference) -> (usize, f64, f64) {
    let nodes = reference.nodes.iter();
    let pushing = nodes.filter(|node| node.time < reference.takeoff);
    let mut torques = [0.0; JOINTS];
    for node in pushing {
        for (most, torque) in torques.iter_mut().zip(node.torques) {
            *most = f64::max(*most, torque.abs());
        }
    }
    let joints = torques.into_iter().zip(robot.drives()).enumerate();
    let joints = joints.map(|(i, (torque, drive))| (i, torque, drive.torque));
    joints
        .max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)))
        .unwrap_or_default()
}
