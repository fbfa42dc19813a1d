//! The results of `rbd-core`, field by field.

use rbd_core::{
    ArticulatedInertia, Configuration, Effort, Force, Inertia, Kinematics, MassMatrix, Motion,
    Posture, Symmetric3, TableModel, Tangent, Transform, Tree,
};
use so3::Scalar;

use super::Numbers;

macro_rules! fields {
    ($($Type:ident $(const $N:ident)? { $($field:ident),* })*) => { $(
        impl<T: Scalar + Numbers $(, const $N: usize)?> Numbers for $Type<T $(, $N)?> {
            fn visit(&self, take: &mut impl FnMut(f64)) {
                $(self.$field.visit(take);)*
            }
        }
    )* };
}

fields! {
    Motion { linear, angular }
    Force { linear, angular }
    Symmetric3 { xx, yy, zz, xy, xz, yz }
    Inertia { mass, first, second }
    ArticulatedInertia { linear, cross, angular }
    Transform { rotation, translation }
    Configuration const N { base, joints }
    Tangent const N { base, joints }
    Effort const N { base, joints }
    Kinematics const N { base, bodies }
    MassMatrix const N { base, coupling, joints }
}

/// A posture shows only its base; its sines and cosines show in what is computed from it.
impl<T: Scalar + Numbers, const N: usize> Numbers for Posture<T, N> {
    fn visit(&self, take: &mut impl FnMut(f64)) {
        self.base().visit(take);
    }
}

impl<T: Scalar + Numbers, const N: usize> Numbers for TableModel<T, N> {
    fn visit(&self, take: &mut impl FnMut(f64)) {
        for body in self.bodies() {
            take(body.subtree_end as f64);
            body.sign.visit(take);
        }
    }
}
