//! `saltus verdicts`: many tasks in both simulators, judged, as one table; and the gate that compares them with what is expected.

mod agreement;
mod conditions;
mod gallery;
mod measures;
mod ranges;
mod subject;

use super::expected::{Expected, Found};
use super::failure::Failure;
use super::folder::check_new;
use super::interrupt;
use super::output::{Output, plant, sims, whole};
use gallery::Gallery;
use indicatif::ProgressBar;
use jump_lab::Sim;
use jump_lab::lab::{Interface, PlantArgument};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use serde_json::json;
use std::collections::HashSet;
use std::path::PathBuf;
use std::process::ExitCode;
use subject::{Cell, Condition, Subject};

/// Options of `saltus verdicts`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Tasks, by name or file; by default the nine of A1.
    tasks: Vec<String>,
    /// Simulators; by default all that this build has.
    #[arg(long, value_parser = sims())]
    sim: Vec<Sim>,
    /// What differs from the plan; as in `saltus run`.
    #[arg(long, value_parser = plant)]
    plant: Option<PlantArgument>,
    /// Seed of the lab; as in `saltus run`.
    #[arg(long, default_value_t = 0, allow_negative_numbers = true, value_parser = whole(0..=u64::MAX))]
    seed: u64,
    /// How the motors are commanded; as in `saltus run`.
    #[arg(long, default_value = "torque")]
    interface: Interface,
    /// One column per condition instead of the measures: nominal, firm and soft ground, joint friction, payload, centre of mass, and
    /// both interfaces to the motors.
    #[arg(long, conflicts_with_all = ["plant", "seed", "interface"])]
    conditions: bool,
    /// With --conditions: one column more, so many seeds of the lab.
    #[arg(long, default_value_t = 0, requires = "conditions", allow_negative_numbers = true, value_parser = whole(0..=100_000))]
    lab: u64,
    /// How far both simulators are apart at take-off, in flight and at touchdown, on hard and firm ground.
    #[arg(long, conflicts_with_all = ["sim", "plant", "seed", "interface", "conditions", "expect"])]
    agreement: bool,
    /// A file of expected verdicts, which replaces the tasks: exit code 2 where one differs, and its name.
    #[arg(long, conflicts_with_all = ["tasks", "conditions"])]
    expect: Option<PathBuf>,
    /// New folder for a gallery: a page of all tasks with their pictures, and the report of every run.
    #[arg(long, conflicts_with_all = ["conditions", "agreement"])]
    out: Option<PathBuf>,
    /// Print what may differ from the plan and the lab's ranges, and nothing else.
    #[arg(long, exclusive = true)]
    ranges: bool,
    #[command(flatten)]
    pub(crate) output: Output,
}

impl Args {
    fn sims(&self) -> Vec<Sim> {
        match (self.sim.as_slice(), cfg!(feature = "mujoco")) {
            ([], true) => vec![Sim::Native, Sim::MUJOCO],
            ([], false) => vec![Sim::Native],
            (given, _) => given.to_vec(),
        }
    }

    fn condition(&self) -> Condition {
        Condition {
            plant: self.plant,
            seed: self.seed,
            interface: self.interface,
        }
    }
}

/// Runs the command. Exit code 0 when every verdict is on target, or as expected; 2 when one is not.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    if args.ranges {
        put!("{}", ranges::markdown());
        return Ok(ExitCode::SUCCESS);
    }
    args.sim.iter().try_for_each(|sim| sim.check())?;
    once(args.tasks.iter().map(String::as_str))?;
    once(args.sim.iter().map(|sim| sim.name()))?;
    if args.agreement {
        Sim::MUJOCO.check()?;
    }
    interrupt::listen()?;
    let expected = args.expect.as_deref().map(Expected::read).transpose()?;
    let names = match &expected {
        Some(expected) => expected.tasks(),
        None if args.tasks.is_empty() => subject::A1.map(str::to_owned).to_vec(),
        None => args.tasks.clone(),
    };
    args.out
        .as_deref()
        .map_or(Ok(()), |out| check_new(Some(out)))?;
    let bar = args.output.bar(
        names.len() as u64,
        "{msg:9} [{bar:40}] {pos}/{len} {elapsed}",
    )?;
    bar.set_message("planning");
    let subjects = names.par_iter().map(|name| {
        let subject = Subject::load(name);
        bar.inc(1);
        subject
    });
    let subjects: Vec<Subject> = subjects.collect::<Result<_, String>>()?;
    if args.interface != Interface::Torque && subjects.iter().any(Subject::is_humanoid) {
        return Err("--interface is for quadruped tasks: iCub's joints take torques".into());
    }
    if args.agreement {
        bar.finish_and_clear();
        return agreement::run(args, &subjects);
    }
    let sims = args.sims();
    if args.conditions {
        return conditions::run(args, &subjects, &sims, &bar);
    }
    let gallery = args.out.as_deref().map(|out| Gallery::create(out, &names));
    let gallery = gallery.transpose()?;
    let cells = judge(&subjects, &sims, &args.condition(), gallery.as_ref(), &bar)?;
    bar.finish_and_clear();
    let verdicts = json!({ "verdicts": cells.iter().map(Cell::json).collect::<Vec<_>>() });
    let page = gallery.map(|gallery| gallery.finish(&cells, &verdicts));
    let page = page.transpose()?;
    if args.output.json {
        say!("{verdicts}");
    } else if !args.output.quiet {
        put!("{}", measures::table(&cells));
        if let Some(page) = page {
            tell!("gallery: {}", page.display());
        }
    }
    match expected {
        Some(expected) => {
            let found: Vec<Found> = cells.iter().map(Cell::found).collect();
            Ok(expected.compare_verdicts(&found))
        }
        None if cells.iter().all(Cell::on_target) => Ok(ExitCode::SUCCESS),
        None => Ok(ExitCode::from(2)),
    }
}

/// Refuses a name that is given twice: its run would be the same, and have the same place in a gallery.
fn once<'a>(names: impl Iterator<Item = &'a str>) -> Result<(), String> {
    let mut known = HashSet::new();
    for name in names {
        if !known.insert(name) {
            return Err(format!(
                "{name} is given twice: its runs would be the same, give it once"
            ));
        }
    }
    Ok(())
}

/// Every subject in every simulator under one condition.
fn judge(
    subjects: &[Subject],
    sims: &[Sim],
    condition: &Condition,
    gallery: Option<&Gallery>,
    bar: &ProgressBar,
) -> Result<Vec<Cell>, Failure> {
    let pairs: Vec<(&Subject, Sim)> = subjects
        .iter()
        .flat_map(|subject| sims.iter().map(move |sim| (subject, *sim)))
        .collect();
    bar.set_message("running");
    bar.set_length(pairs.len() as u64);
    bar.set_position(0);
    let cells = pairs.par_iter().map(|(subject, sim)| {
        let cell = subject.judge(*sim, condition, gallery);
        bar.inc(1);
        cell
    });
    cells.collect()
}
