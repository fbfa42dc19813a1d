//! `saltus reproduce`: both papers, item by item.

use super::run::{new_folder, write};
use crate::jump::plant::Sim;
use crate::reproduce::{Row, humanoid, json, page, quadruped};
use indicatif::ProgressBar;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

/// Options of `saltus reproduce`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only the native simulator; the whole run adds MuJoCo, which needs a build with the feature `mujoco`.
    #[arg(long)]
    quick: bool,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
    /// New folder for the page and its reports; by default out/reproduce, or out/reproduce-2 and so on.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the command. Exit code 0 when every claim that can be judged holds, 2 when one does not.
pub(crate) fn run(args: &Args) -> Result<ExitCode, String> {
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
    let folder = new_folder(args.out.as_deref(), "reproduce")?;
    let bar = ProgressBar::new_spinner();
    bar.enable_steady_tick(Duration::from_millis(100));
    let tell = |what: &str| bar.set_message(what.to_owned());
    let mut rows = quadruped::rows(sims, &folder, tell);
    rows.extend(humanoid::rows(sims, &folder, tell));
    bar.finish_and_clear();
    let mut reports: Vec<String> = std::fs::read_dir(&folder)
        .map_err(|error| format!("{}: {error}", folder.display()))?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    reports.sort();
    let report = json(&rows);
    write(&folder, "reproduce.json", &format!("{report:#}\n"))?;
    write(&folder, "index.html", &page::html(&rows, &reports))?;
    if args.json {
        println!("{report}");
    } else {
        rows.iter().for_each(Row::print);
        println!("page: {}", folder.join("index.html").display());
    }
    Ok(if rows.iter().any(Row::is_refuted) {
        ExitCode::from(2)
    } else {
        ExitCode::SUCCESS
    })
}
