//! What the robot is told.

use jump_control::{JointCommand, JointGains};
use so3::Scalar;

use crate::packet::Packet;
use crate::wire::{Reader, Writer};

/// Position, velocity, feed-forward torque and gains of `N` joints: the motor board makes τ + kp(q_d − q) + kd(q̇_d − q̇) of it, at its own
/// rate. On the wire five blocks of `N` numbers: q_d (rad), q̇_d (rad/s), kp (N m/rad), kd (N m s/rad), τ (N m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<const N: usize>(pub JointCommand<f32, N>);

impl<const N: usize> Command<N> {
    /// A controller's command, as a motor board takes it.
    #[must_use]
    pub fn of<T: Scalar>(command: &JointCommand<T, N>) -> Self {
        Self(converted(command, |x| x.to_f64() as f32))
    }

    /// In the scalar of whoever closes the joints' loop.
    #[must_use]
    pub fn as_scalar<T: Scalar>(&self) -> JointCommand<T, N> {
        converted(&self.0, |x| T::of(f64::from(x)))
    }
}

/// The same numbers in another type.
fn converted<A: Copy, B: Copy, const N: usize>(
    command: &JointCommand<A, N>,
    to: impl Fn(A) -> B,
) -> JointCommand<B, N> {
    JointCommand {
        position: command.position.map(&to),
        velocity: command.velocity.map(&to),
        feed_forward: command.feed_forward.map(&to),
        gains: command.gains.map(|gains| JointGains {
            stiffness: to(gains.stiffness),
            damping: to(gains.damping),
        }),
    }
}

impl<const N: usize> Packet for Command<N> {
    const MARK: u16 = 0x4d43;
    const SHAPE: [u8; 2] = [N as u8, 0];
    const BODY: usize = 20 * N;

    fn write(&self, to: &mut Writer<'_>) {
        let command = &self.0;
        to.numbers(&command.position);
        to.numbers(&command.velocity);
        to.numbers(&command.gains.map(|gains| gains.stiffness));
        to.numbers(&command.gains.map(|gains| gains.damping));
        to.numbers(&command.feed_forward);
    }

    fn read(from: &mut Reader<'_>) -> Self {
        let (position, velocity) = (from.numbers(), from.numbers());
        let (stiffness, damping): ([f32; N], [f32; N]) = (from.numbers(), from.numbers());
        let mut gains = [JointGains {
            stiffness: 0.0,
            damping: 0.0,
        }; N];
        for ((gains, stiffness), damping) in gains.iter_mut().zip(stiffness).zip(damping) {
            *gains = JointGains { stiffness, damping };
        }
        Self(JointCommand {
            position,
            velocity,
            gains,
            feed_forward: from.numbers(),
        })
    }

    /// All numbers are finite, and no gain is negative: a joint that is driven away from where it should be is nobody's wish.
    fn is_usable(&self) -> bool {
        let mut gains = self.0.gains.iter();
        self.0.is_finite() && gains.all(|gains| gains.stiffness >= 0.0 && gains.damping >= 0.0)
    }
}
