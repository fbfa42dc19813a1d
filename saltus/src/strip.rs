//! A jump in one picture, whatever the robot: poses side by side, each over its own ground.

use crate::report::Moment;
use crate::report::data::{Capsule, Scene};
use core::fmt::Write;
use nalgebra::Vector3;

/// Poses in the picture.
const POSES: usize = 11;
/// Time shown before the take-off, s, and after the first contact.
const AROUND: [f64; 2] = [0.15, 0.4];
/// Width of the picture, pixels.
const WIDTH: f64 = 1100.0;
/// Room below the ground for the time, and above, pixels.
const BELOW: f64 = 26.0;
const ABOVE: f64 = 8.0;

/// A capsule in the picture of one pose: horizontal place of its ends from the base, heights, and how near it is, m.
struct Drawn<'a> {
    ends: [[f64; 2]; 2],
    near: f64,
    capsule: &'a Capsule,
}

/// The samples that are shown, from before the take-off to after the touchdown.
pub(crate) fn spread<S>(
    samples: &[S],
    time: impl Fn(&S) -> f64,
    [takeoff, touchdown]: [f64; 2],
) -> Vec<&S> {
    let (from, to) = (takeoff - AROUND[0], touchdown + AROUND[1]);
    let at = |i: usize| from + (to - from) * i as f64 / (POSES - 1) as f64;
    let found = (0..POSES).filter_map(|i| samples.iter().find(|s| time(s) >= at(i)));
    found.collect()
}

/// The picture as SVG; `across` is the horizontal direction that it shows from left to right.
pub(crate) fn svg(scene: &Scene, moments: &[Moment], across: &Vector3<f64>) -> String {
    let poses: Vec<Vec<Drawn<'_>>> = moments.iter().map(|m| pose(scene, m, across)).collect();
    let grounds: Vec<f64> = moments.iter().map(|m| ground(scene, m)).collect();
    let ends = || {
        poses
            .iter()
            .flatten()
            .flat_map(|d| d.ends.map(|end| (end, d.capsule.radius)))
    };
    let wide = ends().fold(0.1, |most, ([x, _], r)| f64::max(most, x.abs() + r));
    let top = ends().fold(0.1, |most, ([_, z], r)| f64::max(most, z + r));
    let bottom = grounds
        .iter()
        .fold(f64::INFINITY, |least, z| z.min(least))
        .min(top);
    let apart = WIDTH / POSES as f64;
    let scale = apart / (2.0 * wide);
    let height = (top - bottom) * scale + ABOVE + BELOW;
    let place = |i: usize, [x, z]: [f64; 2]| {
        let middle = (i as f64 + 0.5) * apart;
        [middle + x * scale, ABOVE + (top - z) * scale]
    };
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH:.0} {height:.0}\" font-family=\"sans-serif\" \
         font-size=\"12\" stroke-linecap=\"round\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (i, ((m, drawn), floor)) in moments.iter().zip(&poses).zip(&grounds).enumerate() {
        let [left, y] = place(i, [-wide, *floor]);
        let _ = writeln!(
            out,
            "<path d=\"M{left:.1} {y:.1}h{apart:.1}\" stroke=\"#57606a\" stroke-linecap=\"butt\"/>"
        );
        for one in drawn {
            let [[x1, y1], [x2, y2]] = one.ends.map(|end| place(i, end));
            let (color, thick) = (&one.capsule.color, 2.0 * one.capsule.radius * scale);
            // A line of no length has no ends in some programs.
            let _ = writeln!(
                out,
                "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {:.1}\" stroke=\"{color}\" stroke-width=\"{thick:.1}\"/>",
                y2 + 0.01
            );
        }
        let [x, _] = place(i, [0.0; 2]);
        let _ = writeln!(
            out,
            "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#57606a\">{:.2} s</text>",
            height - 6.0,
            m.time
        );
    }
    out + "</svg>\n"
}

/// The capsules of a robot, the farthest first.
fn pose<'a>(scene: &'a Scene, m: &Moment, across: &Vector3<f64>) -> Vec<Drawn<'a>> {
    // Towards whoever looks, with the picture's direction to the right and z up.
    let towards = across.cross(&Vector3::z());
    let draw = |capsule: &'a Capsule| {
        let body = usize::try_from(capsule.link)
            .ok()
            .and_then(|i| m.bodies.get(i));
        let ends = [capsule.from, capsule.to].map(|end| {
            let end = Vector3::from(end);
            body.map_or_else(|| m.position + m.orientation * end, |pose| pose.point(&end))
        });
        let from_base = ends.map(|end| end - m.position);
        Drawn {
            ends: [0, 1].map(|i| [across.dot(&from_base[i]), ends[i].z]),
            near: from_base.iter().map(|end| towards.dot(end)).sum(),
            capsule,
        }
    };
    let mut drawn: Vec<Drawn<'_>> = scene.shapes.iter().map(draw).collect();
    drawn.sort_by(|a, b| a.near.total_cmp(&b.near));
    drawn
}

/// Height of the ground under the base.
fn ground(scene: &Scene, m: &Moment) -> f64 {
    let on = scene.block.filter(|[lower, upper]| {
        (0..2).all(|axis| (lower[axis]..=upper[axis]).contains(&m.position[axis]))
    });
    on.map_or(scene.floor + m.floor, |[_, upper]| upper[2])
}
