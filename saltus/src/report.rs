//! What the reports of all robots share: one HTML file with a jump in 3D and its plots, no network needed.

use jump_control::Phase;
use nalgebra::Vector3;
use rbd_core::{Link, Shape, Transform};
use serde_json::{Value, json};

const TEMPLATE: &str = include_str!("../assets/report.html");
const THREE: &str = include_str!("../assets/three.bundle.min.js");
const UPLOT: &str = include_str!("../assets/uPlot.iife.min.js");
const UPLOT_CSS: &str = include_str!("../assets/uPlot.min.css");
/// Every so many milliseconds a frame of the animation, and a point of the plots.
pub(crate) const FRAME: usize = 10;
pub(crate) const POINT: usize = 4;
/// Colours of limbs and curves.
pub(crate) const COLORS: [&str; 4] = ["#0969da", "#bc4c00", "#1a7f37", "#8250df"];
/// Colour of limits.
pub(crate) const LIMIT: &str = "#b42318";

/// A line of the result: name, value, and whether it is good where that can be said.
pub(crate) type Line = (&'static str, String, Option<bool>);

/// The page.
pub(crate) fn page(title: &str, intro: &str, data: &Value) -> String {
    // A string in the data must not end the script.
    let data = data.to_string().replace("</", "<\\/");
    TEMPLATE
        .replace("@TITLE@", title)
        .replace("@INTRO@", intro)
        .replace("@UPLOT_CSS@", UPLOT_CSS)
        .replace("@UPLOT@", UPLOT)
        .replace("@THREE@", THREE)
        .replace("@DATA@", &data)
}

/// The result's lines as the page takes them.
pub(crate) fn lines(table: &[Line]) -> Vec<Value> {
    let mark = |good: bool| if good { "good" } else { "bad" };
    table
        .iter()
        .map(|(name, value, good)| json!([name, value, good.map(mark)]))
        .collect()
}

/// A number with so many decimals: the file stays small.
pub(crate) fn round(x: f64, digits: u32) -> Value {
    let scale = so3::math::powi(10.0, digits);
    json!((x * scale).round() / scale)
}

/// A point with tenths of a millimetre.
pub(crate) fn vector(v: &Vector3<f64>) -> Value {
    json!([round(v.x, 4), round(v.y, 4), round(v.z, 4)])
}

/// A collision shape; the base's link is -1.
pub(crate) fn shape(shape: &Shape<f64>) -> Value {
    json!({
        "link": if let Link::Joint(i) = shape.link { json!(i) } else { json!(-1) },
        "from": shape.from,
        "to": shape.to,
        "radius": shape.radius,
    })
}

/// Orientation of a link, as x, y, z, w.
pub(crate) fn turn(pose: &Transform<f64>) -> Value {
    let turn = so3::quat::from_rotation(&pose.rotation);
    json!(so3::quat::to_xyzw(&turn).map(|x| round(x, 4)))
}

/// Runs of equal phase: name, begin, end, by the phase and the time of a sample.
pub(crate) fn phases<S>(samples: &[S], of: impl Fn(&S) -> (Phase, f64)) -> Vec<Value> {
    let runs = samples.chunk_by(|a, b| of(a).0 == of(b).0);
    let named = runs.filter_map(|run| {
        let ((phase, begin), (_, last)) = (of(run.first()?), of(run.last()?));
        Some(json!([format!("{phase:?}"), begin, last + 1e-3]))
    });
    named.collect()
}

/// One curve over samples.
pub(crate) fn curve<S>(
    label: &str,
    color: &str,
    dashed: bool,
    samples: &[S],
    value: impl Fn(&S) -> f64,
) -> Value {
    let points = samples.iter().step_by(POINT);
    let values: Vec<Value> = points.map(|s| round(value(s), 4)).collect();
    json!({ "label": label, "color": color, "dashed": dashed, "values": values })
}

/// One plot.
pub(crate) fn plot(title: &str, unit: &str, series: Vec<Value>) -> Value {
    json!({ "title": title, "unit": unit, "series": series })
}
