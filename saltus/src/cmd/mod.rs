//! One file per subcommand.

mod disturb;
pub(crate) mod envelope;
pub(crate) mod import;
pub(crate) mod plan;
pub(crate) mod reproduce;
pub(crate) mod run;
pub(crate) mod verify;
