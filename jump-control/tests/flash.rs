//! Plans in flash, as a controller has them: what the compiler reads is what a run-time reader reads, in both scalars.
#![allow(clippy::unwrap_used, reason = "tests")]

use jump_control::container::Container;
use jump_control::{Node, Plan, flash_plan};

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
