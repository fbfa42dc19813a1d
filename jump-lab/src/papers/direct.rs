//! III of paper A: timings found on the whole body directly, against the two stages.

use super::Row;
use core::ops::ControlFlow;
use jump_planner::task::Task;
use jump_planner::whole_body::{self, Timing, WholeBodyPlan};
use ocp_solver::Status;
use std::time::Instant;

/// Tasks that are planned both ways.
const TASKS: [&str; 4] = [
    "a1/lateral",
    "a1/spin-90",
    "a1/forward-60",
    "a1/barrel-roll",
];

/// A way of planning, tried.
#[derive(Default)]
struct Tried {
    solved: usize,
    /// Seconds per task.
    seconds: Vec<f64>,
}

impl Tried {
    fn count(
        &mut self,
        plan: impl FnOnce() -> Result<WholeBodyPlan, String>,
    ) -> Result<(), String> {
        let clock = Instant::now();
        let plan = plan()?;
        self.seconds.push(clock.elapsed().as_secs_f64());
        self.solved += usize::from(plan.outcome.status == Status::Solved);
        Ok(())
    }
}

/// The row: both ways in turns, from the same guess.
pub(super) fn row() -> Row {
    let row = Row::new(
        'A',
        "III: timings optimised on the whole body directly, lateral, spin, forward 0.6 m and barrel roll",
        "too complex to solve",
    );
    let go = |_: &_| ControlFlow::Continue(());
    let (mut stages, mut direct) = (Tried::default(), Tried::default());
    let both = TASKS.iter().try_for_each(|name| {
        let task = Task::load(name).map_err(|error| error.to_string())?;
        stages.count(|| whole_body::plan(&task, &task.solve()?, Timing::Given, go))?;
        direct.count(|| whole_body::plan(&task, &task.guess()?, Timing::Free, go))
    });
    if let Err(error) = both {
        return row.failed(error);
    }
    let pairs = direct.seconds.iter().zip(&stages.seconds);
    let ratios: Vec<f64> = pairs.map(|(direct, stages)| direct / stages).collect();
    let list: Vec<String> = ratios.iter().map(|ratio| format!("{ratio:.1}")).collect();
    row.ours(
        format!(
            "{} of {} solved directly, {} in two stages; directly takes {} times as long",
            direct.solved,
            TASKS.len(),
            stages.solved,
            list.join(", ")
        ),
        direct.solved < stages.solved,
        "holds when the direct way solves fewer tasks; times are told and not judged; no audit on either side, same guess and limits",
    )
}
