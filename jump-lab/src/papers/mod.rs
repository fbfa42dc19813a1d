//! Both papers, item by item: what they report, what comes out here, and whether their claim holds.

mod direct;
mod exponential;
mod humanoid;
mod quadruped;
mod table;
mod touchdown;

use crate::Sim;
use crate::humanoid::Task;
use crate::humanoid::execute::Run as Push;
use crate::quadruped::Planned;
use crate::quadruped::execute::Run;
use core::ops::ControlFlow;

/// Who looks on while both papers are run.
pub trait Watch {
    /// What comes next; the rows end here if it breaks.
    fn next(&mut self, what: &str) -> ControlFlow<()>;

    /// A quadruped's flight under a name of its own, with its end in words.
    fn flown(&mut self, name: &str, jump: &Planned, run: &Run, end: &str);

    /// A humanoid's jump under a name of its own, and the same without its momentum rows.
    fn pushed(&mut self, name: &str, task: &Task, sim: Sim, runs: [&Push; 2]);
}

/// All rows, as they come, so that those before a break remain.
pub fn rows(sims: &[Sim], rows: &mut Vec<Row>, watch: &mut impl Watch) -> ControlFlow<()> {
    quadruped::rows(sims, rows, watch)?;
    humanoid::rows(sims, rows, watch)
}

/// One item of a paper.
pub struct Row {
    /// `A` or `B`.
    pub paper: char,
    /// Table, figure, remark or section.
    pub item: String,
    /// What the paper reports.
    pub theirs: String,
    /// What came out here.
    pub ours: String,
    /// Where ours was simulated; `None` for what needs no simulator.
    pub sim: Option<Sim>,
    /// Whether the paper's claim holds here; `None` where this program cannot judge.
    pub holds: Option<bool>,
    /// Why a claim does not hold or cannot be judged, or how it is judged.
    pub reason: String,
}

impl Row {
    /// A row to be filled.
    #[must_use]
    pub fn new(paper: char, item: impl Into<String>, theirs: impl Into<String>) -> Self {
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

    /// With what came out here, whether the claim holds by it, and how that is judged.
    #[must_use]
    pub fn ours(mut self, ours: impl Into<String>, holds: bool, reason: impl Into<String>) -> Self {
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
    #[must_use]
    pub fn mark(&self) -> &'static str {
        match self.holds {
            Some(true) => "yes",
            Some(false) => "NO",
            None => "unjudged",
        }
    }

    /// The claim does not hold.
    #[must_use]
    pub fn is_refuted(&self) -> bool {
        self.holds == Some(false)
    }
}
