//! The whole-body problem of a task along a motion of the rigid body: the geared A1 on rolling ball feet, with margins.

use super::task::{SrbPlan, Task};
use super::{FOOT_COUNT, JOINTS};
use crate::edge::cautious;
use crate::lengths::Lengths;
use crate::robot::State;
use crate::stops::keep_away;
use crate::tightening::Tightening;
use crate::track::Track;
use nalgebra::Vector3;
use rbd_core::Transform;
use wb_opt::{BASE, Clearance, Foot, Friction, Phase, Point, Pose, Problem, Robot, Weights};

/// Coordinates of the robot.
pub const N: usize = BASE + JOINTS;
pub(crate) const NX: usize = 2 * N;
pub(crate) const NU: usize = N + 3 * FOOT_COUNT;
/// Sides of a friction pyramid.
const SIDES: usize = 8;
/// Trunk corners and knees.
const CLEARANCES: usize = 12;
/// Most pairs of links that keep apart.
pub(crate) const PAIRS: usize = 12;
pub(crate) const NI: usize = wb_opt::row_capacity(N, FOOT_COUNT, SIDES, CLEARANCES + PAIRS, true);

/// Time before touchdown in which the legs rest in the landing posture, s.
pub const POSED: f64 = 0.05;
/// Height over the ground that feet keep on their way, m: ground that gives way would catch what hovers.
const LIFT: f64 = 0.01;
/// The same onto a box.
const ONTO_LIFT: f64 = 0.03;
/// Share of the round friction cone that the edges of a foot's pyramid may reach: between nodes forces leave it by up to 2 % of the
/// largest.
const CONE_SHARE: f64 = 0.95;
/// How far a ball may roll from where it stood, per axis, m.
const ROLL: f64 = 0.03;
const KNEE_CLEARANCE: f64 = 0.03;
/// Least normal force of a foot that stands, in weights of the robot.
const LEAST_FORCE: f64 = 0.04;
/// Fastest that a foot lets go at the take-off, N/s, of a robot of the size that [`rbd_core::Build`] scales from: two feet that bear it take
/// 2 ms to nothing.
const RELEASE: f64 = 3e4;
/// Speed at which planned Coulomb friction of the joints fades, rad/s.
pub const FRICTION_SMOOTHING: f64 = 0.3;
/// How far from its goal the base may be at the touchdown: m, and rad. What a plan needs of it is decided by the task's
/// [`goal`](crate::task::file::WeightsTable::goal) weight: at a robot's limit all, otherwise millimetres.
pub const GOAL_TOLERANCE: [f64; BASE] = [0.02, 0.02, 0.02, 0.05, 0.05, 0.05];

/// What the problem borrows, and the guess that comes with it.
pub(crate) struct Setup<'a> {
    task: &'a Task,
    pub(crate) srb: &'a SrbPlan,
    track: Track<Transform<f64>>,
    pub(crate) lengths: Lengths,
    /// Those of the task, or their parts.
    pub(crate) phases: Vec<Phase<f64, FOOT_COUNT>>,
    /// Times of the nodes, s.
    pub(crate) times: Vec<f64>,
    /// References of the nodes and of the intervals.
    pub(crate) nodes: Vec<Pose<f64, N>>,
    reference: Vec<Pose<f64, N>>,
    clearances: Vec<Clearance<f64>>,
    goal: Pose<f64, N>,
    landing_intervals: usize,
    /// Height over the ground that feet keep on their way, m.
    lift: f64,
}

fn pose(base: &Transform<f64>, joints: &[f64; JOINTS]) -> Pose<f64, N> {
    Pose {
        q: core::array::from_fn(|i| match i {
            0..3 => base.translation[i],
            3..BASE => 0.0,
            _ => joints[i - BASE],
        }),
        rot_wc: base.rotation,
    }
}

/// Times of the nodes of phases, s.
pub(crate) fn times(phases: &[Phase<f64, FOOT_COUNT>]) -> Vec<f64> {
    let mut times = vec![0.0];
    for phase in phases {
        let begin = times[times.len() - 1];
        times.extend((1..=phase.intervals).map(|i| begin + phase.dt * i as f64));
    }
    times
}

impl<'a> Setup<'a> {
    /// On intervals of these lengths.
    pub(crate) fn new(task: &'a Task, srb: &'a SrbPlan, lengths: Lengths) -> Self {
        Self::along(task, srb, lengths, lengths.phases(task, srb))
    }

    /// As [`Setup::new`], with so many intervals in every part.
    pub(crate) fn on(
        task: &'a Task,
        srb: &'a SrbPlan,
        lengths: Lengths,
        intervals: &[usize],
    ) -> Self {
        Self::along(task, srb, lengths, lengths.phases_of(task, srb, intervals))
    }

    /// On intervals that are these, each split into equal parts, in phases of these durations. References stay at their intervals.
    pub(crate) fn split(&self, parts: usize, durations: &[f64]) -> Self {
        let shorter = |phase: &Phase<f64, FOOT_COUNT>| Phase {
            intervals: parts * phase.intervals,
            dt: phase.dt / parts as f64,
            weight: phase.weight / parts as f64,
            ..*phase
        };
        let phases = self.phases.iter().map(shorter).collect();
        let mut split = Self::along(self.task, self.srb, self.lengths, phases);
        split.landing_intervals = parts * self.landing_intervals;
        for (phase, duration) in split.phases.iter_mut().zip(durations) {
            phase.dt = duration / phase.intervals as f64;
        }
        split
    }

    /// Along the motion of the rigid body, on the intervals of these phases.
    fn along(
        task: &'a Task,
        srb: &'a SrbPlan,
        lengths: Lengths,
        phases: Vec<Phase<f64, FOOT_COUNT>>,
    ) -> Self {
        let rigid = &task.problem;
        let lift = match lengths {
            _ if rigid.edge.is_some_and(|edge| edge.drop < 0.0) => ONTO_LIFT,
            // On long intervals begins the search for a jump that has no room for it.
            Lengths::Even(times) if times > 1.0 => 0.0,
            Lengths::Even(_) | Lengths::Graded => LIFT,
        };
        let track = track(task, srb);
        let times = times(&phases);
        let flying = phases.iter().rev();
        let flying = flying.take_while(|phase| !phase.contacts.contains(&true));
        let flight: usize = flying.map(|phase| phase.intervals).sum();
        let dt = phases.last().map_or(POSED, |phase| phase.dt);
        let take_off = times.len() - 1 - flight;
        let ends = [times[take_off], times[times.len() - 1]];
        let mut nodes: Vec<Pose<f64, N>> = Vec::with_capacity(times.len());
        for (k, time) in times.iter().enumerate() {
            let joints = if k <= take_off {
                task.start.joints
            } else {
                task.folding.joints(*time, ends)
            };
            nodes.push(pose(&track.at(*time), &joints));
        }
        let moved = rigid.goal_w - rigid.start_w;
        let goal = Transform::new(
            so3::exp(&(rigid.axis * rigid.angle)),
            task.start.base.translation + moved,
        );
        let middle = |pair: &[Pose<f64, N>]| {
            let turn = so3::Geodesic::shortest(&pair[0].rot_wc, &pair[1].rot_wc);
            Pose {
                q: core::array::from_fn(|i| 0.5 * (pair[0].q[i] + pair[1].q[i])),
                rot_wc: turn.at(0.5),
            }
        };
        Self {
            task,
            srb,
            track,
            lengths,
            reference: nodes.windows(2).map(middle).collect(),
            phases,
            times,
            nodes,
            clearances: clearances(task),
            goal: pose(&goal, task.landing_joints()),
            // Rounding is no interval.
            landing_intervals: (POSED / dt - 1e-6).ceil() as usize,
            lift,
        }
    }

    /// Postures that no plan can choose: at the start, and as the robot lands.
    pub(crate) fn given(&self) -> [State; 2] {
        let start = self.task.start;
        let joints = core::array::from_fn(|i| self.goal.q[BASE + i]);
        [start, State { joints, ..start }]
    }

    /// How much higher limits drawn in keep the robot over the ground, m.
    fn rise(&self, drawn: &Tightening) -> f64 {
        drawn.height * self.task.robot.leg_length
    }

    /// What stays clear of the ground, of [`Self::problem`] within limits drawn in.
    pub(crate) fn clearances(&self, drawn: &Tightening) -> Vec<Clearance<f64>> {
        let rise = self.rise(drawn);
        let raised = |clearance: &Clearance<f64>| Clearance {
            height: clearance.height + rise,
            ..*clearance
        };
        self.clearances.iter().map(raised).collect()
    }

    /// The problem, with all the torque there is, within limits drawn in but those of [`Self::clearances`].
    pub(crate) fn problem(&self, drawn: &Tightening) -> Problem<'_, f64, N, FOOT_COUNT> {
        let task = self.task;
        let rigid = &task.problem;
        let build = task.robot.build(&task.start);
        // A regular octagon: forces keep to the planned share of friction whichever way they point, not along the axes alone.
        let cone = rigid.friction.min(CONE_SHARE * task.limits.friction);
        let mut problem = Problem {
            robot: Robot::on_free_base(&task.robot),
            feet: core::array::from_fn(|i| Foot {
                point: Robot::<f64, N>::point(&task.robot.feet[i]),
                pos_wf: rigid.feet[i].pos_wf + Vector3::new(0.0, 0.0, task.robot.foot_radius),
                radius: task.robot.foot_radius,
            }),
            clearances: &self.clearances,
            apart: &[],
            // A foot that grazes the edge of a box turns the robot over.
            swing_height: task.robot.foot_radius,
            swing_rise: self.rise(drawn) + self.lift,
            edge: cautious(task, self.rise(drawn)),
            phases: &self.phases,
            reference: &self.reference,
            start: pose(&task.start.base, &task.start.joints),
            goal: self.goal,
            goal_tolerance: GOAL_TOLERANCE,
            least_force: LEAST_FORCE * rigid.mass * rigid.gravity,
            release: build.force(RELEASE) / build.time(1.0),
            max_force: (task.limits.force_weights).map_or(f64::INFINITY, |_| rigid.max_force),
            landing_intervals: self.landing_intervals,
            friction_smoothing: FRICTION_SMOOTHING,
            friction: Friction {
                apex: drawn.friction * rigid.max_force,
                ..Friction::within_cone(cone, cone)
            },
            drift: ROLL,
            weights: Weights {
                position: task.weights.position,
                effort: task.weights.torque,
                goal: task.weights.goal,
            },
        };
        let robot = &mut problem.robot;
        let speed_share = task.limits.speed_share * (1.0 - drawn.speed);
        for (motor, limit) in robot.motors.iter_mut().zip(&mut robot.limits) {
            match motor {
                Some(motor) => {
                    motor.corner_speed *= speed_share;
                    motor.no_load_speed *= speed_share;
                    limit.speed *= 1.0 - drawn.speed;
                }
                None => limit.speed *= speed_share,
            }
        }
        let ends = problem.start.q.iter().zip(&problem.goal.q).skip(BASE);
        for (limit, (start, goal)) in robot.limits.iter_mut().skip(BASE).zip(ends) {
            limit.effort *= 1.0 - drawn.torque;
            keep_away(limit, drawn.position, [*start, *goal]);
        }
        problem
    }

    /// Force of the rigid body's motion on a foot at a node, world, N.
    pub(crate) fn force(&self, k: usize, foot: usize) -> Vector3<f64> {
        let k = self.track.interval(self.times[k]);
        let stage = &self.srb.stages[k];
        let sample = self.task.problem.sample(k, &stage.state, &stage.control);
        sample.forces_w[foot]
    }
}

/// Corners of the trunk, and knees.
fn clearances(task: &Task) -> Vec<Clearance<f64>> {
    let com_b = task.robot.com(&task.start) - task.start.base.translation;
    let corner = |corner: &Vector3<f64>| Clearance {
        point: Point {
            link: BASE - 1,
            // The single rigid body's corners are seen from its centre of mass.
            offset_l: corner + com_b,
        },
        height: task.problem.clearance,
    };
    let knee = |leg: usize| Clearance {
        point: Point {
            link: BASE + 3 * leg + 2,
            offset_l: Vector3::zeros(),
        },
        height: KNEE_CLEARANCE,
    };
    let corners = task.problem.corners.iter().map(corner);
    corners.chain((0..FOOT_COUNT).map(knee)).collect()
}

/// The single-rigid-body plan over time, as motion of the robot's base: the rigid body's frame sits at the centre of mass.
fn track(task: &Task, srb: &SrbPlan) -> Track<Transform<f64>> {
    let com_b = task.robot.com(&task.start) - task.start.base.translation;
    let mut time = 0.0;
    let mut times = Vec::new();
    for (k, stage) in srb.stages.iter().enumerate() {
        times.push(time);
        if let Some((i, phase)) = task.problem.phase_of(k) {
            time += stage.state.durations[i] / phase.intervals as f64;
        }
    }
    let states = srb.stages.iter().map(|stage| &stage.state);
    let poses = states.map(|state| (state.pos_w - state.rot_wb * com_b, state.rot_wb));
    Track::new(times, poses)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::{BASE, FOOT_COUNT, Lengths, N, Phase, Setup};
    use crate::task::Task;
    use crate::tightening::Tightening;
    use wb_opt::Pose;

    #[test]
    fn forces_keep_to_the_planned_share_of_friction_whichever_way_they_point() {
        let mut task = Task::load("a1/lateral").unwrap();
        let srb = task.guess().unwrap();
        let corner = |task: &Task| {
            let setup = Setup::new(task, &srb, Lengths::Even(4.0));
            let friction = setup.problem(&Tightening::default()).friction;
            // The eight sides of a regular octagon are as far out along the axes as between them.
            assert!((friction.axes - friction.diagonals.unwrap()).abs() < 1e-12);
            friction.axes / so3::math::cos(core::f64::consts::FRAC_PI_8)
        };
        let planned = task.limits.friction_share * task.limits.friction;
        assert!((corner(&task) - planned).abs() < 1e-12);
        // A task that uses all of it keeps room for what forces do between nodes.
        task.limits.friction_share = 1.0;
        task.problem.friction = task.limits.friction;
        assert!((corner(&task) - 0.95 * task.limits.friction).abs() < 1e-12);
    }

    #[test]
    fn a_roll_is_guessed_with_folded_legs_and_ends_with_legs_out() {
        for (name, folds) in [("a1/barrel-roll", true), ("a1/lateral", false)] {
            let task = Task::load(name).unwrap();
            let srb = task.guess().unwrap();
            let setup = Setup::new(&task, &srb, Lengths::Even(1.0));
            let flies = |phase: &&Phase<f64, FOOT_COUNT>| !phase.contacts.contains(&true);
            let flight = setup
                .phases
                .iter()
                .filter(flies)
                .map(|p| p.intervals)
                .sum::<usize>();
            let (stance, flight) = setup.nodes.split_at(setup.nodes.len() - flight);
            assert!(
                stance
                    .iter()
                    .all(|pose| pose.q[BASE..] == task.start.joints)
            );
            let from_landing = |pose: &Pose<f64, N>| {
                let pairs = pose.q[BASE..].iter().zip(task.landing_joints());
                pairs.fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()))
            };
            let most = flight.iter().map(from_landing).fold(0.0, f64::max);
            assert_eq!(most > 0.7, folds, "{name}: {most}");
            assert_eq!(from_landing(flight.last().unwrap()), 0.0);
        }
    }

    #[test]
    fn heights_that_are_drawn_in_are_higher() {
        let task = Task::load("a1/lateral").unwrap();
        let srb = task.guess().unwrap();
        let setup = Setup::new(&task, &srb, Lengths::Even(4.0));
        let drawn = Tightening {
            height: 0.1,
            ..Tightening::default()
        };
        let rise = 0.1 * task.robot.leg_length;
        let none = Tightening::default();
        let heights = |drawn| setup.clearances(drawn).into_iter().map(|c| c.height);
        assert_eq!(heights(&none).len(), heights(&drawn).len());
        for (before, after) in heights(&none).zip(heights(&drawn)) {
            assert!((after - before - rise).abs() < 1e-12);
        }
        let [before, after] = [none, drawn].map(|drawn| setup.problem(&drawn).swing_rise);
        assert!((after - before - rise).abs() < 1e-12);
    }
}
