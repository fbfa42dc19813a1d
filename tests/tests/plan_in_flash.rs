//! What the firmware's images fly is what stands in the container, which a planner wrote and an audit can read.

use a1_model::A1Geared;
use jump_control::container::{Container, model_hash};
use jump_control::{Measurement, Node, Phase};
use jump_machine::Workspace;
use jump_machine::{Jump, Machine, Observation};
use saltus_probe::flight::{BYTES, HOLD, PLAN, Planned, jump, settings};

type A1<'a> = Container<'a, 12, 4>;

/// The file as it is now, opened as any controller does.
fn open(bytes: &[u8]) -> A1<'_> {
    A1::open(bytes, model_hash::<f64, _, 12>(&A1Geared)).unwrap()
}

#[test]
fn the_bytes_in_the_image_are_the_files_and_a_plan_for_a1() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../firmware/probe/plans/a1-double-backflip.bin"
    );
    assert_eq!(std::fs::read(path).unwrap(), BYTES);
    let plan = open(BYTES);
    assert_eq!(plan.check(), Ok(()));
    assert_eq!(plan.header(), PLAN.header());
    assert_eq!(
        (plan.header().task, plan.header().robot),
        ("a1/double-backflip", "a1")
    );
}

/// Node by node, and bit by bit: a number that is equal could still be −0.
#[test]
fn the_nodes_that_are_flown_are_the_containers() {
    let plan = open(BYTES);
    let double: Vec<_> = plan.nodes().map(|node| node.node::<f64>()).collect();
    assert_eq!(<f64 as Planned>::nodes(), double);
    let single: Vec<_> = plan.nodes().map(|node| node.node::<f32>()).collect();
    assert_eq!(<f32 as Planned>::nodes(), single);
    for (k, flown) in single.iter().enumerate() {
        let Node {
            base,
            base_velocity: v,
            ..
        } = flown;
        let rows = base.rotation.matrix().transpose();
        let numbers = [flown.time]
            .into_iter()
            .chain(base.translation.iter().copied());
        let numbers = numbers.chain(rows.iter().copied()).chain(v.to_array());
        let numbers = numbers.chain(flown.joints).chain(flown.joint_velocities);
        let forces = flown.forces_w.iter().flatten().copied();
        let flown: Vec<u32> = numbers
            .chain(flown.torques)
            .chain(forces)
            .map(f32::to_bits)
            .collect();
        let words = PLAN_NODE / 4 - 1 - 6 * 4;
        let at = BYTES.len() - (plan.count() - k) * PLAN_NODE + 4;
        let there = BYTES[at..]
            .as_chunks::<4>()
            .0
            .iter()
            .map(|x| u32::from_le_bytes(*x));
        assert_eq!(there.take(words).collect::<Vec<_>>(), flown, "node {k}");
    }
}

/// Bytes of a node of A1: the table in `jump_control::container`.
const PLAN_NODE: usize = 4 * (20 + 3 * 12 + 9 * 4);

#[test]
fn the_machine_is_armed_with_what_the_header_says() {
    let (plan, armed) = (open(BYTES), jump::<f32>().unwrap());
    let h = plan.header();
    assert_eq!(
        [armed.plan.takeoff, armed.plan.posing, armed.plan.touchdown],
        [h.takeoff, h.posing, h.touchdown]
    );
    assert_eq!(armed.plan.torques, h.torques);
    assert_eq!(armed.landing_joints, h.landing_joints);
    let turn = so3::log(&armed.rot_goal);
    assert_eq!([turn.x, turn.y, turn.z], [0.0, 0.0, h.heading]);
}

/// The plan as C arms it: from the bytes, where they are. Through all phases the machine commands the same bits as with the nodes that the
/// compiler read. The robot is seen where the plan begins all the time, but for what grows to be wrong about it.
#[test]
fn a_machine_follows_the_bytes_as_it_follows_the_nodes() {
    let stored = Jump::<f64, 12, 4>::stored(&open(BYTES)).unwrap();
    let first = stored.plan.node(0).unwrap();
    let (mut here, mut there) = (Workspace::new(), Workspace::new());
    let mut machines =
        [(&mut here, stored), (&mut there, jump().unwrap())].map(|(memory, jump)| {
            let mut machine = Machine::<f64, _, 12, 4>::new(&A1Geared, settings(), memory);
            machine.arm(jump, HOLD).unwrap();
            machine
        });
    let mut inputs = Observation {
        measured: Measurement {
            base: first.base,
            base_velocity: first.base_velocity,
            joints: first.joints,
            joint_velocities: [0.0; 12],
            foot_forces: [33.0; 4],
            age: 0.001,
        },
        joint_torques: first.torques,
    };
    let mut seen = Vec::new();
    let end = ((HOLD + stored.plan.touchdown + 0.2) * 1e3) as u32;
    for k in 0..end {
        inputs.measured.base.translation.z += 1e-5;
        inputs.measured.base_velocity.angular.y += 1e-3;
        let now = f64::from(k) * 1e-3;
        let ticks = machines.each_mut().map(|machine| {
            let tick = machine.tick(now, Some(&inputs));
            (tick, *machine.command())
        });
        assert_eq!(ticks[0], ticks[1], "{now} s");
        let joints = (&inputs.measured.joints, &inputs.measured.joint_velocities);
        let torques = machines.each_mut().map(|machine| {
            machine
                .joint_tick(joints.0, joints.1, 1e-4)
                .map(f64::to_bits)
        });
        assert_eq!(torques[0], torques[1], "{now} s");
        if seen.last() != Some(&ticks[0].0.phase) {
            seen.push(ticks[0].0.phase);
        }
    }
    assert_eq!(
        seen[..4],
        [Phase::Hold, Phase::Stance, Phase::Flight, Phase::PreLanding]
    );
}
