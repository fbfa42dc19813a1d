//! What the reports of all robots share: one HTML file with jumps in 3D and their plots, no network needed. The same page shows one run, or
//! several side by side.

pub(crate) mod data;
mod measures;

use data::{Capsule, Data, Frames, Plot, Run, Series, VERSION, Words};
use jump_control::Phase;
use jump_lab::lab::Disturbance;
use jump_lab::verdict::Verdict;
use nalgebra::{UnitQuaternion, Vector3};
use rbd_core::{Link, Shape, Transform};
use serde_json::Value;

pub(crate) use measures::{Measured, Planned, angles, measures};

const TEMPLATE: &str = include_str!("../../assets/report.html");
const CSS: &str = include_str!("../../assets/page.css");
const SCRIPTS: [&str; 3] = [
    include_str!("../../assets/robot.js"),
    include_str!("../../assets/plots.js"),
    include_str!("../../assets/page.js"),
];
const THREE: &str = include_str!("../../assets/three.bundle.min.js");
const UPLOT: &str = include_str!("../../assets/uPlot.iife.min.js");
const UPLOT_CSS: &str = include_str!("../../assets/uPlot.min.css");
/// What stands before and after the data in the page.
const DATA: [&str; 2] = [
    "<script type=\"application/json\" id=\"data\">",
    "</script>",
];
/// Every so many milliseconds a frame of the animation, and a point of the plots.
pub(crate) const FRAME: usize = 10;
pub(crate) const POINT: usize = 4;
/// Colours of limbs and curves.
pub(crate) const COLORS: [&str; 4] = ["#0969da", "#bc4c00", "#1a7f37", "#8250df"];
/// Colour of limits.
pub(crate) const LIMIT: &str = "#b42318";
/// Colours of the base and of links that are no feet.
const BASE: &str = "#30363d";
const LINK: &str = "#8c959f";

/// A line of the result: name, value, and whether it is good where that can be said.
pub(crate) type Line = (&'static str, String, Option<bool>);

/// What a report tells beside the motion.
pub(crate) struct About<'a> {
    /// How the lab differed from the plan.
    pub(crate) disturbance: &'a Disturbance,
    pub(crate) verdict: Words,
    /// `result.json`, or `null`.
    pub(crate) result: Value,
    pub(crate) table: &'a [Line],
}

/// Text that is not markup.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

/// The page of one run or of several; `table` is the title of what stands below the animation.
pub(crate) fn page(title: &str, intro: &str, table: &str, data: &Data) -> Result<String, String> {
    let data = serde_json::to_string(data).map_err(|error| error.to_string())?;
    // A string in the data must not end the script.
    let data = data.replace("</", "<\\/");
    Ok(TEMPLATE
        .replace("@TITLE@", &escape(title))
        .replace("@INTRO@", intro)
        .replace("@TABLE@", table)
        .replace("@CSS@", CSS)
        .replace("@UPLOT_CSS@", UPLOT_CSS)
        .replace("@UPLOT@", UPLOT)
        .replace("@THREE@", THREE)
        .replace("@SCRIPTS@", &SCRIPTS.join("\n"))
        .replace("@DATA@", &data))
}

/// The report of one run.
pub(crate) fn report(intro: &str, run: Run) -> Result<String, String> {
    let title = format!("saltus run {}", run.label);
    let data = Data {
        version: VERSION,
        runs: vec![run],
        differences: Vec::new(),
    };
    page(&title, intro, "Result", &data)
}

/// The run in a report, as it was written.
///
/// # Errors
/// What is wrong with the text: it is no report, one of another version, or damaged.
pub(crate) fn read(text: &str) -> Result<Run, String> {
    let other = "was not written by this version of saltus: run the task again";
    let (_, rest) = text.split_once(DATA[0]).ok_or(other)?;
    let cut = "is cut off: copy the folder again, or run the task again";
    let (data, _) = rest.split_once(DATA[1]).ok_or(cut)?;
    let damaged = |why: &str| format!("is damaged ({why}): run the task again");
    let version =
        serde_json::from_str::<Value>(data).map_err(|error| damaged(&error.to_string()))?;
    if version["version"] != VERSION {
        return Err(other.to_owned());
    }
    let data: Data = serde_json::from_str(data).map_err(|error| damaged(&error.to_string()))?;
    let [run] = <[Run; 1]>::try_from(data.runs)
        .map_err(|runs| format!("shows {} runs: give their own folders", runs.len()))?;
    if run.is_whole() {
        Ok(run)
    } else {
        Err(damaged("lists of different lengths"))
    }
}

/// A verdict for the top of the page.
pub(crate) fn words(verdict: &Verdict) -> Words {
    Words {
        words: crate::verdict::sentence(verdict),
        mark: Some(mark(verdict.on_target())),
    }
}

fn mark(good: bool) -> String {
    if good { "good" } else { "bad" }.to_owned()
}

/// The result's lines as the page takes them.
pub(crate) fn lines(table: &[Line]) -> Vec<(String, String, Option<String>)> {
    let lines = table.iter();
    lines
        .map(|(name, value, good)| ((*name).to_owned(), value.clone(), good.map(mark)))
        .collect()
}

/// A number with so many decimals: the file stays small.
pub(crate) fn round(x: f64, digits: u32) -> f64 {
    let scale = so3::math::powi(10.0, digits);
    (x * scale).round() / scale
}

/// A point with tenths of a millimetre.
pub(crate) fn point(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z].map(|x| round(x, 4))
}

/// Collision shapes with their colours: feet have those of their limbs.
pub(crate) fn capsules<'a>(
    shapes: impl IntoIterator<Item = (&'a Shape<f64>, Option<usize>)>,
) -> Vec<Capsule> {
    let capsule = |(shape, foot): (&Shape<f64>, Option<usize>)| {
        let (link, color) = match shape.link {
            Link::Base => (-1, BASE),
            Link::Joint(i) => (i32::try_from(i).unwrap_or(-1), LINK),
        };
        let color = foot.and_then(|i| COLORS.get(i)).unwrap_or(&color);
        Capsule {
            link,
            from: shape.from,
            to: shape.to,
            radius: shape.radius,
            color: (*color).to_owned(),
        }
    };
    shapes.into_iter().map(capsule).collect()
}

/// The robot at one time.
pub(crate) struct Moment {
    pub(crate) time: f64,
    pub(crate) phase: Phase,
    pub(crate) position: Vector3<f64>,
    pub(crate) orientation: UnitQuaternion<f64>,
    pub(crate) com: Vector3<f64>,
    /// Poses of the links in the world.
    pub(crate) bodies: Vec<Transform<f64>>,
    /// Where forces of the ground act, and those, N, world axes.
    pub(crate) feet: Vec<Vector3<f64>>,
    pub(crate) forces_w: Vec<Vector3<f64>>,
    /// By how much the floor has moved upwards, m.
    pub(crate) floor: f64,
}

/// Frames of the animation.
pub(crate) fn frames(moments: impl IntoIterator<Item = Moment>) -> Frames {
    let mut out = Frames::default();
    let mut floor = Vec::new();
    let turn = |q: &UnitQuaternion<f64>, digits| so3::quat::to_xyzw(q).map(|x| round(x, digits));
    for m in moments {
        let bodies = m.bodies.iter();
        let turns = bodies
            .clone()
            .map(|body| turn(&so3::quat::from_rotation(&body.rotation), 4));
        out.t.push(round(m.time, 4));
        out.phase.push(format!("{:?}", m.phase));
        out.position.push(point(&m.position));
        out.orientation.push(turn(&m.orientation, 5));
        out.com.push(point(&m.com));
        out.origins
            .push(bodies.map(|body| point(&body.translation)).collect());
        out.turns.push(turns.collect());
        out.feet.push(m.feet.iter().map(point).collect());
        out.forces.push(m.forces_w.iter().map(point).collect());
        floor.push(round(m.floor, 4));
    }
    out.floor = floor.iter().any(|x| *x != 0.0).then_some(floor);
    out
}

/// Runs of equal phase: name, begin, end, by the phase and the time of a sample.
pub(crate) fn phases<S>(samples: &[S], of: impl Fn(&S) -> (Phase, f64)) -> Vec<(String, f64, f64)> {
    let runs = samples.chunk_by(|a, b| of(a).0 == of(b).0);
    let named = runs.filter_map(|run| {
        let ((phase, begin), (_, last)) = (of(run.first()?), of(run.last()?));
        Some((format!("{phase:?}"), begin, last + 1e-3))
    });
    named.collect()
}

/// Times of the values of all curves.
pub(crate) fn times<S>(samples: &[S], of: impl Fn(&S) -> f64) -> Vec<f64> {
    let points = samples.iter().step_by(POINT);
    points.map(|s| round(of(s), 4)).collect()
}

/// One curve over samples.
pub(crate) fn curve<S>(
    label: &str,
    color: &str,
    dashed: bool,
    samples: &[S],
    value: impl Fn(&S) -> f64,
) -> Series {
    let points = samples.iter().step_by(POINT);
    let values = points.map(|s| Some(round(value(s), 4)).filter(|x| x.is_finite()));
    Series {
        label: label.to_owned(),
        color: color.to_owned(),
        dashed,
        values: values.collect(),
    }
}

/// One plot.
pub(crate) fn plot(title: &str, unit: &str, series: Vec<Series>) -> Plot {
    Plot {
        title: title.to_owned(),
        unit: unit.to_owned(),
        series,
    }
}
