//! Our own contact simulator with A1 standing on its feet.

use contact_sim::{ContactSphere, NativeSimulator, Settings, Simulator, Terrain};
use rbd_core::Tree;

use super::Robot;
use crate::{Real, Recorder, Subject};

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, 12> + Copy>(
    on: &mut Subject<'_, T, R>,
    robot: &Robot<T, M, 12, 4>,
) {
    let spheres = robot.feet.map(|foot| ContactSphere {
        link: foot.link,
        offset: foot.offset,
        radius: T::of(0.02),
    });
    let settings = Settings::new(&robot.limits, &robot.motors);
    let mut plant = NativeSimulator::new(robot.model, spheres, Terrain::FLAT, settings);
    plant.reset(&robot.q, &robot.v);
    for torque in [3.0, -2.0, 1.0] {
        let input = (&mut plant, [T::of(torque); 12]);
        on.call("NativeSimulator::step", input, |(plant, torques)| {
            let done = plant.step(&torques).is_ok();
            (
                (done, *plant.configuration()),
                *plant.velocity(),
                *plant.contact_forces_w(),
            )
        });
    }
    let input = (&mut plant, [T::NAN; 12]);
    on.call("step not a number", input, |(plant, torques)| {
        plant.step(&torques).is_ok()
    });
}
