//! The report: one HTML file with the jump in 3D and its plots, no network needed.

use crate::recording::{self, Frame, LIMBS, POINTS, Scene};
use crate::report::{
    COLORS, FRAME, LIMIT, Line, POINT, curve, lines, page, phases, plot, round, shape, turn, vector,
};
use jump_lab::log::Log;
use jump_lab::quadruped::execute::Run;
use jump_lab::quadruped::log::{Sample, foot_names, joint_names};
use jump_lab::quadruped::{FOOT_COUNT, JOINTS, State};
use jump_planner::planned::Origin;
use jump_planner::reference::Reference;
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use nalgebra::Vector3;
use rbd_core::Transform;
use serde_json::{Value, json};

/// The report's text.
pub(crate) fn html(task: &Task, reference: &Reference, run: &Run, table: &[Line]) -> String {
    let title = format!("saltus run {}", task.name);
    let legs = match reference.origin {
        Origin::WholeBody(_) => "a whole-body optimum along a single-rigid-body one",
        Origin::Kinematics => {
            "a single-rigid-body optimum with leg kinematics and inverse dynamics"
        }
        Origin::RigidBody(_) => {
            "an optimum in joint space with the dynamics of a single rigid body"
        }
        Origin::Stored => "one that was stored before",
    };
    let intro = format!(
        "The robot stands, pushes off, flies and lands under the controllers of the jump; the plant is simulated at 10 kHz (see \
         the table). The plan is {legs}."
    );
    let data = json!({
        "frames": frames(&task.robot, &run.samples),
        "scene": scene(task),
        "phases": phases(&run.samples, |s| (s.phase, s.time)),
        "table": lines(table),
        "plot_times": run.samples.iter().step_by(POINT).map(|s| round(s.time, 4)).collect::<Vec<_>>(),
        "plots": plots(&task.robot, &run.samples, reference),
    });
    page(&title, &intro, &data)
}

/// Hip, thigh, calf and foot of each leg.
fn limbs(robot: &Quadruped, s: &Sample) -> [[Vector3<f64>; POINTS]; LIMBS] {
    let poses = robot.poses(&state(s));
    core::array::from_fn(|leg| {
        let link = |i: usize| poses.bodies[3 * leg + i].translation;
        [
            link(0),
            link(1),
            link(2),
            poses.frame(&robot.feet[leg]).translation,
        ]
    })
}

/// Orientations of the links, as x, y, z, w.
fn turns(robot: &Quadruped, s: &Sample) -> [Value; JOINTS] {
    let poses = robot.poses(&state(s));
    poses.bodies.each_ref().map(turn)
}

/// Where the robot is.
fn state(s: &Sample) -> State {
    State {
        base: Transform::new(s.orientation.to_rotation_matrix(), s.position),
        joints: s.joints,
    }
}

/// The run as MCAP.
pub(crate) fn mcap(task: &Task, run: &Run, log: &Log) -> Result<Vec<u8>, String> {
    let terrain = jump_planner::terrain::terrain(task, 0.0);
    let scene = Scene {
        trunk: task.robot.trunk(),
        foot_radius: task.robot.foot_radius,
        floor: terrain.floor,
        block: terrain.block.map(|block| [block.lower, block.upper]),
    };
    recording::mcap(&task.name, log, &scene, |k| {
        let s = &run.samples[k];
        Frame {
            position: s.position,
            orientation: s.orientation,
            limbs: limbs(&task.robot, s),
            forces_w: core::array::from_fn(|foot| s.forces_w[foot]),
        }
    })
}

/// Poses of the links and forces, for the animation.
fn frames(robot: &Quadruped, samples: &[Sample]) -> Value {
    let kept: Vec<&Sample> = samples.iter().step_by(FRAME).collect();
    let each = |f: &dyn Fn(&Sample) -> Value| kept.iter().map(|s| f(s)).collect::<Vec<_>>();
    json!({
        "t": each(&|s| round(s.time, 4)),
        "phase": each(&|s| json!(format!("{:?}", s.phase))),
        "position": each(&|s| vector(&s.position)),
        "orientation": each(&|s| json!(so3::quat::to_xyzw(&s.orientation).map(|x| round(x, 5)))),
        "com": each(&|s| vector(&s.com)),
        "turns": each(&|s| json!(turns(robot, s))),
        "points": each(&|s| json!(limbs(robot, s).as_flattened().iter().map(vector).collect::<Vec<_>>())),
        "forces": each(&|s| json!(s.forces_w[..FOOT_COUNT].iter().map(vector).collect::<Vec<_>>())),
    })
}

fn scene(task: &Task) -> Value {
    let terrain = jump_planner::terrain::terrain(task, 0.0);
    json!({
        "floor": terrain.floor,
        "block": terrain.block.map(|block| [block.lower, block.upper]),
        "foot_radius": task.robot.foot_radius,
        "trunk": task.robot.trunk(),
        "shapes": task.robot.shapes.each_ref().map(shape),
        "nose": 0.145,
        "goal": vector(&(task.start.base.translation + task.goal)),
    })
}

fn plots(robot: &Quadruped, samples: &[Sample], reference: &Reference) -> Vec<Value> {
    let mut out = base(samples);
    out.extend(torques(robot, samples));
    out.extend(forces(robot, samples));
    let touchdown = reference.touchdown;
    let error = move |s: &Sample| {
        if s.time > touchdown {
            return f64::NAN;
        }
        let pairs = (0..JOINTS).map(|j| (s.joints[j] - s.planned_joints[j]).abs());
        pairs.fold(0.0, f64::max)
    };
    out.push(plot(
        "Largest joint tracking error up to the planned touchdown",
        "rad",
        vec![curve("error", COLORS[0], false, samples, error)],
    ));
    let fastest = robot.drives()[0].no_load_speed;
    let speed = |s: &Sample| {
        s.joint_velocities
            .iter()
            .fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    out.push(plot(
        "Fastest joint",
        "rad/s",
        vec![
            curve("speed", COLORS[0], false, samples, speed),
            curve("no-load speed", LIMIT, true, samples, move |_| fastest),
        ],
    ));
    out
}

/// Place and attitude of the base.
fn base(samples: &[Sample]) -> Vec<Value> {
    let axes = ["x", "y", "z"];
    vec![
        plot(
            "Base position",
            "m",
            (0..3)
                .flat_map(|i| {
                    let planned = move |s: &Sample| s.planned_position[i];
                    let name = format!("{} plan", axes[i]);
                    [
                        curve(axes[i], COLORS[i], false, samples, move |s| s.position[i]),
                        curve(&name, COLORS[i], true, samples, planned),
                    ]
                })
                .collect(),
        ),
        plot(
            "Base orientation",
            "degrees",
            ["roll", "pitch", "yaw"]
                .iter()
                .enumerate()
                .map(|(i, name)| {
                    curve(name, COLORS[i], false, samples, move |s| {
                        let (roll, pitch, yaw) = s.orientation.euler_angles();
                        [roll, pitch, yaw][i].to_degrees()
                    })
                })
                .collect(),
        ),
    ]
}

/// Torques of the joints by kind, with their limits.
fn torques(robot: &Quadruped, samples: &[Sample]) -> Vec<Value> {
    let names = joint_names(robot);
    let motors = robot.drives();
    let mut out = Vec::new();
    for (i, kind) in ["Hip", "Thigh", "Calf"].iter().enumerate() {
        let mut series: Vec<Value> = (0..FOOT_COUNT)
            .map(|leg| {
                let j = 3 * leg + i;
                curve(&names[j], COLORS[leg], false, samples, move |s| {
                    s.torques[j]
                })
            })
            .collect();
        let limit = motors[i].torque;
        series.push(curve("limit", LIMIT, true, samples, move |_| limit));
        series.push(curve("-limit", LIMIT, true, samples, move |_| -limit));
        out.push(plot(&format!("{kind} torques"), "N m", series));
    }
    out
}

/// Forces of the feet, and those that are wanted.
fn forces(robot: &Quadruped, samples: &[Sample]) -> Vec<Value> {
    let mut out = Vec::new();
    for (axis, title) in [
        (2, "Contact forces, normal"),
        (1, "Contact forces, sideways (y)"),
    ] {
        let series = foot_names(robot)
            .into_iter()
            .enumerate()
            .flat_map(|(leg, name)| {
                // In the air and before it the plan, on the ground again what the landing's program commands.
                let wanted = move |s: &Sample| {
                    s.planned_forces_w[leg][axis] + s.commanded_forces_w[leg][axis]
                };
                [
                    curve(name, COLORS[leg], false, samples, move |s| {
                        s.forces_w[leg][axis]
                    }),
                    curve(
                        &format!("{name} command"),
                        COLORS[leg],
                        true,
                        samples,
                        wanted,
                    ),
                ]
            })
            .collect();
        out.push(plot(title, "N", series));
    }
    out
}
