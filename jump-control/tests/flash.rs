//! Plans in flash, as a controller has them: what the compiler reads is what a run-time reader reads, in both scalars.

use jump_control::container::{Container, ContainerError, write};
use jump_control::{Node, Plan, PlanError, flash_plan, sample};

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

/// Read or left where it is stored, a plan starts in the posture that it is sampled with before it begins.
#[test]
fn a_plan_starts_where_its_first_node_is() {
    let container = Container::<2, 1>::open(BYTES, PLAN.robot()).unwrap();
    let h = container.header();
    let stored = Plan::<f32, 2, 1>::stored(&container).unwrap();
    let read = Plan::new(&SINGLE, h.takeoff, h.posing, h.touchdown, h.torques).unwrap();
    for plan in [stored, read] {
        assert_eq!(plan.start(), Some(sample(&plan, -1.0, 0).joints));
        assert_eq!(plan.start(), Some([-0.2, 0.0]));
    }
}

/// The pre-landing posture is taken at the earliest when the robot leaves the ground, and before it lands: a plan where it is not is refused
/// where it is stored as it is when it was read.
#[test]
fn a_stored_plan_has_its_phases_in_order() {
    let nodes: [_; 3] = core::array::from_fn(|i| PLAN.node(i).unwrap());
    let mut h = *PLAN.header();
    let what = "posing";
    let refused = Err(ContainerError::Value { node: None, what });
    let cases = [(0.0, false), (0.049, false), (0.05, true), (0.06, true)];
    for (posing, in_order) in cases.into_iter().chain([(0.1, true), (0.101, false)]) {
        h.posing = posing;
        let mut bytes = [0; BYTES.len()];
        write(&mut bytes, PLAN.robot(), &h, &nodes).unwrap();
        let container = Container::<2, 1>::open(&bytes, PLAN.robot()).unwrap();
        let stored = Plan::<f32, 2, 1>::stored(&container).map(|plan| plan.posing);
        let read = Plan::new(&SINGLE, h.takeoff, posing, h.touchdown, h.torques);
        let read = read.map(|plan| plan.posing);
        if in_order {
            assert_eq!((stored, read), (Ok(posing), Ok(posing)));
        } else {
            assert_eq!((stored, read), (refused, Err(PlanError::PhaseOrder)));
        }
    }
}
