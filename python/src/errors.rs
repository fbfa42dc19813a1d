//! Errors as Python's exceptions, which `saltus/errors.py` declares.

use core::fmt::Display;

use jump_planner::answer::Answer;
use pyo3::{PyErr, import_exception};

import_exception!(saltus.errors, AuditFailed);
import_exception!(saltus.errors, OutOfTime);
import_exception!(saltus.errors, BadInput);
import_exception!(saltus.errors, Error);
import_exception!(saltus.errors, Infeasible);
import_exception!(saltus.errors, NotFound);
import_exception!(saltus.errors, Refused);

/// What cannot be used, named by `error`.
pub(crate) fn bad(error: impl Display) -> PyErr {
    BadInput::new_err(error.to_string())
}

/// What went wrong although the input could be used.
pub(crate) fn failed(error: impl Display) -> PyErr {
    Error::new_err(error.to_string())
}

/// Why there is no plan.
pub(crate) fn no_plan(answer: &Answer) -> PyErr {
    let told = (
        answer.text(),
        answer.because.clone(),
        answer.relaxations.clone(),
    );
    match answer.status {
        "Infeasible" => Infeasible::new_err(told),
        "AuditFailed" => AuditFailed::new_err(told),
        "OutOfTime" => OutOfTime::new_err(told),
        _ => NotFound::new_err(told),
    }
}
