//! `saltus envelope`: how often a jump succeeds, over what may differ from the plan.

mod ablation;
mod picture;
mod study;

use super::failure::Failure;
use super::folder::{check_file, check_new};
use super::interrupt;
use super::no_plan::refuse;
use super::output::{Output, whole};
use crate::cmd::output::{measures, planners, plant, sims};
use jump_lab::Sim;
use jump_lab::lab::{Interface, PlantArgument};
use jump_lab::quadruped::envelope::{Counts, table};
use jump_lab::quadruped::measure::Measure;
use jump_planner::planned::Planner;
use jump_planner::task::Task;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use study::{Shard, Study, names, shard};

/// Most runs of a study: beyond, only memory and a lifetime are used.
const MOST_SAMPLES: u64 = 10_000_000;

/// Options of `saltus envelope`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Task, such as a1/lateral.
    task: String,
    /// Number of runs over all shards.
    #[arg(long, default_value_t = 100, allow_negative_numbers = true, value_parser = whole(1..=MOST_SAMPLES))]
    samples: u64,
    /// Seed of the whole study.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true, value_parser = whole(0..=u64::MAX))]
    seed: u64,
    /// Simulator.
    #[arg(long, default_value = "native", value_parser = sims())]
    sim: Sim,
    /// How the legs are planned along the single rigid body's motion.
    #[arg(long, default_value = "whole-body", value_parser = planners())]
    planner: Planner,
    /// What differs from the plan in every run, instead of the lab of the run's seed; as in `saltus run`.
    #[arg(long, value_parser = plant)]
    plant: Option<PlantArgument>,
    /// How the motors are commanded; as in `saltus run`.
    #[arg(long, default_value = "torque")]
    interface: Interface,
    /// Measures against disturbances to do without, separated by commas.
    #[arg(long, value_name = "MEASURE", value_delimiter = ',', value_parser = measures())]
    without: Vec<Measure>,
    /// The study with all measures, and once without each.
    #[arg(long, conflicts_with = "without")]
    ablate: bool,
    /// Part k of n, from 1/n to n/n; every part may run on a machine of its own.
    #[arg(long, default_value = "1/1", value_parser = shard)]
    shard: Shard,
    /// Folder of the study; by default out/envelope-TASK, with what differs from the defaults. A study that is there already
    /// goes on.
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: Output,
}

impl Args {
    /// The folder where none is given.
    fn folder(&self, task: &Task, without: &[Measure]) -> PathBuf {
        let kind = if self.ablate { "ablation" } else { "envelope" };
        let mut name = format!("{kind}-{}", task.name.replace(['/', '\\'], "-"));
        if self.planner != Planner::WholeBody {
            name += "-";
            name += self.planner.name();
        }
        if let Some(plant) = &self.plant {
            name += "-";
            name += &plant.to_string().replace([',', '=', '@'], "-");
        }
        if self.interface != Interface::Torque {
            name += &format!("-{}", self.interface);
        }
        if !without.is_empty() {
            name += "-without-";
            name += &names(without).replace(',', "-");
        }
        Path::new("out").join(name)
    }
}

/// Runs the command. Exit code 0 when the study or its shard is complete, 2 when there is no plan to study; Ctrl-C leaves the table of the samples so far.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    args.sim.check()?;
    let task = Task::load(&args.task)?;
    let mut without = args.without.clone();
    without.sort_unstable();
    without.dedup();
    let study = Study {
        task: &task,
        planner: args.planner,
        sim: args.sim,
        samples: args.samples,
        seed: args.seed,
        plant: args.plant,
        interface: args.interface,
        shard: args.shard,
        folder: match &args.out {
            Some(folder) => folder.clone(),
            None => args.folder(&task, &without),
        },
        without,
    };
    if study.folder.is_dir() {
        check_file(&study.folder.join("samples"))?;
    } else {
        check_new(Some(&study.folder))?;
    }
    interrupt::listen()?;
    let bar = args
        .output
        .bar(0, "{msg}{pos}/{len} [{bar:40}] {elapsed}, {eta} left")?;
    let parts = if args.ablate {
        Some(ablation::parts(&study)?)
    } else {
        study.refuse_strangers()?;
        None
    };
    bar.set_message("planning ");
    let reference = match study.plan() {
        Ok(reference) => reference,
        Err(why) => {
            bar.finish_and_clear();
            return refuse(args.output, &task.name, why);
        }
    };
    let (text, result) = if let Some(parts) = parts {
        let rows = ablation::run((&study, parts), &reference, &bar)?;
        (
            ablation::text(&rows),
            json!({ "ablation": ablation::json(&rows) }),
        )
    } else {
        bar.set_message("");
        let samples = study.run(&reference, &bar)?;
        let mut text = table(&samples);
        text += &format!("{} of {} samples", samples.len(), args.samples);
        let counts = ablation::counts_json(&Counts::of(&samples));
        (text, Value::Object(counts))
    };
    bar.finish_and_clear();
    let complete = !interrupt::asked();
    if args.output.json {
        say!("{}", report(args, &study, complete, result));
    } else if !args.output.quiet {
        say!("{}\nfolder: {}", text.trim_end(), study.folder.display());
    }
    Ok(if complete {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(interrupt::CODE)
    })
}

/// The object of `--json`, with the keys of the result.
fn report(args: &Args, study: &Study<'_>, complete: bool, result: Value) -> Value {
    let without = study.without.iter().map(|measure| measure.name());
    let mut report = json!({
        "task": study.task.name,
        "sim": args.sim.name(),
        "planner": args.planner.name(),
        "seed": args.seed,
        "samples": args.samples,
        "without": without.collect::<Vec<_>>(),
        "complete": complete,
        "folder": study.folder,
    });
    if let (Value::Object(report), Value::Object(result)) = (&mut report, result) {
        report.extend(result);
    }
    report
}
