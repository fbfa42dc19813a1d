//! The legs before the ground and as it comes: level, over the capture point, short enough for their joints, and along with the ground.

use jump_control::{Measurement, Plan};
use nalgebra::Vector3;
use rbd_core::{CentroidalMap, Configuration, GRAVITY, Limbs, Motion, Tree, centroidal_map};
use so3::{Scalar, math};

use crate::Machine;
use landing::solve_damped;

/// The legs as they wait for the ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waiting<T: Scalar, const N: usize, const F: usize> {
    /// Joint positions, rad.
    pub(crate) joints: [T; N],
    /// Joint velocities with which feet are drawn up, rad/s.
    pub(crate) velocities: [T; N],
    /// Height of the feet in the plan's touchdown, world, m.
    ground: T,
    /// How far all feet are raised for the joints' sake, m.
    raised: T,
    /// How far each foot has been drawn up, m.
    retracted: [T; F],
    /// Feet that have touched the ground.
    touched: [bool; F],
    /// Time on the ground, s.
    since: T,
    /// Whether the machine's wanted legs are those of `joints`, from which the next posture is found.
    pub(crate) known: bool,
}

impl<T: Scalar, const N: usize, const F: usize> Waiting<T, N, F> {
    /// Legs without ground of a robot that stands.
    pub(crate) const fn standing(joints: &[T; N]) -> Self {
        Self {
            since: T::INFINITY,
            ..Self::new(joints, T::ZERO)
        }
    }

    /// Legs in this posture, for a ground at which the feet of a plan are at this height.
    pub(crate) const fn new(joints: &[T; N], ground: T) -> Self {
        Self {
            joints: *joints,
            velocities: [T::ZERO; N],
            ground,
            raised: T::ZERO,
            retracted: [T::ZERO; F],
            touched: [false; F],
            since: T::ZERO,
            known: false,
        }
    }
}

impl<T: Scalar, M: Tree<T, N>, const N: usize, const F: usize> Machine<'_, T, M, N, F> {
    /// Mean height of the feet in the touchdown of a plan, world, m.
    pub(crate) fn ground(&self, plan: &Plan<'_, T, N, F>) -> T {
        let Some(node) = plan.node(plan.node_at(plan.touchdown, 0)) else {
            return T::ZERO;
        };
        let q = Configuration {
            joints: node.joints,
            ..Configuration::NEUTRAL
        };
        let limbs = Limbs::new(self.model, &q, &self.settings.pd.feet);
        let heights = limbs
            .ends
            .iter()
            .map(|end| (node.base.rotation * end.position).z);
        node.base.translation.z + heights.fold(T::ZERO, |sum, z| sum + z) / T::of(F.max(1) as f64)
    }

    /// The landing posture for a body that goes on turning until it touches down, `left` from now: legs that follow the tilt of
    /// now turn a body away from its plan that would have been level in time. What goes on is not the base's angular velocity, which legs on
    /// their way change, but that of the robot with its joints locked. The wanted legs must be those of the last posture.
    #[inline(always)]
    pub(crate) fn level(&mut self, measured: &Measurement<T, N, F>, left: T, dt: T) {
        let left = math::max(left, T::ZERO);
        let rot_bw = measured.base.rotation.inverse();
        let mut up_b = rot_bw * Vector3::z();
        let mut velocity_b = measured.base_velocity;
        if left > T::ZERO {
            let mut map = CentroidalMap::ZERO;
            centroidal_map(self.model, &self.limbs.posture, &mut map);
            let momentum = map.momentum(&measured.velocity());
            let omega_b = rot_bw * map.locked_angular_velocity(&momentum);
            let back = so3::exp(&(omega_b * -left));
            (up_b, velocity_b.linear) = (back * up_b, back * velocity_b.linear);
        }
        let raised = self.give_way(measured, (&up_b, &velocity_b), left, dt);
        self.waiting.joints = self.posture.follow(
            &self.level_feet,
            (&up_b, &velocity_b.linear),
            &raised,
            (&self.waiting.joints, &self.wanted),
        );
        self.waiting.known = false;
    }

    /// How far each foot is to be raised, m: legs are shortened for what the ground will do to their joints, and feet near it are drawn up.
    /// The body will touch down, `left` from now, with this vertical and, but for what it still falls, this velocity.
    fn give_way(
        &mut self,
        measured: &Measurement<T, N, F>,
        (up_b, velocity_b): (&Vector3<T>, &Motion<T>),
        left: T,
        dt: T,
    ) -> [T; F] {
        let (s, waiting) = (&self.settings, &mut self.waiting);
        let (rot_wb, velocity) = (&measured.base.rotation, &measured.base_velocity);
        let gained = T::of(-GRAVITY[2]) * left;
        let body_fall = -(rot_wb * velocity.linear).z;
        let meeting_b = Motion::new(velocity_b.linear - up_b * gained, velocity_b.angular);
        let fastest = s.shortening.fastest(&self.wanted.ends, &meeting_b);
        waiting.raised = s
            .shortening
            .raise(waiting.raised, fastest, body_fall + gained, dt);
        waiting.velocities = [T::ZERO; N];
        let mut raised = [waiting.raised; F];
        let feet = raised.iter_mut().zip(&mut waiting.retracted);
        let feet = feet.zip(&waiting.touched).zip(&self.limbs.ends);
        for (((raised, retracted), touched), end) in feet {
            let speed_b = velocity.linear + velocity.angular.cross(&end.position);
            let height = measured.base.translation.z + (rot_wb * end.position).z - waiting.ground;
            let falls = (-(rot_wb * speed_b).z, body_fall);
            let speed = s.retraction.speed(*retracted, height, falls);
            if !*touched && speed > T::ZERO {
                *retracted += speed * dt;
                let force = solve_damped(end, s.posture.damping, &(up_b * speed));
                end.add_tr_mul(&force, &mut waiting.velocities);
            }
            *raised += *retracted;
        }
        raised
    }

    /// What the first touch changes, and feet that have not touched the ground yet when others have: they go on as before it, for a while, and
    /// then stand as the robot will. The velocities of their joints, rad/s.
    pub(crate) fn meet(&mut self, measured: &Measurement<T, N, F>, dt: T) -> [T; N] {
        let waiting = &mut self.waiting;
        for (touched, on) in waiting.touched.iter_mut().zip(&self.contact.contacts) {
            *touched |= *on;
        }
        if waiting.since == T::ZERO {
            let fall = -(measured.base.rotation * measured.base_velocity.linear).z;
            self.landing.settings = self.settings.landing.after_fall(fall);
        }
        waiting.since += dt;
        if waiting.since >= self.settings.retraction.lasting {
            // Feet that are still in the air come down beside those that carry the robot: legs as short as they waited would not reach.
            waiting.joints = self.posture.joints;
            return [T::ZERO; N];
        }
        if !self.waiting.known {
            let q = Configuration {
                joints: self.waiting.joints,
                ..Configuration::NEUTRAL
            };
            self.wanted.update(self.model, &q, &self.settings.pd.feet);
        }
        self.level(measured, T::ZERO, dt);
        self.waiting.velocities
    }
}
