//! The results of `rbd-core`, field by field.

use rbd_core::{
    AbaDerivatives, ArticulatedInertia, BlockMatrix, BodyMotions, CenterOfMass,
    CentroidalDerivatives, CentroidalMap, CentroidalState, ComJacobian, ComMotion, Configuration,
    ContactRow, ContactSolution, Effort, Force, ForceColumns, FrameDerivatives, FrameJacobian,
    Inertia, Kinematics, Limbs, MassMatrix, Motion, Posture, RneaDerivatives, Symmetric3,
    TableError, TableModel, Tangent, Transform, Tree,
};
use so3::Scalar;

use super::Numbers;

macro_rules! fields {
    ($($Type:ident $(const $N:ident)? { $($field:ident),* })*) => { $(
        impl<T: Scalar + Numbers $(, const $N: usize)?> Numbers for $Type<T $(, $N)?> {
            fn visit(&self, take: &mut dyn FnMut(f64)) {
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
    BodyMotions const N { base_velocity, base_acceleration, velocities, accelerations }
    FrameJacobian const N { base, joints }
    BlockMatrix const N { base, base_joints, joints_base, joints }
    RneaDerivatives const N { by_position, by_velocity, by_acceleration }
    AbaDerivatives const N { acceleration, by_position, by_velocity, by_effort }
    FrameDerivatives const N {
        jacobian, velocity_by_position, acceleration_by_position, acceleration_by_velocity
    }
    ForceColumns const N { base, joints }
    CentroidalDerivatives const N {
        momentum, rate, map, momentum_by_position, rate_by_position, rate_by_velocity
    }
    ContactRow const N { gradient, bias }
    CenterOfMass { mass, position_w }
    ComMotion { mass, position_w, velocity_w, acceleration_w }
    ComJacobian const N { base_linear, base_angular, joints }
    CentroidalMap const N { mass, com_w, locked_inertia_w, base, joints }
    CentroidalState { mass, com_w, com_velocity_w, momentum_w, kinetic_energy, potential_energy }
}

impl<T: Scalar + Numbers, const N: usize, const K: usize> Numbers for Limbs<T, N, K> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        for end in &self.ends {
            end.position.visit(take);
            for (_, column) in end.columns() {
                column.visit(take);
            }
        }
    }
}

impl<T: Scalar + Numbers, const N: usize, const K: usize> Numbers for ContactSolution<T, N, K> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.motion.visit(take);
        self.forces.visit(take);
        self.residual.visit(take);
    }
}

/// A posture shows only its base; its sines and cosines show in what is computed from it.
impl<T: Scalar + Numbers, const N: usize> Numbers for Posture<T, N> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.base().visit(take);
    }
}

impl Numbers for TableError {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        let (kind, place) = match *self {
            Self::TooManyBodies { bodies, .. } => (1.0, bodies),
            Self::NotDepthFirst { body } => (2.0, body),
            Self::NotFinite { body } => (3.0, body),
            Self::BadInertia { body } => (4.0, body),
            Self::BadSign { body } => (5.0, body),
            Self::BadTilt { body } => (6.0, body),
            _ => (0.0, 0),
        };
        take(kind);
        take(place as f64);
    }
}

impl<T: Scalar + Numbers, const N: usize> Numbers for TableModel<T, N> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        for body in self.bodies() {
            take(body.subtree_end as f64);
            body.sign.visit(take);
        }
    }
}
