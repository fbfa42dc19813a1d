//! A model built at run time from tables.

use so3::Scalar;

use crate::joint::Kind;
use crate::model::{BaseBody, BaseKind, Body, Link};
use crate::tree::{Fold, Tree, walk};

/// A robot known only at run time, with at most `CAP` joints.
///
/// The same algorithms run on it as on a const model; entries of joint arrays beyond
/// [`Tree::joint_count`] stay zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableModel<T, const CAP: usize> {
    base_kind: BaseKind,
    base: BaseBody<T>,
    bodies: [Body<T>; CAP],
    count: usize,
}

/// Why tables are not a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TableError {
    /// More bodies than the model type holds: raise `CAP`.
    TooManyBodies {
        /// Bodies in the table.
        bodies: usize,
        /// Bodies that fit.
        capacity: usize,
    },
    /// The body's parent does not stand before it, or its subtree is not one run of rows: put the
    /// bodies in depth-first order.
    NotDepthFirst {
        /// Index of the body.
        body: usize,
    },
    /// A number is NaN or infinite.
    NotFinite {
        /// Index of the body; the number of bodies stands for the base.
        body: usize,
    },
    /// The mass is negative or its second moments are not those of any mass distribution.
    BadInertia {
        /// Index of the body; the number of bodies stands for the base.
        body: usize,
    },
    /// The sign is neither 1 nor −1.
    BadSign {
        /// Index of the body.
        body: usize,
    },
    /// The fixed rotation of a tilted joint is not a rotation, or an aligned joint has one.
    BadTilt {
        /// Index of the body.
        body: usize,
    },
}

impl core::fmt::Display for TableError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooManyBodies { bodies, capacity } => {
                write!(
                    f,
                    "{bodies} bodies do not fit a model for {capacity}: raise its capacity"
                )
            }
            Self::NotDepthFirst { body } => {
                write!(
                    f,
                    "body {body} breaks the depth-first order: reorder the table"
                )
            }
            Self::NotFinite { body } => write!(f, "body {body} has a NaN or infinite number"),
            Self::BadInertia { body } => {
                write!(
                    f,
                    "body {body} has moments of mass that no mass distribution has"
                )
            }
            Self::BadSign { body } => write!(f, "body {body} has a sign that is not 1 or -1"),
            Self::BadTilt { body } => write!(f, "body {body} has a tilt that is not a rotation"),
        }
    }
}

impl core::error::Error for TableError {}

impl<T: Scalar, const CAP: usize> TableModel<T, CAP> {
    /// A model from its base and its bodies in depth-first order; `subtree_end` is filled in.
    ///
    /// # Errors
    /// Names the first row that breaks a rule of [`TableError`].
    pub fn new(
        base_kind: BaseKind,
        base: BaseBody<T>,
        rows: &[Body<T>],
    ) -> Result<Self, TableError> {
        let model = Self::with_any_inertia(base_kind, base, rows)?;
        check_distribution(base.mass, &base.first, &base.second, rows.len())?;
        for (i, row) in rows.iter().enumerate() {
            check_distribution(row.mass, &row.first, &row.second, i)?;
        }
        Ok(model)
    }

    /// As [`TableModel::new`], but second moments that no mass distribution has are taken as they are.
    ///
    /// Published robot descriptions have such links, and dynamics are defined for them as long as the mass
    /// matrix stays positive definite: that is for the caller to know.
    ///
    /// # Errors
    /// Names the first row that breaks another rule of [`TableError`].
    pub fn with_any_inertia(
        base_kind: BaseKind,
        base: BaseBody<T>,
        rows: &[Body<T>],
    ) -> Result<Self, TableError> {
        let count = rows.len();
        if count > CAP {
            return Err(TableError::TooManyBodies {
                bodies: count,
                capacity: CAP,
            });
        }
        check_moments(base.mass, &base.first, &base.second, count)?;
        let mut bodies = [Body::EMPTY; CAP];
        for (slot, row) in bodies.iter_mut().zip(rows) {
            *slot = *row;
        }
        for (i, row) in rows.iter().enumerate() {
            check_body(row, i)?;
            let end = subtree_end(rows, i);
            if let Link::Joint(p) = row.parent
                && (p >= i || end > subtree_end(rows, p))
            {
                return Err(TableError::NotDepthFirst { body: i });
            }
            if let Some(slot) = bodies.get_mut(i) {
                slot.subtree_end = end;
            }
        }
        Ok(Self {
            base_kind,
            base,
            bodies,
            count,
        })
    }
}

/// One past the last row of the run of descendants that follows row `i`.
fn subtree_end<T>(rows: &[Body<T>], i: usize) -> usize {
    let after = rows.iter().skip(i + 1);
    i + 1
        + after
            .take_while(|b| matches!(b.parent, Link::Joint(p) if p >= i))
            .count()
}

fn check_body<T: Scalar>(row: &Body<T>, body: usize) -> Result<(), TableError> {
    let numbers = row.offset.iter().chain(row.tilt.iter().flatten());
    if !numbers
        .chain([&row.rotor_inertia, &row.sign])
        .all(|x| x.is_finite_number())
    {
        return Err(TableError::NotFinite { body });
    }
    check_moments(row.mass, &row.first, &row.second, body)?;
    if row.rotor_inertia < T::ZERO {
        return Err(TableError::BadInertia { body });
    }
    if row.sign != T::ONE && row.sign != -T::ONE {
        return Err(TableError::BadSign { body });
    }
    let tilt = row.tilt_matrix();
    let identity = nalgebra::Matrix3::identity();
    let tolerance = T::EPSILON * T::of(64.0);
    let off = (tilt * tilt.transpose() - identity).abs().max();
    let tilted = (tilt - identity).abs().max() > T::ZERO;
    if off > tolerance || tilt.determinant() < T::ZERO || (tilted && !row.kind.is_tilted()) {
        return Err(TableError::BadTilt { body });
    }
    Ok(())
}

/// Moments of mass must be finite, and mass not negative.
fn check_moments<T: Scalar>(
    mass: T,
    first: &[T; 3],
    second: &[T; 6],
    body: usize,
) -> Result<(), TableError> {
    let mut numbers = [&mass].into_iter().chain(first).chain(second);
    if !numbers.all(|x| x.is_finite_number()) {
        return Err(TableError::NotFinite { body });
    }
    if mass < T::ZERO {
        return Err(TableError::BadInertia { body });
    }
    Ok(())
}

/// Second moments about the centre of mass must be positive semidefinite; that is the triangle
/// inequality of the principal inertias.
fn check_distribution<T: Scalar>(
    mass: T,
    first: &[T; 3],
    second: &[T; 6],
    body: usize,
) -> Result<(), TableError> {
    let com = if mass > T::ZERO {
        first.map(|h| h / mass)
    } else {
        [T::ZERO; 3]
    };
    let shift = crate::spatial::Symmetric3::outer(&com.into(), mass);
    let s = crate::spatial::Symmetric3::new(*second) - shift;
    // Round-off of the parallel-axis terms and of tables printed with few digits.
    let scale = second
        .iter()
        .fold(T::ZERO, |m, x| so3::math::max(m, so3::math::abs(*x)));
    let slack = scale * T::of(1e-4);
    let minors = [
        s.xx * s.yy - s.xy * s.xy,
        s.xx * s.zz - s.xz * s.xz,
        s.yy * s.zz - s.yz * s.yz,
    ];
    let ok = [s.xx, s.yy, s.zz].into_iter().all(|x| x >= -slack)
        && minors.into_iter().all(|x| x >= -slack * scale)
        && s.to_matrix().determinant() >= -slack * scale * scale;
    if ok {
        Ok(())
    } else {
        Err(TableError::BadInertia { body })
    }
}

impl<T: Scalar, const CAP: usize> Tree<T, CAP> for TableModel<T, CAP> {
    #[inline]
    fn base_kind(&self) -> BaseKind {
        self.base_kind
    }

    #[inline]
    fn base(&self) -> &BaseBody<T> {
        &self.base
    }

    #[inline]
    fn bodies(&self) -> &[Body<T>; CAP] {
        &self.bodies
    }

    #[inline]
    fn joint_count(&self) -> usize {
        self.count
    }

    #[inline]
    fn fold<F: Fold<T>>(&self, fold: &mut F, base: &F::Down) -> F::Up {
        walk(&self.bodies, self.count, fold, base)
    }
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 8] = [
        Self::RevoluteX,
        Self::RevoluteY,
        Self::RevoluteZ,
        Self::RevoluteTilted,
        Self::PrismaticX,
        Self::PrismaticY,
        Self::PrismaticZ,
        Self::PrismaticTilted,
    ];
}
