//! `cargo xtask bench`: our code beside its peers, in pinned versions from pip, as tables of ratios.

pub(crate) mod dynamics;
mod scripts;

use anyhow::Result;
use scripts::Table;

/// Arguments of `cargo xtask bench`.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Rigid-body dynamics beside Pinocchio and CasADi-generated C.
    Dynamics(dynamics::Args),
    /// Quadratic programs beside DAQP and Clarabel.
    Qp,
    /// Plans on the single rigid body beside CasADi and IPOPT.
    Srb(scripts::Args),
    /// Plans of the whole body beside CasADi and IPOPT.
    WholeBody(scripts::Args),
    /// A tick of whole-body control beside DAQP, and TSID where it is there.
    Wbc,
    /// Every table, one after the other.
    All(scripts::Args),
}

pub(crate) fn run(args: &Args) -> Result<()> {
    match &args.what {
        What::Dynamics(args) => dynamics::run(args),
        What::Qp => scripts::run(Table::Qp, false),
        What::Srb(args) => scripts::run(Table::Srb, args.short),
        What::WholeBody(args) => scripts::run(Table::WholeBody, args.short),
        What::Wbc => scripts::run(Table::Wbc, false),
        What::All(args) => {
            println!("== dynamics");
            dynamics::run(&dynamics::Args {
                rounds: if args.short { 1 } else { 9 },
                milliseconds: if args.short { 1 } else { 10 },
                check: false,
            })?;
            Table::ALL
                .into_iter()
                .try_for_each(|table| scripts::run(table, args.short))
        }
    }
}
