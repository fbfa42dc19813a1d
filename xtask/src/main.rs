//! The checks of the workspace, one command per file. `cargo xtask help` lists them.

mod bare;
mod bench;
mod board;
mod boards;
mod book;
mod c_abi;
mod ci;
mod cross;
mod devtools;
mod examples;
mod firmware;
mod firmware_lints;
mod first_hour;
mod flash_plan;
mod fuzz;
mod gen_model;
mod icount;
mod image;
mod import_check;
mod mujoco;
mod mutants;
mod package;
mod panics;
mod probe;
mod python;
mod qemu;
mod random;
mod replay;
mod report;
mod reproduce;
mod run;
mod smoke;
mod suites;
mod verdicts;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(
    name = "cargo xtask",
    about = "The checks of the Saltus workspace",
    version
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Every check but the tests themselves: what CI runs.
    Ci(ci::Args),
    /// Build every control crate alone for the bare-metal targets.
    Cross(cross::Args),
    /// Link the image whose panic handler is an undefined symbol, and see the link fail with a panic introduced.
    Smoke(smoke::Args),
    /// Run the image under QEMU and compare its numbers with the host's bit for bit.
    Qemu(qemu::Args),
    /// Check the C header, and run the C example here and on a board.
    CAbi(c_abi::Args),
    /// Fly whole jumps on the boards and hold the costs of their control ticks against budgets.
    Firmware(firmware::Args),
    /// Formatting and lints of the firmware's workspace, for the host and for bare targets.
    FirmwareLints(firmware_lints::Args),
    /// Plan the firmware's jump anew and write it where its images read it.
    FlashPlan(flash_plan::Args),
    /// Time our code beside its pinned peers and print tables of ratios.
    Bench(bench::Args),
    /// Count the instructions of every algorithm and compare with the golden file.
    Icount(icount::Args),
    /// Import many robots, compile what comes out, and compare it with Pinocchio.
    ImportCheck(import_check::Args),
    /// Look at reports, comparisons and the gallery with a real browser: not blank, moving, nothing under the ground, no complaint.
    Report(report::Args),
    /// Run both papers at their quick size and see that every item is there.
    Reproduce(reproduce::Args),
    /// Run every task in both simulators and compare the verdicts with the expected ones.
    Verdicts(verdicts::Args),
    /// The tests that take too long for `cargo test --workspace`.
    Suites(suites::Args),
    /// Type what the guide tells a newcomer to type.
    FirstHour(first_hour::Args),
    /// Build every crate from its own archive, with the oldest compiler that it promises.
    Package(package::Args),
    /// Run the examples of all crates.
    Examples(examples::Args),
    /// Hostile files and command lines for `saltus`, until the time is over.
    Fuzz(fuzz::Args),
    /// Break the source of the control crates in many small ways, and count how many of them their tests notice.
    Mutants(mutants::Args),
    /// Build the Python package, install it in an environment of its own, and run its tests and example.
    Python(python::Args),
    /// Make the book of the guide, the references and the crates' pages, and see that no link in it leads nowhere.
    Book(book::Args),
    /// Fetch the MuJoCo library and run cargo with it.
    Mujoco(mujoco::Args),
    /// Write the tables of the model crates from their URDFs, or check that they are up to date.
    GenModel(gen_model::Args),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Ci(args) => ci::run(&args),
        Command::Cross(args) => cross::run(&args),
        Command::Smoke(args) => smoke::run(&args),
        Command::Qemu(args) => qemu::run(&args),
        Command::CAbi(args) => c_abi::run(&args),
        Command::Firmware(args) => firmware::run(&args),
        Command::FirmwareLints(args) => firmware_lints::run(&args),
        Command::FlashPlan(args) => flash_plan::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Icount(args) => icount::run(&args),
        Command::ImportCheck(args) => import_check::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Reproduce(args) => reproduce::run(&args),
        Command::Verdicts(args) => verdicts::run(&args),
        Command::Suites(args) => suites::run(&args),
        Command::FirstHour(args) => first_hour::run(&args),
        Command::Package(args) => package::run(&args),
        Command::Examples(args) => examples::run(&args),
        Command::Fuzz(args) => fuzz::run(&args),
        Command::Mutants(args) => mutants::run(&args),
        Command::Python(args) => python::run(&args),
        Command::Book(args) => book::run(&args),
        Command::Mujoco(args) => mujoco::run(&args),
        Command::GenModel(args) => gen_model::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
