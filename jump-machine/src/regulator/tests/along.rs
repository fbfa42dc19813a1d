//! What is wanted along a plan: between its nodes, and of plans with few and many of them.

extern crate std;

use std::vec::Vec;

use a1_model::{A1, BUILD};
use jump_control::{Node, Plan, Torques};
use nalgebra::Vector3;
use rbd_core::{Configuration, Limbs, Motion, Tangent, Transform};

use super::super::{Regulator, Weights};
use super::{DT, LOAD_HEIGHT, TAKEOFF, feet, nodes, plan, prepare, prepared};
use crate::Load;

/// Forces that are wanted at a time of the plan, after this node, of a robot that moves as at the first node, but for its base and that its centre of mass is aside.
fn of_first(
    moment: (usize, f64),
    base: Transform<f64>,
    base_velocity: Motion<f64>,
    aside_b: &Vector3<f64>,
) -> [Vector3<f64>; 4] {
    let nodes = nodes::<f64>();
    let first = nodes[0];
    let q = Configuration {
        base,
        joints: first.joints,
    };
    let velocity = Tangent {
        base: base_velocity,
        joints: first.joint_velocities,
    };
    let limbs = Limbs::new(&A1, &q, &feet());
    let load = Load {
        share: 0.0,
        height: LOAD_HEIGHT,
    };
    prepared().forces(
        (&A1, &Weights::new(&BUILD)),
        &plan(&nodes),
        [moment; 2],
        &velocity,
        (&limbs, aside_b, &load),
        (&first.base.rotation, &first.forces_w),
    )
}

/// At a node what is wanted is the same at the end of the interval before and at the beginning of the next, and over the last interval, whose gains are held,
/// it changes evenly with the plan.
#[test]
fn forces_do_not_jump_at_a_node_and_follow_the_plan_in_between() {
    let first = nodes::<f64>()[0];
    let at = |node: usize, place: f64| {
        let here = (first.base, first.base_velocity);
        of_first((node, DT * place), here.0, here.1, &Vector3::zeros())
    };
    let apart = |a: &[Vector3<f64>; 4], b: &[Vector3<f64>; 4]| {
        let apart = a.iter().zip(b).map(|(a, b)| (a - b).norm());
        apart.fold(0.0, f64::max)
    };
    for node in 0..TAKEOFF - 1 {
        let (before, after) = (at(node, node as f64 + 1.0), at(node + 1, node as f64 + 1.0));
        assert!(apart(&at(node, node as f64), &before) > 0.1, "{before:?}");
        assert!(apart(&before, &after) < 1e-9, "{before:?} {after:?}");
    }
    let [begin, middle, end] = [2.0, 2.5, 3.0].map(|place| at(TAKEOFF - 1, place));
    let mean = core::array::from_fn(|foot| (begin[foot] + end[foot]) * 0.5);
    assert!(apart(&begin, &end) > 0.1, "{begin:?} {end:?}");
    assert!(apart(&middle, &mean) < 1e-9, "{middle:?} {mean:?}");
}

/// What counts is the centre of mass and how it moves: where a trunk is aside by as much as the centre of mass is on its other side, nothing is to be changed.
#[test]
fn a_robot_whose_centre_of_mass_is_where_planned_is_left_alone_wherever_its_trunk_is() {
    let (first, aside_b) = (nodes::<f64>()[0], Vector3::new(0.02, -0.01, 0.005));
    let mut base = first.base;
    base.translation -= base.rotation * aside_b;
    let mut velocity = first.base_velocity;
    velocity.linear -= velocity.angular.cross(&aside_b);
    let most = |aside_b: &Vector3<f64>| {
        let forces = of_first((0, 0.0), base, velocity, aside_b);
        forces.iter().map(Vector3::norm).fold(0.0, f64::max)
    };
    assert!(most(&aside_b) < 1e-2, "{}", most(&aside_b));
    assert!(most(&Vector3::zeros()) > 1.0);
}

/// Forces that are wanted at this share of a push-off of 0.4 s with so many nodes and these of the flight, of a robot that stands as planned but for this
/// velocity.
fn standing(count: usize, flight: &[f64], share: f64, sways: [f64; 3]) -> [Vector3<f64>; 4] {
    let first = Node {
        base_velocity: Motion::ZERO,
        joint_velocities: [0.0; 12],
        ..nodes::<f64>()[0]
    };
    let push = (0..count).map(|k| Node {
        time: 0.4 * k as f64 / count as f64,
        ..first
    });
    let flight = flight.iter().map(|time| Node {
        time: *time,
        forces_w: [Vector3::zeros(); 4],
        ..first
    });
    let nodes: Vec<_> = push.chain(flight).collect();
    let plan = Plan::new(&nodes, 0.4, 0.5, 0.5, Torques::Hold).unwrap();
    let mut regulator = Regulator::new();
    prepare(&mut regulator, &plan, usize::MAX);
    let time = 0.4 * share;
    let q = Configuration {
        base: first.base,
        joints: first.joints,
    };
    let mut velocity = Tangent::ZERO;
    velocity.base.linear = sways.into();
    let limbs = Limbs::new(&A1, &q, &feet());
    let load = Load {
        share: 0.0,
        height: LOAD_HEIGHT,
    };
    regulator.forces(
        (&A1, &Weights::new(&BUILD)),
        &plan,
        [(plan.node_at(time, 0), time); 2],
        &velocity,
        (&limbs, &Vector3::zeros(), &load),
        (&first.base.rotation, &first.forces_w),
    )
}

const FLIGHT: [f64; 3] = [0.4, 0.45, 0.5];
const SWAYS: [f64; 3] = [0.01, 0.02, -0.03];

/// One that stands as planned is left alone, between any two nodes that are kept and whether or not the plan goes on to the take-off.
#[test]
fn a_robot_that_stands_as_planned_is_left_alone_however_many_nodes_it_has() {
    for count in [60, 191, 192, 193, 383, 384] {
        for (flight, end) in [(FLIGHT.as_slice(), count), (&[], count - 1)] {
            for node in [0, 1, count / 2, end - 2, end - 1] {
                let share = (node as f64 + 0.9) / count as f64;
                let [most, sways] = [[0.0; 3], SWAYS].map(|sways| {
                    let forces = standing(count, flight, share, sways);
                    forces.iter().map(Vector3::norm).fold(0.0, f64::max)
                });
                assert!(most < 1e-3 && sways > 0.1, "{count} {node}: {most} {sways}");
            }
        }
    }
}

/// A push-off is answered from its first node to its last, however many it has, and as much however finely it is divided.
#[test]
fn a_push_off_is_answered_however_many_nodes_it_has() {
    for count in [1, 2, 60, 71, 72, 142, 143, 191, 192, 215, 216, 383, 384] {
        for node in [0, 1, count / 2, count - 1] {
            let share = (node.min(count - 1) as f64 + 0.1) / count as f64;
            let total: Vector3<f64> = standing(count, &FLIGHT, share, SWAYS).iter().sum();
            assert!(total.z > 0.5 && total.y < -0.3, "{count} {node} {total}");
        }
    }
    for share in [0.001, 0.02, 0.3, 0.8] {
        let few = standing(50, &FLIGHT, share, SWAYS);
        for count in [71, 72, 100, 143, 144, 191, 192, 215, 216, 383] {
            let many = standing(count, &FLIGHT, share, SWAYS);
            for (few, many) in few.iter().zip(&many) {
                assert!(
                    (few - many).norm() < 0.1 * few.norm(),
                    "{count} {share}: {few} {many}"
                );
            }
        }
    }
}
