//! Adapters against golden frames of a program that was written from the same public sources and knows nothing of them
//! (`golden/generate.py`).

use jump_control::{JointCommand, JointGains};
use proptest::prelude::*;
use robot_link::Command;
use robot_link::adapters::unitree_go2::MotorState;
use robot_link::adapters::{mini_cheetah, unitree_go2};

/// The command of the golden frames.
fn command() -> Command<12> {
    let numbers = |of: fn(f32) -> f32| core::array::from_fn(|i| of(i as f32));
    Command(JointCommand {
        position: numbers(|i| 0.25 * i - 1.0),
        velocity: numbers(|i| 2.0 - 0.5 * i),
        feed_forward: numbers(|i| 3.0 * i),
        gains: core::array::from_fn(|i| JointGains {
            stiffness: 20.0 + i as f32,
            damping: 1.0 + 0.125 * i as f32,
        }),
    })
}

#[test]
fn a_go2_is_told_the_golden_bytes() {
    let golden = include_bytes!("golden/go2_low_cmd.bin");
    assert_eq!(&unitree_go2::low_cmd(&command()), golden);
}

/// The check value of CRC-32/MPEG-2 in the catalogue of CRCs is 0x0376E6E7 for `123456789`; of its first eight bytes, in words, it is this.
#[test]
fn the_crc_is_that_of_the_catalogue_by_words() {
    let reversed = *b"43218765";
    // "9" is the ninth byte: eight more steps of the same division.
    let mut remainder = unitree_go2::crc(&reversed) ^ (u32::from(b'9') << 24);
    for _ in 0..8 {
        let divisor = if remainder >> 31 == 1 { 0x04c1_1db7 } else { 0 };
        remainder = (remainder << 1) ^ divisor;
    }
    assert_eq!(remainder, 0x0376_e6e7);
}

#[test]
fn a_go2_says_its_joints_in_our_order() {
    let motors = core::array::from_fn(|i| MotorState {
        q: i as f32,
        dq: 100.0 + i as f32,
        tau_est: 200.0 + i as f32,
    });
    let (gyroscope, accelerometer) = ([1.0, 2.0, 3.0], [0.0, 0.0, 9.81]);
    let state = unitree_go2::state(&motors, gyroscope, accelerometer, [1, 2, 3, 4], 2.0);
    // FL FR RL RR of FR FL RR RL.
    let joints = [3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8].map(|i| i as f32);
    assert_eq!(state.joints, joints);
    assert_eq!(state.joint_velocities, joints.map(|i| 100.0 + i));
    assert_eq!(state.joint_torques, joints.map(|i| 200.0 + i));
    assert_eq!(state.foot_forces, [4.0, 2.0, 8.0, 6.0]);
    assert_eq!(state.specific_force_i, accelerometer);
    assert_eq!(state.angular_velocity_i, gyroscope);
}

/// Numbers up to 50 to what single precision leaves of them, since the golden ones were computed in double; flags and checksum as they are.
#[test]
fn both_boards_of_a_cheetah_are_told_the_golden_words() {
    let golden: [&[u8; 132]; 2] = [
        include_bytes!("golden/cheetah_0.bin"),
        include_bytes!("golden/cheetah_1.bin"),
    ];
    let word = |frame: &[u8], k: usize| {
        let at = |i: usize| frame[(4 * k + i) ^ 1];
        u32::from_le_bytes([at(0), at(1), at(2), at(3)])
    };
    for (frame, golden) in mini_cheetah::spine_commands(&command(), true)
        .iter()
        .zip(golden)
    {
        for k in 0..30 {
            let [ours, theirs] = [word(frame, k), word(golden, k)].map(f32::from_bits);
            assert!((ours - theirs).abs() < 4e-6, "word {k}: {ours}, {theirs}");
        }
        assert_eq!([word(frame, 30), word(frame, 31)], [1, 1]);
        // All 33 words together: nothing.
        assert_eq!((0..33).fold(0, |sum, k| sum ^ word(frame, k)), 0);
        assert_eq!((0..33).fold(0, |sum, k| sum ^ word(golden, k)), 0);
    }
}

proptest! {
    /// What a board is told as a position comes back as one: a board that is where it should be says what it was told. One wrong bit does not.
    #[test]
    fn a_cheetah_that_is_where_it_was_told_says_so(
        position in proptest::array::uniform12(-3.0_f32..3.0),
        velocity in proptest::array::uniform12(-20.0_f32..20.0),
        bit in 0..8_usize * 60,
    ) {
        let mut told = JointCommand::damp(1.0);
        (told.position, told.velocity) = (position, velocity);
        let answers = mini_cheetah::spine_commands(&Command(told), true).map(|mut frame| {
            // An answer: positions, velocities, flags, and the exclusive or, whose bytes are exchanged as well.
            let mut sum = [0; 4];
            for k in 0..14 {
                (0..4).for_each(|i| sum[i] ^= frame[4 * k + i]);
            }
            frame[56..60].copy_from_slice(&sum);
            frame
        });
        let [q, qd] = mini_cheetah::joints([&answers[0], &answers[1]]).unwrap();
        for (heard, told) in q.iter().zip(&position).chain(qd.iter().zip(&velocity)) {
            prop_assert!((heard - told).abs() < 1e-5, "{} {}", heard, told);
        }
        let mut damaged = answers[1];
        damaged[bit / 8] ^= 1 << (bit % 8);
        prop_assert!(mini_cheetah::joints([&answers[0], &damaged]).is_none());
    }
}
