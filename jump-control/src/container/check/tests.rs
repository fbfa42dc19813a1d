//! The pass over the bytes against the plain definition, which decodes every node first.
#![allow(clippy::unwrap_used, reason = "tests")]
extern crate std;

use super::{CONE, Checked, FAR, MOST, Rules, SAME_TIME, header, near};
use crate::container::record::is_rotation;
use crate::container::tests::{ROBOT, bytes, sealed};
use crate::container::{Container, ContainerError, Header, PlanNode};
use nalgebra::Vector3;
use proptest::prelude::*;
use so3::math;
use std::vec::Vec;

type Hop<'a> = Container<'a, 2, 1>;

/// [`Container::check`] as its documentation reads.
fn plain(container: &Hop<'_>) -> Checked {
    container.check_header()?;
    let mut before: Option<PlanNode<2, 1>> = None;
    for i in 0..container.header.nodes {
        let node = container.node(usize::from(i)).unwrap();
        let last = i + 1 == container.header.nodes;
        let order = before.and_then(|before| order(&before, &node));
        if let Some(what) = order.or_else(|| fault(&container.header, &node, last)) {
            let node = Some(i);
            return Err(ContainerError::Value { node, what });
        }
        before = Some(node);
    }
    let end = before.map_or(f32::NAN, |node| node.time);
    header(
        near(end, container.header.touchdown),
        "time of the last node",
    )
}

fn first(checks: &[(bool, &'static str)]) -> Option<&'static str> {
    let broken = checks.iter().find(|(ok, _)| !ok);
    broken.map(|(_, what)| *what)
}

fn order(before: &PlanNode<2, 1>, node: &PlanNode<2, 1>) -> Option<&'static str> {
    let follows = node.phase == before.phase || node.phase == before.phase.saturating_add(1);
    first(&[(node.time > before.time, "time"), (follows, "phase")])
}

fn fault(h: &Header<'_, 2>, node: &PlanNode<2, 1>, last: bool) -> Option<&'static str> {
    let all = |xs: &[f32]| xs.iter().all(|x| x.abs() <= FAR);
    let finite = |xs: &[f32]| xs.iter().all(|x| x.is_finite());
    let phases = &h.phases[..usize::from(h.phase_count)];
    let phase = phases.get(usize::from(node.phase));
    let in_time = node.time.abs() <= FAR && node.time <= h.touchdown + SAME_TIME;
    let pushes = node.forces_w.iter().enumerate().all(|(foot, force)| {
        let stands = phase.is_some_and(|p| (u32::from(p.contacts) >> foot) & 1 == 1);
        pushes(h, force, stands)
    });
    first(&[
        (in_time, "time"),
        (phase.is_some(), "phase"),
        (all(&node.position_w), "position of the base"),
        (is_rotation(&node.rotation_wb), "rotation of the base"),
        (all(&node.velocity_b), "velocity of the base"),
        (all(&node.joints), "joints"),
        (all(&node.joint_velocities), "joint velocities"),
        (finite(&node.torques), "torques"),
        (finite(node.forces_w.as_flattened()), "forces"),
        (last || pushes, "forces"),
        (all(node.feet_b.as_flattened()), "feet"),
        (
            all(node.foot_velocities_b.as_flattened()),
            "velocities of the feet",
        ),
    ])
}

fn pushes(h: &Header<'_, 2>, force: &[f32; 3], stands: bool) -> bool {
    let [x, y, z] = force.map(f64::from);
    let slack = f64::from(CONE * h.margins.max_force);
    let most = f64::from(MOST * h.margins.max_force);
    let side = math::hypot(x, y);
    if stands {
        z >= -slack && z <= most && side <= f64::from(h.margins.friction) * z + slack
    } else {
        side <= slack && z.abs() <= slack
    }
}

/// Forces on, inside and outside of narrow and of wide cones.
#[test]
fn the_cone_by_squares_is_the_cone() {
    let stored = bytes();
    let container: Hop<'_> = Container::open(&stored, ROBOT).unwrap();
    for friction in [0.6, 2.0] {
        let mut h = *container.header();
        h.margins.friction = friction;
        let rules = Rules::of(&h);
        let sizes = [0.0_f32, 0.1, 0.5, 0.8, 0.9, 1.0, 60.0, 1600.0, f32::MAX];
        let signed = || sizes.iter().flat_map(|x| [*x, -x]);
        for (x, y) in signed().flat_map(|x| signed().map(move |y| (x, y))) {
            for (z, stands) in signed().flat_map(|z| [(z, true), (z, false)]) {
                let force = [x, y, z];
                let (pass, definition) = (rules.pushes(force, stands), pushes(&h, &force, stands));
                assert_eq!(pass, definition, "{force:?} {stands} {friction}");
            }
        }
    }
}

/// Every number of every node, and its first byte, where the phase stands, in turn holds each of these; then two numbers do.
#[test]
fn the_pass_refuses_what_the_plain_definition_refuses() {
    let above = |x: f32| f32::from_bits(x.to_bits() + 1);
    let slack = CONE * 160.0;
    let sizes = [
        0.0,
        f32::MIN_POSITIVE,
        1e-3,
        0.05,
        0.6,
        slack,
        above(slack),
        80.0,
        FAR,
        above(FAR),
        1600.0,
        above(1600.0),
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
    ];
    let values: Vec<[u8; 4]> = sizes
        .iter()
        .flat_map(|x| [x.to_le_bytes(), (-x).to_le_bytes()])
        .chain([[1, 0, 0, 0], [2, 0, 0, 0], [255, 0, 0, 0]])
        .collect();
    let whole = bytes();
    let nodes = Hop::size(0);
    let (mut refused, mut accepted) = (0, 0);
    let mut compare = |stored: Vec<u8>| {
        let stored = sealed(stored);
        let container: Hop<'_> = Container::open(&stored, ROBOT).unwrap();
        let (pass, definition) = (container.check(), plain(&container));
        assert_eq!(pass, definition);
        *if pass.is_ok() {
            &mut accepted
        } else {
            &mut refused
        } += 1;
    };
    let at: Vec<usize> = (nodes..whole.len()).step_by(4).collect();
    for (i, place) in at.iter().enumerate() {
        for (k, value) in values.iter().enumerate() {
            let mut stored = whole.clone();
            stored[*place..place + 4].copy_from_slice(value);
            compare(stored.clone());
            let (other, second) = (at[(i * 7 + k * 3) % at.len()], values[(k * 5) % 33]);
            stored[other..other + 4].copy_from_slice(&second);
            compare(stored);
        }
    }
    assert!(
        refused > 2000 && accepted > 2000,
        "{refused} refused, {accepted} accepted"
    );
}

proptest! {
    /// Rows of a rotation, as single precision has them, are those of one; mirrored, stretched or leaning by a hundredth they are not.
    #[test]
    fn only_rotations_are_rotations(turn in prop::array::uniform3(-3.0..3.0_f64), row in 0..3_usize, other in 1..3_usize) {
        let rotation = so3::exp(&Vector3::from(turn));
        let rows: [[f32; 3]; 3] = core::array::from_fn(|i| core::array::from_fn(|j| rotation[(i, j)] as f32));
        prop_assert!(is_rotation(&rows));
        let changed = |change: fn(f32, f32) -> f32| {
            let mut changed = rows;
            changed[row] = core::array::from_fn(|j| change(rows[row][j], rows[(row + other) % 3][j]));
            is_rotation(&changed)
        };
        prop_assert!(!changed(|x, _| -x));
        prop_assert!(!changed(|x, _| 1.01 * x));
        prop_assert!(!changed(|x, y| (x + 0.01 * y) / 1.000_05));
    }
}
