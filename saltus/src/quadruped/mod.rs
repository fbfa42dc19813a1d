//! What is told of a quadruped's jump: report, picture, JSON.

pub(crate) mod json;
pub(crate) mod report;
pub(crate) mod strip;
