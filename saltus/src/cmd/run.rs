//! `saltus run`: plan a jump, execute it in simulation, report.

use crate::humanoid;
use crate::jump::judge::Verdict;
use crate::jump::planned::Planner;
use crate::jump::plant::{Disturbance, Sim};
use crate::jump::task::{SrbPlan, Task};
use crate::jump::{execute, log, reference, report};
use crate::report::Line;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Options of `saltus run`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Task, such as a1/lateral.
    task: String,
    /// Simulator.
    #[arg(long, default_value = "native")]
    sim: Sim,
    /// Seed of the disturbances: 0 is the nominal run, others draw masses, friction, rotor inertia, latency and noise.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// How the legs are planned along the single rigid body's motion.
    #[arg(long, default_value = "whole-body")]
    planner: Planner,
    /// Humanoid tasks: height to gain in flight, m.
    #[arg(long, default_value_t = 0.04)]
    height: f64,
    /// Humanoid tasks: leave the angular momentum alone.
    #[arg(long)]
    no_momentum: bool,
    /// Humanoid tasks: share of the joints' torque limits that there is.
    #[arg(long, default_value_t = 1.0)]
    torque_share: f64,
    /// Humanoid tasks: what holds the robot in flight and landing.
    #[arg(long, default_value = "qp")]
    landing: humanoid::Landing,
    /// How the plant differs, instead of a seed's draw: mass=1.1,friction=0.4,latency=2,noise.
    #[arg(long)]
    plant: Option<Disturbance>,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
    /// New folder for report, log and result; by default out/TASK, or out/TASK-2 and so on if that exists.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<ExitCode, String> {
    if let Some(task) = humanoid::Task::named(&args.task) {
        let task = humanoid::Task {
            height: args.height,
            momentum: !args.no_momentum,
            torque_share: args.torque_share,
            landing: args.landing,
            ..task
        };
        return run_humanoid(args, &task);
    }
    if args.plant.is_some() {
        return Err("--plant is for humanoid tasks: use --seed for this one".into());
    }
    let task = Task::load(&args.task)?;
    if let Some(path) = args.out.as_deref().filter(|path| path.exists()) {
        return Err(taken(path));
    }
    let bar = if args.json {
        ProgressBar::hidden()
    } else {
        ProgressBar::new(1000)
    };
    let style =
        ProgressStyle::with_template("{msg:28} [{bar:40}] {elapsed}").map_err(|e| e.to_string())?;
    bar.set_style(style.progress_chars("=> "));
    bar.set_message("planning the body's motion");
    let plan = task.solve()?;
    bar.set_message("planning the legs");
    bar.set_position(50);
    let reference = args.planner.plan(&task, &plan)?;
    let clock = Instant::now();
    let end = execute::HOLD + reference.touchdown + execute::SETTLE;
    let run = execute::run(&task, &reference, args.sim, args.seed, |t, phase| {
        bar.set_message(format!("simulating: {phase:?}"));
        bar.set_position(100 + (900.0 * (t + execute::HOLD) / end) as u64);
    })?;
    let wall = clock.elapsed().as_secs_f64();
    bar.finish_and_clear();
    let verdict = Verdict::of(&task, &run);
    let json = verdict.json(&task, &plan, &reference, &run, args.sim, args.seed);
    // Only a run that came to its end leaves a folder.
    let folder = new_folder(args.out.as_deref(), &task.name)?;
    write(&folder, "log.csv", &log::csv(&run.samples))?;
    write(&folder, "result.json", &format!("{json:#}\n"))?;
    let table = table(&task, &plan, &reference, &run, &verdict, args.sim, wall);
    write(
        &folder,
        "report.html",
        &report::html(&task, &reference, &run, &table),
    )?;
    if args.json {
        println!("{json}");
    } else {
        for (name, value, _) in &table {
            println!("{name:18} {value}");
        }
        println!("report: {}", folder.join("report.html").display());
    }
    Ok(if verdict.on_target() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(2)
    })
}

/// Runs a jump of paper B.
fn run_humanoid(args: &Args, task: &humanoid::Task) -> Result<ExitCode, String> {
    if let Some(path) = args.out.as_deref().filter(|path| path.exists()) {
        return Err(taken(path));
    }
    let disturbance = args.plant.unwrap_or_else(|| Disturbance::draw(args.seed));
    let run = humanoid::execute::run(task, args.sim, &disturbance, args.seed, |_, _| {})?;
    let verdict = humanoid::judge::Verdict::of(&run);
    let json = verdict.json(task, &run, args.seed, args.sim.name());
    // Figure 6 of paper B compares a jump with one that leaves the angular momentum alone.
    let free = if task.momentum {
        let free = humanoid::Task {
            momentum: false,
            ..*task
        };
        Some(humanoid::execute::run(
            &free,
            args.sim,
            &disturbance,
            args.seed,
            |_, _| {},
        )?)
    } else {
        None
    };
    let folder = new_folder(args.out.as_deref(), task.name())?;
    write(&folder, "log.csv", &humanoid::log::csv(&run.samples))?;
    write(&folder, "result.json", &format!("{json:#}\n"))?;
    let table = verdict.table(task, &run, args.sim.name());
    write(
        &folder,
        "report.html",
        &humanoid::report::html(task, &run, free.as_ref(), &table)?,
    )?;
    if args.json {
        println!("{json}");
    } else {
        for (name, value, _) in &table {
            println!("{name:26} {value}");
        }
        println!("report: {}", folder.join("report.html").display());
    }
    Ok(if verdict.on_target(task) {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(2)
    })
}

/// The result for people.
fn table(
    task: &Task,
    plan: &SrbPlan,
    reference: &reference::Reference,
    run: &execute::Run,
    verdict: &Verdict,
    sim: Sim,
    wall: f64,
) -> Vec<Line> {
    let yes = |b: bool| if b { "yes" } else { "NO" }.to_owned();
    let seconds = |x: Option<f64>| x.map_or("never".to_owned(), |x| format!("{x:.3} s"));
    let span = run.samples.len() as f64 * 1e-3;
    let plain = |name, value| (name, value, None);
    let limit = a1_model::MOTORS[0].torque;
    vec![
        plain("task", task.name.clone()),
        plain(
            "body plan",
            format!(
                "solved in {:.0} ms, {} iterations, phases {:.3?} s",
                plan.wall_ms, plan.iterations, reference.durations
            ),
        ),
        (
            "leg plan",
            format!(
                "{}; torque {:.1} of {limit:.1} N m, friction {:.2} of 0.60",
                reference.whole_body.map_or_else(
                    || "leg kinematics, not a whole-body optimum".to_owned(),
                    |solved| format!(
                        "whole body solved in {:.0} ms, {} iterations",
                        solved.wall_ms, solved.iterations
                    )
                ),
                reference.peak_torque,
                reference.peak_friction
            ),
            Some(reference.peak_torque <= limit && reference.peak_friction <= 0.60),
        ),
        plain(
            "simulated",
            format!(
                "{span:.1} s in {wall:.1} s, {} simulator, 10 kHz",
                sim.name()
            ),
        ),
        ("landed", yes(verdict.landed), Some(verdict.landed)),
        (
            "upright after 2 s",
            yes(verdict.upright),
            Some(verdict.upright),
        ),
        plain("first contact", seconds(run.first_contact)),
        (
            "position error",
            format!("{:.3} m", verdict.position_error),
            Some(verdict.position_error <= 0.10),
        ),
        (
            "orientation error",
            format!("{:.1} deg", verdict.orientation_error),
            Some(verdict.orientation_error <= 10.0),
        ),
        plain("apex of the CoM", format!("{:.3} m", verdict.apex)),
        plain("peak torque", format!("{:.1} N m", run.peak_torque)),
        plain(
            "torque saturation",
            format!(
                "{:.1} ms in the push-off, {:.1} ms in the landing",
                run.push_off_saturation * 1e3,
                run.landing_saturation * 1e3
            ),
        ),
        plain("peak foot force", format!("{:.0} N", run.peak_foot_force)),
        (
            "trunk touched",
            if run.trunk_contact { "YES" } else { "no" }.to_owned(),
            Some(verdict.trunk_is_right),
        ),
        plain(
            "landing QP",
            format!(
                "{} solves, {} failures, at most {} iterations",
                run.qp_solves, run.qp_failures, run.qp_max_iterations
            ),
        ),
    ]
}

fn taken(path: &Path) -> String {
    format!(
        "{} exists already: choose another --out, nothing is overwritten",
        path.display()
    )
}

/// A folder that did not exist before.
pub(super) fn new_folder(wanted: Option<&Path>, task: &str) -> Result<PathBuf, String> {
    let create = |path: &Path| {
        let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
        parent
            .map_or(Ok(()), std::fs::create_dir_all)
            .and_then(|()| std::fs::create_dir(path))
    };
    let describe = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    if let Some(path) = wanted {
        create(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::AlreadyExists => taken(path),
            _ => describe(path, error),
        })?;
        return Ok(path.to_owned());
    }
    let name = task.replace('/', "-");
    for i in 1..10_000 {
        let path = Path::new("out").join(if i == 1 {
            name.clone()
        } else {
            format!("{name}-{i}")
        });
        match create(&path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(describe(&path, error)),
        }
    }
    Err("out/ holds ten thousand runs of this task: clean it up".into())
}

pub(super) fn write(folder: &Path, name: &str, text: &str) -> Result<(), String> {
    let path = folder.join(name);
    std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))
}
