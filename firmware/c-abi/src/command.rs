//! What joints are to do.

use jump_control::{JointCommand, JointGains};

/// What the joints are to do until the next command: τ = `feed_forward` + `stiffness` (`position` − q) + `damping`
/// (`velocity` − q̇), inside what the motors can do.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<const N: usize> {
    /// Joint positions, rad.
    pub position: [f64; N],
    /// Joint velocities, rad/s.
    pub velocity: [f64; N],
    /// Torques, N m.
    pub feed_forward: [f64; N],
    /// Stiffnesses, N m/rad.
    pub stiffness: [f64; N],
    /// Dampings, N m s/rad.
    pub damping: [f64; N],
}

impl<const N: usize> Command<N> {
    /// Damping alone, N m s/rad: what a caller gets that must not trust anything else.
    pub(crate) const fn damp(damping: f64) -> Self {
        Self {
            position: [0.0; N],
            velocity: [0.0; N],
            feed_forward: [0.0; N],
            stiffness: [0.0; N],
            damping: [damping; N],
        }
    }

    pub(crate) fn of(c: &JointCommand<f64, N>) -> Self {
        Self {
            position: c.position,
            velocity: c.velocity,
            feed_forward: c.feed_forward,
            stiffness: c.gains.map(|g| g.stiffness),
            damping: c.gains.map(|g| g.damping),
        }
    }

    pub(crate) fn read(&self) -> JointCommand<f64, N> {
        let mut gains = [JointGains {
            stiffness: 0.0,
            damping: 0.0,
        }; N];
        let given = self.stiffness.iter().zip(&self.damping);
        for (gains, (stiffness, damping)) in gains.iter_mut().zip(given) {
            (gains.stiffness, gains.damping) = (*stiffness, *damping);
        }
        JointCommand {
            position: self.position,
            velocity: self.velocity,
            feed_forward: self.feed_forward,
            gains,
        }
    }
}
