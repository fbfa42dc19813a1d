//! Coupled joints: fewer coordinates than joints.
//!
//! A finger driven by a linkage, a belt over two joints, a URDF's `<mimic>`: the position of one joint is a fixed
//! multiple of another's. The tree keeps every joint; a [`Reduction`] says how they follow the R independent ones,
//!
//! ```text
//! q = G q_r + g,   ν = G ν_r,   ν̇ = G ν̇_r,   τ_r = Gᵀ τ,   M_r = Gᵀ M G,   h_r = Gᵀ h,   J_r = J G
//! ```
//!
//! with one entry per row of the constant G. Because G is constant, no bias term appears, and
//! M_r ν̇_r + h_r = τ_r are the exact equations of motion of the coupled robot (D'Alembert: the forces in the coupling do no
//! work). Every algorithm of the crate runs on the tree as it is; what comes in is spread, what comes out is gathered.
//! Pinocchio reads `<mimic>` joints as independent ones unless asked (`mimic=False`), and so does `model-import`, which
//! keeps the coupling as a reduction beside the tree; Pinocchio's `mimic=True` is this reduction.
//!
//! ```
//! use rbd_core::reduction::{Coupling, Reduction};
//! use rbd_core::{Configuration, Tangent};
//! // Two fingers that open together, the second one the other way round.
//! let hand = Reduction::<f64, 2, 1> {
//!     rows: [Coupling::independent(0), Coupling { coordinate: 0, ratio: -1.0, offset: 0.1 }],
//! };
//! let q = hand.configuration(&Configuration { joints: [0.5], ..Configuration::NEUTRAL });
//! assert_eq!(q.joints, [0.5, -0.4]);
//! let v = hand.tangent(&Tangent { joints: [2.0], ..Tangent::ZERO });
//! assert_eq!(v.joints, [2.0, -2.0]);
//! ```

use core::ops::{Add, Mul};

use so3::Scalar;

use crate::algo::crba::{MassMatrix, crba};
use crate::algo::rnea::nonlinear_effects;
use crate::algo::{at, put};
use crate::linear::{ldl_back_substitute, ldl_factor, ldl_solve};
use crate::model::BaseKind;
use crate::spatial::{ArticulatedInertia, Force, Motion};
use crate::state::{Configuration, Effort, Posture, Tangent};
use crate::tree::Tree;

/// How one joint of the tree follows an independent coordinate: q = ratio · `q_r`\[coordinate\] + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling<T> {
    /// Index of the independent coordinate.
    pub coordinate: usize,
    /// Rate of the joint per rate of the coordinate: 1 for the independent joint itself.
    pub ratio: T,
    /// Position of the joint where the coordinate is zero, rad or m.
    pub offset: T,
}

impl<T: Scalar> Coupling<T> {
    /// The joint that is the coordinate.
    #[must_use]
    pub const fn independent(coordinate: usize) -> Self {
        Self {
            coordinate,
            ratio: T::ONE,
            offset: T::ZERO,
        }
    }

    /// A joint that stays at zero: what rows beyond the last joint of a run-time model are.
    pub const STILL: Self = Self {
        coordinate: 0,
        ratio: T::ZERO,
        offset: T::ZERO,
    };
}

/// The `N` joints of a tree as functions of `R` independent coordinates. One row per joint of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduction<T, const N: usize, const R: usize> {
    /// How each joint follows.
    pub rows: [Coupling<T>; N],
}

/// Why rows are no reduction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReductionError {
    /// A joint follows a coordinate that is not there.
    NoSuchCoordinate {
        /// Index of the joint.
        joint: usize,
    },
    /// A ratio or an offset is NaN or infinite.
    NotFinite {
        /// Index of the joint.
        joint: usize,
    },
    /// A coordinate moves no joint, so that no forward dynamics exists.
    MovesNothing {
        /// Index of the coordinate.
        coordinate: usize,
    },
}

impl core::fmt::Display for ReductionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NoSuchCoordinate { joint } => {
                write!(
                    f,
                    "joint {joint} follows a coordinate that is not there: raise R or correct the row"
                )
            }
            Self::NotFinite { joint } => {
                write!(f, "joint {joint} follows with a NaN or infinite number")
            }
            Self::MovesNothing { coordinate } => {
                write!(f, "coordinate {coordinate} moves no joint: leave it out")
            }
        }
    }
}

impl core::error::Error for ReductionError {}

impl<T: Scalar, const N: usize, const R: usize> Reduction<T, N, R> {
    /// Checks the rows of the first `joints` joints.
    ///
    /// # Errors
    /// Names the first row or coordinate that breaks a rule of [`ReductionError`]. The methods below are total all the
    /// same: a joint without a coordinate stays at its offset.
    pub fn validate(&self, joints: usize) -> Result<(), ReductionError> {
        let mut moves = [false; R];
        for (joint, row) in self.rows.iter().enumerate().take(joints) {
            if row.coordinate >= R {
                return Err(ReductionError::NoSuchCoordinate { joint });
            }
            if !(row.ratio.is_finite_number() && row.offset.is_finite_number()) {
                return Err(ReductionError::NotFinite { joint });
            }
            if row.ratio != T::ZERO {
                put(&mut moves, row.coordinate, true);
            }
        }
        match moves.iter().position(|moves| !moves) {
            Some(coordinate) => Err(ReductionError::MovesNothing { coordinate }),
            None => Ok(()),
        }
    }

    /// q = G `q_r` + g, rad or m; the base is what it is.
    #[inline]
    #[must_use]
    pub fn configuration(&self, reduced: &Configuration<T, R>) -> Configuration<T, N> {
        Configuration {
            base: reduced.base,
            joints: self
                .rows
                .map(|row| row.ratio * at(&reduced.joints, row.coordinate) + row.offset),
        }
    }

    /// G x of a velocity, an acceleration or a displacement.
    #[inline]
    #[must_use]
    pub fn tangent(&self, reduced: &Tangent<T, R>) -> Tangent<T, N> {
        Tangent {
            base: reduced.base,
            joints: self
                .rows
                .map(|row| row.ratio * at(&reduced.joints, row.coordinate)),
        }
    }

    /// Gᵀ τ: the effort on the independent coordinates that does the same work, N m or N.
    #[inline]
    #[must_use]
    pub fn effort(&self, full: &Effort<T, N>) -> Effort<T, R> {
        Effort {
            base: full.base,
            joints: self.gather(&full.joints, T::ZERO),
        }
    }

    /// X G of the joint columns of a Jacobian or map (`FrameJacobian`, `ComJacobian`, `CentroidalMap`, …), whose base
    /// columns stay as they are; `zero` is the zero column.
    #[inline]
    #[must_use]
    pub fn gather<V>(&self, columns: &[V; N], zero: V) -> [V; R]
    where
        V: Copy + Default + Add<Output = V> + Mul<T, Output = V>,
    {
        let mut out = [zero; R];
        for (row, &column) in self.rows.iter().zip(columns) {
            if let Some(sum) = out.get_mut(row.coordinate) {
                *sum = *sum + column * row.ratio;
            }
        }
        out
    }

    /// `M_r` = Gᵀ M G. Cost: N² products.
    #[inline]
    pub fn mass(&self, full: &MassMatrix<T, N>, out: &mut MassMatrix<T, R>) {
        out.base = full.base;
        out.coupling = self.gather(&full.coupling, Force::ZERO);
        out.joints = [[T::ZERO; R]; R];
        for (row, entries) in self.rows.iter().zip(&full.joints) {
            let gathered = self.gather(entries, T::ZERO);
            if let Some(to) = out.joints.get_mut(row.coordinate) {
                for (x, y) in to.iter_mut().zip(gathered) {
                    *x += row.ratio * y;
                }
            }
        }
    }
}

impl<const N: usize, const R: usize> Reduction<f64, N, R> {
    /// The same reduction in single precision.
    #[must_use]
    pub const fn to_f32(&self) -> Reduction<f32, N, R> {
        let mut rows = [Coupling::<f32>::STILL; N];
        let mut i = 0;
        while i < N {
            let Coupling {
                coordinate,
                ratio,
                offset,
            } = self.rows[i];
            rows[i] = Coupling {
                coordinate,
                ratio: ratio as f32,
                offset: offset as f32,
            };
            i += 1;
        }
        Reduction { rows }
    }
}

/// Scratch of [`coupled_dynamics`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoupledWorkspace<T, const N: usize, const R: usize> {
    /// M of the tree at the last call.
    pub full: MassMatrix<T, N>,
    /// `M_r` at the last call.
    pub reduced: MassMatrix<T, R>,
    factors: [[T; R]; R],
    /// H⁻¹ Cᵀ by columns of the base.
    answers: [[T; R]; 6],
}

impl<T: Scalar, const N: usize, const R: usize> CoupledWorkspace<T, N, R> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            full: MassMatrix::ZERO,
            reduced: MassMatrix::ZERO,
            factors: [[T::ZERO; R]; R],
            answers: [[T::ZERO; R]; 6],
        }
    }
}

impl<T: Scalar, const N: usize, const R: usize> Default for CoupledWorkspace<T, N, R> {
    fn default() -> Self {
        Self::new()
    }
}

/// Forward dynamics of a coupled robot: ν̇_r of `M_r` ν̇_r + Gᵀ h(q, G ν_r) = τ_r.
///
/// `posture` is that of [`Reduction::configuration`]. By blocks M_r = [A C; Cᵀ H]: (A − C H⁻¹ Cᵀ) a_b = f_b − C H⁻¹ f_j and
/// H a_j = f_j − Cᵀ a_b; a fixed base does not accelerate. A coordinate without any inertia does not answer. Joint friction is
/// not included (see [`joint_friction`](crate::joint_friction)).
///
/// Cost: [`crba`], [`nonlinear_effects`], N² products and a Cholesky factorisation of R³/6: the coupling closes loops that
/// [`aba`](crate::aba) cannot walk.
#[inline]
#[must_use]
pub fn coupled_dynamics<T: Scalar, M: Tree<T, N>, const N: usize, const R: usize>(
    model: &M,
    reduction: &Reduction<T, N, R>,
    posture: &Posture<T, N>,
    velocity: &Tangent<T, R>,
    effort: &Effort<T, R>,
    ws: &mut CoupledWorkspace<T, N, R>,
) -> Tangent<T, R> {
    crba(model, posture, &mut ws.full);
    reduction.mass(&ws.full, &mut ws.reduced);
    let bias = nonlinear_effects(model, posture, &reduction.tangent(velocity));
    let force = *effort - reduction.effort(&bias);
    ws.factors = ws.reduced.joints;
    ldl_factor(&mut ws.factors);
    let mut joints = ldl_back_substitute(&ws.factors, force.joints);
    if model.base_kind() == BaseKind::Fixed {
        return Tangent {
            base: Motion::ZERO,
            joints,
        };
    }
    let coupling = &ws.reduced.coupling;
    let mut base = ArticulatedInertia::from(ws.reduced.base).to_rows();
    let mut rest = force.base.to_array();
    for (k, answer) in ws.answers.iter_mut().enumerate() {
        let column = coupling.map(|c| at(&c.to_array(), k));
        *answer = ldl_back_substitute(&ws.factors, column);
    }
    for (i, (row, rest)) in base.iter_mut().zip(&mut rest).enumerate() {
        let column = coupling.map(|c| at(&c.to_array(), i));
        for (x, answer) in row.iter_mut().zip(&ws.answers) {
            *x -= dot(&column, answer);
        }
        *rest -= dot(&column, &joints);
    }
    let moved = ldl_solve(&mut base, rest);
    for (answer, &x) in ws.answers.iter().zip(&moved) {
        for (y, &z) in joints.iter_mut().zip(answer) {
            *y -= z * x;
        }
    }
    Tangent {
        base: Motion::from_array(moved),
        joints,
    }
}

#[inline(always)]
fn dot<T: Scalar, const K: usize>(a: &[T; K], b: &[T; K]) -> T {
    a.iter().zip(b).fold(T::ZERO, |sum, (&x, &y)| sum + x * y)
}
