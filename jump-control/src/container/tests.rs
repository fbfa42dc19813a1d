#![allow(clippy::unwrap_used, reason = "tests")]
extern crate std;

use super::{
    Container, ContainerError, GroundStep, Header, MOST_PHASES, Margins, NodeGains, PREFIX,
    PlanNode, PlanPhase, Row, model_hash, write,
};
use crate::{Node, Plan, Torques, sample};
use std::vec;
use std::vec::Vec;

const ROBOT: u64 = 0x0123_4567_89ab_cdef;

fn header() -> Header<'static> {
    let mut phases = [PlanPhase::default(); MOST_PHASES];
    phases[0] = PlanPhase {
        contacts: 3,
        duration: 0.5,
    };
    Header {
        task: "a1/lateral",
        robot: "two feet",
        torques: Torques::Hold,
        takeoff: 0.1,
        posing: 0.15,
        touchdown: 0.2,
        phase_count: 2,
        phases,
        ground: Some(GroundStep {
            drop: 0.3,
            axis: 1,
            side: -1,
            distance: 0.18,
        }),
        margins: Margins {
            friction: 0.6,
            friction_share: 0.75,
            max_force: 160.0,
            torque_share: 0.7,
            speed_share: 0.85,
            weight: 130.0,
        },
        nodes: 0,
        has_gains: false,
    }
}

fn nodes() -> Vec<PlanNode<3, 2>> {
    let node = |i: usize| PlanNode {
        phase: (i / 2) as u8,
        time: 0.05 * i as f32,
        position_w: [0.1, 0.2, 0.3 + i as f32],
        rotation_wb: [0.0, 0.0, 0.6, 0.8],
        velocity_b: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        joints: Row([0.1, -0.2, i as f32]),
        joint_velocities: Row([1.0, 2.0, 3.0]),
        torques: Row([-1.0, 20.0, i as f32]),
        forces_w: Row([[1.0, 2.0, 30.0], [0.0, 0.0, 40.0]]),
        feet_b: Row([[0.0, 0.1, -0.25]; 2]),
        foot_velocities_b: Row([[0.5, 0.0, -1.0]; 2]),
    };
    (0..4).map(node).collect()
}

fn bytes(gains: bool) -> Vec<u8> {
    let gain = NodeGains {
        by_joints: Row([Row([1.0, 2.0, 3.0]); 3]),
        ..NodeGains::default()
    };
    let gains = if gains { vec![gain; 4] } else { vec![] };
    let mut out = vec![0; 4096];
    let length = write(&mut out, ROBOT, &header(), &nodes(), &gains).unwrap();
    out.truncate(length);
    out
}

type Opened<'a> = Result<Container<'a, 3, 2>, ContainerError>;

#[test]
fn what_is_written_is_read() {
    for gains in [false, true] {
        let mut stored = bytes(gains);
        // The rest of a page of flash.
        stored.extend([0xff; 100]);
        let container = (Container::open(&stored, ROBOT) as Opened<'_>).unwrap();
        let expected = Header {
            nodes: 4,
            has_gains: gains,
            ..header()
        };
        assert_eq!(*container.header(), expected);
        assert_eq!(container.nodes().collect::<Vec<_>>(), nodes());
        assert_eq!(container.node(4), None);
        assert_eq!(container.gains(3).is_some(), gains);
        assert_eq!(container.gains(4), None);
        let mut storage = [Node::<f64, 3, 2>::ZERO; 5];
        let read = container.read_into(&mut storage).unwrap();
        let h = container.header();
        let times = [h.takeoff, h.posing, h.touchdown].map(f64::from);
        let plan = Plan::new(read, times[0], times[1], times[2], h.torques).unwrap();
        let reference = sample(&plan, 0.06, 0);
        assert_eq!(reference.torques, [-1.0, 20.0, 1.0]);
        let axis = read[0].base.rotation * nalgebra::Vector3::x();
        assert!((axis - nalgebra::Vector3::new(0.28, 0.96, 0.0)).norm() < 1e-6);
        let mut short = [Node::<f64, 3, 2>::ZERO; 3];
        let refused = container.read_into(&mut short);
        assert_eq!(
            refused,
            Err(ContainerError::Buffer {
                needed: 4,
                given: 3
            })
        );
    }
}

/// Every single bit, every byte turned over, and every shorter length.
#[test]
fn damage_is_always_detected() {
    let stored = bytes(true);
    for i in 0..stored.len() {
        for mask in [1, 2, 4, 8, 16, 32, 64, 128, 255_u8] {
            let mut damaged = stored.clone();
            damaged[i] ^= mask;
            let opened: Opened<'_> = Container::open(&damaged, ROBOT);
            assert!(opened.is_err(), "byte {i}, mask {mask}");
        }
        let opened: Opened<'_> = Container::open(&stored[..i], ROBOT);
        assert!(
            matches!(opened, Err(ContainerError::TooShort { .. })),
            "length {i}"
        );
    }
}

#[test]
fn refusals_name_their_reason() {
    let stored = bytes(false);
    let refused = |bytes: &[u8]| (Container::open(bytes, ROBOT) as Opened<'_>).unwrap_err();
    let mut other = stored.clone();
    other[4] = 2;
    assert_eq!(refused(&other), ContainerError::Version { found: 2 });
    other[0] = b'X';
    assert_eq!(refused(&other), ContainerError::NotAPlan);
    let mut other = stored.clone();
    other[PREFIX + 3] ^= 1;
    assert_eq!(refused(&other), ContainerError::Checksum);
    let wrong: Opened<'_> = Container::open(&stored, ROBOT + 1);
    assert_eq!(
        wrong.unwrap_err(),
        ContainerError::Robot {
            planned: ROBOT,
            given: ROBOT + 1
        }
    );
    let wrong: Result<Container<'_, 4, 2>, _> = Container::open(&stored, ROBOT);
    assert_eq!(
        wrong.unwrap_err(),
        ContainerError::Size { joints: 3, feet: 2 }
    );
    let mut small = [0; 100];
    let refused = write(&mut small, ROBOT, &header(), &nodes(), &[]);
    assert!(matches!(refused, Err(ContainerError::Buffer { .. })));
    let mut out = vec![0; 4096];
    let refused = write(
        &mut out,
        ROBOT,
        &header(),
        &nodes(),
        &[NodeGains::default()],
    );
    assert_eq!(refused, Err(ContainerError::Header));
}

#[test]
fn the_hash_tells_robots_apart_and_not_precisions() {
    let geared = model_hash::<f64, _, 12>(&a1_model::A1Geared);
    assert_eq!(geared, model_hash::<f32, _, 12>(&a1_model::A1Geared));
    assert_ne!(geared, model_hash::<f64, _, 12>(&a1_model::A1));
}
