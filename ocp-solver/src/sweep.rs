//! Work on every node that waits for no other node's: by one thread in order, or by several (`threads.rs`).
//!
//! A node's work reads the next one's state and costate and writes its own node only, so who does it when changes no number. Sums over nodes
//! are not part of it: they are taken afterwards, in order.

use crate::stage::Stage;
use so3::Scalar;

/// Which point of the next node is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum At {
    /// The iterate.
    Iterate,
    /// The trial point of the line search.
    Trial,
}

/// What the work on a node reads of the next one.
#[derive(Debug)]
pub(crate) struct Next<'a, T, X, const NX: usize> {
    pub(crate) state: &'a X,
    /// Multiplier of the dynamics that lead there.
    pub(crate) costate: &'a [T; NX],
}

impl<T, X, const NX: usize> Clone for Next<'_, T, X, NX> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T, X, const NX: usize> Copy for Next<'_, T, X, NX> {}

impl At {
    /// What is read of a node.
    #[inline(always)]
    pub(crate) const fn of<T, X, const NX: usize, const NU: usize, const NI: usize, K>(
        self,
        stage: &Stage<T, X, NX, NU, NI, K>,
    ) -> Next<'_, T, X, NX> {
        Next {
            state: match self {
                Self::Iterate => &stage.state,
                Self::Trial => &stage.trial.0,
            },
            costate: &stage.node.costate,
        }
    }
}

/// Does `work` for every node of a part of the nodes, of which the first is number `first` and the one behind it `after`.
#[inline(always)]
pub(crate) fn part<T: Scalar, X, O, K, const NX: usize, const NU: usize, const NI: usize>(
    own: &mut O,
    (first, stages): (usize, &mut [Stage<T, X, NX, NU, NI, K>]),
    after: Option<Next<'_, T, X, NX>>,
    at: At,
    work: &impl Fn(&mut O, usize, &mut Stage<T, X, NX, NU, NI, K>, Option<Next<'_, T, X, NX>>),
) {
    let (mut rest, mut k) = (stages, first);
    while let Some((stage, tail)) = rest.split_first_mut() {
        let next = tail.first().map(|next| at.of(next)).or(after);
        work(own, k, stage, next);
        rest = tail;
        k = k.wrapping_add(1);
    }
}

/// Does `work` for every node. Each of the workers has something of its own, that `begin` makes and `end` takes back.
#[inline(always)]
pub(crate) fn each<T: Scalar, X, O, K, const NX: usize, const NU: usize, const NI: usize>(
    workers: usize,
    stages: &mut [Stage<T, X, NX, NU, NI, K>],
    at: At,
    begin: impl Fn() -> O + Sync,
    work: impl Fn(&mut O, usize, &mut Stage<T, X, NX, NU, NI, K>, Option<Next<'_, T, X, NX>>) + Sync,
    mut end: impl FnMut(O) + Send,
) where
    X: Copy + Send + Sync,
    K: Send,
{
    #[cfg(feature = "std")]
    if workers > 1 {
        crate::threads::each(workers, stages, at, begin, work, end);
        return;
    }
    let _ = workers;
    let mut own = begin();
    part(&mut own, (0, stages), None, at, &work);
    end(own);
}
