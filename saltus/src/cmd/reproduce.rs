//! `saltus reproduce`: both papers, item by item.

use super::expected::{Expected, Found};
use super::failure::Failure;
use super::folder::{create, describe, write};
use super::interrupt;
use super::output::Output;
use crate::reproduce::{Row, humanoid, json, page, quadruped};
use core::ops::ControlFlow;
use jump_lab::Sim;
use std::path::PathBuf;
use std::process::ExitCode;

/// Options of `saltus reproduce`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only the native simulator; the whole run adds MuJoCo, which needs a build with the feature `mujoco`.
    #[arg(long)]
    quick: bool,
    /// A file of expected verdicts: exit code 2 where an item does not come out as it says, whatever it is.
    #[arg(long)]
    expect: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: Output,
    /// New folder for the page and its reports; by default out/reproduce, or out/reproduce-2 and so on.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the command. Exit code 0 when every claim that can be judged holds, 2 when one does not; Ctrl-C leaves the
/// page of the rows so far.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    let sims: &[Sim] = match (args.quick, cfg!(feature = "mujoco")) {
        (true, _) => &[Sim::Native],
        (false, true) => &[Sim::Native, Sim::Mujoco],
        (false, false) => {
            return Err(
                "this build has no MuJoCo: `--quick`, or `cargo xtask mujoco run --release -p saltus --features mujoco -- reproduce`"
                    .into(),
            );
        }
    };
    let expected = args.expect.as_deref().map(Expected::read).transpose()?;
    let folder = create(args.out.as_deref(), "reproduce")?;
    interrupt::listen()?;
    let bar = args.output.spinner();
    let tell = |what: &str| {
        bar.set_message(what.to_owned());
        if interrupt::asked() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let mut rows = Vec::new();
    let complete = quadruped::rows(sims, &folder, &mut rows, tell).is_continue()
        && humanoid::rows(sims, &folder, &mut rows, tell).is_continue();
    bar.finish_and_clear();
    let mut reports: Vec<String> = std::fs::read_dir(&folder)
        .map_err(|error| Failure::Outside(describe(&folder, &error)))?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    reports.sort();
    let report = json(&rows, complete);
    write(
        &folder,
        "reproduce.json",
        format!("{report:#}\n").as_bytes(),
    )?;
    write(
        &folder,
        "index.html",
        page::html(&rows, &reports).as_bytes(),
    )?;
    if args.output.json {
        say!("{report}");
    } else if !args.output.quiet {
        rows.iter().for_each(Row::print);
        say!("page: {}", folder.join("index.html").display());
    }
    Ok(if !complete {
        ExitCode::from(interrupt::CODE)
    } else if let Some(expected) = expected {
        let found: Vec<Found> = rows.iter().map(Row::found).collect();
        expected.compare_papers(&found)
    } else if rows.iter().any(Row::is_refuted) {
        ExitCode::from(2)
    } else {
        ExitCode::SUCCESS
    })
}
