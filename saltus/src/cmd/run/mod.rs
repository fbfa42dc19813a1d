//! `saltus run`: a jump in simulation, planned now or before, with its report.

mod humanoid;
mod quadruped;

use super::failure::Failure;
use super::folder::publish;
use super::output::Output;
use super::output::{landings, planners, plant, sims, whole};
use jump_lab::Sim;
use jump_lab::humanoid as icub;
use jump_lab::lab::{Disturbance, Interface, Lab, PlantArgument};
use jump_lab::log::Log;
use jump_planner::planned::Planner;
use serde_json::Value;
use std::path::PathBuf;
use std::process::ExitCode;

/// Options of `saltus run`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// A built-in task such as a1/lateral or icub/velocity, the path of a task file, or plan.bin of `saltus plan --out`.
    #[arg(value_name = "TASK|PLAN")]
    what: String,
    /// Task of a stored plan, by which its run is judged, where it is not found under the name in the plan.
    #[arg(long)]
    task: Option<String>,
    /// Simulator.
    #[arg(long, default_value = "native", value_parser = sims())]
    sim: Sim,
    /// Seed of the lab: 0 is the nominal run, others draw what differs from the plan, and the noise.
    #[arg(long, default_value_t = 0, allow_negative_numbers = true, value_parser = whole(0..=u64::MAX))]
    seed: u64,
    /// Quadruped tasks: how the legs are planned along the single rigid body's motion [default: whole-body].
    #[arg(long, value_parser = planners())]
    planner: Option<Planner>,
    /// Quadruped tasks: jump with the robot of this URDF or profile (TOML beside a URDF) instead of the task's.
    #[arg(long)]
    robot: Option<PathBuf>,
    /// Lock joints of that robot at a position, rad or m.
    #[arg(long, value_name = "JOINT=VALUE", requires = "robot")]
    lock: Vec<String>,
    /// Humanoid tasks: height to gain in flight, m [default: 0.04].
    #[arg(long, allow_negative_numbers = true, value_parser = height)]
    height: Option<f64>,
    /// Humanoid tasks: leave the angular momentum alone.
    #[arg(long)]
    no_momentum: bool,
    /// Humanoid tasks: share of the joints' torque limits that there is [default: 1].
    #[arg(long, allow_negative_numbers = true, value_parser = share)]
    torque_share: Option<f64>,
    /// Humanoid tasks: what holds the robot in flight and landing [default: qp].
    #[arg(long, value_parser = landings())]
    landing: Option<icub::Landing>,
    /// What differs from the plan, instead of a seed's draw: lab, noise or KEY=VALUE, separated by commas, such as
    /// payload=2@0,0,0.05,ground=soft; `saltus verdicts --ranges` lists the keys.
    #[arg(long, value_parser = plant)]
    plant: Option<PlantArgument>,
    /// How the motors are commanded: torque (10 kHz), joint-pd (1 kHz over a link) or joint-pd@500.
    #[arg(long, default_value = "torque")]
    interface: Interface,
    #[command(flatten)]
    pub(crate) output: Output,
    /// File for the landing's quadratic programs, as numbers for other solvers.
    #[arg(long, hide = true)]
    programs: Option<PathBuf>,
    /// New folder for report, log and result; by default out/TASK, or out/TASK-2 and so on if that exists.
    #[arg(long)]
    out: Option<PathBuf>,
}

fn height(text: &str) -> Result<f64, String> {
    number(text)
        .filter(|x| *x > 0.0 && *x <= 1.0)
        .ok_or_else(|| "a height above 0 and up to 1 m is needed, such as 0.04".to_owned())
}

fn share(text: &str) -> Result<f64, String> {
    number(text)
        .filter(|x| *x > 0.0 && *x <= 1.0)
        .ok_or_else(|| "a share above 0 and up to 1 is needed, such as 0.8".to_owned())
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok()
}

/// Runs the command. Exit code 0 when the jump is on target, 2 when it is not or cannot be.
pub(crate) fn run(args: &Args) -> Result<ExitCode, Failure> {
    args.sim.check()?;
    let Some(task) = icub::Task::named(&args.what) else {
        args.refuse_humanoid_options()?;
        return quadruped::run(args);
    };
    args.refuse_quadruped_options()?;
    let task = icub::Task {
        height: args.height.unwrap_or(task.height),
        momentum: !args.no_momentum,
        torque_share: args.torque_share.unwrap_or(task.torque_share),
        landing: args.landing.unwrap_or(task.landing),
        ..task
    };
    humanoid::run(args, &task)
}

/// Names the first option that is given and means nothing here.
fn refuse_given(options: &[(&str, bool)], why: &str) -> Result<(), Failure> {
    match options.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(format!("{option} {why}").into()),
        None => Ok(()),
    }
}

impl Args {
    fn refuse_humanoid_options(&self) -> Result<(), Failure> {
        let options = [
            ("--height", self.height.is_some()),
            ("--no-momentum", self.no_momentum),
            ("--torque-share", self.torque_share.is_some()),
            ("--landing", self.landing.is_some()),
        ];
        let why = "is for humanoid tasks, icub/velocity and icub/torque; for a quadruped goal_m, turn and limits stand in a task file";
        refuse_given(&options, why)
    }

    fn refuse_quadruped_options(&self) -> Result<(), Failure> {
        let options = [
            ("--planner", self.planner.is_some()),
            ("--robot", self.robot.is_some()),
            ("--task", self.task.is_some()),
            ("--programs", self.programs.is_some()),
            ("--interface", self.interface != Interface::Torque),
        ];
        let why = "is for quadruped tasks; a humanoid task takes --height, --no-momentum, --torque-share and --landing, and its joints take torques";
        refuse_given(&options, why)
    }

    /// What differs from the plan in the lab of this robot.
    fn disturbance(&self, lab: Lab) -> Disturbance {
        PlantArgument::plant(self.plant.as_ref(), lab, self.seed)
    }
}

/// What a run leaves behind.
struct Files<'a> {
    task: &'a str,
    log: &'a Log,
    /// The log as MCAP.
    mcap: Vec<u8>,
    result: &'a Value,
    report: String,
    /// The jump in one picture.
    strip: String,
}

impl Files<'_> {
    /// Writes a new folder and tells where it is.
    fn publish(&self, args: &Args) -> Result<(), Failure> {
        let result = format!("{:#}\n", self.result);
        let csv = self.log.csv();
        let files = [
            ("log.csv", csv.as_bytes()),
            ("log.mcap", self.mcap.as_slice()),
            ("result.json", result.as_bytes()),
            ("report.html", self.report.as_bytes()),
            ("strip.svg", self.strip.as_bytes()),
        ];
        let folder = publish(args.out.as_deref(), self.task, &files)?;
        if args.output.json {
            say!("{}", self.result);
        } else if !args.output.quiet {
            say!("report: {}", folder.join("report.html").display());
        }
        Ok(())
    }
}

/// 0 on target, 2 not.
fn code(on_target: bool) -> ExitCode {
    if on_target {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(2)
    }
}

#[cfg(test)]
mod tests {
    use super::{height, share};

    #[test]
    fn shares_and_heights_are_numbers_that_can_be() {
        for good in ["0.04", "1"] {
            assert!(height(good).is_ok() && share(good).is_ok(), "{good}");
        }
        for bad in ["0", "-1", "nan", "inf", "1e9", "x", ""] {
            assert!(height(bad).is_err() && share(bad).is_err(), "{bad}");
        }
    }
}
