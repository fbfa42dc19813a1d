//! The log of a run, one row per millisecond, whatever the robot.

use core::fmt::Write;
use jump_control::Phase;

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Time of the plan, s: negative before the push-off.
    pub time: f64,
    /// Of the machine.
    pub phase: String,
    /// In the order of the columns.
    pub numbers: Vec<f64>,
}

/// All rows, with the names of their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// Names of the numbers.
    pub columns: Vec<String>,
    /// In the order of time.
    pub rows: Vec<Row>,
}

impl Log {
    /// The table of these samples: of each time, phase and numbers.
    pub fn new(
        columns: Vec<String>,
        samples: impl IntoIterator<Item = (f64, Phase, Vec<f64>)>,
    ) -> Self {
        let rows = samples.into_iter().map(|(time, phase, numbers)| Row {
            time,
            phase: format!("{phase:?}"),
            numbers,
        });
        Self {
            rows: rows.collect(),
            columns,
        }
    }

    /// As text: time and phase, then the columns.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut out = format!("time,phase,{}\n", self.columns.join(","));
        for row in &self.rows {
            let _ = write!(out, "{:.4},{}", row.time, row.phase);
            for x in &row.numbers {
                let _ = write!(out, ",{x:.6}");
            }
            out.push('\n');
        }
        out
    }
}
