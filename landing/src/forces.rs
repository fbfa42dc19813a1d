//! The force QP.
//!
//! minimise w_f |Σ f − F|² + w_m |Σ r × f − M|² + w_e |f|² over the foot forces f in world axes, r from the centre
//! of mass to the foot, subject to |f_x|, |f_y| ≤ μ f_z, 0 ≤ f_z ≤ f_max and |τ| ≤ τ_max with τ = −Jᵀ f + τ_0; feet in
//! the air have bounds [0, 0], which the solver eliminates.

use dense_qp::{Problem, Status, solve_warm};
use nalgebra::{Matrix3, Vector3};
use rbd_core::Limbs;
use so3::Scalar;

use crate::{Outcome, Settings};

/// Rows that enter or leave in one solve. A tick that needs more ends with forces that keep every limit, and the next goes on from its
/// rows.
const MAX_ITERATIONS: u32 = 40;

/// What the QP needs to know of one foot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FootData<T: Scalar> {
    pub(crate) in_contact: bool,
    /// From the centre of mass to the foot, world axes.
    pub(crate) arm_w: Vector3<T>,
}

/// Wrench about the centre of mass that the forces are to make.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wrench<T: Scalar> {
    pub(crate) force_w: Vector3<T>,
    pub(crate) moment_w: Vector3<T>,
}

/// Arrays of one QP with `V` = 3 F variables and `M` = 4 F + N rows.
#[derive(Clone, Debug)]
pub(crate) struct Data<T, const V: usize, const M: usize> {
    hessian: [[T; V]; V],
    gradient: [T; V],
    rows: [[T; V]; M],
    spans: [[usize; 2]; M],
    row_lower: [T; M],
    row_upper: [T; M],
    lower: [T; V],
    upper: [T; V],
    /// Whether other feet are in contact than in the program before.
    regrouped: bool,
}

impl<T: Scalar, const V: usize, const M: usize> Data<T, V, M> {
    pub(crate) const fn new() -> Self {
        Self {
            hessian: [[T::ZERO; V]; V],
            gradient: [T::ZERO; V],
            rows: [[T::ZERO; V]; M],
            spans: [[0; 2]; M],
            row_lower: [T::ZERO; M],
            row_upper: [T::ZERO; M],
            lower: [T::ZERO; V],
            upper: [T::ZERO; V],
            regrouped: false,
        }
    }

    /// Writes H, g and the bounds of the feet.
    fn write_cost<const F: usize>(
        &mut self,
        settings: &Settings<T>,
        feet: &[FootData<T>; F],
        wanted: &Wrench<T>,
    ) {
        let (force, moment) = (settings.force_weight, settings.moment_weight);
        for (i, foot) in feet.iter().enumerate() {
            for (j, other) in feet.iter().enumerate().skip(i) {
                // w_f + w_m [r_i]×ᵀ[r_j]×, and [a]×ᵀ[b]× = (a·b) − b aᵀ.
                let (a, b) = (&foot.arm_w, &other.arm_w);
                let turn = *a * -moment;
                let mut block = b * turn.transpose();
                let diagonal = force + moment * a.dot(b);
                let effort = if i == j {
                    settings.effort_weight
                } else {
                    T::ZERO
                };
                for k in 0..3 {
                    if let Some(x) = block.get_mut((k, k)) {
                        *x += diagonal + effort;
                    }
                }
                self.put_block(i, j, &block);
                if i != j {
                    self.put_block(j, i, &block.transpose());
                }
            }
        }
        self.regrouped = false;
        let limits = self.lower.chunks_mut(3).zip(self.upper.chunks_mut(3));
        for ((gradient, (lower, upper)), foot) in self.gradient.chunks_mut(3).zip(limits).zip(feet)
        {
            let pull = wanted.force_w * settings.force_weight
                + wanted.moment_w.cross(&foot.arm_w) * settings.moment_weight;
            let top = settings.max_normal_force;
            let (low, high) = if foot.in_contact {
                let side = settings.friction * top;
                ([-side, -side, T::ZERO], [side, side, top])
            } else {
                ([T::ZERO; 3], [T::ZERO; 3])
            };
            self.regrouped |= upper.last() != high.last();
            gradient.copy_from_slice((-pull).as_slice());
            lower.copy_from_slice(&low);
            upper.copy_from_slice(&high);
        }
    }

    /// Writes one 3 × 3 block of H.
    fn put_block(&mut self, i: usize, j: usize, block: &Matrix3<T>) {
        for (row, values) in self.hessian.iter_mut().skip(3 * i).zip(block.row_iter()) {
            for (slot, x) in row.iter_mut().skip(3 * j).zip(values.iter()) {
                *slot = *x;
            }
        }
    }

    /// The program as it stands.
    pub(crate) const fn problem(&self) -> Problem<'_, T, V, M> {
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

    /// Writes the rows: four of friction per foot, then one per joint.
    fn write_rows<const N: usize, const F: usize>(
        &mut self,
        settings: &Settings<T>,
        feet: &[FootData<T>; F],
        limbs: &Limbs<T, N, F>,
        other_torques: &[T; N],
        max_torques: &[T; N],
    ) {
        let limits = self.row_lower.iter_mut().zip(self.row_upper.iter_mut());
        let shapes = self.rows.iter_mut().zip(&mut self.spans);
        let mut rows = shapes.zip(limits);
        for (i, foot) in feet.iter().enumerate() {
            let (one, zero, mu) = (T::ONE, T::ZERO, settings.friction);
            // ± f_x − μ f_z ≤ 0 and ± f_y − μ f_z ≤ 0; nothing to say of a foot in the air.
            for values in [
                [one, zero, -mu],
                [-one, zero, -mu],
                [zero, one, -mu],
                [zero, -one, -mu],
            ] {
                let Some(((row, span), (low, high))) = rows.next() else {
                    return;
                };
                (*low, *high) = (-T::INFINITY, T::ZERO);
                *row = [T::ZERO; V];
                *span = [0; 2];
                if foot.in_contact {
                    *span = [3 * i, 3 * i + 3];
                    for (slot, value) in row.iter_mut().skip(3 * i).zip(values) {
                        *slot = value;
                    }
                }
            }
        }
        for (other, most) in other_torques.iter().zip(max_torques) {
            let Some(((row, span), (low, high))) = rows.next() else {
                return;
            };
            *row = [T::ZERO; V];
            *span = [0; 2];
            // Where the other torques alone use up the joint, zero force must remain possible.
            *low = so3::math::min(-*most - *other, T::ZERO);
            *high = so3::math::max(*most - *other, T::ZERO);
        }
        let rot_wb = &limbs.posture.base().rotation;
        let ends = limbs.ends.iter().zip(feet).enumerate();
        for (i, (end, _)) in ends.filter(|(_, (_, foot))| foot.in_contact) {
            for (j, column) in end.columns() {
                let row = self.rows.get_mut(4 * F + j);
                let triple = row.and_then(|row| row.get_mut(3 * i..3 * i + 3));
                if let (Some(triple), Some(span)) = (triple, self.spans.get_mut(4 * F + j)) {
                    triple.copy_from_slice((-(rot_wb * column)).as_slice());
                    *span = match *span {
                        [0, 0] => [3 * i, 3 * i + 3],
                        [from, _] => [from, 3 * i + 3],
                    };
                }
            }
        }
    }

    /// Forces of the feet. A problem that cannot be solved gives the last iterate clipped into the limits, and says so.
    pub(crate) fn solve<const N: usize, const F: usize>(
        &mut self,
        settings: &Settings<T>,
        feet: &[FootData<T>; F],
        limbs: &Limbs<T, N, F>,
        wanted: &Wrench<T>,
        torques: (&[T; N], &[T; N]),
        workspace: &mut dense_qp::Workspace<T, V, M>,
    ) -> ([Vector3<T>; F], Outcome) {
        self.write_cost(settings, feet, wanted);
        self.write_rows(settings, feet, limbs, torques.0, torques.1);
        let problem = self.problem();
        let mut forces = [Vector3::zeros(); F];
        let options = dense_qp::Settings {
            max_iterations: MAX_ITERATIONS,
            ..dense_qp::Settings::default()
        };
        // Other feet share the load anew: the active rows of before would mostly have to leave one by one.
        if self.regrouped {
            workspace.forget();
        }
        let Ok(solution) = solve_warm(&problem, &options, workspace) else {
            return (forces, Outcome::BadData);
        };
        let mut numbers = solution.x.iter();
        for force in &mut forces {
            for (x, number) in force.iter_mut().zip(numbers.by_ref()) {
                *x = if number.is_finite_number() {
                    *number
                } else {
                    T::ZERO
                };
            }
        }
        let outcome = if solution.status == Status::Solved {
            Outcome::Solved(solution.iterations)
        } else {
            Outcome::Failed(solution.status)
        };
        self.clip(&mut forces);
        if !matches!(outcome, Outcome::Solved(_)) {
            self.shorten(settings.friction, &mut forces);
        }
        (forces, outcome)
    }

    /// Brings forces inside friction and torques, which a program that was cut short may leave: first into the pyramid, then shorter
    /// until the joints can give them. Zero force keeps every row, so some length does.
    fn shorten<const F: usize>(&self, friction: T, forces: &mut [Vector3<T>; F]) {
        for force in forces.iter_mut() {
            let side = friction * force.z;
            force.x = so3::math::clamp(force.x, -side, side);
            force.y = so3::math::clamp(force.y, -side, side);
        }
        let limits = self.row_lower.iter().zip(&self.row_upper);
        for (row, (low, high)) in self.rows.iter().zip(limits).skip(4 * F) {
            for (entries, force) in row.chunks(3).zip(forces.iter_mut()) {
                let terms = entries.iter().zip(force.iter());
                let value = terms.fold(T::ZERO, |sum, (a, x)| sum + *a * *x);
                if value > *high {
                    *force *= *high / value;
                } else if value < *low {
                    *force *= *low / value;
                }
            }
        }
    }

    /// Clips forces into their bounds, against round-off.
    fn clip<const F: usize>(&self, forces: &mut [Vector3<T>; F]) {
        let mut bounds = self.lower.iter().zip(&self.upper);
        for force in forces {
            for (x, (low, high)) in force.iter_mut().zip(bounds.by_ref()) {
                *x = so3::math::clamp(*x, *low, *high);
            }
        }
    }
}
