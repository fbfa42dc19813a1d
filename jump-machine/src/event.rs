//! What happened in a tick, by phase.

use jump_control::{Event, Measurement, Phase};
use rbd_core::Tree;
use so3::Scalar;

use crate::{Machine, Refusal};

impl<T: Scalar, M: Tree<T, N>, const N: usize, const F: usize> Machine<'_, T, M, N, F> {
    /// The event of this tick, if any, at time `t` of the plan.
    pub(crate) fn event(&mut self, t: T, measured: &Measurement<T, N, F>) -> Option<Event> {
        let (settings, velocity) = (&self.settings, &measured.base_velocity);
        let (linear, angular) = settings.rest;
        let phase = self.supervisor.phase;
        let moving = velocity.linear.norm_squared() > linear * linear
            || velocity.angular.norm_squared() > angular * angular;
        let resting = !moving && self.supervisor.upright;
        self.calm = if !resting || !matches!(phase, Phase::Landing | Phase::Stand) {
            T::ZERO
        } else {
            self.calm + settings.period
        };
        match (phase, &self.jump) {
            (Phase::Hold, Some(_)) if t < T::ZERO => None,
            (Phase::Hold, _) if !self.workspace.regulator.is_ready() => {
                Some(self.supervisor.refuse(Refusal::TooLate))
            }
            (Phase::Hold, Some(jump)) => {
                let (joints, tolerance) = (&measured.joints, settings.start_tolerance);
                let mut first = jump.plan.start().unwrap_or(*joints);
                for (first, moved) in first.iter_mut().zip(&self.centred.joints) {
                    *first += *moved;
                }
                Some(self.supervisor.begin(joints, &first, tolerance))
            }
            (Phase::Stance, Some(jump)) => (t >= jump.plan.takeoff).then_some(Event::Takeoff),
            (Phase::Flight, Some(jump)) => (t >= jump.plan.posing).then_some(Event::Posing),
            (Phase::PreLanding, _) if self.contact.any() => Some(Event::Touchdown),
            (Phase::PreLanding, Some(jump)) => {
                (t > jump.plan.touchdown + settings.patience).then_some(Event::Overdue)
            }
            (Phase::Landing, _) => (self.calm > settings.settling).then_some(Event::Settled),
            (Phase::Stand, _) => (self.calm == T::ZERO).then_some(Event::Disturbed),
            _ => None,
        }
    }
}
