//! Unitree Go2, low level, over DDS: topics `lowcmd` and `lowstate`, messages `unitree_go/LowCmd` and `unitree_go/LowState`.
//!
//! **Has never met hardware.** Source: `unitreerobotics/unitree_ros2`, `example/src/include/common/motor_crc.h` and `example/src/src/common/motor_crc.cpp`
//! (fields, joint order, checksum), `example/src/src/low_level_ctrl.cpp` (modes and stop values); order of the feet as in `unitree_ros`,
//! `unitree_controller/src/servo.cpp`.
//!
//! DDS carries the fields, and whoever publishes them needs the checksum, which is that of the C structure in memory: 812 bytes, aligned as
//! C aligns. [`low_cmd`] is this image; its fields stand where the table says.
//!
//! | bytes | |
//! |---|---|
//! | 0, 1 | head: `fe ef` |
//! | 2, 3 | level: `ff`, low; reserved |
//! | 4..22 | serial number (2 words), version (2 words), bandwidth: 0 |
//! | 24.. | 20 motors, each 36 bytes: mode (1, and 3 to align), q, dq, tau, Kp, Kd, 3 words reserved |
//! | 744..804 | battery (4), remote (40), LEDs (12), fans (2), GPIO, and one to align: 0 |
//! | 804..808 | reserved |
//! | 808..812 | CRC of the 202 words before |
//!
//! Motors 0 to 11 are FR FL RR RL, hip, thigh and calf of each; signs and zeros are those of the published URDF. The others get the values
//! at which a motor does not move: position 2.146·10⁹, speed 16 000.

use crate::command::Command;
use crate::state::State;
use crate::wire::Writer;

use super::reordered;

/// Bytes of the structure.
pub const LOW_CMD: usize = 812;
/// Motors in the message.
const MOTORS: usize = 20;
/// Mode in which a motor's loop is closed; 0 is passive.
const SERVO: u8 = 1;
/// Position at which a motor does not close its position's loop.
const STOP_POSITION: f32 = 2.146e9;
/// Speed at which it does not close its speed's loop.
const STOP_SPEED: f32 = 16_000.0;

/// The image of a `LowCmd` with its checksum.
#[must_use]
pub fn low_cmd(command: &Command<12>) -> [u8; LOW_CMD] {
    let mut image = [0; LOW_CMD];
    let mut to = Writer::new(&mut image);
    to.put(&[0xfe, 0xef, 0xff, 0]);
    to.zeros(20);
    let command = &command.0;
    let (q, qd) = (reordered(&command.position), reordered(&command.velocity));
    let (tau, gains) = (reordered(&command.feed_forward), reordered(&command.gains));
    let joints = q.iter().zip(&qd).zip(tau.iter().zip(&gains));
    let told = joints
        .map(|((q, qd), (tau, gains))| [*q, *qd, *tau, gains.stiffness, gains.damping])
        .chain(core::iter::repeat([
            STOP_POSITION,
            STOP_SPEED,
            0.0,
            0.0,
            0.0,
        ]));
    for numbers in told.take(MOTORS) {
        to.put(&[SERVO, 0, 0, 0]);
        to.numbers(&numbers);
        to.zeros(12);
    }
    to.zeros(LOW_CMD - 4 - 744);
    let sum = crc(to.written());
    to.put(&sum.to_le_bytes());
    image
}

/// CRC of little-endian words, highest bit first: polynomial 0x04C11DB7, begun with all ones, not inverted at the end. It is the CRC-32/MPEG-2 of the bytes
/// of each word in the opposite order.
#[must_use]
pub fn crc(bytes: &[u8]) -> u32 {
    let mut remainder = u32::MAX;
    for word in bytes.as_chunks::<4>().0 {
        remainder ^= u32::from_le_bytes(*word);
        for _ in 0..32 {
            let divisor = if remainder >> 31 == 1 { 0x04c1_1db7 } else { 0 };
            remainder = (remainder << 1) ^ divisor;
        }
    }
    remainder
}

/// What is used of one motor of a `LowState`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorState {
    /// Position, rad.
    pub q: f32,
    /// Velocity, rad/s.
    pub dq: f32,
    /// Estimated torque, N m.
    pub tau_est: f32,
}

/// A state of what a `LowState` says: `motor_state` 0 to 11, `imu_state.gyroscope` (rad/s) and `.accelerometer` (m/s²), and `foot_force` (FR FL RR RL).
///
/// The unit of `foot_force` is not published: `newtons` is how many a count is, measured on the robot that it is meant for; 0 for feet that
/// are not believed, whose touch the joints' torques tell.
#[must_use]
pub fn state(
    motors: &[MotorState; 12],
    gyroscope: [f32; 3],
    accelerometer: [f32; 3],
    foot_force: [i16; 4],
    newtons: f32,
) -> State<12, 4> {
    let motors = reordered(motors);
    let [fr, fl, rr, rl] = foot_force.map(|count| newtons * f32::from(count));
    State {
        tripped: false,
        joints: motors.map(|motor| motor.q),
        joint_velocities: motors.map(|motor| motor.dq),
        joint_torques: motors.map(|motor| motor.tau_est),
        specific_force_i: accelerometer,
        angular_velocity_i: gyroscope,
        foot_forces: [fl, fr, rl, rr],
    }
}
