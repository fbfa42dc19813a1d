//! Plans in flash, as a controller has them: what the compiler reads is what a run-time reader reads, in both scalars.

use jump_control::container::Container;
use jump_control::{Node, Plan, flash_plan, sample};

/// Written by the container's own tests, see `the_golden_is_written` there.
const BYTES: &[u8] = include_bytes!("hop.bin");
const PLAN: Container<'static, 2, 1> = flash_plan!(BYTES);
static DOUBLE: [Node<f64, 2, 1>; PLAN.count()] = PLAN.nodes_f64();
static SINGLE: [Node<f32, 2, 1>; PLAN.count()] = PLAN.nodes_f32();

#[test]
fn the_compiler_reads_the_same_plan() {
    let container = Container::<2, 1>::open(BYTES, PLAN.robot()).unwrap();
    assert_eq!(PLAN.header(), container.header());
    let (mut double, mut single) = ([Node::ZERO; 3], [Node::ZERO; 3]);
    assert_eq!(container.read_into(&mut double).unwrap(), DOUBLE);
    assert_eq!(container.read_into(&mut single).unwrap(), SINGLE);
    assert_eq!(SINGLE[2].time, 0.1);
    assert_eq!(DOUBLE[2].time, f64::from(0.1_f32));
    assert_eq!(DOUBLE[1].joints, [f64::from(-0.2_f32), 1.0]);
    assert_eq!(DOUBLE[1].forces_w[0].z, 50.0);
}

#[test]
fn it_can_be_followed() {
    let h = PLAN.header();
    assert!(Plan::new(&SINGLE, h.takeoff, h.posing, h.touchdown, h.torques).is_ok());
    // Beyond the last node there is nothing.
    assert_eq!(PLAN.nodes_f32::<4>()[3], Node::ZERO);
    assert_eq!(PLAN.nodes_f32::<1>(), SINGLE[..1]);
}

/// Followed where it is stored, a plan says the same bits as its nodes do: at nodes, between them, before and after, and for no time at all.
#[test]
fn a_stored_plan_is_followed_from_its_bytes() {
    let container = Container::<2, 1>::open(BYTES, PLAN.robot()).unwrap();
    let h = container.header();
    let stored = Plan::<f64, 2, 1>::stored(&container).unwrap();
    let [takeoff, posing, touchdown] = [h.takeoff, h.posing, h.touchdown].map(f64::from);
    let read = Plan::new(&DOUBLE, takeoff, posing, touchdown, h.torques).unwrap();
    assert_eq!(stored.count(), 3);
    assert_eq!(
        (stored.takeoff, stored.posing, stored.touchdown),
        (takeoff, posing, touchdown)
    );
    for (i, node) in DOUBLE.iter().enumerate() {
        assert_eq!(stored.node(i), Some(*node));
    }
    assert_eq!(stored.node(3), None);
    for step in -5..30 {
        let time = f64::from(step) * 0.005;
        for hint in [0, 1, 2, 9] {
            assert_eq!(sample(&stored, time, hint), sample(&read, time, hint));
        }
        for node in 0..4 {
            assert_eq!(stored.base((node, time)), read.base((node, time)));
        }
    }
    assert_eq!(sample(&stored, f64::NAN, 1), sample(&read, f64::NAN, 1));
}
