//! What the robot says.

use crate::packet::Packet;
use crate::wire::{Reader, Writer};

/// Sensors of a robot with `N` joints and `F` feet, SI units; accelerometer and gyroscope in the axes of the IMU.
///
/// On the wire: flags (4 bytes; bit 0 [`tripped`](Self::tripped)), then the numbers in the order of the fields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<const N: usize, const F: usize> {
    /// The robot has heard nothing for too long, and damps its joints until somebody resets it.
    pub tripped: bool,
    /// Joint positions, rad.
    pub joints: [f32; N],
    /// Joint velocities, rad/s.
    pub joint_velocities: [f32; N],
    /// Mean torques at the joints since the last state, friction included, N m.
    pub joint_torques: [f32; N],
    /// Accelerometer: acceleration minus gravity, m/s². At rest it points up.
    pub specific_force_i: [f32; 3],
    /// Gyroscope, rad/s.
    pub angular_velocity_i: [f32; 3],
    /// Normal forces on the feet, N.
    pub foot_forces: [f32; F],
}

impl<const N: usize, const F: usize> State<N, F> {
    /// Zero everywhere.
    pub const ZERO: Self = Self {
        tripped: false,
        joints: [0.0; N],
        joint_velocities: [0.0; N],
        joint_torques: [0.0; N],
        specific_force_i: [0.0; 3],
        angular_velocity_i: [0.0; 3],
        foot_forces: [0.0; F],
    };
}

impl<const N: usize, const F: usize> Packet for State<N, F> {
    const MARK: u16 = 0x5453;
    const SHAPE: [u8; 2] = [N as u8, F as u8];
    const BODY: usize = 4 + 4 * (3 * N + 6 + F);

    fn write(&self, to: &mut Writer<'_>) {
        to.put(&u32::from(self.tripped).to_le_bytes());
        to.numbers(&self.joints);
        to.numbers(&self.joint_velocities);
        to.numbers(&self.joint_torques);
        to.numbers(&self.specific_force_i);
        to.numbers(&self.angular_velocity_i);
        to.numbers(&self.foot_forces);
    }

    fn read(from: &mut Reader<'_>) -> Self {
        Self {
            tripped: u32::from_le_bytes(from.take()) & 1 != 0,
            joints: from.numbers(),
            joint_velocities: from.numbers(),
            joint_torques: from.numbers(),
            specific_force_i: from.numbers(),
            angular_velocity_i: from.numbers(),
            foot_forces: from.numbers(),
        }
    }

    /// Always: estimator and machine name the sensor whose number is none.
    fn is_usable(&self) -> bool {
        true
    }
}
