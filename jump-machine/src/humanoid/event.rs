//! What happened in a tick, by phase.

use jump_control::{Event, Measurement, Phase};
use rbd_core::{GRAVITY, Tree};
use so3::Scalar;

use super::Machine;
use super::jump::Armed;
use super::stance::first_foot;
use crate::Refusal;

impl<
    T: Scalar,
    M: Tree<T, N>,
    const N: usize,
    const F: usize,
    const K: usize,
    const V: usize,
    const W: usize,
    const R: usize,
> Machine<'_, T, M, N, F, K, V, W, R>
{
    /// The event of this tick of length `dt`, if any, at time `t` of the jump.
    pub(super) fn event(&mut self, t: T, measured: &Measurement<T, N, F>, dt: T) -> Option<Event> {
        let (s, velocity) = (&self.settings, &measured.base_velocity);
        let (linear, angular) = s.rest;
        let moving = velocity.linear.norm() > linear || velocity.angular.norm() > angular;
        let phase = self.supervisor.phase;
        let resting = !moving && self.supervisor.upright;
        self.calm = if !resting || !matches!(phase, Phase::Landing | Phase::Stand) {
            T::ZERO
        } else {
            self.calm + dt
        };
        match (phase, &self.armed) {
            // The push-off holds the centre of mass where the jump begins in the world: elsewhere, it would push with all its might.
            (Phase::Hold, Some(armed)) if self.away(armed, measured) => {
                Some(self.supervisor.refuse(Refusal::Place))
            }
            (Phase::Hold, Some(_)) if t < T::ZERO => None,
            (Phase::Hold, Some(armed)) => {
                let first = &armed.jump.start.joints;
                Some(
                    self.supervisor
                        .begin(&measured.joints, first, s.start_tolerance),
                )
            }
            (Phase::Stance, Some(armed)) => {
                (t >= armed.jump.profile.duration).then_some(Event::Takeoff)
            }
            // The ground cannot come before the robot falls.
            (Phase::Flight, Some(armed)) => {
                let apex = self.took_off + armed.jump.profile.speed / T::of(-GRAVITY[2]);
                (t >= apex).then_some(Event::Posing)
            }
            (Phase::PreLanding, _) if total(&measured.foot_forces) > s.touchdown_force => {
                Some(Event::Touchdown)
            }
            (Phase::PreLanding, _) => (t > self.took_off + s.patience).then_some(Event::Overdue),
            (Phase::Landing, _) => (self.calm > s.settling).then_some(Event::Settled),
            (Phase::Stand, _) => (self.calm == T::ZERO).then_some(Event::Disturbed),
            _ => None,
        }
    }

    /// Whether the robot stands elsewhere than where the jump begins. Not inlined: poses of all links on the stack are for the hold alone.
    #[inline(never)]
    fn away(&self, armed: &Armed<T, N>, measured: &Measurement<T, N, F>) -> bool {
        let foot = first_foot(self.model, &self.settings.feet, &measured.configuration());
        let distance = (foot.translation - armed.anchor.translation).norm();
        distance > self.settings.start_distance
    }
}

/// Force on all feet together.
fn total<T: Scalar, const F: usize>(forces: &[T; F]) -> T {
    forces.iter().fold(T::ZERO, |sum, force| sum + *force)
}
