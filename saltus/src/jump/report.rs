//! The report.
use super::execute::Run;
use super::judge::Verdict;
use super::reference::Reference;
use super::task::Task;
pub(crate) fn html(
    _: &Task,
    _: &Reference,
    _: &Run,
    _: &Verdict,
    _: &serde_json::Value,
) -> Result<String, String> {
    Ok(String::new())
}
