//! `saltus verify`: read a stored plan and audit it again.
//!
//! Exit code 0 for a plan that passes, 2 for one that does not or cannot be read.

use super::failure::{Failure, brief};
use super::folder::describe;
use super::output::Output;
use jump_planner::audit::{Audit, check_values};
use jump_planner::robot::Quadruped;
use jump_planner::stored::{Stored, agree, open_for};
use jump_planner::task::Task;
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;

/// Options of `saltus verify`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The container: plan.bin of `saltus plan --out`.
    file: PathBuf,
    /// URDF or profile of the robot that the plan is for; A1 without it.
    #[arg(long)]
    robot: Option<PathBuf>,
    /// Joints of that robot that were locked.
    #[arg(long, value_name = "JOINT=VALUE", requires = "robot")]
    lock: Vec<String>,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    let robot = match &args.robot {
        Some(path) => Quadruped::load(path, &args.lock)
            .map_err(|error| format!("{}: {error}", path.display())),
        None => Quadruped::a1().map_err(|error| error.to_string()),
    }?;
    let bytes =
        jump_planner::file::read(&args.file).map_err(|error| describe(&args.file, &error))?;
    let show = |error| format!("{}: {error}", args.file.display());
    let plan = open_for(&bytes, &robot).map_err(show)?;
    check_values(&robot, &plan).map_err(show)?;
    args.compare(&plan)?;
    let audit = Audit::of(&robot, &plan).map_err(show)?;
    let header = plan.header();
    let status = if audit.passes() {
        "Solved"
    } else {
        "AuditFailed"
    };
    if args.output.json {
        let report = json!({
            "task": header.task,
            "robot": header.robot,
            "status": status,
            "audit": audit.details(&robot),
        });
        say!("{report}");
    } else if !args.output.quiet {
        say!("{} for {}: {status}", header.task, header.robot);
        say!("  {}", audit.summary());
        if !audit.passes() {
            say!("  {}", audit.complaint());
        }
    }
    Ok(ExitCode::from(if audit.passes() { 0 } else { 2 }))
}

impl Args {
    /// Compares the plan with its task where that is found here: what the plan was to keep to stands nowhere else.
    fn compare(&self, plan: &Stored<'_>) -> Result<(), Failure> {
        let name = plan.header().task;
        match Task::load_for(name, self.robot.as_deref(), &self.lock) {
            Ok(task) => agree(plan.header(), &task)
                .map_err(|error| format!("{}: {error}", self.file.display()).into()),
            Err(error) => {
                if !self.output.quiet {
                    let why = brief(&error.to_string());
                    tell!(
                        "saltus: warning: goal, box and margins are not compared with the task: {why}"
                    );
                }
                Ok(())
            }
        }
    }
}
