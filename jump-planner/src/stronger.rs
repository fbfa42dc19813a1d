//! How much stronger joints would have to be for a jump that they do not give.

use crate::robot::Quadruped;
use crate::stored::joint_name;
use crate::whole_body::WholeBodyPlan;
use wb_opt::BASE;

/// The weakest joints with which a motion was found, on intervals too long to execute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stronger {
    /// How many times as strong and as fast as they are all of them were taken to be.
    pub times: f64,
    /// The joint with the largest torque, and that, N m.
    pub torque: (usize, f64),
    /// The fastest joint, and its speed, rad/s.
    pub speed: (usize, f64),
}

impl Stronger {
    /// Of a plan with joints so many times as strong.
    pub(crate) fn of(times: f64, plan: &WholeBodyPlan) -> Self {
        let [mut torque, mut speed] = [(0, 0.0); 2];
        for sample in plan.intervals.iter().map(|interval| &interval.sample) {
            let joints = sample.effort.iter().zip(&sample.v).skip(BASE);
            for (i, (effort, v)) in joints.enumerate() {
                for (most, value) in [(&mut torque, effort.abs()), (&mut speed, v.abs())] {
                    if value > most.1 {
                        *most = (i, value);
                    }
                }
            }
        }
        Self {
            times,
            torque,
            speed,
        }
    }

    /// What would have to change, in a sentence.
    pub(crate) fn told(&self, robot: &Quadruped) -> String {
        let ((torque_of, torque), (speed_of, speed)) = (self.torque, self.speed);
        format!(
            "joints would have to be {:.2} times as strong and as fast: {} would give {torque:.0} N m and {} turn at {speed:.0} rad/s",
            self.times,
            joint_name(robot, torque_of),
            joint_name(robot, speed_of),
        )
    }
}
