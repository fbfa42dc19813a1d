//! Plans jumps of legged robots.

// They panic where nobody reads: `say`, `put` and `tell` do not.
#![deny(clippy::print_stdout, clippy::print_stderr)]

// Before all others: its macros print for them.
#[macro_use]
mod stream;

mod cmd;
mod examples;
mod humanoid;
mod plant;
mod quadruped;
mod recording;
mod report;
mod strip;
mod verdict;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use serde_json::json;
use std::process::ExitCode;
use std::sync::LazyLock;

#[derive(Parser)]
#[command(version = VERSION.as_str(), about, after_help = examples::PROGRAM)]
struct Cli {
    /// Runs and audits at the same time, and threads of a solve [default: as many as there are cores]. Results do not depend on it.
    #[arg(long, global = true, value_name = "N", allow_negative_numbers = true, value_parser = cmd::output::whole(1..=1024))]
    jobs: Option<u64>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Plan a jump.
    #[command(after_help = examples::PLAN)]
    Plan(cmd::plan::Args),
    /// Audit a stored plan again.
    #[command(after_help = examples::VERIFY)]
    Verify(cmd::verify::Args),
    /// Turn a URDF into a model crate.
    #[command(after_help = examples::IMPORT)]
    Import(cmd::import::Args),
    /// Plan a jump or take a stored plan, execute it in simulation, and report.
    #[command(after_help = examples::RUN)]
    Run(cmd::run::Args),
    /// Watch runs in a browser: one's report, or several side by side.
    #[command(after_help = examples::WATCH)]
    Watch(cmd::watch::Args),
    /// Run a jump many times, each disturbed otherwise, and tell how often it succeeds.
    #[command(after_help = examples::ENVELOPE)]
    Envelope(cmd::envelope::Args),
    /// Run tasks in both simulators and print their verdicts as a table, or compare them with the expected ones.
    #[command(after_help = examples::VERDICTS)]
    Verdicts(cmd::verdicts::Args),
    /// Run both papers whole, and print their figures beside ours.
    #[command(after_help = examples::REPRODUCE)]
    Reproduce(cmd::reproduce::Args),
    /// Print the script with which a shell completes these commands.
    #[command(after_help = examples::COMPLETIONS)]
    Completions(cmd::completions::Args),
}

/// What `--version` prints: with the simulator that this build has besides its own, or how to get it.
static VERSION: LazyLock<String> = LazyLock::new(|| {
    let own = env!("CARGO_PKG_VERSION");
    #[cfg(feature = "mujoco")]
    let more = format!("with MuJoCo {}", contact_sim::mujoco_version());
    #[cfg(not(feature = "mujoco"))]
    let more = "without MuJoCo; in the workspace, `cargo xtask mujoco build --release -p saltus --features mujoco` builds with it";
    format!("{own} ({more})")
});

impl Command {
    /// Whether errors are JSON too.
    fn is_json(&self) -> bool {
        match self {
            Self::Plan(args) => args.output.json,
            Self::Verify(args) => args.output.json,
            Self::Import(args) => args.output.json,
            Self::Run(args) => args.output.json,
            Self::Watch(args) => args.output.json,
            Self::Envelope(args) => args.output.json,
            Self::Verdicts(args) => args.output.json,
            Self::Reproduce(args) => args.output.json,
            Self::Completions(_) => false,
        }
    }
}

fn main() -> ExitCode {
    let Cli { jobs, command } = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return stream::finish(grammar(&error)),
    };
    if let Some(jobs) = jobs {
        let threads = usize::try_from(jobs).unwrap_or(1);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        // Fails only where a pool is there already: nothing has begun.
        let _ = pool.build_global();
    }
    let outcome = match &command {
        Command::Plan(args) => cmd::plan::run(args),
        Command::Verify(args) => cmd::verify::run(args),
        Command::Import(args) => cmd::import::run(args),
        Command::Run(args) => cmd::run::run(args),
        Command::Watch(args) => cmd::watch::run(args),
        Command::Envelope(args) => cmd::envelope::run(args),
        Command::Verdicts(args) => cmd::verdicts::run(args),
        Command::Reproduce(args) => cmd::reproduce::run(args),
        Command::Completions(args) => cmd::completions::run(args, Cli::command()),
    };
    stream::finish(outcome.unwrap_or_else(|failure| failure.tell(command.is_json())))
}

/// Help, version, and what the grammar of the command line refuses.
fn grammar(error: &clap::Error) -> ExitCode {
    let text = error.render().to_string();
    // Help is as long as it is; what repeats an argument is cut, and then goes without colours.
    let is_help = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    let told = cmd::failure::brief(&text);
    // What is refused is not read any further, so that nobody else knows that JSON was asked for.
    if error.use_stderr() && !is_help && std::env::args_os().any(|word| word == "--json") {
        say!("{}", json!({ "status": "Error", "error": told.trim_end() }));
    }
    if is_help || !error.use_stderr() || told.len() + text.lines().count() >= text.len() {
        stream::clap(error);
    } else {
        tell!("{told}");
    }
    ExitCode::from(if error.use_stderr() { 2 } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::Cli;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
