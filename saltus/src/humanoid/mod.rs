//! What is told of a humanoid's jump: report, table, JSON.

pub(crate) mod json;
pub(crate) mod report;
pub(crate) mod strip;
pub(crate) mod table;
