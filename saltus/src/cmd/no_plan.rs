//! Telling that there is nothing to execute, as `saltus plan` tells it.

use super::failure::Failure;
use super::output::Output;
use jump_planner::NoPlan;
use serde_json::json;
use std::process::ExitCode;

/// Tells why there is nothing to execute; exit code 2.
pub(super) fn refuse(output: Output, task: &str, why: NoPlan) -> Result<ExitCode, Failure> {
    let answer = match why {
        NoPlan::Answer(answer) => answer,
        NoPlan::Error(error) => return Err(error.into()),
    };
    if output.json {
        say!(
            "{}",
            json!({ "task": task, "status": answer.status, "answer": answer.json() })
        );
    } else if !output.quiet {
        say!("{task}: {}\n{}", answer.status, answer.text());
    }
    Ok(ExitCode::from(2))
}
