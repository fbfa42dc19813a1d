//! One file per subcommand, and what they share.

pub(crate) mod completions;
pub(crate) mod envelope;
pub(crate) mod expected;
pub(crate) mod failure;
mod folder;
pub(crate) mod import;
mod interrupt;
mod leftovers;
mod no_plan;
pub(crate) mod output;
pub(crate) mod plan;
pub(crate) mod reproduce;
pub(crate) mod run;
pub(crate) mod verdicts;
pub(crate) mod verify;
pub(crate) mod watch;
