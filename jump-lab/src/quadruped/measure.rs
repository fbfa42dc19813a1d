//! What makes an execution robust; a study can do without each of them, which shows what it is worth.

use super::{FOOT_COUNT, JOINTS, Node};
use core::str::FromStr;
use jump_machine::Settings;
use jump_planner::NoPlan;
use jump_planner::planned::{self, Planner};
use jump_planner::reference::Reference;
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use jump_planner::whole_body::FRICTION_SMOOTHING;
use rbd_core::{Model, Tree, joint_friction};

/// One measure against disturbances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Measure {
    /// Weighing by the motors while the robot waits, and the plan's torques scaled by it.
    Weighing,
    /// Finding the centre of mass while the robot waits, and a trunk that is moved until it is where the plan has it.
    Centring,
    /// Telling what a load turns from what it weighs, in the push-off.
    Load,
    /// Rotor inertia and joint friction in the plan's torques.
    Drives,
    /// Plan forces that keep to a share of friction, torque and speed.
    Margins,
    /// The plan's torques a millisecond early, for what holding and the slew limit delay them by.
    Lookahead,
    /// A landing posture that follows the capture point before touchdown.
    Posture,
    /// Forces of the feet that bring the body back to its plan, by a time-varying LQR.
    Regulator,
    /// Feet that let go at the take-off, and are pulled up where the ground does not let go.
    Unloading,
    /// Legs drawn in or stretched in flight, so that the body turns on time.
    InertiaShaping,
    /// Legs that wait shorter for a fast ground, and feet that go along with it.
    Retraction,
}

impl Measure {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Weighing,
        Self::Centring,
        Self::Load,
        Self::Drives,
        Self::Margins,
        Self::Lookahead,
        Self::Posture,
        Self::Regulator,
        Self::Unloading,
        Self::InertiaShaping,
        Self::Retraction,
    ];

    /// Its name on the command line and in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Weighing => "weighing",
            Self::Centring => "centring",
            Self::Load => "load",
            Self::Drives => "drives",
            Self::Margins => "margins",
            Self::Lookahead => "lookahead",
            Self::Posture => "posture",
            Self::Regulator => "regulator",
            Self::Unloading => "unloading",
            Self::InertiaShaping => "inertia-shaping",
            Self::Retraction => "retraction",
        }
    }

    /// What it is, in a line.
    #[must_use]
    pub const fn what(self) -> &'static str {
        match self {
            Self::Weighing => {
                "Weighing by the motors while the robot waits, and the plan's torques scaled by it"
            }
            Self::Centring => {
                "Finding the centre of mass while the robot waits, and moving it to where the plan has it"
            }
            Self::Load => "Telling what a load turns from what it weighs, in the push-off",
            Self::Drives => "Rotor inertia and joint friction in the plan's torques",
            Self::Margins => "Plan forces that keep to a share of friction, torque and speed",
            Self::Lookahead => {
                "The plan's torques a millisecond early, for what holding and the slew limit delay them by"
            }
            Self::Posture => "A landing posture that follows the capture point before touchdown",
            Self::Regulator => "Forces of the feet that bring the body back to its plan",
            Self::Unloading => "Feet that let go at the take-off and are pulled up",
            Self::InertiaShaping => {
                "Legs drawn in or stretched in flight, so that the body turns on time"
            }
            Self::Retraction => {
                "Legs that wait shorter for a fast ground, and feet that go along with it"
            }
        }
    }

    /// Whether the plan is another without it.
    #[must_use]
    pub const fn is_planned(self) -> bool {
        matches!(self, Self::Drives | Self::Margins)
    }

    /// Plans a task without these measures.
    ///
    /// # Errors
    /// [`NoPlan`]: what `saltus plan` would answer, or a measure that this planner cannot do without.
    pub fn plan(task: &Task, planner: Planner, without: &[Self]) -> Result<Reference, NoPlan> {
        let mut task = task.clone();
        if without.contains(&Self::Margins) {
            let limits = &mut task.limits;
            (limits.friction_share, limits.speed_share) = (1.0, 1.0);
            limits.torque_shares = [1.0; 3];
            task.problem.friction = limits.friction;
        }
        let body = planned::body(&task)?;
        let mut reference = planner.plan(&task, &body)?;
        if without.contains(&Self::Drives) {
            if planner != Planner::WholeBody {
                let what = "only whole-body plans can do without drives";
                return Err(NoPlan::Error(what.to_owned()));
            }
            forget_drives(&task.robot, &mut reference.nodes);
            reference.store_torques()?;
        }
        Ok(reference)
    }

    /// Takes the measure out of the controller.
    pub fn leave(self, settings: &mut Settings<f64, JOINTS, FOOT_COUNT>) {
        match self {
            Self::Weighing => settings.max_payload = 0.0,
            Self::Centring => settings.centring.most = 0.0,
            Self::Load => settings.centring.most_load = 0.0,
            Self::Lookahead => settings.lookahead = 0.0,
            // No time before touchdown is that long after it.
            Self::Posture => {
                settings.levelling = -f64::INFINITY;
                settings.retraction.lasting = -f64::INFINITY;
            }
            Self::Regulator => settings.regulator.normal = 0.0,
            // No time after the take-off is that early.
            Self::Unloading => settings.unloading.lasting = -f64::INFINITY,
            Self::InertiaShaping => settings.inertia_shaping.gain = 0.0,
            Self::Retraction => {
                settings.retraction.share = 0.0;
                settings.shortening.most = 0.0;
            }
            Self::Drives | Self::Margins => {}
        }
    }
}

impl FromStr for Measure {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|measure| measure.name() == name);
        found.ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("no measure `{name}`; there are {names}")
        })
    }
}

/// Takes the torques that turn rotors and overcome joint friction out of a whole-body plan, whose accelerations are the
/// differences of its nodes' velocities.
fn forget_drives(robot: &Quadruped, nodes: &mut [Node]) {
    let rotors = Tree::<f64, JOINTS>::bodies(robot).map(|body| body.rotor_inertia);
    let mut rest = nodes;
    while let [node, after @ ..] = rest {
        let Some(next) = after.first() else { return };
        let (now, then) = (node.joint_velocities, next.joint_velocities);
        let dt = next.time - node.time;
        let middle = core::array::from_fn(|i| 0.5 * (now[i] + then[i]));
        let lost = joint_friction(Model::limits(robot), &middle, FRICTION_SMOOTHING);
        for (i, torque) in node.torques.iter_mut().enumerate() {
            *torque += lost[i] - rotors[i] * (then[i] - now[i]) / dt;
        }
        rest = after;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{Measure, forget_drives};
    use crate::Sim;
    use crate::lab::{Lab, PlantArgument};
    use crate::quadruped::execute::{Trial, run_watched};
    use crate::quadruped::log::Sample;
    use crate::quadruped::{JOINTS, Node, Planned, State};
    use a1_model::{A1, a1};
    use jump_planner::Velocity;
    use jump_planner::robot::Quadruped;
    use jump_planner::task::Task;
    use jump_planner::whole_body::FRICTION_SMOOTHING;
    use rbd_core::{Posture, joint_friction, rnea};

    #[test]
    fn names_are_read_back() {
        for measure in Measure::ALL {
            assert_eq!(measure.name().parse(), Ok(measure));
        }
        assert!("weight".parse::<Measure>().is_err());
    }

    /// Along the ground, m, at the planned touchdown of two backflips.
    fn lands(plant: &str, without: &[Measure]) -> f64 {
        const PLAN: &[u8] = include_bytes!("../../../firmware/probe/plans/a1-double-backflip.bin");
        let planned = Planned::open(&Quadruped::a1().unwrap(), PLAN, Task::load).unwrap();
        let plant: PlantArgument = plant.parse().unwrap();
        let trial = Trial {
            disturbance: PlantArgument::plant(Some(&plant), Lab::A1, 0),
            without,
            ..Trial::nominal(Sim::Native)
        };
        let (task, reference) = (&planned.task, &planned.reference);
        let run = run_watched(task, reference, trial, |_, _| {}, |_, _| {}, |_| {}).unwrap();
        let before = |sample: &&Sample| sample.time < reference.touchdown - 0.01;
        run.samples.iter().rfind(before).unwrap().position.x
    }

    /// Without the measure its weight turns it too much, and its centre of mass is not where its speed is regulated.
    #[test]
    fn a_load_on_the_trunk_is_carried_nearly_to_where_nothing_is() {
        let (nothing, load) = (lands("", &[]), "payload=1.5@0,0,0.04");
        let [with, without] =
            [&[][..], &[Measure::Load]].map(|measures| (lands(load, measures) - nothing).abs());
        assert!(with < 0.5 * without, "{with} {without}");
    }

    /// What is left are the torques of a robot without rotors and friction, by inverse dynamics.
    #[test]
    fn a_plan_without_drives_has_the_torques_of_a_robot_without_them() {
        const DT: f64 = 0.005;
        let robot = Quadruped::a1().unwrap();
        let speeds = |k: usize| core::array::from_fn(|i| 0.3 * (i as f64 - 5.0) + 0.1 * k as f64);
        let accelerations: [f64; JOINTS] = [0.1 / DT; JOINTS];
        let middle = speeds(0).map(|speed: f64| speed + 0.05);
        let q = State {
            joints: core::array::from_fn(|i| 0.2 * i as f64 - 1.0),
            ..State::NEUTRAL
        };
        let joints_only = |joints| Velocity {
            joints,
            ..Velocity::ZERO
        };
        let (v, a) = (joints_only(middle), joints_only(accelerations));
        let with = rnea(&robot, &Posture::new(&robot, &q), &v, &a).joints;
        let lost = joint_friction(&a1::LIMITS, &middle, FRICTION_SMOOTHING);
        let mut nodes = [0, 1].map(|k| Node {
            time: DT * k as f64,
            joint_velocities: speeds(k),
            ..Node::ZERO
        });
        nodes[0].torques = core::array::from_fn(|i| with[i] - lost[i]);
        forget_drives(&robot, &mut nodes);
        let without = rnea(&A1, &Posture::new(&A1, &q), &v, &a).joints;
        for i in 0..JOINTS {
            assert!((nodes[0].torques[i] - without[i]).abs() < 1e-9, "joint {i}");
            // Otherwise nothing would be shown.
            assert!((with[i] - lost[i] - without[i]).abs() > 1e-3, "joint {i}");
        }
        assert_eq!(nodes[1].torques, [0.0; JOINTS]);
    }
}
