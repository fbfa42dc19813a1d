#![allow(clippy::unwrap_used, reason = "tests")]
extern crate std;

use super::{
    Container, ContainerError, GroundStep, Header, LONGEST_ROBOT, LONGEST_TASK, MOST_PHASES,
    Margins, PREFIX, PlanNode, PlanPhase, VERSION, model_hash, parts, write,
};
use crate::{Node, Plan, Torques, sample};
use std::string::String;
use std::vec;
use std::vec::Vec;

pub(super) const ROBOT: u64 = 0x0123_4567_89ab_cdef;
/// What these tests write, as it is stored: see [`the_golden_is_written`].
const GOLDEN: &[u8] = include_bytes!("../../tests/hop.bin");

fn header() -> Header<'static, 2> {
    let mut phases = [PlanPhase::default(); MOST_PHASES];
    phases[0] = PlanPhase {
        contacts: 1,
        duration: 0.05,
    };
    phases[1].duration = 0.05;
    Header {
        task: "monopod/hop",
        robot: "monopod",
        torques: Torques::Hold,
        phase_count: 2,
        nodes: 3,
        takeoff: 0.05,
        posing: 0.07,
        touchdown: 0.1,
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
        goal_w: [0.1, 0.3, -0.3],
        heading: 1.5,
        landing_joints: [0.7, -1.4],
    }
}

fn nodes() -> Vec<PlanNode<2, 1>> {
    let node = |i: u8| {
        let x = f32::from(i);
        PlanNode {
            phase: i / 2,
            time: 0.05 * x,
            position_w: [0.1, 0.2, 0.3 + x],
            // A turn about z with the sine 0.8, then one about x with the sine 0.6.
            rotation_wb: [[0.6, -0.64, 0.48], [0.8, 0.48, -0.36], [0.0, 0.6, 0.8]],
            velocity_b: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
            joints: [-0.2, x],
            joint_velocities: [7.0, 8.0],
            torques: [20.0, x],
            forces_w: [[10.0, 20.0, if i == 0 { 100.0 } else { 50.0 }]],
            feet_b: [[0.0, 0.1, -0.25]],
            foot_velocities_b: [[0.5, 0.0, -1.0]],
        }
    };
    let mut nodes: Vec<_> = (0..3).map(node).collect();
    nodes[2].forces_w = [[0.0; 3]];
    nodes
}

fn written(header: &Header<'_, 2>, nodes: &[PlanNode<2, 1>]) -> Vec<u8> {
    let mut out = vec![0; Container::<2, 1>::size(nodes.len())];
    let length = write(&mut out, ROBOT, header, nodes).unwrap();
    assert_eq!(length, out.len());
    out
}

pub(super) fn bytes() -> Vec<u8> {
    written(&header(), &nodes())
}

type Opened<'a> = Result<Container<'a, 2, 1>, ContainerError>;

#[test]
fn what_is_written_is_read() {
    let mut stored = bytes();
    // The rest of a page of flash.
    stored.extend([0xff; 100]);
    let container = (Container::open(&stored, ROBOT) as Opened<'_>).unwrap();
    assert_eq!(*container.header(), header());
    assert_eq!(container.robot(), ROBOT);
    assert_eq!(container.nodes().collect::<Vec<_>>(), nodes());
    assert_eq!(container.node(3), None);
    assert_eq!(container.node(usize::MAX), None);
    assert_eq!(container.check(), Ok(()));
    let mut storage = [Node::<f64, 2, 1>::ZERO; 4];
    let read = container.read_into(&mut storage).unwrap();
    let h = container.header();
    let times = [h.takeoff, h.posing, h.touchdown].map(f64::from);
    let plan = Plan::new(read, times[0], times[1], times[2], h.torques).unwrap();
    let reference = sample(&plan, 0.06, 0);
    assert_eq!(reference.torques, [20.0, 1.0]);
    let axis = read[0].base.rotation * nalgebra::Vector3::x();
    assert!((axis - nalgebra::Vector3::new(0.6, 0.8, 0.0)).norm() < 1e-7);
    let mut short = [Node::<f64, 2, 1>::ZERO; 2];
    let refused = container.read_into(&mut short);
    assert_eq!(
        refused,
        Err(ContainerError::Buffer {
            needed: 3,
            given: 2
        })
    );
}

/// Nothing is lost without a box, and with the other rule for torques.
#[test]
fn what_may_be_missing_is_read_as_missing() {
    let other = Header {
        ground: None,
        torques: Torques::Linear,
        task: "",
        ..header()
    };
    let stored = written(&other, &[]);
    let container = (Container::open(&stored, ROBOT) as Opened<'_>).unwrap();
    assert_eq!(*container.header(), Header { nodes: 0, ..other });
    assert_eq!(container.nodes().count(), 0);
}

/// Rewrites the golden file: `cargo test -p jump-control --lib -- --ignored the_golden_is_written`. A change of the layout is a new version.
#[test]
#[ignore = "writes a file"]
fn the_golden_is_written() {
    std::fs::write(
        concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hop.bin"),
        bytes(),
    )
    .unwrap();
}

/// The bytes of this version are those that it had when the golden file was written, and stand where the table says.
#[test]
fn the_layout_is_the_one_of_the_table() {
    let stored = bytes();
    assert_eq!(stored, GOLDEN);
    let text = |at: usize, length: usize| core::str::from_utf8(&stored[at..at + length]).unwrap();
    let number = |at: usize| f32::from_le_bytes(*stored[at..].first_chunk().unwrap());
    assert_eq!(text(0, 4), "SLTS");
    assert_eq!(stored[4..8], [VERSION as u8, 0, 2, 1]);
    assert_eq!(stored[8..16], ROBOT.to_le_bytes());
    assert_eq!(stored[16..20], (stored.len() as u32).to_le_bytes());
    assert_eq!((stored[24], text(25, 11)), (11, "monopod/hop"));
    assert_eq!((stored[280], text(281, 7)), (7, "monopod"));
    assert_eq!(stored[344..348], [0, 2, 3, 0]);
    assert_eq!([348, 352, 356].map(number), [0.05, 0.07, 0.1]);
    assert_eq!((stored[360], number(364)), (1, 0.05));
    assert_eq!((stored[368], number(372)), (0, 0.05));
    assert_eq!(stored[424..428], [1, 255, 0, 0]);
    assert_eq!([428, 432].map(number), [0.3, 0.18]);
    let margins = [436, 440, 444, 448, 452, 456].map(number);
    assert_eq!(margins, [0.6, 0.75, 160.0, 0.7, 0.85, 130.0]);
    assert_eq!([460, 464, 468].map(number), [0.1, 0.3, -0.3]);
    assert_eq!([472, 476, 480].map(number), [1.5, 0.7, -1.4]);
    let (n, f) = (2, 1);
    let nodes = 476 + 4 * n;
    let each = 4 * (20 + 3 * n + 9 * f);
    assert_eq!(stored.len(), nodes + 3 * each);
    let at = nodes + 2 * each;
    assert_eq!(stored[at..at + 4], [1, 0, 0, 0]);
    assert_eq!([at + 4, at + 16].map(number), [0.1, 2.3]);
    assert_eq!([at + 20, at + 32, at + 44].map(number), [0.6, 0.8, 0.0]);
    assert_eq!([at + 56, at + 76].map(number), [1.0, 6.0]);
    let joints = [80, 80 + 4 * n, 80 + 8 * n].map(|k| number(at + k));
    assert_eq!(joints, [-0.2, 7.0, 20.0]);
    let feet = [80 + 12 * n, 80 + 12 * (n + f), 80 + 12 * (n + 2 * f)];
    let feet = feet.map(|k| number(at + k + 8));
    assert_eq!(feet, [0.0, -0.25, -1.0]);
}

/// Every single bit, every byte turned over, and every shorter length.
#[test]
fn damage_is_always_detected() {
    let stored = bytes();
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

/// Writes the checksum of bytes that were changed on purpose.
pub(super) fn sealed(mut stored: Vec<u8>) -> Vec<u8> {
    let sum = super::checksum(&stored);
    stored[super::CHECKSUM..PREFIX].copy_from_slice(&sum.to_le_bytes());
    stored
}

#[test]
fn refusals_name_their_reason() {
    let stored = bytes();
    let refused = |bytes: &[u8]| (Container::open(bytes, ROBOT) as Opened<'_>).unwrap_err();
    let mut other = stored.clone();
    other[4] = 1;
    assert_eq!(refused(&other), ContainerError::Version { found: 1 });
    let said = std::format!("{}", refused(&other));
    assert_eq!(
        said,
        "a plan of version 1; this reads version 2: plan again"
    );
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
        ContainerError::Size { joints: 2, feet: 1 }
    );
    // A length below that of the prefix, a name longer than its field, one that is no text, an unknown rule for torques, a node too many.
    for (at, byte) in [(16, 10), (17, 0), (280, 64), (25, 0xff), (344, 2), (346, 4)] {
        let mut other = stored.clone();
        other[at] = byte;
        let length = u32::from_le_bytes(*other[16..].first_chunk().unwrap()) as usize;
        let sum = super::checksum(&other[..length]);
        other[super::CHECKSUM..PREFIX].copy_from_slice(&sum.to_le_bytes());
        assert_eq!(refused(&other), ContainerError::Header, "byte {at}");
    }
}

#[test]
fn what_has_no_room_is_not_written() {
    let mut small = [0; 100];
    let refused = write(&mut small, ROBOT, &header(), &nodes());
    let needed = bytes().len();
    let given = 100;
    assert_eq!(refused, Err(ContainerError::Buffer { needed, given }));
    let long: String = "x".repeat(LONGEST_TASK + 1);
    let mut out = vec![0; 4096];
    for (what, room) in [("task", LONGEST_TASK), ("robot", LONGEST_ROBOT)] {
        for given in [room, room + 1] {
            let mut header = header();
            match what {
                "task" => header.task = &long[..given],
                _ => header.robot = &long[..given],
            }
            let result = write(&mut out, ROBOT, &header, &nodes());
            let expected = if given == room {
                Ok(needed)
            } else {
                Err(ContainerError::Name { what, given, room })
            };
            assert_eq!(result, expected);
        }
    }
}

/// One wrong value at a time, with a checksum that fits.
#[test]
fn values_that_cannot_be_are_named() {
    let at = 476 + 4 * 2;
    let nan = f32::NAN.to_le_bytes();
    let cases: [(usize, [u8; 4], Option<u16>, &str); 9] = [
        (345, [9, 3, 0, 0], None, "number of phases"),
        (348, nan, None, "takeoff"),
        (424, [2, 255, 0, 0], None, "ground"),
        (460, nan, None, "goal"),
        (472, 1e3_f32.to_le_bytes(), None, "goal"),
        (476, nan, None, "landing posture"),
        (
            at + 20,
            0.601_f32.to_le_bytes(),
            Some(0),
            "rotation of the base",
        ),
        (
            at + 48,
            (-0.6_f32).to_le_bytes(),
            Some(0),
            "rotation of the base",
        ),
        (at + 80 + 24, 90_f32.to_le_bytes(), Some(0), "forces"),
    ];
    for (at, bytes_there, node, what) in cases {
        let mut stored = bytes();
        stored[at..at + 4].copy_from_slice(&bytes_there);
        let stored = sealed(stored);
        let container = (Container::open(&stored, ROBOT) as Opened<'_>).unwrap();
        assert_eq!(
            container.check(),
            Err(ContainerError::Value { node, what }),
            "byte {at}"
        );
    }
    // A mirrored base is none, and is read as level where nobody checks.
    let mut mirrored = nodes();
    mirrored[0].rotation_wb[2] = [0.0, -0.6, -0.8];
    assert!(!super::record::is_rotation(&mirrored[0].rotation_wb));
    let level = nalgebra::Rotation3::<f32>::identity();
    assert_eq!(mirrored[0].node::<f32>().base.rotation, level);
}

/// What a test does to the header.
type Change<'a> = &'a dyn Fn(&mut Header<'static, 2>);

/// What the check says of a plan with this header, which is written as it is.
fn checked(change: Change<'_>) -> Result<(), ContainerError> {
    let mut changed = header();
    change(&mut changed);
    let stored = written(&changed, &nodes());
    let container = (Container::open(&stored, ROBOT) as Opened<'_>).unwrap();
    container.check()
}

/// Friction, the largest force and the weight are each positive and finite, and shares are above zero and at most one: whichever one of
/// them is not, the others do not make up for it.
#[test]
fn every_margin_has_its_range() {
    let bad = [0.0, -0.0, -0.5, f32::INFINITY, f32::NAN];
    let refused = |what| Err(ContainerError::Value { node: None, what });
    for x in bad {
        let margins: [Change<'_>; 3] = [
            &|h| h.margins.friction = x,
            &|h| h.margins.max_force = x,
            &|h| h.margins.weight = x,
        ];
        assert_eq!(margins.map(checked), [refused("margins"); 3], "{x}");
    }
    for x in bad.into_iter().chain([1.0 + f32::EPSILON]) {
        let shares: [Change<'_>; 3] = [
            &|h| h.margins.friction_share = x,
            &|h| h.margins.torque_share = x,
            &|h| h.margins.speed_share = x,
        ];
        assert_eq!(shares.map(checked), [refused("shares"); 3], "{x}");
    }
    let all_of_it: Change<'_> = &|h| {
        h.margins.friction_share = 1.0;
        h.margins.torque_share = 1.0;
        h.margins.speed_share = 1.0;
    };
    assert_eq!(checked(all_of_it), Ok(()));
}

/// A robot with one foot cannot stand on a second or on any other, alone or together with the first.
#[test]
fn nobody_stands_on_feet_that_are_not_there() {
    let what = "feet of a phase";
    for contacts in 2..=u8::MAX {
        let stands: Change<'_> = &|h| h.phases[0].contacts = contacts;
        let refused = Err(ContainerError::Value { node: None, what });
        assert_eq!(checked(stands), refused, "{contacts}");
    }
    assert_eq!(checked(&|_| ()), Ok(()));
}

/// Before its jump begins a robot waits on its feet, also where the first phase lifts them; once it has begun, what is lifted bears nothing.
#[test]
fn a_robot_waits_on_feet_that_its_first_phase_lifts() {
    let mut lifted = header();
    lifted.phases[0].contacts = 0;
    for (time, what) in [(-1e-3, Ok(())), (0.0, Err(Some(0)))] {
        let mut nodes = nodes();
        nodes[0].time = time;
        nodes[1].forces_w = [[0.0; 3]];
        let stored = written(&lifted, &nodes);
        let container = (Container::open(&stored, ROBOT) as Opened<'_>).unwrap();
        let checked = container.check().map_err(|error| match error {
            ContainerError::Value { node, what } => {
                assert_eq!(what, "forces");
                node
            }
            _ => None,
        });
        assert_eq!(checked, what, "{time}");
    }
}

/// Parts of a node are those of the whole, and zeros elsewhere: for any parts that are asked for.
#[test]
fn parts_of_a_node_are_the_wholes() {
    fn expect<const PARTS: u8>(container: &Container<'_, 2, 1>) {
        for (i, whole) in nodes().into_iter().enumerate() {
            let mut expected = PlanNode {
                phase: whole.phase,
                time: whole.time,
                ..PlanNode::ZERO
            };
            if PARTS & parts::BASE == parts::BASE {
                expected.position_w = whole.position_w;
                expected.rotation_wb = whole.rotation_wb;
                expected.velocity_b = whole.velocity_b;
            }
            if PARTS & parts::JOINTS == parts::JOINTS {
                expected.joints = whole.joints;
                expected.joint_velocities = whole.joint_velocities;
                expected.torques = whole.torques;
            }
            if PARTS & parts::FORCES == parts::FORCES {
                expected.forces_w = whole.forces_w;
            }
            assert_eq!(container.stored().parts::<PARTS>(i), Some(expected));
        }
    }
    let stored = bytes();
    let container = (Container::open(&stored, ROBOT) as Opened<'_>).unwrap();
    expect::<0>(&container);
    expect::<{ parts::BASE }>(&container);
    expect::<{ parts::JOINTS }>(&container);
    expect::<{ parts::FORCES }>(&container);
    expect::<{ parts::ALL }>(&container);
}

#[test]
fn the_hash_tells_robots_apart_and_not_precisions() {
    let geared = model_hash::<f64, _, 12>(&a1_model::A1Geared);
    assert_eq!(geared, model_hash::<f32, _, 12>(&a1_model::A1Geared));
    assert_ne!(geared, model_hash::<f64, _, 12>(&a1_model::A1));
}
