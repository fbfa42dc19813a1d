//! Plans jumps of legged robots.

mod audit;
mod cmd;
mod humanoid;
mod jump;
mod noise;
mod observer;
mod reference;
mod report;
mod reproduce;
mod robot;
mod track;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

#[derive(Parser)]
#[command(version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Plan a jump.
    Plan(cmd::plan::Args),
    /// Audit a stored plan again.
    Verify(cmd::verify::Args),
    /// Turn a URDF into a model crate.
    Import(cmd::import::Args),
    /// Plan a jump, execute it in simulation, and report.
    Run(cmd::run::Args),
    /// Run a jump many times, each disturbed otherwise, and tell how often it succeeds.
    Envelope(cmd::envelope::Args),
    /// Run both papers whole, and print their figures beside ours.
    Reproduce(cmd::reproduce::Args),
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Plan(args) => cmd::plan::run(&args),
        Command::Verify(args) => Ok(cmd::verify::run(&args)),
        Command::Import(args) => Ok(cmd::import::run(&args)),
        Command::Run(args) => cmd::run::run(&args),
        Command::Envelope(args) => cmd::envelope::run(&args),
        Command::Reproduce(args) => cmd::reproduce::run(&args),
    };
    match outcome {
        Ok(code) => code,
        Err(message) => {
            eprintln!("saltus: {message}");
            ExitCode::from(1)
        }
    }
}
