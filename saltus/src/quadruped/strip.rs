//! A jump in one picture: poses side by side, seen along the axis about which the body turns.

use crate::report::COLORS;
use core::fmt::Write;
use jump_lab::quadruped::State;
use jump_lab::quadruped::execute::Run;
use jump_lab::quadruped::log::Sample;
use jump_planner::robot::Quadruped;
use jump_planner::task::Task;
use nalgebra::Vector3;
use rbd_core::Transform;

/// Poses in the picture.
const POSES: usize = 11;
/// Distance between two poses, m.
const APART: f64 = 0.62;
/// Pixels per metre.
const SCALE: f64 = 160.0;
/// Time shown before the take-off, s, and after the first contact.
const AROUND: [f64; 2] = [0.15, 0.4];

/// The picture as SVG.
pub(crate) fn svg(task: &Task, run: &Run, takeoff: f64) -> String {
    let from = takeoff - AROUND[0];
    let to = run.first_contact.unwrap_or(takeoff + 0.5) + AROUND[1];
    let shown: Vec<&Sample> = (0..POSES)
        .filter_map(|i| {
            let time = from + (to - from) * i as f64 / (POSES - 1) as f64;
            run.samples.iter().find(|sample| sample.time >= time)
        })
        .collect();
    let across = across(task);
    let floor = jump_planner::terrain::terrain(task, 0.0).floor;
    let top = shown.iter().map(|s| s.position.z).fold(0.0, f64::max) + 0.35;
    let [width, height] = [POSES as f64 * APART * SCALE, (top - floor + 0.25) * SCALE];
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" \
         font-size=\"12\" stroke-linecap=\"round\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (i, sample) in shown.iter().enumerate() {
        let middle = (i as f64 + 0.5) * APART;
        let place = |p: &Vector3<f64>| {
            let x = middle + across.dot(&(p - sample.position));
            [x * SCALE, (top - p.z) * SCALE]
        };
        draw(&task.robot, &mut out, sample, place);
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#57606a\">{:.2} s</text>",
            middle * SCALE,
            height - 6.0,
            sample.time
        );
    }
    let ground = (top - floor) * SCALE;
    let _ = writeln!(
        out,
        "<path d=\"M0 {ground:.1}H{width:.0}\" stroke=\"#57606a\"/></svg>"
    );
    out
}

/// The horizontal direction of the picture: across the axis of the turn, else along the jump.
fn across(task: &Task) -> Vector3<f64> {
    let axis = task.problem.axis;
    let is_turn = task.problem.angle != 0.0;
    let sideways = if is_turn && axis.z.abs() < 0.5 {
        axis.x.abs() > axis.y.abs()
    } else {
        task.goal.y.abs() > task.goal.x.abs()
    };
    if sideways { Vector3::y() } else { Vector3::x() }
}

/// Trunk and legs.
fn draw(
    robot: &Quadruped,
    out: &mut String,
    sample: &Sample,
    place: impl Fn(&Vector3<f64>) -> [f64; 2],
) {
    let q = State {
        base: Transform::new(sample.orientation.to_rotation_matrix(), sample.position),
        joints: sample.joints,
    };
    let mut path = |points: &[Vector3<f64>], color: &str, wide: f64| {
        let corners: Vec<String> = points
            .iter()
            .map(|p| {
                let [x, y] = place(p);
                format!("{x:.1} {y:.1}")
            })
            .collect();
        let _ = writeln!(
            out,
            "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{wide}\"/>",
            corners.join("L")
        );
    };
    let trunk = robot.trunk();
    let corner = |i: usize| {
        let side = |axis: usize| {
            let half = 0.5 * trunk[axis];
            if (i >> axis) & 1 == 0 { half } else { -half }
        };
        sample.position + sample.orientation * Vector3::new(side(0), side(1), side(2))
    };
    for i in 0..8_usize {
        for axis in 0..3 {
            let j = i | 1 << axis;
            if j != i {
                path(&[corner(i), corner(j)], "#1f2328", 1.5);
            }
        }
    }
    let kinematics = robot.poses(&q);
    for (leg, (foot, color)) in robot.feet.iter().zip(COLORS).enumerate() {
        let link = |i: usize| kinematics.bodies[3 * leg + i].translation;
        let foot = kinematics.frame(foot).translation;
        path(&[link(0), link(1), link(2), foot], color, 3.0);
    }
}
