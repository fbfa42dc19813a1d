//! What stands in the way of a solution: the rows that are violated most.

use crate::kernel::larger;
use crate::stage::Stage;
use so3::Scalar;
use so3::math::max;

/// A row that is violated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocking<T> {
    /// The node.
    pub stage: usize,
    /// The row of that node.
    pub row: usize,
    /// By how much its bounds would have to give way, in the row's own units; the sign tells the side:
    /// positive above the upper bound.
    pub violation: T,
    /// Its multiplier; positive where the upper bound pushes.
    pub multiplier: T,
}

impl<T: Scalar, X: Copy, const NX: usize, const NU: usize, const NI: usize, K: Copy>
    Stage<T, X, NX, NU, NI, K>
{
    /// Violation of row `i`: `c − upper` above the upper bound, `c − lower` below the lower bound, else 0.
    ///
    /// Zero for a row that does not exist.
    #[must_use]
    pub fn violation(&self, i: usize) -> T {
        let (rows, values) = (&self.node.rows, &self.node.values.rows);
        let (Some(value), Some(lower), Some(upper)) =
            (values.get(i), rows.lower.get(i), rows.upper.get(i))
        else {
            return T::ZERO;
        };
        if i >= self.node.row_count() {
            T::ZERO
        } else if *value > *upper {
            *value - *upper
        } else if *value < *lower {
            *value - *lower
        } else {
            T::ZERO
        }
    }

    /// Largest violation of a row or of the dynamics that leave this node.
    fn worst(&self) -> T {
        let gaps = self.node.values.gap.iter();
        let gap = gaps.fold(T::ZERO, |most, gap| larger(most, *gap));
        (0..self.node.row_count()).fold(gap, |most, i| larger(most, self.violation(i)))
    }
}

/// The `N` rows that are violated most, worst first, at the point that the stages hold.
///
/// After [`Status::LocallyInfeasible`](crate::Status::LocallyInfeasible) these are the rows that block: at a
/// point of least squared violation a row is violated exactly if loosening it would help.
#[must_use]
pub fn blocking_rows<
    const N: usize,
    T: Scalar,
    X: Copy,
    const NX: usize,
    const NU: usize,
    const NI: usize,
    K: Copy,
>(
    stages: &[Stage<T, X, NX, NU, NI, K>],
) -> [Option<Blocking<T>>; N] {
    let mut worst: [Option<Blocking<T>>; N] = [None; N];
    for (k, stage) in stages.iter().enumerate() {
        let multipliers = stage.row_multipliers();
        for (row, multiplier) in multipliers.iter().enumerate().take(stage.node.row_count()) {
            let violation = stage.violation(row);
            if violation == T::ZERO {
                continue;
            }
            let mut candidate = Some(Blocking {
                stage: k,
                row,
                violation,
                multiplier: *multiplier,
            });
            for slot in &mut worst {
                let size =
                    |b: &Option<Blocking<T>>| b.map_or(T::ZERO, |b| so3::math::abs(b.violation));
                if size(&candidate) > size(slot) {
                    core::mem::swap(slot, &mut candidate);
                }
            }
        }
    }
    worst
}

/// Largest violation of any row or dynamics.
pub(crate) fn largest_violation<
    T: Scalar,
    X: Copy,
    const NX: usize,
    const NU: usize,
    const NI: usize,
    K: Copy,
>(
    stages: &[Stage<T, X, NX, NU, NI, K>],
) -> T {
    stages
        .iter()
        .fold(T::ZERO, |most, stage| max(most, stage.worst()))
}
