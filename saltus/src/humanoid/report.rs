//! The report of a humanoid jump, with the figures of paper B: 1 (the profile), 2 and 3 (joints and centre of mass), 5 (the
//! animation), 6 (the base's pitch with and without the rows on angular momentum).

use crate::recording::{self, Frame, LIMBS, POINTS, Scene};
use crate::report::{
    COLORS, FRAME, LIMIT, Line, POINT, curve, lines, page, phases, plot, round, shape, turn, vector,
};
use icub_model::gazebo::joint;
use icub_model::{LIMITS, SOLES};
use jump_control::Phase;
use jump_lab::humanoid::execute::Run;
use jump_lab::humanoid::log::Sample;
use jump_lab::humanoid::{JOINTS, ROBOT, State, Task, links, poses};
use jump_lab::log::Log;
use nalgebra::Vector3;
use rbd_core::{Model, Transform};
use serde_json::{Value, json};

/// The base as a box, m.
const TRUNK_SIZE: [f64; 3] = [0.12, 0.18, 0.14];
/// Radius of the balls in the place of feet, m.
const DRAWN_FOOT: f64 = 0.02;

/// The report's text; `free` is the same jump without the rows on angular momentum.
pub(crate) fn html(
    task: &Task,
    run: &Run,
    free: Option<&Run>,
    table: &[Line],
) -> Result<String, String> {
    let title = format!("saltus run {}", task.name());
    let intro = "The robot stands in a squat, pushes off under the program of paper B, flies and lands. The animation stands for \
        figure 5; plots carry the number of the figure that they stand for. Figure 4 is of the robot itself and has no counterpart.";
    let data = json!({
        "frames": frames(&run.samples),
        "scene": {
            "floor": 0.0,
            "block": null,
            "foot_radius": DRAWN_FOOT,
            "trunk": TRUNK_SIZE,
            "shapes": links().each_ref().map(shape),
            // The base's x axis points backwards.
            "nose": -0.07,
            "goal": [0.0, 0.0, 0.0],
        },
        "phases": phases(&run.samples, |s| (s.phase, s.time)),
        "table": lines(table),
        "plot_times": run.samples.iter().step_by(POINT).map(|s| round(s.time, 4)).collect::<Vec<_>>(),
        "plots": plots(task, run, free)?,
    });
    Ok(page(&title, intro, &data))
}

/// Where the robot is.
fn state(s: &Sample) -> State {
    State {
        base: Transform::new(s.orientation.to_rotation_matrix(), s.position),
        joints: s.joints,
    }
}

/// Both legs and both arms as chains of four points.
fn limbs(s: &Sample) -> [[Vector3<f64>; POINTS]; LIMBS] {
    let poses = poses(&state(s));
    let body = |i: usize| poses.bodies[i].translation;
    let leg = |hip: usize, sole: usize| {
        let foot = poses.frame(&SOLES[sole].frame).translation;
        [body(hip), body(hip + 3), body(hip + 4), foot]
    };
    let arm = |shoulder: usize| {
        let (upper, elbow) = (body(shoulder), body(shoulder + 3));
        [body(joint::TORSO_YAW), upper, upper, elbow]
    };
    [
        leg(joint::L_HIP_PITCH, 0),
        leg(joint::R_HIP_PITCH, 1),
        arm(joint::L_SHOULDER_PITCH),
        arm(joint::R_SHOULDER_PITCH),
    ]
}

/// The run as MCAP.
pub(crate) fn mcap(task: &Task, run: &Run, log: &Log) -> Result<Vec<u8>, String> {
    let scene = Scene {
        trunk: TRUNK_SIZE,
        foot_radius: DRAWN_FOOT,
        floor: 0.0,
        block: None,
    };
    recording::mcap(task.name(), log, &scene, |k| {
        let s = &run.samples[k];
        let [left, right] = s.forces_w;
        Frame {
            position: s.position,
            orientation: s.orientation,
            limbs: limbs(s),
            forces_w: [left, right, Vector3::zeros(), Vector3::zeros()],
        }
    })
}

/// Limbs with the forces on the soles, for the animation.
fn frames(samples: &[Sample]) -> Value {
    let kept: Vec<&Sample> = samples.iter().step_by(FRAME).collect();
    let zero = json!([0, 0, 0]);
    let forces = |s: &Sample| {
        let [left, right] = s.forces_w.each_ref().map(vector);
        json!([left, right, zero, zero])
    };
    let each = |f: &dyn Fn(&Sample) -> Value| kept.iter().map(|s| f(s)).collect::<Vec<_>>();
    json!({
        "t": each(&|s| round(s.time, 4)),
        "phase": each(&|s| json!(format!("{:?}", s.phase))),
        "position": each(&|s| vector(&s.position)),
        "orientation": each(&|s| json!(so3::quat::to_xyzw(&s.orientation).map(|x| round(x, 5)))),
        "com": each(&|s| vector(&s.com)),
        "origins": each(&|s| json!(poses(&state(s)).bodies.each_ref().map(|body| vector(&body.translation)))),
        "turns": each(&|s| json!(poses(&state(s)).bodies.each_ref().map(turn))),
        "points": each(&|s| json!(limbs(s).as_flattened().iter().map(vector).collect::<Vec<_>>())),
        "forces": each(&forces),
    })
}

fn plots(task: &Task, run: &Run, free: Option<&Run>) -> Result<Vec<Value>, String> {
    let samples = run.samples.as_slice();
    let mut out = height(task, samples)?;
    out.extend(joints(task, samples));
    out.push(pitch(task, samples, free));
    out.push(plot(
        "Forces on the soles, normal",
        "N",
        vec![
            curve("left", COLORS[0], false, samples, |s| s.forces_w[0].z),
            curve("right", COLORS[1], false, samples, |s| s.forces_w[1].z),
        ],
    ));
    let axes = ["x", "y", "z"].iter().enumerate();
    let momentum =
        axes.map(|(i, name)| curve(name, COLORS[i], false, samples, move |s| s.momentum[i]));
    out.push(plot(
        "Angular momentum about the CoM",
        "kg m²/s",
        momentum.collect(),
    ));
    Ok(out)
}

/// Speed, acceleration and height of the centre of mass beside their profile.
fn height(task: &Task, samples: &[Sample]) -> Result<Vec<Value>, String> {
    let profile = task.profile()?;
    let pushing = |t: f64| (0.0..=profile.duration).contains(&t);
    let planned = |f: &dyn Fn(f64) -> f64| {
        let value = |s: &Sample| if pushing(s.time) { f(s.time) } else { f64::NAN };
        curve("plan", COLORS[0], true, samples, value)
    };
    // The profile goes on as a fall; on the ground again it means nothing.
    let desired = |s: &Sample| match s.phase {
        Phase::Landing | Phase::Stand | Phase::Abort => f64::NAN,
        _ => s.wanted_height,
    };
    Ok(vec![
        plot(
            "Figure 1: speed of the CoM, vertical",
            "m/s",
            vec![
                planned(&|t| profile.at(t).speed),
                curve("measured", COLORS[1], false, samples, |s| s.com_velocity.z),
            ],
        ),
        plot(
            "Figure 1: acceleration of the CoM, vertical",
            "m/s²",
            vec![planned(&|t| profile.at(t).acceleration)],
        ),
        plot(
            "Figures 2d, 3d: height of the CoM",
            "m",
            vec![
                curve("desired", COLORS[0], true, samples, desired),
                curve("measured", COLORS[1], false, samples, |s| s.com.z),
            ],
        ),
    ])
}

/// Speeds and torques of the joints that the paper shows, with their limits.
fn joints(task: &Task, samples: &[Sample]) -> Vec<Value> {
    let mut out = Vec::new();
    let names = Model::<f64, JOINTS>::joint_names(&ROBOT);
    for (letter, i) in [
        ("a", joint::L_ANKLE_PITCH),
        ("b", joint::L_KNEE),
        ("c", joint::L_HIP_PITCH),
    ] {
        let limits =
            |limit: f64| [limit, -limit].map(|x| curve("limit", LIMIT, true, samples, move |_| x));
        let name = names[i];
        let speed = curve(name, COLORS[0], false, samples, |s| s.joint_velocities[i]);
        let torque = curve(name, COLORS[0], false, samples, |s| s.torques[i]);
        let with = |series: Value, limit: f64| {
            let mut all = vec![series];
            all.extend(limits(limit));
            all
        };
        let title = |what: &str| format!("Figures 2{letter}, 3{letter}: {what} of {name}");
        let all = with(speed, LIMITS[i].speed);
        out.push(plot(&title("speed"), "rad/s", all));
        let all = with(torque, task.motors()[i].torque);
        out.push(plot(&title("torque"), "N m", all));
    }
    out
}

/// Pitch of the base, and what it is without the momentum rows.
fn pitch(task: &Task, samples: &[Sample], free: Option<&Run>) -> Value {
    let mut pitch = vec![curve(
        if task.momentum {
            "with the rows"
        } else {
            "without"
        },
        COLORS[0],
        false,
        samples,
        Sample::pitch_deg,
    )];
    if let Some(free) = free {
        let label = "without the rows";
        pitch.push(curve(
            label,
            COLORS[1],
            false,
            &free.samples,
            Sample::pitch_deg,
        ));
    }
    plot("Figure 6: pitch of the base", "degrees", pitch)
}
