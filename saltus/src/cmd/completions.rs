//! `saltus completions`: what a shell needs to complete this program's command lines.

use super::failure::Failure;
use clap::Command;
use clap_complete::Shell;
use std::process::ExitCode;

/// Options of `saltus completions`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The shell.
    shell: Shell,
}

/// Prints the script.
pub(crate) fn run(args: &Args, mut program: Command) -> Result<ExitCode, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "saltus", &mut script);
    put!("{}", String::from_utf8_lossy(&script));
    Ok(ExitCode::SUCCESS)
}
