//! Frames come back as they were sent, and never otherwise.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    missing_docs,
    reason = "tests"
)]

use proptest::prelude::*;
use saltus_loops::frame::{FRAME, LUGGAGE, Order, REPORT, Refusal, Report};

/// Any bits: also those of no number.
fn numbers<const K: usize>() -> impl Strategy<Value = [f32; K]> {
    proptest::array::uniform(any::<u32>().prop_map(f32::from_bits))
}

prop_compose! {
    fn reports()(
        (number, jump) in any::<(u16, bool)>(),
        joints in numbers(),
        joint_velocities in numbers(),
        torques in numbers(),
        specific_force in numbers(),
        angular_velocity in numbers(),
        foot_forces in numbers(),
    ) -> Report {
        Report {
            number, jump, joints, joint_velocities, torques, specific_force, angular_velocity, foot_forces,
        }
    }
}

prop_compose! {
    fn orders()(
        number in any::<u16>(),
        torques in numbers(),
        bytes in proptest::array::uniform(any::<u8>()),
        count in 0..=LUGGAGE,
    ) -> Order {
        Order { number, torques, luggage: (bytes, count) }
    }
}

/// Every bit of a frame in turn, the other way round.
fn damaged<const K: usize>(frame: [u8; K]) -> impl Iterator<Item = [u8; K]> {
    (0..8 * K).map(move |bit| {
        let mut other = frame;
        other[bit / 8] ^= 1 << (bit % 8);
        other
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_report_comes_back_and_no_flipped_bit_gets_through(report in reports()) {
        let frame = report.encode();
        // Numbers that are none compare by their bits.
        prop_assert_eq!(Report::decode(&frame).unwrap().encode(), frame);
        for other in damaged::<REPORT>(frame) {
            prop_assert!(matches!(Report::decode(&other), Err(Refusal::Mark | Refusal::Checksum)));
        }
    }

    #[test]
    fn an_order_comes_back_and_no_flipped_bit_gets_through(order in orders()) {
        let frame = order.encode();
        prop_assert_eq!(Order::decode(&frame).unwrap().encode(), frame);
        for other in damaged::<FRAME>(frame) {
            prop_assert!(matches!(Order::decode(&other), Err(Refusal::Mark | Refusal::Checksum)));
        }
    }

    #[test]
    fn other_bytes_are_no_frame(bytes in proptest::collection::vec(any::<u8>(), 0..2 * FRAME), cut in 0..FRAME) {
        // A checksum of 32 bits and a mark: one in 2⁴⁸ would be.
        prop_assert!(Report::decode(&bytes).is_err() && Order::decode(&bytes).is_err());
        let order = Order { number: 1, torques: [1.0; 12], luggage: ([0; LUGGAGE], 0) };
        prop_assert_eq!(Order::decode(&order.encode()[..cut]), Err(Refusal::CutOff));
    }
}
