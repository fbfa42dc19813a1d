//! Why there is nothing to follow, in one type for all who execute what they plan.

use super::answer::Answer;
use core::fmt;

/// Why there is nothing to follow.
pub enum NoPlan {
    /// There is no plan, or none was found: what `saltus plan` answers.
    Answer(Answer),
    /// A task that no solver can begin with, or a plan that cannot be stored or followed.
    Error(String),
}

impl fmt::Display for NoPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Answer(answer) => f.write_str(&answer.text()),
            Self::Error(error) => f.write_str(error),
        }
    }
}

impl fmt::Debug for NoPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl core::error::Error for NoPlan {}

impl From<Answer> for NoPlan {
    fn from(answer: Answer) -> Self {
        Self::Answer(answer)
    }
}

impl From<String> for NoPlan {
    fn from(error: String) -> Self {
        Self::Error(error)
    }
}

impl From<NoPlan> for String {
    fn from(none: NoPlan) -> Self {
        none.to_string()
    }
}
