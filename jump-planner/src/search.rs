//! The search for a motion of the whole body.
//!
//! First with the least torque, on intervals as short as they will be. Where that finds no motion, the search goes on on few long
//! intervals, which cost a quarter: with all the torque there is and then with less, in other durations and then in the given ones, for what
//! a rigid body can do in a time, legs with motors may not. What is found there is the guess on intervals half as long, and so on. What is not
//! found is searched for with stronger joints, which are made weaker until they are the robot's or have no motion any more.
//!
//! A first try that does not arrive takes seconds. So where it takes longer than those that do, the search on long intervals begins beside
//! it, on a core of its own if the machine has one. What comes out is the same, since the first try is waited for, and sooner.

use crate::Observe;
use crate::grid::Grid;
use crate::lengths::Lengths;
use crate::task::{SrbPlan, Task};
use crate::whole_body::{Timing, WholeBodyPlan};
use core::ops::ControlFlow;
use core::sync::atomic::{AtomicBool, Ordering};
use ocp_solver::{Progress, Status};
use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, Scope, ScopedJoinHandle};

/// Lengths of intervals on which a motion is searched for that the first try did not find.
const LONG: usize = 4;
/// Parts of an interval on the way back to short ones.
const HALVES: usize = 2;
/// Iterations after which the search begins beside the first try: easy jumps have almost arrived by then.
const SLOW: usize = 20;
/// Stack of the search beside it, B: a solver's scratch lies there, and in a build without optimisation many times.
const STACK: usize = 1 << 26;

/// A plan, or how far the search came, and the grid that it is on.
type Found<'a> = Result<(Grid<'a>, WholeBodyPlan), String>;

/// A plan on short intervals, or how far the search came; on the last grid that was tried.
pub(crate) fn searched<'a>(
    task: &'a Task,
    srb: &'a SrbPlan,
    timing: Timing,
    observer: Observe<'_>,
) -> Found<'a> {
    let lengths = match timing {
        Timing::Given => Lengths::Graded,
        // Parts of a phase have no durations of their own.
        Timing::Free => Lengths::Even(1.0),
    };
    let mut grid = Grid::new(task, srb, timing, lengths);
    let is_alone = crate::threads() == 1;
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let mut beside = None;
        let plan = grid.with_least_torque(&mut |progress| {
            if progress.iteration == SLOW && !is_alone {
                beside = Beside::begin(scope, &stop, task, srb, timing);
            }
            observer(progress)
        })?;
        if is_decided(&plan) {
            stop.store(true, Ordering::Relaxed);
            return Ok((grid, plan));
        }
        let (long, plan) = match beside {
            Some(beside) => beside.end(&stop, observer)?,
            None => on_long_intervals(task, srb, timing, observer)?,
        };
        Ok((long.after(grid), plan))
    })
}

/// Whether nothing is to be searched for any more.
const fn is_decided(plan: &WholeBodyPlan) -> bool {
    matches!(plan.outcome.status, Status::Solved | Status::Cancelled)
}

/// A search on long intervals that runs beside the first try.
struct Beside<'scope, 'a> {
    search: ScopedJoinHandle<'scope, Found<'a>>,
    progress: Receiver<Progress<f64>>,
}

impl<'scope, 'a: 'scope> Beside<'scope, 'a> {
    /// Begins it; none where the system has no thread to give.
    fn begin(
        scope: &'scope Scope<'scope, '_>,
        stop: &'scope AtomicBool,
        task: &'a Task,
        srb: &'a SrbPlan,
        timing: Timing,
    ) -> Option<Self> {
        let (tell, progress) = channel();
        let mut observer = move |progress: &Progress<f64>| {
            // Nobody listens once the first try has arrived, and then the search is stopped as well.
            let _ = tell.send(*progress);
            if stop.load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let thread = thread::Builder::new().stack_size(STACK);
        let search = move || on_long_intervals(task, srb, timing, &mut observer);
        let search = thread.spawn_scoped(scope, search).ok()?;
        Some(Self { search, progress })
    }

    /// Waits for its end, while the observer hears of every iteration since the beginning and may stop it.
    fn end(self, stop: &AtomicBool, observer: Observe<'_>) -> Found<'a> {
        for progress in self.progress {
            if observer(&progress).is_break() {
                stop.store(true, Ordering::Relaxed);
            }
        }
        match self.search.join() {
            Ok(found) => found,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

/// The search on long intervals; a motion that it finds is made one on short ones.
///
/// First in durations of its own: what the first try did not find in the given ones, long intervals rarely have in them either. Where there is
/// none at all, with stronger joints, and from there with weaker ones: that finds the motion, or how strong they would have to be.
fn on_long_intervals<'a>(
    task: &'a Task,
    srb: &'a SrbPlan,
    timing: Timing,
    observer: Observe<'_>,
) -> Found<'a> {
    let is_given = timing == Timing::Given && task.has_given_durations();
    let own = if is_given { timing } else { Timing::Free };
    let long = |timing| Grid::new(task, srb, timing, Lengths::Even(LONG as f64));
    let (mut grid, mut plan) = split(long(own), Grid::with_most_torque, observer)?;
    if !is_decided(&plan) && own != timing {
        let (given, again) = split(long(timing), Grid::with_most_torque, observer)?;
        (grid, plan) = (given.after(grid), again);
    }
    let mut ends = grid.path.iter().map(|solve| solve.status);
    if is_decided(&plan) || ends.any(|status| status == Status::Solved) {
        return Ok((grid, plan));
    }
    let mut weaker = long(own);
    let (found, stronger) = weaker.with_weakest_joints(observer)?;
    if found.outcome.status == Status::Cancelled {
        plan = found;
    } else if found.outcome.status == Status::Solved && stronger.is_none() {
        (weaker, plan) = split(weaker, |_, _| Ok(found), observer)?;
    }
    plan.stronger = stronger;
    Ok((weaker.after(grid), plan))
}

/// A plan on long intervals, and, if it is one, on ever shorter ones from there: with its torque, or with the most if they have no motion with that.
fn split<'a>(
    mut grid: Grid<'a>,
    begin: impl FnOnce(&mut Grid<'a>, Observe<'_>) -> Result<WholeBodyPlan, String>,
    observer: Observe<'_>,
) -> Found<'a> {
    let mut plan = begin(&mut grid, observer)?;
    let mut left = LONG;
    // In halves: at once in as many parts as there will be, a motion is too far from the next one for half of those jumps.
    while plan.outcome.status == Status::Solved && left > 1 {
        left /= HALVES;
        grid = grid.split(HALVES);
        plan = grid.resume(observer)?;
        if !is_decided(&plan) && grid.allow_most_torque() {
            plan = grid.resume(observer)?;
        }
    }
    Ok((grid, plan))
}
