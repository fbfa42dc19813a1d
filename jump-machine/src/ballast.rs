//! The robot with its centre of mass where it was measured: a battery, cables or a payload on the base.

use nalgebra::Vector3;
use rbd_core::tree::Fold;
use rbd_core::{BaseBody, BaseKind, Body, Link, Symmetric3, Tree};
use so3::Scalar;

/// A model whose base is its own and whose limbs are borrowed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ballasted<'a, T, M> {
    model: &'a M,
    base: BaseBody<T>,
}

impl<'a, T: Scalar, M> Ballasted<'a, T, M> {
    /// As its tables say.
    pub(crate) fn new<const N: usize>(model: &'a M) -> Self
    where
        M: Tree<T, N>,
    {
        Self {
            model,
            base: *model.base(),
        }
    }

    /// With a first moment of mass of the base that is more by `moment_b`, kg m, base axes, which moves the centre of mass of a robot of mass m by
    /// `moment_b`/m. About its own centre the base is as hard to turn as before (parallel axes). A base without mass stays as it is.
    pub(crate) fn with_moment(mut self, moment_b: &Vector3<T>) -> Self {
        let mass = self.base.mass;
        if mass > T::ZERO {
            let (before, per_mass) = (Vector3::from(self.base.first), T::ONE / mass);
            let after = before + moment_b;
            let less = Symmetric3::outer(&before, per_mass).to_array();
            let more = Symmetric3::outer(&after, per_mass).to_array();
            for ((second, more), less) in self.base.second.iter_mut().zip(more).zip(less) {
                *second += more - less;
            }
            self.base.first = after.into();
        }
        self
    }
}

impl<T: Scalar, M: Tree<T, N>, const N: usize> Tree<T, N> for Ballasted<'_, T, M> {
    #[inline(always)]
    fn base_kind(&self) -> BaseKind {
        self.model.base_kind()
    }

    #[inline(always)]
    fn base(&self) -> &BaseBody<T> {
        &self.base
    }

    #[inline(always)]
    fn bodies(&self) -> &[Body<T>; N] {
        self.model.bodies()
    }

    #[inline(always)]
    fn joint_count(&self) -> usize {
        self.model.joint_count()
    }

    #[inline(always)]
    fn fold<F: Fold<T>>(&self, fold: &mut F, base: &F::Down) -> F::Up {
        self.model.fold(fold, base)
    }

    #[inline(always)]
    fn moves(&self, joint: usize, link: Link) -> bool {
        self.model.moves(joint, link)
    }
}

#[cfg(test)]
mod tests {
    use super::Ballasted;
    use a1_model::A1Geared;
    use nalgebra::{Matrix3, Vector3};
    use rbd_core::{Configuration, Posture, Tree, center_of_mass};

    #[test]
    fn the_centre_of_mass_moves_and_the_base_turns_as_before() {
        let robot = Ballasted::<f64, _>::new(&A1Geared);
        let q = Configuration::<f64, 12>::NEUTRAL;
        let found = |robot: &Ballasted<'_, f64, A1Geared>| {
            let com = center_of_mass(robot, &Posture::new(robot, &q));
            let base = Tree::<f64, 12>::base(robot);
            let first = Vector3::from(base.first);
            let second = base.inertia().second.to_matrix();
            (
                com.mass,
                com.position_w,
                second - first * first.transpose() / base.mass,
            )
        };
        let (mass, com, central) = found(&robot);
        let way = Vector3::new(0.02, -0.01, 0.003);
        let (same, moved, as_before) = found(&robot.with_moment(&(way * mass)));
        assert_eq!(mass, same);
        assert!((moved - com - way).norm() < 1e-12);
        let change: Matrix3<f64> = as_before - central;
        assert!(change.norm() < 1e-12);
    }
}
