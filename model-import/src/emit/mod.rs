//! Writes a robot as Rust: one module of tables, or a whole crate around it.

mod krate;
mod module;
mod names;

pub use krate::{Crate, Dependency, commands, write_crate};
pub use module::{Provenance, module};
pub use names::{constant, is_keyword, type_name};
