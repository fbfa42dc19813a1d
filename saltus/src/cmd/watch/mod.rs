//! `saltus watch`: the report of a run in the browser, or several runs side by side on one page.

mod browser;
mod compare;
mod folder;

use super::failure::Failure;
use super::folder::{check_new, publish};
use super::output::Output;
use crate::report;
use crate::report::data::{Data, Run, VERSION};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Most runs on one page: as many colours as people tell apart.
const MOST: usize = 6;

/// Options of `saltus watch`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folders that `saltus run` wrote, or those in the folder of `saltus verdicts --out`; up to six.
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<PathBuf>,
    /// Only tell the address of the page.
    #[arg(long)]
    no_open: bool,
    #[command(flatten)]
    pub(crate) output: Output,
    /// Several runs: new folder for their page; by default out/comparison, or out/comparison-2 and so on.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the command. Exit code 0 when the page is there.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    let paths = &args.runs;
    if paths.len() > MOST {
        return Err(format!("{} runs: up to {MOST} fit on one page", paths.len()).into());
    }
    if let ([path], Some(_)) = (paths.as_slice(), &args.out) {
        let shown = path.display();
        return Err(format!("--out is for several runs: {shown} has its page already").into());
    }
    let several = paths.len() > 1;
    if several {
        check_new(args.out.as_deref())?;
    }
    let mut runs = paths
        .iter()
        .map(|path| folder::read(path))
        .collect::<Result<Vec<Run>, _>>()?;
    let page = match paths.as_slice() {
        [path] => path.join(folder::REPORT),
        _ => {
            compare::check(paths, &runs)?;
            compare::name(paths, &mut runs);
            let differences = compare::differences(&runs);
            let data = Data {
                version: VERSION,
                runs,
                differences,
            };
            let labels: Vec<&str> = data.runs.iter().map(|run| run.label.as_str()).collect();
            let title = labels.join(" · ");
            let page = report::page(&title, compare::INTRO, compare::TABLE, &data)?;
            runs = data.runs;
            let files = [(compare::PAGE, page.as_bytes())];
            publish(args.out.as_deref(), "comparison", &files)?.join(compare::PAGE)
        }
    };
    tell(args, &page, &runs)?;
    Ok(ExitCode::SUCCESS)
}

/// Tells verdicts and the page's address, and opens it where there is a screen.
fn tell(args: &Args, page: &Path, runs: &[Run]) -> Result<(), Failure> {
    let address = browser::address(page).map_err(Failure::Outside)?;
    if args.output.json {
        let verdicts = runs.iter().zip(&args.runs).map(|(run, path)| {
            json!({
                "folder": path,
                "task": run.result["task"],
                "on_target": run.result["on_target"],
                "verdict": run.verdict.words,
            })
        });
        say!(
            "{}",
            json!({ "page": page, "address": address, "runs": verdicts.collect::<Vec<_>>() })
        );
    } else if !args.output.quiet {
        for run in runs {
            say!("{}: {}", run.label, run.verdict.words);
        }
        say!("page: {address}");
    }
    if !args.no_open {
        browser::open(&address);
    }
    Ok(())
}
