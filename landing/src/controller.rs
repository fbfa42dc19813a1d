//! One tick of the landing controller.
//!
//! The body is a single rigid body under the foot forces: m c̈ = Σ f + m g and L̇ = Σ (p − c) × f. Wanted are
//! c̈_d = K_p(c_d − c) − K_d ċ and L̇_d = I_w(K_p log(R_d Rᵀ) − K_d ω), with c_d over the middle of the feet.

use dense_qp::Status;
use nalgebra::{Matrix3, Vector3};
use rbd_core::{
    Configuration, Frame, GRAVITY, LimbEnd, Limbs, Tangent, Tree, centroidal_state,
    generalized_gravity,
};
use so3::Scalar;

use crate::forces::Forces;
use crate::wrench::Wrench;
use crate::{Settings, Target};

/// The landing controller of a robot with `N` joints and `F` feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing<T, const N: usize, const F: usize> {
    /// The feet; each is the end of a leg of its own.
    pub feet: [Frame<T>; F],
    /// Gains, weights and limits.
    pub settings: Settings<T>,
    /// Largest torque of each joint, N m.
    pub max_torques: [T; N],
}

/// Memory of the controller: the program of the last tick that had one, and the limits that held at its solution. All zero at
/// first.
#[derive(Clone, Debug)]
pub struct Workspace<T: Scalar, const N: usize, const F: usize> {
    pub(crate) forces: Forces<T, N, F>,
}

impl<T: Scalar, const N: usize, const F: usize> Workspace<T, N, F> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            forces: Forces::new(),
        }
    }

    /// Forces of the ground on the feet that the last tick with a program commanded, world axes, N; zero on feet in the air.
    #[must_use]
    pub fn forces_w(&self) -> [Vector3<T>; F] {
        let mut forces_w = self.forces.inside();
        for (force_w, on) in forces_w.iter_mut().zip(&self.forces.on) {
            if !on {
                *force_w = Vector3::zeros();
            }
        }
        forces_w
    }
}

impl<T: Scalar, const N: usize, const F: usize> Default for Workspace<T, N, F> {
    fn default() -> Self {
        Self::new()
    }
}

/// What came of the force QP.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// No foot is in contact: nothing to solve.
    Airborne,
    /// Optimal, after so many active sets.
    Solved(u32),
    /// Not optimal ([`Status::Limit`]: more active sets than a tick has time for; the next tick goes on from the last): the forces are
    /// the last iterate, brought inside all limits.
    Failed(Status),
    /// The state was not finite: forces are zero and the joints only damped.
    BadData,
}

/// What the joints are to do until the next tick: τ = `feed_forward` + K_p(`position` − q) − K_d q̇.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<T: Scalar, const N: usize, const F: usize> {
    /// Feed-forward torques, N m.
    pub feed_forward: [T; N],
    /// Joint positions to hold, rad; without effect where the stiffness is zero.
    pub position: [T; N],
    /// Stiffness, N m/rad: zero in stance legs.
    pub stiffness: [T; N],
    /// Damping, N m s/rad.
    pub damping: [T; N],
    /// Forces planned for the feet, world axes, N.
    pub forces_w: [Vector3<T>; F],
    /// What came of the QP.
    pub outcome: Outcome,
}

impl<T: Scalar, const N: usize, const F: usize> Command<T, N, F> {
    /// Legs that stand bear their own gravity and damp, without stiffness. Returned is what their joints do beside the forces of the
    /// feet, −Jᵀf: the limits on these count it.
    #[inline(always)]
    fn bear(
        &mut self,
        settings: &Settings<T>,
        limbs: &Limbs<T, N, F>,
        contacts: &[bool; F],
        (gravity, speeds): (&[T; N], &[T; N]),
    ) -> [T; N] {
        let mut other = [T::ZERO; N];
        for (j, _) in standing(limbs, contacts).flat_map(LimbEnd::columns) {
            let slots = self.feed_forward.get_mut(j).zip(other.get_mut(j));
            let gains = self.stiffness.get_mut(j).zip(self.damping.get_mut(j));
            let known = gravity.get(j).zip(speeds.get(j));
            if let (Some((tau, other)), Some((stiffness, damping)), Some((gravity, qd))) =
                (slots, gains, known)
            {
                let stance_damping = settings.damping(*qd);
                (*tau, *other) = (*gravity, *gravity - stance_damping * *qd);
                (*stiffness, *damping) = (T::ZERO, stance_damping);
            }
        }
        other
    }
}

impl<T: Scalar, const N: usize, const F: usize> Landing<T, N, F> {
    /// A controller.
    #[must_use]
    pub const fn new(feet: [Frame<T>; F], settings: Settings<T>, max_torques: [T; N]) -> Self {
        Self {
            feet,
            settings,
            max_torques,
        }
    }

    /// One tick: the state, which feet are in contact, where to go, and the joint positions in which swing legs wait.
    #[expect(
        clippy::too_many_arguments,
        reason = "each is a separate thing the caller knows"
    )]
    pub fn step<R: Tree<T, N>>(
        &self,
        model: &R,
        configuration: &Configuration<T, N>,
        velocity: &Tangent<T, N>,
        contacts: &[bool; F],
        target: &Target<T>,
        waiting: &[T; N],
        workspace: &mut Workspace<T, N, F>,
    ) -> Command<T, N, F> {
        let limbs = Limbs::new(model, configuration, &self.feet);
        self.step_at(
            model, &limbs, velocity, contacts, target, waiting, workspace,
        )
    }

    /// [`Landing::step`] where the legs are known already: `limbs` of [`Landing::feet`].
    #[expect(
        clippy::too_many_arguments,
        reason = "each is a separate thing the caller knows"
    )]
    pub fn step_at<R: Tree<T, N>>(
        &self,
        model: &R,
        limbs: &Limbs<T, N, F>,
        velocity: &Tangent<T, N>,
        contacts: &[bool; F],
        target: &Target<T>,
        waiting: &[T; N],
        workspace: &mut Workspace<T, N, F>,
    ) -> Command<T, N, F> {
        let s = &self.settings;
        let mut command = Command {
            feed_forward: [T::ZERO; N],
            position: *waiting,
            stiffness: [s.swing_stiffness; N],
            damping: [s.swing_damping; N],
            forces_w: [Vector3::zeros(); F],
            outcome: Outcome::Airborne,
        };
        let posture = &limbs.posture;
        let body = centroidal_state(model, posture, velocity);
        let (arms_w, support) = look_at_feet(limbs, &body.com_w, contacts);
        let finite = body
            .com_w
            .iter()
            .chain(body.com_velocity_w.iter())
            .chain(support.iter());
        if !finite.copied().all(Scalar::is_finite_number) {
            command.outcome = Outcome::BadData;
            command.stiffness = [T::ZERO; N];
            return command;
        }
        if !contacts.contains(&true) {
            return command;
        }

        let rot_wb = &posture.base().rotation;
        let rates = (body.com_velocity_w, rot_wb * velocity.base.angular);
        let wanted = self.wrench(
            target,
            &body.com_w,
            &support,
            rates,
            rot_wb.matrix(),
            body.mass,
        );
        let gravity = generalized_gravity(model, posture).joints;
        let other = command.bear(s, limbs, contacts, (&gravity, &velocity.joints));
        let forces = &mut workspace.forces;
        let cone = (s.friction, s.max_normal_force);
        let torques = (&other, &self.max_torques);
        forces.limits.write(cone, limbs, contacts, torques);
        forces.on = *contacts;
        forces.aim(s, &arms_w, &wanted);
        (command.forces_w, command.outcome) = forces.solve();
        let forces_w = command.forces_w.iter().zip(contacts);
        let forces_w = forces_w.filter(|(_, on)| **on).map(|(force, _)| force);
        for (end, force) in standing(limbs, contacts).zip(forces_w) {
            end.add_tr_mul(&-(rot_wb.inverse() * force), &mut command.feed_forward);
        }
        command
    }

    /// The wrench that moves the body towards its target.
    fn wrench(
        &self,
        target: &Target<T>,
        com_w: &Vector3<T>,
        support_w: &Vector3<T>,
        (velocity_w, omega_w): (Vector3<T>, Vector3<T>),
        rot_wb: &Matrix3<T>,
        mass: T,
    ) -> Wrench<T> {
        let s = &self.settings;
        let [x, y] = target.offset_w;
        let error = support_w + Vector3::new(x, y, target.height) - com_w;
        let pull = |(kp, kd): (T, T), e: T, v: T| kp * e - kd * v;
        let acceleration = Vector3::new(
            pull(s.horizontal, error.x, velocity_w.x),
            pull(s.horizontal, error.y, velocity_w.y),
            pull(s.height, error.z, velocity_w.z),
        );
        let gravity = Vector3::from(GRAVITY.map(T::of));
        let turn = so3::log(&nalgebra::Rotation3::from_matrix_unchecked(
            target.rot_wb.matrix() * rot_wb.transpose(),
        ));
        let inertia_w =
            rot_wb * Matrix3::from_diagonal(&Vector3::from(s.inertia_b)) * rot_wb.transpose();
        let (kp, kd) = s.rotation;
        Wrench {
            force_w: (acceleration - gravity) * mass,
            moment_w: inertia_w * (turn * kp - omega_w * kd),
        }
    }

    /// Forces as joint torques: −Σ Jᵀ f, for those who check.
    #[must_use]
    pub fn reaction_torques<R: Tree<T, N>>(
        &self,
        model: &R,
        configuration: &Configuration<T, N>,
        forces_w: &[Vector3<T>; F],
    ) -> [T; N] {
        let limbs = Limbs::new(model, configuration, &self.feet);
        let mut torques = [T::ZERO; N];
        for (end, f) in limbs.ends.iter().zip(forces_w) {
            end.add_tr_mul(&-(configuration.base.rotation.inverse() * f), &mut torques);
        }
        torques
    }
}

/// The legs whose feet are on the ground.
fn standing<'a, T: Scalar, const N: usize, const F: usize>(
    limbs: &'a Limbs<T, N, F>,
    contacts: &'a [bool; F],
) -> impl Iterator<Item = &'a LimbEnd<T, N>> {
    let ends = limbs.ends.iter().zip(contacts);
    ends.filter(|(_, on)| **on).map(|(end, _)| end)
}

/// Arms of the feet from the centre of mass, and the support: the middle of all feet horizontally, the mean of those in contact
/// vertically.
fn look_at_feet<T: Scalar, const N: usize, const F: usize>(
    limbs: &Limbs<T, N, F>,
    com_w: &Vector3<T>,
    contacts: &[bool; F],
) -> ([Vector3<T>; F], Vector3<T>) {
    let base = limbs.posture.base();
    let from_com = base.translation - com_w;
    let mut arms_w = [Vector3::zeros(); F];
    let (mut sum, mut low, mut count) = (Vector3::zeros(), T::ZERO, T::ZERO);
    for ((arm_w, end), on) in arms_w.iter_mut().zip(&limbs.ends).zip(contacts) {
        *arm_w = base.rotation * end.position + from_com;
        sum += *arm_w;
        if *on {
            low += arm_w.z;
            count += T::ONE;
        }
    }
    let mut support = sum / T::of(F.max(1) as f64);
    if count > T::ZERO {
        support.z = low / count;
    }
    (arms_w, support + com_w)
}
