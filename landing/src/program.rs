//! The force program of a tick written out for solvers of general programs.

use dense_qp::Problem;
use nalgebra::Vector3;
use so3::Scalar;

use crate::Workspace;

/// The program of a landing tick over the forces of all feet in world axes: `V` must be 3 F, `M` 4 F + N. Rows are four of friction
/// per foot and then one per joint; feet in the air have bounds [0, 0].
#[derive(Clone, Debug)]
pub struct Program<T, const V: usize, const M: usize> {
    hessian: [[T; V]; V],
    gradient: [T; V],
    rows: [[T; V]; M],
    spans: [[usize; 2]; M],
    row_lower: [T; M],
    row_upper: [T; M],
    lower: [T; V],
    upper: [T; V],
}

impl<T: Scalar, const V: usize, const M: usize> Program<T, V, M> {
    /// The program of the last tick that had one.
    #[must_use]
    pub fn of<const N: usize, const F: usize>(workspace: &Workspace<T, N, F>) -> Self {
        const { assert!(V == 3 * F && M == 4 * F + N, "V must be 3 F and M 4 F + N") };
        let mut program = Self {
            hessian: [[T::ZERO; V]; V],
            gradient: [T::ZERO; V],
            rows: [[T::ZERO; V]; M],
            spans: [[0; 2]; M],
            row_lower: [-T::INFINITY; M],
            row_upper: [T::ZERO; M],
            lower: [T::ZERO; V],
            upper: [T::ZERO; V],
        };
        program.write_cost(workspace);
        program.write_limits(workspace);
        program
    }

    /// The program, to be solved.
    #[must_use]
    pub const fn problem(&self) -> Problem<'_, T, V, M> {
        Problem::new(
            &self.hessian,
            &self.gradient,
            &self.rows,
            &self.row_lower,
            &self.row_upper,
        )
        .with_bounds(&self.lower, &self.upper)
        .with_spans(&self.spans)
    }

    /// H = BᵀB + w_e and g = −Bᵀb.
    fn write_cost<const N: usize, const F: usize>(&mut self, workspace: &Workspace<T, N, F>) {
        let forces = &workspace.forces;
        for (i, row) in self.hessian.iter_mut().enumerate() {
            let Some(arm) = forces.arms.get(i / 3) else {
                return;
            };
            let mut axis = Vector3::zeros();
            axis[i % 3] = T::ONE;
            let wrench = arm.wrench(&axis);
            for (block, arm) in row.chunks_mut(3).zip(&forces.arms) {
                block.copy_from_slice(arm.pull(&wrench).as_slice());
            }
            if let Some(x) = row.get_mut(i) {
                *x += forces.effort;
            }
        }
        for (block, arm) in self.gradient.chunks_mut(3).zip(&forces.arms) {
            block.copy_from_slice((-arm.pull(&forces.wanted)).as_slice());
        }
    }

    fn write_limits<const N: usize, const F: usize>(&mut self, workspace: &Workspace<T, N, F>) {
        let forces = &workspace.forces;
        let limits = &forces.limits;
        let rows = self.rows.iter_mut().zip(&mut self.spans);
        let mut rows = rows.zip(self.row_lower.iter_mut().zip(&mut self.row_upper));
        for (foot, on) in forces.on.iter().enumerate() {
            let columns = [3 * foot, 3 * foot + 3];
            for number in 0..4 {
                let Some(((row, span), _)) = rows.next() else {
                    return;
                };
                if *on {
                    put(row, span, columns, &limits.row(number).normal);
                }
            }
        }
        for (j, ((row, span), (least, most))) in rows.enumerate() {
            let leg = limits
                .legs
                .iter()
                .zip(&forces.on)
                .position(|([first, last], on)| *on && (*first..*last).contains(&j));
            if let (Some(foot), Some(torque)) = (leg, limits.torques.get(j)) {
                put(row, span, [3 * foot, 3 * foot + 3], &torque.normal);
                (*least, *most) = (torque.least, torque.most);
            }
        }
        let bounds = self.lower.chunks_mut(3).zip(self.upper.chunks_mut(3));
        for ((lower, upper), on) in bounds.zip(&forces.on) {
            if *on {
                // Without friction there is no force to the side, however large the normal force may be: 0 · ∞ would be NaN.
                let side = if limits.friction > T::ZERO {
                    limits.friction * limits.top
                } else {
                    T::ZERO
                };
                lower.copy_from_slice(&[-side, -side, T::ZERO]);
                upper.copy_from_slice(&[side, side, limits.top]);
            }
        }
    }
}

/// A row that speaks of one foot's force only.
fn put<T: Scalar, const V: usize>(
    row: &mut [T; V],
    span: &mut [usize; 2],
    [from, to]: [usize; 2],
    normal: &Vector3<T>,
) {
    if let Some(entries) = row.get_mut(from..to) {
        entries.copy_from_slice(normal.as_slice());
        *span = [from, to];
    }
}
