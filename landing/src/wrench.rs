//! Wrenches about the centre of mass, weighed, and the symmetric 6 × 6 systems between them.

use nalgebra::{Matrix3, Vector3};
use so3::Scalar;

use crate::least_squares::Ldl3;

/// A force with a moment about the centre of mass, world axes. In the solver each part is multiplied by the root of its weight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wrench<T: Scalar> {
    pub(crate) force_w: Vector3<T>,
    pub(crate) moment_w: Vector3<T>,
}

impl<T: Scalar> Wrench<T> {
    pub(crate) const ZERO: Self = Self {
        force_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
        moment_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
    };

    #[inline(always)]
    pub(crate) fn scaled(&self, f: T) -> Self {
        Self {
            force_w: self.force_w * f,
            moment_w: self.moment_w * f,
        }
    }

    #[inline(always)]
    pub(crate) fn sub(&self, other: &Self) -> Self {
        Self {
            force_w: self.force_w - other.force_w,
            moment_w: self.moment_w - other.moment_w,
        }
    }

    #[inline(always)]
    pub(crate) fn dot(&self, other: &Self) -> T {
        self.force_w.dot(&other.force_w) + self.moment_w.dot(&other.moment_w)
    }

    /// Largest magnitude of an entry.
    pub(crate) fn size(&self) -> T {
        so3::math::max(self.force_w.amax(), self.moment_w.amax())
    }
}

/// How the force on one foot becomes a weighed wrench: B f = (√w_f f, √w_m r × f).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arm<T: Scalar> {
    /// √w_f.
    pub(crate) force: T,
    /// √w_m r.
    pub(crate) moment_w: Vector3<T>,
}

impl<T: Scalar> Arm<T> {
    pub(crate) const ZERO: Self = Self {
        force: T::ZERO,
        moment_w: Vector3::new(T::ZERO, T::ZERO, T::ZERO),
    };

    /// B f.
    #[inline(always)]
    pub(crate) fn wrench(&self, force_w: &Vector3<T>) -> Wrench<T> {
        Wrench {
            force_w: force_w * self.force,
            moment_w: self.moment_w.cross(force_w),
        }
    }

    /// Bᵀ s.
    #[inline(always)]
    pub(crate) fn pull(&self, s: &Wrench<T>) -> Vector3<T> {
        s.force_w * self.force + s.moment_w.cross(&self.moment_w)
    }
}

/// A symmetric matrix over wrenches, by blocks: forces, moments × forces, moments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square<T: Scalar> {
    forces: Matrix3<T>,
    mixed: Matrix3<T>,
    moments: Matrix3<T>,
}

impl<T: Scalar> Square<T> {
    /// x I.
    pub(crate) fn diagonal(x: T) -> Self {
        Self {
            forces: Matrix3::from_diagonal_element(x),
            mixed: Matrix3::zeros(),
            moments: Matrix3::from_diagonal_element(x),
        }
    }

    /// Adds B Bᵀ.
    #[inline]
    pub(crate) fn add_arm(&mut self, arm: &Arm<T>) {
        let r = &arm.moment_w;
        let square = arm.force * arm.force;
        let size = r.dot(r);
        for k in 0..3 {
            self.forces[(k, k)] += square;
            self.moments[(k, k)] += size;
        }
        self.moments -= r * r.transpose();
        let (x, y, z) = (r.x * arm.force, r.y * arm.force, r.z * arm.force);
        self.mixed[(0, 1)] -= z;
        self.mixed[(0, 2)] += y;
        self.mixed[(1, 0)] += z;
        self.mixed[(1, 2)] -= x;
        self.mixed[(2, 0)] -= y;
        self.mixed[(2, 1)] += x;
    }

    /// Adds f w wᵀ.
    #[inline]
    pub(crate) fn add_square(&mut self, f: T, w: &Wrench<T>) {
        let scaled = w.scaled(f);
        self.forces += scaled.force_w * w.force_w.transpose();
        self.mixed += scaled.moment_w * w.force_w.transpose();
        self.moments += scaled.moment_w * w.moment_w.transpose();
    }
}

/// The inverse of a positive definite [`Square`]: forces are eliminated first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inverse<T: Scalar> {
    forces: Ldl3<T>,
    /// mixed · forces⁻¹.
    share: Matrix3<T>,
    moments: Ldl3<T>,
}

impl<T: Scalar> Inverse<T> {
    #[inline]
    pub(crate) fn new(k: &Square<T>) -> Self {
        let forces = Ldl3::new(&k.forces);
        let mut share = Matrix3::zeros();
        for (row, mut to) in k.mixed.row_iter().zip(share.row_iter_mut()) {
            to.copy_from(&forces.solve(&row.transpose()).transpose());
        }
        Self {
            forces,
            share,
            moments: Ldl3::new(&(k.moments - share * k.mixed.transpose())),
        }
    }

    /// K⁻¹ b.
    #[inline]
    pub(crate) fn solve(&self, b: &Wrench<T>) -> Wrench<T> {
        let moment_w = self.moments.solve(&(b.moment_w - self.share * b.force_w));
        let force_w = self.forces.solve(&b.force_w) - self.share.tr_mul(&moment_w);
        Wrench { force_w, moment_w }
    }
}
