//! The report: one HTML file with the jump in 3D and its plots, no network needed.

use crate::recording::{self, Frame, LIMBS, POINTS};
use crate::report::data::{self, Kind, Plan, Plot, Scene, Series};
use crate::report::{
    About, COLORS, FRAME, LIMIT, Measured, Moment, Planned, angles, capsules, curve, frames, lines,
    measures, phases, plot, point, report, times,
};
use jump_lab::lab::Disturbance;
use jump_lab::log::Log;
use jump_lab::quadruped::execute::Run;
use jump_lab::quadruped::log::{Sample, foot_names, joint_names};
use jump_lab::quadruped::plant::ground;
use jump_lab::quadruped::{FOOT_COUNT, JOINTS, State};
use jump_planner::planned::Origin;
use jump_planner::reference::Reference;
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use nalgebra::Vector3;
use rbd_core::Transform;

/// The report's text.
pub(crate) fn html(
    task: &Task,
    reference: &Reference,
    run: &Run,
    about: About<'_>,
) -> Result<String, String> {
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
    let samples = run.samples.as_slice();
    let kept = samples.iter().step_by(FRAME);
    let run = data::Run {
        kind: Kind::Quadruped,
        label: task.name.clone(),
        takeoff: reference.takeoff,
        weight: run.weight,
        verdict: about.verdict,
        result: about.result,
        scene: scene(task, about.disturbance),
        frames: frames(kept.map(|s| moment(&task.robot, s))),
        plan: Plan::Robot(frames(planned(task, reference, samples))),
        phases: phases(samples, |s| (s.phase, s.time)),
        table: lines(about.table),
        plot_times: times(samples, |s| s.time),
        plots: plots(&task.robot, samples, reference),
        measures: measures(&measured(&task.robot, run, reference)),
    };
    report(&intro, run)
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

/// Where the robot is.
fn state(s: &Sample) -> State {
    State {
        base: Transform::new(s.orientation.to_rotation_matrix(), s.position),
        joints: s.joints,
    }
}

/// The run as MCAP.
pub(crate) fn mcap(
    task: &Task,
    run: &Run,
    disturbance: &Disturbance,
    log: &Log,
) -> Result<Vec<u8>, String> {
    let terrain = ground(task, disturbance);
    let scene = recording::Scene {
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

/// The robot at a sample.
pub(crate) fn moment(robot: &Quadruped, s: &Sample) -> Moment {
    Moment {
        time: s.time,
        phase: s.phase,
        forces_w: s.forces_w[..FOOT_COUNT].to_vec(),
        floor: s.floor,
        ..posed(robot, &state(s))
    }
}

/// The robot where it is, in no phase and without forces.
fn posed(robot: &Quadruped, q: &State) -> Moment {
    let poses = robot.poses(q);
    let feet = robot.feet.iter();
    Moment {
        time: 0.0,
        phase: jump_control::Phase::Hold,
        position: q.base.translation,
        orientation: so3::quat::from_rotation(&q.base.rotation),
        com: robot.com(q),
        bodies: poses.bodies.to_vec(),
        feet: feet.map(|foot| poses.frame(foot).translation).collect(),
        forces_w: vec![Vector3::zeros(); FOOT_COUNT],
        floor: 0.0,
    }
}

/// The plan at the frames of the animation, up to its touchdown.
fn planned(task: &Task, reference: &Reference, samples: &[Sample]) -> Vec<Moment> {
    let kept = samples.iter().step_by(FRAME);
    let until = kept.take_while(|s| s.time <= reference.touchdown);
    let at = |s: &Sample| {
        let pose = posed(&task.robot, &reference.pose(s.time)?);
        Some(Moment {
            time: s.time,
            phase: s.phase,
            ..pose
        })
    };
    until.filter_map(at).collect()
}

/// What does not move.
pub(crate) fn scene(task: &Task, disturbance: &Disturbance) -> Scene {
    let terrain = ground(task, disturbance);
    let shapes = task.robot.shapes.iter().enumerate();
    Scene {
        floor: terrain.floor,
        block: terrain.block.map(|block| [block.lower, block.upper]),
        shapes: capsules(shapes.map(|(i, shape)| (shape, (i < FOOT_COUNT).then_some(i)))),
        nose: 0.5 * task.robot.trunk()[0],
        goal: point(&(task.start.base.translation + task.goal)),
        feet: COLORS.map(str::to_owned).to_vec(),
    }
}

/// Measures that all robots have, with the plan's.
fn measured(robot: &Quadruped, run: &Run, reference: &Reference) -> Vec<(Measured, Planned)> {
    let drives = robot.drives();
    let most = |values: &[f64; JOINTS], limit: &dyn Fn(usize) -> f64| {
        let shares = values.iter().enumerate().map(|(j, x)| x.abs() / limit(j));
        shares.fold(0.0, f64::max)
    };
    let torque = |torques: &[f64; JOINTS]| most(torques, &|j| drives[j].torque);
    let total = |forces: &[Vector3<f64>]| forces.iter().map(|f| f.z).sum::<f64>() / run.weight;
    let of = |s: &Sample| {
        let measured = Measured {
            com: s.com,
            orientation: s.orientation,
            torque: torque(&s.torques),
            speed: most(&s.joint_velocities, &|j| drives[j].no_load_speed),
            force: total(&s.forces_w[..FOOT_COUNT]),
        };
        let pose = reference.pose(s.time);
        let pose = pose.filter(|_| s.time <= reference.touchdown);
        let planned = pose.map_or(Planned::NOTHING, |q| Planned {
            com: robot.com(&q).into(),
            angles: angles(&so3::quat::from_rotation(&q.base.rotation)),
            torque: torque(&s.planned_torques),
            force: total(&s.planned_forces_w),
        });
        (measured, planned)
    };
    run.samples.iter().map(of).collect()
}

fn plots(robot: &Quadruped, samples: &[Sample], reference: &Reference) -> Vec<Plot> {
    let mut out = base(samples, reference);
    out.extend(torques(robot, samples, reference.touchdown));
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
fn base(samples: &[Sample], reference: &Reference) -> Vec<Plot> {
    let pose = |s: &Sample| {
        let pose = reference.pose(s.time);
        pose.filter(|_| s.time <= reference.touchdown)
    };
    let place = |s: &Sample, i: usize| pose(s).map_or(f64::NAN, |q| q.base.translation[i]);
    let angle = |s: &Sample, i: usize| {
        let turn = pose(s).map(|q| so3::quat::from_rotation(&q.base.rotation));
        turn.map_or(f64::NAN, |turn| angles(&turn)[i].to_degrees())
    };
    let both = |names: [&str; 3],
                run: &dyn Fn(&Sample, usize) -> f64,
                plan: &dyn Fn(&Sample, usize) -> f64| {
        let pairs = names.iter().enumerate().flat_map(|(i, name)| {
            [
                curve(name, COLORS[i], false, samples, |s| run(s, i)),
                curve(&format!("{name} plan"), COLORS[i], true, samples, |s| {
                    plan(s, i)
                }),
            ]
        });
        pairs.collect::<Vec<_>>()
    };
    vec![
        plot(
            "Base position",
            "m",
            both(["x", "y", "z"], &|s, i| s.position[i], &place),
        ),
        plot(
            "Base orientation",
            "degrees",
            both(
                ["roll", "pitch", "yaw"],
                &|s, i| angles(&s.orientation)[i].to_degrees(),
                &angle,
            ),
        ),
    ]
}

/// Torques of the joints by kind, with the plan's and their limits.
fn torques(robot: &Quadruped, samples: &[Sample], touchdown: f64) -> Vec<Plot> {
    let names = joint_names(robot);
    let motors = robot.drives();
    let mut out = Vec::new();
    for (i, kind) in ["Hip", "Thigh", "Calf"].iter().enumerate() {
        let legs = (0..FOOT_COUNT).flat_map(|leg| {
            let (j, color) = (3 * leg + i, COLORS[leg]);
            let planned = move |s: &Sample| {
                let flown = s.time <= touchdown;
                if flown {
                    s.planned_torques[j]
                } else {
                    f64::NAN
                }
            };
            [
                curve(&names[j], color, false, samples, move |s| s.torques[j]),
                curve(&format!("{} plan", names[j]), color, true, samples, planned),
            ]
        });
        let mut series: Vec<Series> = legs.collect();
        let limit = motors[i].torque;
        series.push(curve("limit", LIMIT, true, samples, move |_| limit));
        series.push(curve("-limit", LIMIT, true, samples, move |_| -limit));
        out.push(plot(&format!("{kind} torques"), "N m", series));
    }
    out
}

/// Forces of the feet, and those that are wanted.
fn forces(robot: &Quadruped, samples: &[Sample]) -> Vec<Plot> {
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
