//! Both papers, item by item: what they report, what comes out here, and whether their claim holds.

mod direct;
mod exponential;
pub(crate) mod humanoid;
pub(crate) mod page;
pub(crate) mod quadruped;
mod touchdown;

use crate::cmd::expected::Found;
use jump_lab::Sim;
use serde_json::{Value, json};
use std::path::Path;

/// One item of a paper.
pub(crate) struct Row {
    /// `A` or `B`.
    paper: char,
    /// Table, figure, remark or section.
    item: String,
    /// What the paper reports.
    theirs: String,
    /// What came out here.
    ours: String,
    /// Where ours was simulated; `None` for what needs no simulator.
    sim: Option<Sim>,
    /// Whether the paper's claim holds here; `None` where this program cannot judge.
    holds: Option<bool>,
    /// Why a claim does not hold or cannot be judged, or how it is judged.
    reason: String,
}

impl Row {
    fn new(paper: char, item: impl Into<String>, theirs: impl Into<String>) -> Self {
        Self {
            paper,
            item: item.into(),
            theirs: theirs.into(),
            ours: String::new(),
            sim: None,
            holds: None,
            reason: String::new(),
        }
    }

    fn ours(mut self, ours: impl Into<String>, holds: bool, reason: impl Into<String>) -> Self {
        self.ours = ours.into();
        self.holds = Some(holds);
        self.reason = reason.into();
        self
    }

    fn simulated(mut self, sim: Sim) -> Self {
        self.sim = Some(sim);
        self
    }

    /// What failed before there was anything to compare.
    fn failed(self, error: impl Into<String>) -> Self {
        self.ours("failed", false, error)
    }

    fn unjudged(mut self, ours: impl Into<String>, reason: impl Into<String>) -> Self {
        self.ours = ours.into();
        self.reason = reason.into();
        self
    }

    /// As printed: yes, NO, or unjudged.
    pub(crate) fn mark(&self) -> &'static str {
        match self.holds {
            Some(true) => "yes",
            Some(false) => "NO",
            None => "unjudged",
        }
    }

    /// The claim does not hold.
    pub(crate) fn is_refuted(&self) -> bool {
        self.holds == Some(false)
    }

    fn json(&self) -> Value {
        json!({
            "paper": self.paper.to_string(),
            "item": self.item,
            "paper_value": self.theirs,
            "ours": self.ours,
            "simulator": self.sim.map(Sim::name),
            "holds": self.holds,
            "reason": self.reason,
        })
    }

    /// As the file of expected verdicts has it: `A: Table II, ...`, and `unjudged` where this program cannot judge.
    pub(crate) fn found(&self) -> Found {
        let outcome = self.mark();
        Found {
            name: format!("{}: {}", self.paper, self.item),
            sim: self.sim.map_or("any", Sim::name).to_owned(),
            outcome: outcome.to_owned(),
            words: format!("{outcome}: {} ({})", self.ours, self.reason),
        }
    }

    /// For a terminal.
    pub(crate) fn print(&self) {
        let sim = self.sim.map_or("", Sim::name);
        say!("{:3} {} {} [{sim}]", self.mark(), self.paper, self.item);
        say!("      paper: {}", self.theirs);
        say!("      here:  {}", self.ours);
        if !self.reason.is_empty() {
            say!("      {}", self.reason);
        }
    }
}

/// The object of `--json`; incomplete if the run was stopped.
pub(crate) fn json(rows: &[Row], complete: bool) -> Value {
    json!({ "complete": complete, "rows": rows.iter().map(Row::json).collect::<Vec<_>>() })
}

/// A report in a folder of its own below `folder`.
fn write_report(folder: &Path, name: &str, html: &str) -> Result<(), String> {
    let own = folder.join(name);
    let path = own.join("report.html");
    std::fs::create_dir_all(&own)
        .and_then(|()| std::fs::write(&path, html))
        .map_err(|error| format!("{}: {error}", path.display()))
}
