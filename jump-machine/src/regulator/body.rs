//! The single rigid body at a node of the plan, and how an error of it goes on until the next.

use jump_control::Node;
use nalgebra::{Matrix3, SVector, Vector3};
use rbd_core::{CentroidalMap, Configuration, Frame, Limbs, Tangent, Tree, centroidal_map};
use so3::Scalar;

use super::cost_to_go::{Drift, MOMENTA, stack};

/// The robot of a node as one body, with its legs as they are there.
pub(super) struct Body<T: Scalar, const F: usize> {
    mass: T,
    /// Centre of mass, its velocity and the angular momentum about it, world axes.
    pub(super) com_w: Vector3<T>,
    pub(super) com_velocity_w: Vector3<T>,
    pub(super) angular_w: Vector3<T>,
    /// I⁻¹ about the centre of mass, world axes.
    pub(super) inverse_inertia_w: Matrix3<T>,
    /// Forces of the ground on the feet, and the feet seen from the centre of mass, world axes.
    pub(super) forces_w: [Vector3<T>; F],
    arms_w: [Vector3<T>; F],
    /// What is carried, seen from the centre of mass, world axes.
    load_w: Vector3<T>,
}

impl<T: Scalar, const F: usize> Body<T, F> {
    /// The body of `node`, that would carry loads so high over the base's origin; `limbs` is memory for its legs.
    pub(super) fn new<M: Tree<T, N>, const N: usize>(
        model: &M,
        node: &Node<T, N, F>,
        feet: &[Frame<T>; F],
        (limbs, load_height): (&mut Limbs<T, N, F>, T),
    ) -> Self {
        let q = Configuration {
            base: node.base,
            joints: node.joints,
        };
        let velocity = Tangent {
            base: node.base_velocity,
            joints: node.joint_velocities,
        };
        let mut map = CentroidalMap::ZERO;
        limbs.update(model, &q, feet);
        centroidal_map(model, &limbs.posture, &mut map);
        let momentum = map.momentum(&velocity);
        let i = &map.locked_inertia_w;
        let inertia = Matrix3::new(i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz);
        Self {
            mass: map.mass,
            com_w: map.com_w,
            com_velocity_w: momentum.linear / map.mass,
            angular_w: momentum.angular,
            inverse_inertia_w: inertia.try_inverse().unwrap_or_else(Matrix3::zeros),
            forces_w: node.forces_w,
            arms_w: limbs
                .ends
                .each_ref()
                .map(|end| node.base.point(&end.position) - map.com_w),
            load_w: node.base.point(&(Vector3::z() * load_height)) - map.com_w,
        }
    }

    /// How an error goes on for `dt` if nothing answers it:
    /// δċ = δv, δθ̇ = I⁻¹ (δL + L × δθ), δv̇ = 0, δL̇ = F × δc + p Σ (r_i − l) × f_i, of a robot that carries p at l ([`Load`](crate::Load)).
    ///
    /// The body turns with ω = I⁻¹ (L − L_legs), and a rotation δθ of it turns I and the momentum L_legs of its legs; what is left of both is
    /// L × δθ. The feet stand where they stand, so a body that is aside has the planned force F on another arm.
    pub(super) fn drift(&self, dt: T) -> Drift<T> {
        let one = Matrix3::identity();
        let turning = self.inverse_inertia_w * so3::hat(&self.angular_w) * dt;
        // Second order: in flight the error goes around with the body.
        let turned = one + turning + turning * turning * T::HALF;
        let turns = (one + turning * T::HALF) * self.inverse_inertia_w * dt;
        let total: Vector3<T> = self.forces_w.iter().sum();
        let legs = self.arms_w.iter().zip(&self.forces_w);
        let loaded: Vector3<T> = legs
            .map(|(arm, force)| (arm - self.load_w).cross(force))
            .sum();
        Drift {
            dt,
            turned,
            turns,
            pushed: so3::hat(&total) * dt,
            loaded: loaded * dt,
        }
    }

    /// What a unit of force on a foot along a world axis does to the momenta in a unit of time: (e/m, r × e).
    pub(super) fn push(&self, foot: usize, axis: usize) -> SVector<T, MOMENTA> {
        let mut unit = Vector3::zeros();
        if let Some(entry) = unit.get_mut(axis) {
            *entry = T::ONE;
        }
        let arm = self.arms_w.get(foot).copied().unwrap_or_default();
        stack([unit / self.mass, arm.cross(&unit)])
    }
}
