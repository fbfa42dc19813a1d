//! Several threads for one iteration: parts of the nodes for whoever is free, and a factorisation in two steps, of which one runs ahead.
//!
//! Threads are begun for each pass and end with it, which takes some tens of microseconds. Where the system has no thread to give, those that
//! are there do its work.

use crate::keep::Keep;
use crate::project::{OfControls, Work};
use crate::riccati::Direction;
use crate::rows::RowBarrier;
use crate::stage::Stage;
use crate::sweep::{At, Next, part};
use so3::Scalar;
use std::boxed::Box;
use std::sync::mpsc::channel;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, scope};

/// Nodes that a thread takes at once: few, since those in flight cost a fraction of those on four feet.
const PART: usize = 4;
/// Stack of a thread, B: derivatives lie there, and in a build without optimisation many times.
const STACK: usize = 1 << 26;

/// The nodes that nobody has taken.
struct Queue<'a, S> {
    first: usize,
    stages: &'a mut [S],
}

/// A part of the nodes: the number of the first one, and the state and the costate of the one behind them, if there is one.
type Part<'a, S, T, X, const NX: usize> = (usize, &'a mut [S], Option<(X, [T; NX])>);

impl<'a, T: Scalar, X: Copy, K, const NX: usize, const NU: usize, const NI: usize>
    Queue<'a, Stage<T, X, NX, NU, NI, K>>
{
    fn take(&mut self, at: At) -> Option<Part<'a, Stage<T, X, NX, NU, NI, K>, T, X, NX>> {
        let stages = core::mem::take(&mut self.stages);
        let (part, rest) = stages.split_at_mut(PART.min(stages.len()));
        let first = self.first;
        self.first = first.saturating_add(part.len());
        let after = rest.first().map(|next| {
            let Next { state, costate } = at.of(next);
            (*state, *costate)
        });
        self.stages = rest;
        (!part.is_empty()).then_some((first, part, after))
    }
}

/// What is behind a lock. A thread that panics ends the whole pass, so nobody reads what it may have left half done.
fn lock<V>(mutex: &Mutex<V>) -> MutexGuard<'_, V> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Works here and on as many threads more, or as many as there are. Not generic, as little here is: what `std` does for it is compiled once
/// and not for every pass of every problem.
fn share(more: usize, worker: &(dyn Fn() + Sync)) {
    scope(|scope| {
        for _ in 0..more {
            let thread = Builder::new().stack_size(STACK);
            if thread.spawn_scoped(scope, worker).is_err() {
                break;
            }
        }
        worker();
    });
}

/// What comes out here, while the other runs beside it; nothing where there is no thread to be had.
fn run_beside<'a>(
    other: Box<dyn FnOnce() + Send + 'a>,
    here: Box<dyn FnOnce() -> Option<bool> + 'a>,
) -> Option<bool> {
    scope(|scope| {
        let thread = Builder::new().stack_size(STACK);
        thread.spawn_scoped(scope, other).ok()?;
        here()
    })
}

/// See [`crate::sweep::each`].
pub(crate) fn each<T: Scalar, X, O, K, const NX: usize, const NU: usize, const NI: usize>(
    workers: usize,
    stages: &mut [Stage<T, X, NX, NU, NI, K>],
    at: At,
    begin: impl Fn() -> O + Sync,
    work: impl Fn(&mut O, usize, &mut Stage<T, X, NX, NU, NI, K>, Option<Next<'_, T, X, NX>>) + Sync,
    end: impl FnMut(O) + Send,
) where
    X: Copy + Send + Sync,
    K: Send,
{
    let parts = stages.len().div_ceil(PART);
    let queue = Mutex::new(Queue { first: 0, stages });
    let end = Mutex::new(end);
    let worker = || {
        let mut own = begin();
        let take = || lock(&queue).take(at);
        while let Some((first, stages, after)) = take() {
            let after = after
                .as_ref()
                .map(|(state, costate)| Next { state, costate });
            part(&mut own, (first, stages), after, at, &work);
        }
        let mut end = lock(&end);
        (*end)(own);
    };
    share(workers.min(parts).saturating_sub(1), &worker);
}

/// The backward recursion ([`crate::riccati`]) beside a thread that condenses stages before it comes to them; nothing if there is none to
/// be had, or if the derivatives that both read are not kept.
pub(crate) fn factorise<T: Scalar, X, K, const NX: usize, const NU: usize, const NI: usize>(
    stages: &mut [Stage<T, X, NX, NU, NI, K>],
    barrier: RowBarrier<T>,
    shift: T,
) -> Option<bool>
where
    X: Send,
    K: Keep<T, NX, NU, NI>,
{
    stages.first()?.kept.kept()?;
    let (ready, condensed) = channel();
    let stages = stages.iter_mut().rev();
    let condense = move || {
        for stage in stages {
            let mut q = Box::new(OfControls::new());
            if let Some(d) = stage.kept.kept() {
                stage.node.condense(d, &mut q, barrier.mu, shift);
            }
            // The recursion has ended where nobody takes it.
            if ready.send((stage, q)).is_err() {
                break;
            }
        }
    };
    let recur = move || {
        let mut work = Work::new();
        let mut next = None;
        for (stage, q) in condensed {
            work.q = *q;
            let Stage { node, kept, .. } = stage;
            if !node.recur(kept.kept()?, &mut work, next, barrier) {
                return Some(false);
            }
            next = Some(&node.riccati);
        }
        Some(true)
    };
    run_beside(Box::new(condense), Box::new(recur))
}

/// The forward substitution ([`crate::riccati`]) beside a thread that does what no later node waits for; nothing as in [`factorise`].
pub(crate) fn substitute<T: Scalar, X, K, const NX: usize, const NU: usize, const NI: usize>(
    stages: &mut [Stage<T, X, NX, NU, NI, K>],
    barrier: RowBarrier<T>,
    direction: Direction<T>,
) -> Option<Direction<T>>
where
    X: Send,
    K: Keep<T, NX, NU, NI>,
{
    stages.first()?.kept.kept()?;
    let (ready, propagated) = channel::<&mut Stage<T, X, NX, NU, NI, K>>();
    // A node is completed once the next one, to which it hands multipliers, is not needed any more either.
    let complete = move || {
        let mut direction = direction;
        let mut complete =
            |stage: &mut Stage<T, X, NX, NU, NI, K>,
             next: Option<&mut Stage<T, X, NX, NU, NI, K>>| {
                let Stage { node, kept, .. } = stage;
                let next = next.map(|next| &mut next.node);
                node.complete(kept.kept()?, next, barrier, &mut direction);
                Some(())
            };
        let mut stage = propagated.recv().ok()?;
        for next in propagated {
            complete(stage, Some(&mut *next))?;
            stage = next;
        }
        complete(stage, None)?;
        Some(direction)
    };
    scope(|scope| {
        let thread = Builder::new().stack_size(STACK);
        let completed = thread.spawn_scoped(scope, complete).ok()?;
        let (mut slope, mut rest) = (T::ZERO, stages);
        while let Some((stage, tail)) = rest.split_first_mut() {
            let Stage { node, kept, .. } = &mut *stage;
            let next = tail.first_mut().map(|next| &mut next.node);
            node.propagate(kept.kept()?, next, &mut slope);
            // Without a receiver the thread has panicked, and so does this one below.
            let _ = ready.send(stage);
            rest = tail;
        }
        drop(ready);
        match completed.join() {
            Ok(found) => found.map(|mut direction| {
                direction.slope += slope;
                direction
            }),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}
