//! Hold and push-off: one of two programs (paper B, III-D and III-E).

use jump_control::JointCommand;
use nalgebra::Vector3;
use rbd_core::Tree;
use so3::Scalar;
use wbc_qp::jump::ComReference;
use wbc_qp::{Yielded, anchored};

use super::jump::Armed;
use super::machine::Now;
use super::workspace::Program;
use super::{Machine, Solved, Work, Workspace};

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
    /// Hold and push-off: the centre of mass along its profile.
    pub(super) fn push(
        &mut self,
        armed: &Armed<T, N>,
        now: &Now<'_, T, N, F>,
    ) -> (JointCommand<T, N>, Work<T>) {
        for foot in &mut self.feet {
            foot.load = T::ONE;
        }
        let point = armed.jump.profile.at(now.t);
        let up = Vector3::z();
        let wanted = ComReference {
            position_w: armed.com_w + up * point.rise,
            velocity_w: up * point.speed,
            acceleration_w: up * point.acceleration,
        };
        match self.workspace.push_off {
            Program::Velocity(_) => self.push_by_velocity(armed, now, &wanted),
            Program::Torque(_) => self.push_by_torque(now, &wanted),
        }
    }

    #[inline(never)]
    fn push_by_velocity(
        &mut self,
        armed: &Armed<T, N>,
        now: &Now<'_, T, N, F>,
        wanted: &ComReference<T>,
    ) -> (JointCommand<T, N>, Work<T>) {
        let Workspace {
            push_off, snapshot, ..
        } = &mut *self.workspace;
        let Program::Velocity(program) = push_off else {
            return (self.supervisor.safe(), Work::Damping);
        };
        // Servos hide the feet's own small motion, and a centre of mass that ignores it is smooth.
        let (joints, speeds) = (&now.q.joints, &now.v.joints);
        let (q, v) = match self.feet.first() {
            Some(foot) => anchored(self.model, joints, speeds, &foot.frame, &armed.anchor),
            None => (now.q, now.v),
        };
        snapshot.update(self.model, &q, &v);
        let limits = &self.settings.limits;
        let tick = program.tick(self.model, snapshot, &self.feet, limits, wanted, now.dt);
        let velocities = tick.map_or([T::ZERO; N], |tick| tick.velocities);
        let solved = tick.map(|tick| Solved {
            iterations: tick.iterations,
            residuals: tick.residuals,
            yielded: Yielded::Nothing,
            capped: false,
        });
        let command = self.track(&velocities);
        for (servo, qd) in self.servo.iter_mut().zip(velocities) {
            *servo += now.dt * qd;
        }
        (command, Work::PushOff(solved))
    }

    #[inline(never)]
    fn push_by_torque(
        &mut self,
        now: &Now<'_, T, N, F>,
        wanted: &ComReference<T>,
    ) -> (JointCommand<T, N>, Work<T>) {
        let Workspace {
            push_off, snapshot, ..
        } = &mut *self.workspace;
        let Program::Torque(program) = push_off else {
            return (self.supervisor.safe(), Work::Damping);
        };
        // Nothing hides it from torques: a foot that rocks would look like the whole robot rocking.
        snapshot.update(self.model, &now.q, &now.v);
        let joints = (&self.settings.limits, &self.settings.motors);
        let tick = program.tick(self.model, snapshot, &self.feet, joints, wanted, now.dt);
        // The servos only follow, to be ready for the flight.
        self.servo = now.q.joints;
        let solved = self.take(tick);
        (self.torque_command(), Work::PushOff(solved))
    }
}
