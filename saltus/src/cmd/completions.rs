//! `saltus completions`: what a shell needs to complete this program's command lines.

use clap::Command;
use clap_complete::Shell;
use std::io::{self, Write};
use std::process::ExitCode;

/// Options of `saltus completions`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The shell.
    shell: Shell,
}

/// Prints the script.
pub(crate) fn run(args: &Args, mut program: Command) -> Result<ExitCode, String> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "saltus", &mut script);
    let written = io::stdout().write_all(&script);
    written.map_err(|error| format!("the script cannot be written: {error}"))?;
    Ok(ExitCode::SUCCESS)
}
