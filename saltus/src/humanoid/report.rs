//! The report of a humanoid jump, with the figures of paper B: 1 (the profile), 2 and 3 (joints and centre of mass), 5 (the
//! animation), 6 (the base's pitch with and without the rows on angular momentum).

use crate::recording::{self, Frame, LIMBS, POINTS};
use crate::report::data::{self, Kind, Plan, Plot, Scene, Series};
use crate::report::{
    About, COLORS, FRAME, LIMIT, Measured, Moment, Planned, capsules, curve, frames, lines,
    measures, phases, plot, point, report, round, times,
};
use icub_model::gazebo::joint;
use icub_model::{LIMITS, SOLES};
use jump_control::Phase;
use jump_lab::humanoid::execute::Run;
use jump_lab::humanoid::log::Sample;
use jump_lab::humanoid::{FEET, JOINTS, ROBOT, SPHERES, State, Task, links, poses, spheres};
use jump_lab::log::Log;
use nalgebra::Vector3;
use rbd_core::{Model, Shape, Transform};

/// The base as a box, m.
const TRUNK_SIZE: [f64; 3] = [0.12, 0.18, 0.14];
/// Radius of the balls in the place of feet, m.
const DRAWN_FOOT: f64 = 0.02;

/// The report's text; `free` is the same jump without the rows on angular momentum.
pub(crate) fn html(
    task: &Task,
    run: &Run,
    free: Option<&Run>,
    about: About<'_>,
) -> Result<String, String> {
    let intro = "The robot stands in a squat, pushes off under the program of paper B, flies and lands. The animation stands for \
        figure 5; plots carry the number of the figure that they stand for. Figure 4 is of the robot itself and has no counterpart.";
    let samples = run.samples.as_slice();
    let run = data::Run {
        kind: Kind::Humanoid,
        label: task.name().to_owned(),
        takeoff: run.takeoff,
        weight: run.weight,
        verdict: about.verdict,
        result: about.result,
        scene: scene(),
        frames: frames(samples.iter().step_by(FRAME).map(moment)),
        plan: rise(samples),
        phases: phases(samples, |s| (s.phase, s.time)),
        table: lines(about.table),
        plot_times: times(samples, |s| s.time),
        plots: plots(task, run, free)?,
        measures: measures(&measured(task, run)),
    };
    report(intro, run)
}

/// The soles' corners, which touch the ground, each drawn with a way to every other of its sole.
fn soles() -> Vec<(usize, Shape<f64>)> {
    let corners = spheres();
    let mut out = Vec::new();
    for (foot, sole) in corners.chunks(SPHERES / FEET).enumerate() {
        for (i, from) in sole.iter().enumerate() {
            let ways = sole.iter().skip(i + 1);
            out.extend(ways.map(|to| {
                (
                    foot,
                    Shape {
                        to: to.from,
                        ..*from
                    },
                )
            }));
        }
    }
    out
}

/// What does not move.
pub(crate) fn scene() -> Scene {
    let (links, soles) = (links(), soles());
    let links = links.iter().enumerate();
    let links = links.map(|(i, shape)| (shape, Some(i).filter(|foot| *foot < FEET)));
    let soles = soles.iter().map(|(foot, shape)| (shape, Some(*foot)));
    Scene {
        floor: 0.0,
        block: None,
        shapes: capsules(links.chain(soles)),
        // The base's x axis points backwards.
        nose: -0.07,
        goal: [0.0; 3],
        feet: COLORS[..FEET]
            .iter()
            .map(|&color| color.to_owned())
            .collect(),
    }
}

/// The profile goes on as a fall; on the ground again it means nothing.
fn is_planned(s: &Sample) -> bool {
    !matches!(s.phase, Phase::Landing | Phase::Stand | Phase::Abort)
}

/// What is planned: the height of the centre of mass, over where it begins.
fn rise(samples: &[Sample]) -> Plan {
    let start = samples.first().map_or_else(Vector3::zeros, |s| s.com);
    let kept = samples.iter().step_by(FRAME);
    let planned: Vec<&Sample> = kept.take_while(|s| is_planned(s)).collect();
    let at = |s: &&Sample| point(&Vector3::new(start.x, start.y, s.wanted_height));
    Plan::Com {
        t: planned.iter().map(|s| round(s.time, 4)).collect(),
        com: planned.iter().map(at).collect(),
    }
}

/// Measures that all robots have, with the planned height.
fn measured(task: &Task, run: &Run) -> Vec<(Measured, Planned)> {
    let motors = task.motors();
    let of = |s: &Sample| {
        let torques = s
            .torques
            .iter()
            .zip(&motors)
            .map(|(x, m)| x.abs() / m.torque);
        let speeds = s.joint_velocities.iter().zip(&LIMITS);
        let speeds = speeds.map(|(x, limits)| x.abs() / limits.speed);
        let measured = Measured {
            com: s.com,
            orientation: s.orientation,
            torque: torques.fold(0.0, f64::max),
            speed: speeds.fold(0.0, f64::max),
            force: s.forces_w.iter().map(|f| f.z).sum::<f64>() / run.weight,
        };
        let height = if is_planned(s) {
            s.wanted_height
        } else {
            f64::NAN
        };
        let planned = Planned {
            com: [f64::NAN, f64::NAN, height],
            ..Planned::NOTHING
        };
        (measured, planned)
    };
    run.samples.iter().map(of).collect()
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
    let scene = recording::Scene {
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

/// The robot at a sample.
pub(crate) fn moment(s: &Sample) -> Moment {
    let poses = poses(&state(s));
    let soles = SOLES
        .iter()
        .map(|sole| poses.frame(&sole.frame).translation);
    Moment {
        time: s.time,
        phase: s.phase,
        position: s.position,
        orientation: s.orientation,
        com: s.com,
        bodies: poses.bodies.to_vec(),
        feet: soles.collect(),
        forces_w: s.forces_w.to_vec(),
        floor: s.floor,
    }
}

fn plots(task: &Task, run: &Run, free: Option<&Run>) -> Result<Vec<Plot>, String> {
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
fn height(task: &Task, samples: &[Sample]) -> Result<Vec<Plot>, String> {
    let profile = task.profile()?;
    let pushing = |t: f64| (0.0..=profile.duration).contains(&t);
    let planned = |f: &dyn Fn(f64) -> f64| {
        let value = |s: &Sample| if pushing(s.time) { f(s.time) } else { f64::NAN };
        curve("plan", COLORS[0], true, samples, value)
    };
    let desired = |s: &Sample| {
        if is_planned(s) {
            s.wanted_height
        } else {
            f64::NAN
        }
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
fn joints(task: &Task, samples: &[Sample]) -> Vec<Plot> {
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
        let with = |series: Series, limit: f64| {
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
fn pitch(task: &Task, samples: &[Sample], free: Option<&Run>) -> Plot {
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
