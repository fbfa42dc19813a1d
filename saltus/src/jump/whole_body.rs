//! The whole-body plan of a task as it is to be executed: the geared A1 on rolling ball feet, with margins.

use super::pace::Pace;
use super::stored::{open, store};
use super::task::{SrbPlan, Task};
use super::{FOOT_COUNT, JOINTS};
use crate::audit::Audit;
use crate::track::Track;
use core::ops::ControlFlow;
use nalgebra::Vector3;
use ocp_solver::{Progress, Solution, Stage, Status, blocking_rows};
use rbd_core::Transform;
use std::time::Instant;
use wb_opt::{
    BASE, Clearance, Foot, Gains, Judgement, Phase, Point, Pose, Problem, Robot, Row, Sample,
    State, Weights,
};

/// Coordinates of the robot.
pub(crate) const N: usize = BASE + JOINTS;
const NX: usize = 2 * N;
const NU: usize = N + 3 * FOOT_COUNT;
/// Trunk corners and knees.
const CLEARANCES: usize = 12;
const NI: usize = wb_opt::row_capacity(N, FOOT_COUNT, CLEARANCES, true);

/// Longest interval in contact, s. At twice the length the audit finds limits exceeded between nodes.
const CONTACT_DT: f64 = 0.005;
/// Longest interval in flight, s: no forces change, but the turn must be right.
const FLIGHT_DT: f64 = 0.005;
/// Time before touchdown in which the legs rest in the landing posture, s.
pub(crate) const POSED: f64 = 0.05;
/// Most iterations; tasks that are solved take 15 to 130.
const PATIENCE: usize = 150;
/// How much farther than it is a box edge is taken to be, m.
const EDGE_MARGIN: f64 = 0.12;
/// How far a ball may roll from where it stood, per axis, m.
const ROLL: f64 = 0.03;
const KNEE_CLEARANCE: f64 = 0.03;
/// Least normal force of a foot that stands, in weights of the robot.
const LEAST_FORCE: f64 = 0.04;
/// Speed at which planned Coulomb friction of the joints fades, rad/s.
pub(crate) const FRICTION_SMOOTHING: f64 = 0.3;
pub(crate) const GOAL_TOLERANCE: [f64; BASE] = [0.02, 0.02, 0.02, 0.05, 0.05, 0.05];

/// A solved whole-body plan.
pub(crate) struct WholeBodyPlan {
    pub(crate) outcome: Solution<f64>,
    pub(crate) judged: Judgement<f64>,
    /// Torque that the plan was allowed of the strongest joint, N m.
    pub(crate) torque_limit: f64,
    pub(crate) phases: Vec<Phase<f64, FOOT_COUNT>>,
    pub(crate) intervals: Vec<Interval>,
    /// State at the planned touchdown.
    pub(crate) end: State<f64, N>,
    /// What blocks, worst first; nothing if the plan was solved.
    pub(crate) blocked: Vec<Blocked>,
    /// Share of the torque limits that the plan was allowed.
    pub(crate) torque_share: f64,
}

/// A row that is violated where the solver stopped.
pub(crate) struct Blocked {
    pub(crate) row: Row,
    /// By how much, in the row's own unit.
    pub(crate) violation: f64,
}

/// One interval of a plan; torques and forces are held over it.
pub(crate) struct Interval {
    /// Start and length, s.
    pub(crate) start: f64,
    pub(crate) dt: f64,
    /// State at the start.
    pub(crate) state: State<f64, N>,
    /// The middle.
    pub(crate) sample: Sample<f64, N, FOOT_COUNT>,
    pub(crate) gains: Gains<f64, N, FOOT_COUNT>,
}

/// A plan and what its audit found.
pub(crate) struct Audited {
    pub(crate) plan: WholeBodyPlan,
    /// The plan as it is stored; nothing of a plan that was not solved.
    pub(crate) bytes: Vec<u8>,
    /// None of a plan that was not solved.
    pub(crate) audit: Option<Audit>,
    /// Time of planning, without the audit, ms.
    pub(crate) wall_ms: f64,
}

/// Plans the whole body and audits the plan. Where the audit finds limits exceeded between nodes or a flight that is not
/// true to the dynamics, the intervals were too long for this robot: they are halved, once.
pub(crate) fn audited(
    task: &Task,
    srb: &SrbPlan,
    with_gains: bool,
    mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<Audited, String> {
    let mut wall_ms = 0.0;
    let mut on_intervals = |share: f64| {
        let clock = Instant::now();
        let plan = plan_on(task, srb, share, &mut observer)?;
        wall_ms += clock.elapsed().as_secs_f64() * 1e3;
        let (mut bytes, mut audit) = (Vec::new(), None);
        if plan.outcome.status == Status::Solved {
            bytes = store(task, &plan, with_gains)?;
            let stored = open(&bytes, &task.robot).map_err(|error| error.to_string())?;
            audit = Some(Audit::of(&task.robot, &stored)?);
        }
        Ok::<_, String>(Audited {
            plan,
            bytes,
            audit,
            wall_ms,
        })
    };
    let coarse = on_intervals(1.0)?;
    if coarse.audit.as_ref().is_none_or(Audit::passes) {
        return Ok(coarse);
    }
    let fine = on_intervals(0.5)?;
    // A plan that fails its audit says more than none.
    let wall_ms = fine.wall_ms;
    let told = if fine.audit.is_some() { fine } else { coarse };
    Ok(Audited { wall_ms, ..told })
}

/// Plans the whole body along a single-rigid-body plan.
pub(crate) fn plan(
    task: &Task,
    srb: &SrbPlan,
    observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<WholeBodyPlan, String> {
    plan_on(task, srb, 1.0, observer)
}

/// Plans on intervals of a share of their usual length.
fn plan_on(
    task: &Task,
    srb: &SrbPlan,
    share: f64,
    mut observer: impl FnMut(&Progress<f64>) -> ControlFlow<()>,
) -> Result<WholeBodyPlan, String> {
    let rigid = &task.problem;
    let landing_joints = task.robot.landing_joints(&task.start)?;
    let pose = |base: &Transform<f64>, joints: &[f64; JOINTS]| Pose {
        q: core::array::from_fn(|i| match i {
            0..3 => base.translation[i],
            3..BASE => 0.0,
            _ => joints[i - BASE],
        }),
        rot_wc: base.rotation,
    };
    let start = pose(&task.start.base, &task.start.joints);

    let mut phases = Vec::new();
    for (phase, duration) in rigid.used_phases().iter().zip(durations(srb)) {
        let longest = if phase.contacts.contains(&true) {
            CONTACT_DT
        } else {
            FLIGHT_DT
        };
        let intervals = (duration / (share * longest)).ceil().max(1.0);
        phases.push(Phase {
            contacts: phase.contacts,
            intervals: intervals as usize,
            dt: duration / intervals,
        });
    }
    let track = track(task, srb);
    let mut times = vec![0.0];
    for phase in &phases {
        let begin = times[times.len() - 1];
        times.extend((1..=phase.intervals).map(|i| begin + phase.dt * i as f64));
    }
    let flight = phases.last().map_or(0, |phase| phase.intervals);
    let take_off = times.len() - 1 - flight;
    let mut nodes: Vec<Pose<f64, N>> = Vec::with_capacity(times.len());
    for (k, time) in times.iter().enumerate() {
        let joints = if k <= take_off {
            &task.start.joints
        } else {
            &landing_joints
        };
        nodes.push(pose(&track.at(*time), joints));
    }
    let moved = rigid.goal_w - rigid.start_w;
    let goal = Transform::new(
        so3::exp(&(rigid.axis * rigid.angle)),
        task.start.base.translation + moved,
    );
    let goal = pose(&goal, &landing_joints);
    let middle = |pair: &[Pose<f64, N>]| {
        let turn = so3::Geodesic::shortest(&pair[0].rot_wc, &pair[1].rot_wc);
        Pose {
            q: core::array::from_fn(|i| 0.5 * (pair[0].q[i] + pair[1].q[i])),
            rot_wc: turn.at(0.5),
        }
    };
    let reference: Vec<_> = nodes.windows(2).map(middle).collect();

    let com_b = task.robot.com(&task.start) - task.start.base.translation;
    let corner = |corner: &Vector3<f64>| Clearance {
        point: Point {
            link: BASE - 1,
            // The single rigid body's corners are seen from its centre of mass.
            offset_l: corner + com_b,
        },
        height: rigid.clearance,
    };
    let knee = |leg: usize| Clearance {
        point: Point {
            link: BASE + 3 * leg + 2,
            offset_l: Vector3::zeros(),
        },
        height: KNEE_CLEARANCE,
    };
    let clearances: Vec<_> = rigid
        .corners
        .iter()
        .map(corner)
        .chain((0..FOOT_COUNT).map(knee))
        .collect();
    let edge = rigid.edge.map(|mut edge| {
        edge.distance += EDGE_MARGIN;
        edge
    });
    let mut problem = Problem {
        robot: Robot::on_free_base(&task.robot),
        feet: core::array::from_fn(|i| Foot {
            point: Robot::<f64, N>::point(&task.robot.feet[i]),
            pos_wf: rigid.feet[i].pos_wf + Vector3::new(0.0, 0.0, task.robot.foot_radius),
            radius: task.robot.foot_radius,
        }),
        clearances: &clearances,
        // A foot that grazes the edge of a box turns the robot over.
        swing_height: task.robot.foot_radius,
        edge,
        phases: &phases,
        reference: &reference,
        start,
        goal,
        goal_tolerance: GOAL_TOLERANCE,
        least_force: LEAST_FORCE * rigid.mass * rigid.gravity,
        landing_intervals: (POSED / (share * FLIGHT_DT)) as usize,
        friction_smoothing: FRICTION_SMOOTHING,
        friction: rigid.friction,
        drift: ROLL,
        weights: Weights {
            position: task.weights.position,
            effort: task.weights.torque,
            goal: task.weights.goal,
        },
    };
    for (motor, limit) in problem
        .robot
        .motors
        .iter_mut()
        .zip(&mut problem.robot.limits)
    {
        match motor {
            Some(motor) => {
                motor.corner_speed *= task.limits.speed_share;
                motor.no_load_speed *= task.limits.speed_share;
            }
            None => limit.speed *= task.limits.speed_share,
        }
    }
    let mut stages: Vec<Stage<f64, State<f64, N>, NX, NU, NI>> =
        vec![Stage::new(State::at_rest(start)); problem.intervals() + 1];
    let mut settings = wb_opt::settings();
    (settings.max_iterations, settings.attempt_iterations) = (PATIENCE, PATIENCE);
    let mut solved = None;
    let given = problem.robot.limits;
    let shares = task.limits.torque_shares;
    for (i, share) in shares.into_iter().enumerate() {
        for (limit, given) in problem.robot.limits.iter_mut().zip(&given).skip(BASE) {
            limit.effort = share * given.effort;
        }
        let force = |k: usize, foot: usize| {
            let k = track.interval(times[k]);
            let stage = &srb.stages[k];
            rigid.sample(k, &stage.state, &stage.control).forces_w[foot]
        };
        problem.write_guess(&mut stages, &nodes, force, || 0.0);
        let (mut pace, mut cancelled) = (Pace::default(), false);
        let watch = |progress: &Progress<f64>| {
            cancelled = observer(progress).is_break();
            // With the most torque there is nothing to save time for.
            let last = i + 1 == shares.len();
            let violation = progress.residual.primal;
            if !cancelled && (last || pace.keeps_up(progress.attempt, violation, PATIENCE)) {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        };
        let outcome = problem
            .plan(&settings, &mut stages, watch)
            .map_err(|error| format!("task {}: {error}", task.name))?;
        solved = Some((outcome, share));
        if cancelled || outcome.status == Status::Solved {
            break;
        }
    }
    let (outcome, torque_share) = solved.ok_or("no torque to plan with")?;
    let strongest = given.iter().skip(BASE).map(|limit| limit.effort);
    let torque_limit = torque_share * strongest.fold(0.0, f64::max);
    let judged = problem.judge(stages.iter().map(|stage| (&stage.state, &stage.control)));
    let intervals = stages[..problem.intervals()].iter().enumerate();
    let intervals = intervals.map(|(k, stage)| Interval {
        start: times[k],
        dt: problem.dt(k),
        state: stage.state,
        sample: problem.sample(k, &stage.state, &stage.control),
        gains: problem.gains(k, &stage.state, &stage.control, stage.gain()),
    });
    let blocking = blocking_rows::<4, _, _, _, _, _, _>(&stages);
    let blocked = blocking.iter().flatten().filter_map(|found| {
        let (row, unit) = problem.row(found.stage, found.row)?;
        let violation = (found.violation * unit).abs();
        Some(Blocked { row, violation })
    });
    let blocked = match outcome.status {
        Status::Solved => Vec::new(),
        _ => blocked.collect(),
    };
    let end = stages.last().map(|stage| stage.state);
    Ok(WholeBodyPlan {
        end: end.ok_or("no nodes")?,
        torque_share,
        blocked,
        outcome,
        judged,
        torque_limit,
        intervals: intervals.collect(),
        phases,
    })
}

fn durations(srb: &SrbPlan) -> impl Iterator<Item = f64> {
    let state = srb.stages.first().map(|stage| stage.state.durations);
    state.into_iter().flatten()
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
