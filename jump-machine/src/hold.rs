//! The hold before the jump: the robot gathers its legs to where its plan begins, weighs itself, finds its centre of mass and what it carries, and computes the push-off's gains.

use jump_control::{MinimumJerk, Reference};
use nalgebra::Vector3;
use rbd_core::{GRAVITY, Tree, center_of_mass};
use so3::{Scalar, math};

use crate::regulator::NODES_PER_TICK;
use crate::{Jump, Machine, Observation};

impl<'a, T: Scalar, M: Tree<T, N>, const N: usize, const F: usize> Machine<'a, T, M, N, F> {
    /// Takes the joints at time `t` of the plan from where they are in the first tick of the hold to where the plan begins: at once, feet would hop.
    pub(crate) fn gather(&mut self, t: T, joints: &[T; N], reference: &mut Reference<T, N>) {
        let (since, way) = self.gathering.get_or_insert((
            t,
            MinimumJerk {
                from: *joints,
                velocity: [T::ZERO; N],
                to: reference.joints,
                duration: self.settings.gathering,
            },
        ));
        (reference.joints, reference.joint_velocities) = way.at(t - *since);
    }

    /// A tick of the hold at time `t` of the plan, whose torques are `planned`. While the trunk moves no gains are computed: a tick has no time for both.
    #[inline(always)]
    pub(crate) fn hold(
        &mut self,
        jump: &Jump<'a, T, N, F>,
        t: T,
        inputs: &Observation<T, N, F>,
        planned: &[T; N],
    ) {
        let s = &self.settings;
        let moving = -s.centring.before();
        if t >= moving {
            self.locate();
            return;
        }
        // It has come to rest by then.
        if t >= moving - s.weighing {
            self.payload.add(&inputs.joint_torques, planned);
            let (felt, sensed) = (self.contact.residual(), &inputs.measured.foot_forces);
            self.balance.add(felt, sensed);
        }
        let (body, plan) = ((self.model, &s.regulator), &jump.plan);
        let regulator = &mut self.workspace.regulator;
        let legs = (&s.pd.feet, &mut self.wanted);
        let load_height = s.centring.load_height;
        regulator.advance(body, plan, legs, load_height, NODES_PER_TICK);
    }

    /// Once: where the centre of mass is, and what is carried.
    fn locate(&mut self) {
        if self.centred.offset_b.is_some() {
            return;
        }
        let posture = &self.limbs.posture;
        let (base, com) = (posture.base(), center_of_mass(self.model, posture));
        let rot_bw = base.rotation.inverse();
        let (up_b, com_b) = (
            rot_bw * Vector3::z(),
            rot_bw * (com.position_w - base.translation),
        );
        let weight = com.mass * T::of(-GRAVITY[2]);
        let standing = (&self.limbs, &up_b);
        let found = self
            .balance
            .found(standing, (weight, &com_b), &self.settings.centring);
        let (offset_b, heavier) = found.map_or((Vector3::zeros(), T::ZERO), |found| {
            (found.offset_b, found.heavier)
        });
        for foot in &mut self.level_feet {
            *foot += offset_b;
        }
        self.centred.offset_b = Some(offset_b);
        // A robot that is lighter than its model carries nothing.
        let most = self.settings.centring.most_load;
        self.centred.load = math::clamp(heavier, T::ZERO, most);
    }
}
