//! Packets come back as they were sent, and never otherwise.

use jump_control::{JointCommand, JointGains};
use proptest::prelude::*;
use robot_link::packet::{Echo, Header, Packet, Refusal, decode, encode};
use robot_link::{Command, State};

type Told = Command<12>;
type Says = State<12, 4>;

/// Any bits: also those of no number.
fn numbers<const K: usize>() -> impl Strategy<Value = [f32; K]> {
    proptest::array::uniform(any::<u32>().prop_map(f32::from_bits))
}

prop_compose! {
    fn headers()(
        (number, stamp) in any::<(u32, u64)>(),
        echo in any::<Option<(u32, u32, u32)>>(),
    ) -> Header {
        let echo = echo.map(|(number, held_us, stamp)| Echo { number, held_us, stamp: u64::from(stamp) });
        Header { number, stamp, echo }
    }
}

prop_compose! {
    pub(crate) fn commands()(
        position in numbers(),
        velocity in numbers(),
        feed_forward in numbers(),
        (stiffness, damping) in (numbers::<12>(), numbers::<12>()),
    ) -> Told {
        let gains = core::array::from_fn(|i| JointGains { stiffness: stiffness[i], damping: damping[i] });
        Command(JointCommand { position, velocity, feed_forward, gains })
    }
}

prop_compose! {
    fn states()(
        tripped in any::<bool>(),
        joints in numbers(),
        joint_velocities in numbers(),
        joint_torques in numbers(),
        specific_force_i in numbers(),
        angular_velocity_i in numbers(),
        foot_forces in numbers(),
    ) -> Says {
        State {
            tripped, joints, joint_velocities, joint_torques, specific_force_i, angular_velocity_i, foot_forces,
        }
    }
}

/// Comes back with its header; no flipped bit gets through, nor a byte too few or too many. Numbers that are none compare by their bits.
fn comes_back<P: Packet>(header: &Header, packet: &P) -> Result<(), TestCaseError> {
    let mut bytes = vec![0; P::LENGTH + 1];
    prop_assert_eq!(encode(header, packet, &mut bytes), Some(P::LENGTH));
    let frame = &bytes[..P::LENGTH];
    let (again, told) = decode::<P>(frame).unwrap();
    prop_assert_eq!(&again, header);
    let mut second = vec![0; P::LENGTH];
    encode(&again, &told, &mut second);
    prop_assert_eq!(&second, frame);
    for bit in 0..8 * P::LENGTH {
        let mut other = second.clone();
        other[bit / 8] ^= 1 << (bit % 8);
        let refused = matches!(decode::<P>(&other), Err(Refusal::Mark | Refusal::Checksum));
        prop_assert!(refused, "bit {}", bit);
    }
    for cut in 0..P::LENGTH {
        prop_assert_eq!(decode::<P>(&frame[..cut]).err(), Some(Refusal::CutOff));
        prop_assert_eq!(encode(header, packet, &mut second[..cut]), None);
    }
    prop_assert_eq!(decode::<P>(&bytes).err(), Some(Refusal::TooLong));
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_command_comes_back(header in headers(), command in commands()) {
        comes_back(&header, &command)?;
    }

    #[test]
    fn a_state_comes_back(header in headers(), state in states()) {
        comes_back(&header, &state)?;
    }

    #[test]
    fn other_bytes_are_no_packet(bytes in proptest::collection::vec(any::<u8>(), 0..2 * Told::LENGTH)) {
        prop_assert!(decode::<Told>(&bytes).is_err() && decode::<Says>(&bytes).is_err());
    }

    /// What single precision holds goes through the wire unchanged in either scalar.
    #[test]
    fn scalars_keep_their_bits(command in commands()) {
        prop_assume!(command.0.is_finite());
        prop_assert_eq!(Command::of(&command.as_scalar::<f64>()), command);
        prop_assert_eq!(Command::of(&command.as_scalar::<f32>()), command);
    }
}

/// The layout of the module's table, byte by byte: other programs read it.
#[test]
fn the_layout_is_the_documented_one() {
    let header = Header {
        number: 0x0403_0201,
        stamp: 0x0807_0605_0403_0201,
        echo: Some(Echo {
            number: 7,
            held_us: 300,
            stamp: 9,
        }),
    };
    let mut state = State::<1, 2>::ZERO;
    state.tripped = true;
    state.joints = [1.0];
    state.foot_forces = [2.0, -2.0];
    let mut bytes = [0; State::<1, 2>::LENGTH];
    encode(&header, &state, &mut bytes).unwrap();
    let mut golden = vec![0x53, 0x54, 1, 2, 1, 2, 3, 4, 1, 2, 3, 4, 5, 6, 7, 8];
    golden.extend([7, 0, 0, 0, 0x2c, 1, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0]);
    golden.extend([1, 0, 0, 0, 0, 0, 0x80, 0x3f]);
    golden.extend([0; 4 * 8]);
    golden.extend([0, 0, 0, 0x40, 0, 0, 0, 0xc0]);
    let (body, sum) = bytes.split_at(bytes.len() - 4);
    assert_eq!(body, golden);
    let sum = u32::from_le_bytes(sum.try_into().unwrap());
    assert_eq!(sum, jump_control::Crc32::START.with(&golden).value());
    assert_eq!((Told::LENGTH, Says::LENGTH), (276, 224));
}

#[test]
fn a_packet_of_another_robot_is_refused() {
    let header = Header {
        number: 0,
        stamp: 0,
        echo: None,
    };
    let mut bytes = [0; Says::LENGTH];
    // As many bytes for other joints and feet: 3·1 = 4 − 1.
    encode(&header, &State::<11, 7>::ZERO, &mut bytes).unwrap();
    assert_eq!(decode::<Says>(&bytes).err(), Some(Refusal::Shape));
    assert!(decode::<State<11, 7>>(&bytes).is_ok());
}
