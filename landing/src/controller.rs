//! One tick of the landing controller.
//!
//! The body is a single rigid body under the foot forces: m c̈ = Σ f + m g and L̇ = Σ (p − c) × f. Wanted are
//! c̈_d = K_p(c_d − c) − K_d ċ and L̇_d = I_w(K_p log(R_d Rᵀ) − K_d ω), with c_d over the middle of the feet.

use dense_qp::Status;
use nalgebra::{Matrix3, Vector3};
use rbd_core::{
    Axes, Configuration, Force, Frame, FrameJacobian, GRAVITY, Kinematics, Posture, Tangent, Tree,
    centroidal_state, forward_kinematics, frame_jacobian, generalized_gravity,
};
use so3::Scalar;

use crate::forces::{Data, FootData, Wrench};
use crate::{Settings, Target};

/// The landing controller of a robot with `N` joints and `F` feet; `V` must be 3 F and `M` 4 F + N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing<T, const N: usize, const F: usize, const V: usize, const M: usize> {
    /// The feet; each is the end of a leg of its own.
    pub feet: [Frame<T>; F],
    /// Gains, weights and limits.
    pub settings: Settings<T>,
    /// Largest torque of each joint, N m.
    pub max_torques: [T; N],
}

/// Memory of the controller: the QP's arrays and active set. All zero at first.
#[derive(Clone, Debug)]
pub struct Workspace<T: Scalar, const V: usize, const M: usize> {
    data: Data<T, V, M>,
    qp: dense_qp::Workspace<T, V, M>,
}

impl<T: Scalar, const V: usize, const M: usize> Workspace<T, V, M> {
    /// All zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            data: Data::new(),
            qp: dense_qp::Workspace::new(),
        }
    }
}

impl<T: Scalar, const V: usize, const M: usize> Default for Workspace<T, V, M> {
    fn default() -> Self {
        Self::new()
    }
}

/// What came of the force QP.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// No foot is in contact: nothing to solve.
    Airborne,
    /// Solved in so many iterations.
    Solved(u32),
    /// Not solved: the forces are the best iterate, inside the force limits.
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

impl<T: Scalar, const N: usize, const F: usize, const V: usize, const M: usize>
    Landing<T, N, F, V, M>
{
    /// A controller.
    #[must_use]
    pub const fn new(feet: [Frame<T>; F], settings: Settings<T>, max_torques: [T; N]) -> Self {
        const { assert!(V == 3 * F && M == 4 * F + N, "V must be 3 F and M 4 F + N") };
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
        workspace: &mut Workspace<T, V, M>,
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
        let posture = Posture::new(model, configuration);
        let body = centroidal_state(model, &posture, velocity);
        let (feet, support) = self.look_at_feet(model, &posture, &body.com_w, contacts);
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

        let rot_wb = &configuration.base.rotation;
        let rates = (body.com_velocity_w, rot_wb * velocity.base.angular);
        let wanted = self.wrench(
            target,
            &body.com_w,
            &support,
            rates,
            rot_wb.matrix(),
            body.mass,
        );
        // Torques that the joint carries beside −Jᵀf: gravity of the legs and damping.
        let mut other = generalized_gravity(model, &posture).joints;
        let stance = self.stance_joints(&feet);
        for ((tau, qd), stands) in other.iter_mut().zip(&velocity.joints).zip(&stance) {
            *tau = if *stands {
                *tau - s.stance_damping * *qd
            } else {
                T::ZERO
            };
        }
        let limits = (&other, &self.max_torques);
        let Workspace { data, qp } = workspace;
        (command.forces_w, command.outcome) = data.solve(s, &feet, &wanted, limits, qp);

        let gravity = generalized_gravity(model, &posture).joints;
        for (j, stands) in stance.iter().enumerate() {
            let reaction = feet
                .iter()
                .zip(&command.forces_w)
                .fold(T::ZERO, |sum, (foot, f)| {
                    sum + foot.columns.get(j).map_or(T::ZERO, |column| column.dot(f))
                });
            let slots = command.feed_forward.iter_mut().zip(&mut command.stiffness);
            let slots = slots.zip(&mut command.damping).zip(&gravity);
            if let (true, Some((((tau, stiffness), damping), gravity))) =
                (*stands, { slots }.nth(j))
            {
                *tau = *gravity - reaction;
                *stiffness = T::ZERO;
                *damping = s.stance_damping;
            }
        }
        command
    }

    /// Arms and Jacobians of the feet, and the support: the middle of all feet horizontally, the mean of those in contact
    /// vertically.
    fn look_at_feet<R: Tree<T, N>>(
        &self,
        model: &R,
        posture: &Posture<T, N>,
        com_w: &Vector3<T>,
        contacts: &[bool; F],
    ) -> ([FootData<T, N>; F], Vector3<T>) {
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(model, posture, &mut kinematics);
        let mut jacobian = FrameJacobian::ZERO;
        let mut feet = [FootData {
            in_contact: false,
            arm_w: Vector3::zeros(),
            columns: [Vector3::zeros(); N],
        }; F];
        let (mut sum, mut low, mut count) = (Vector3::zeros(), T::ZERO, T::ZERO);
        for ((data, frame), on) in feet.iter_mut().zip(&self.feet).zip(contacts) {
            let pos_w = kinematics.frame(frame).translation;
            frame_jacobian(
                model,
                &kinematics,
                frame,
                Axes::LocalWorldAligned,
                &mut jacobian,
            );
            data.in_contact = *on;
            data.arm_w = pos_w - com_w;
            data.columns = jacobian.joints.map(|column| column.linear);
            sum += pos_w;
            if *on {
                low += pos_w.z;
                count += T::ONE;
            }
        }
        let mut support = sum / T::of(F.max(1) as f64);
        if count > T::ZERO {
            support.z = low / count;
        }
        (feet, support)
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

    /// Joints that move a foot in contact.
    fn stance_joints(&self, feet: &[FootData<T, N>; F]) -> [bool; N] {
        let mut stance = [false; N];
        for foot in feet.iter().filter(|foot| foot.in_contact) {
            for (stands, column) in stance.iter_mut().zip(&foot.columns) {
                *stands |= column.norm_squared() > T::ZERO;
            }
        }
        stance
    }

    /// Forces as joint torques: −Σ Jᵀ f, for those who check.
    #[must_use]
    pub fn reaction_torques<R: Tree<T, N>>(
        &self,
        model: &R,
        configuration: &Configuration<T, N>,
        forces_w: &[Vector3<T>; F],
    ) -> [T; N] {
        let mut kinematics = Kinematics::IDENTITY;
        forward_kinematics(model, &Posture::new(model, configuration), &mut kinematics);
        let mut jacobian = FrameJacobian::ZERO;
        let mut torques = [T::ZERO; N];
        for (frame, f) in self.feet.iter().zip(forces_w) {
            frame_jacobian(
                model,
                &kinematics,
                frame,
                Axes::LocalWorldAligned,
                &mut jacobian,
            );
            let effort = jacobian.tr_mul(&Force::new(*f, Vector3::zeros()));
            for (tau, x) in torques.iter_mut().zip(effort.joints) {
                *tau -= x;
            }
        }
        torques
    }
}
