//! A task's robot and its ground in MuJoCo's format, for programs that bring a simulator of their own.

use crate::JOINTS;
use crate::task::Task;
use crate::terrain::terrain;
use contact_sim::{Geom, Settings};
use rbd_core::Model;

/// The robot with its shapes, motors' rotors and joint losses, and the ground, as `saltus run --sim mujoco` simulates them nominally: steps of
/// 0.1 ms on hard ground with a friction of 0.6. The base is a free joint without a start: the plan's first node has it. Motors are not in
/// it: torques are `qfrc_applied`. Shapes are named `touch0`, `touch1`, …; the first four are the feet.
#[must_use]
pub fn mjcf(task: &Task) -> String {
    let robot = &task.robot;
    let mut settings = Settings::<f64, JOINTS>::new(Model::limits(robot), &robot.drives());
    settings.substeps = 1;
    let geoms = robot.shapes.map(Geom::Swept);
    let pairs = contact_sim::self_contacts(robot, &robot.shapes, &task.start);
    contact_sim::mjcf(robot, (&geoms, &pairs), &terrain(task, 0.0), &settings)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::mjcf;
    use crate::task::Task;

    #[test]
    fn a_scene_has_the_ground_of_its_task_and_the_feet_first() {
        let scene = mjcf(&Task::load("a1/lateral").unwrap());
        assert!(scene.contains("<option timestep=\"0.0001\""), "{scene}");
        assert!(scene.contains("pos=\"0 0 0\"") && !scene.contains("size=\"0.6"));
        let foot = a1_model::FOOT_RADIUS;
        for i in 0..4 {
            let ball = format!("name=\"touch{i}\" type=\"sphere\" size=\"{foot:?}\"");
            assert!(scene.contains(&ball), "{ball} in {scene}");
        }
        let box_height = -Task::load("a1/lateral-down").unwrap().goal.z;
        let scene = mjcf(&Task::load("a1/lateral-down").unwrap());
        assert!(
            scene.contains(&format!("pos=\"0 0 -{box_height}\"")),
            "{scene}"
        );
    }
}
