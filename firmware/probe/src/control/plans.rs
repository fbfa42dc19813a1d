//! A plan as bytes, read and checked as a controller does that is told of it at run time.

use jump_control::Node;
use jump_control::container::{Container, ContainerError, model_hash};
use rbd_core::Model;
use so3::Scalar;

use super::Robot;
use crate::{Numbers, Real, Recorder, Subject};

/// The container that the tests of `jump-control` write: of a robot with two joints and one foot, three nodes.
const HOP: &[u8] = include_bytes!("../../../../jump-control/tests/hop.bin");
/// Bytes that are no plan.
const DAMAGED: [u8; 64] = [0x53; 64];

type Hop<'a> = Container<'a, 2, 1>;

impl<T: Scalar + Numbers, const N: usize, const F: usize> Numbers for Node<T, N, F> {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        self.time.visit(take);
        (self.base, self.base_velocity).visit(take);
        (self.joints, self.joint_velocities, self.torques).visit(take);
        self.forces_w.visit(take);
    }
}

impl Numbers for ContainerError {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        take(self.reason().len() as f64);
    }
}

pub(super) fn run<T: Real, R: Recorder, M: Model<T, 12>>(
    on: &mut Subject<'_, T, R>,
    robot: &Robot<T, M, 12, 4>,
) {
    let own = on.call("model_hash", &robot.model, |model| Hash(model_hash(model)));
    let Ok(plan) = Hop::read(HOP) else { return };
    for bytes in [HOP, &DAMAGED, &[]] {
        let _ = on.call(
            "Container::open",
            (bytes, plan.robot()),
            |(bytes, robot)| Hop::open(bytes, robot).map(|plan| plan.header().landing_joints),
        );
    }
    on.call(
        "Container::open of another robot",
        (HOP, own.0),
        |(bytes, robot)| Hop::open(bytes, robot).is_ok(),
    );
    let _ = on.call("Container::check", &plan, |plan| plan.check());
    for room in [3, 2] {
        let mut nodes = [Node::<T, 2, 1>::ZERO; 3];
        let out = nodes.get_mut(..room).unwrap_or_default();
        let _ = on.call("Container::read_into", (&plan, out), |(plan, out)| {
            let read = plan.read_into(out);
            read.map(|nodes| nodes.last().copied())
        });
    }
}

/// A hash, listed by its halves.
struct Hash(u64);

impl Numbers for Hash {
    fn visit(&self, take: &mut dyn FnMut(f64)) {
        take((self.0 >> 32) as f64);
        take((self.0 & 0xffff_ffff) as f64);
    }
}
