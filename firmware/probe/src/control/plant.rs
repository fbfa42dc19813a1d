//! Our own contact simulator with A1 standing on its feet.

use contact_sim::{NativeSimulator, Settings, Shape, Simulator, Terrain};
use rbd_core::Tree;

use super::Robot;
use crate::{Real, Recorder, Subject};

pub(super) fn run<T: Real, R: Recorder, M: Tree<T, 12> + Copy>(
    on: &mut Subject<'_, T, R>,
    robot: &Robot<T, M, 12, 4>,
) {
    let mut owner = 0;
    let feet = robot.feet.map(|foot| {
        owner += 1;
        Shape::ball(foot.link, foot.offset, T::of(0.02), owner - 1)
    });
    let settings = Settings::new(&robot.limits, &robot.motors);
    let mut plant =
        NativeSimulator::<T, M, 12, 4, 4>::new(robot.model, feet, Terrain::FLAT, settings);
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
