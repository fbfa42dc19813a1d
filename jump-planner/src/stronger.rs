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
        let most = |values: &dyn Fn(usize) -> f64| {
            let joints = (0..crate::JOINTS).map(|i| (i, values(i)));
            joints.fold((0, 0.0), |most, of| if of.1 > most.1 { of } else { most })
        };
        let peak = |value: &dyn Fn(&crate::whole_body::Interval) -> f64| {
            let values = plan.intervals.iter().map(value);
            values.fold(0.0, |most, value| f64::max(most, value.abs()))
        };
        Self {
            times,
            torque: most(&|i| peak(&|interval| interval.sample.effort[BASE + i])),
            speed: most(&|i| peak(&|interval| interval.sample.v[BASE + i])),
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
