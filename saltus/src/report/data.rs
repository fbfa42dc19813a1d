//! What a page knows of its runs, as JSON in an element of its own: written into reports, and read back where runs are compared.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Of this layout; another version is not read.
pub(crate) const VERSION: u32 = 1;

type Point = [f64; 3];
/// As x, y, z, w.
type Turn = [f64; 4];

/// Everything on one page.
#[derive(Serialize, Deserialize)]
pub(crate) struct Data {
    /// [`VERSION`].
    pub(crate) version: u32,
    /// One in a report, several in a comparison.
    pub(crate) runs: Vec<Run>,
    /// What differs between several: a name, and a word for each.
    pub(crate) differences: Vec<Vec<String>>,
}

/// Which robots have the same curves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Kind {
    Quadruped,
    Humanoid,
}

/// One run, whatever the robot.
#[derive(Serialize, Deserialize)]
pub(crate) struct Run {
    pub(crate) kind: Kind,
    /// The task; in a comparison what tells it from the others.
    pub(crate) label: String,
    /// Planned, s.
    pub(crate) takeoff: f64,
    /// Of the robot, N.
    pub(crate) weight: f64,
    pub(crate) verdict: Words,
    /// `result.json`; `null` where the page was made by another command than a run.
    pub(crate) result: Value,
    pub(crate) scene: Scene,
    pub(crate) frames: Frames,
    pub(crate) plan: Plan,
    /// Name, begin and end.
    pub(crate) phases: Vec<(String, f64, f64)>,
    /// Name, value, and `good` or `bad` where that can be said.
    pub(crate) table: Vec<(String, String, Option<String>)>,
    /// Of the values of all curves, s.
    pub(crate) plot_times: Vec<f64>,
    /// Of this robot.
    pub(crate) plots: Vec<Plot>,
    /// The same of all robots of a kind.
    pub(crate) measures: Vec<Plot>,
}

/// A verdict in words.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Words {
    pub(crate) words: String,
    /// `good`, `bad`, or nothing where nobody judged.
    pub(crate) mark: Option<String>,
}

/// What does not move.
#[derive(Serialize, Deserialize)]
pub(crate) struct Scene {
    /// Height of the ground, m.
    pub(crate) floor: f64,
    /// Lower and upper corner of a box on it, m.
    pub(crate) block: Option<[Point; 2]>,
    pub(crate) shapes: Vec<Capsule>,
    /// Where the mark is that tells the front, along the base's x axis, m.
    pub(crate) nose: f64,
    pub(crate) goal: Point,
    /// Colours of the feet.
    pub(crate) feet: Vec<String>,
}

/// A collision shape, in the axes of its link; the base is link -1.
#[derive(Serialize, Deserialize)]
pub(crate) struct Capsule {
    pub(crate) link: i32,
    pub(crate) from: Point,
    pub(crate) to: Point,
    pub(crate) radius: f64,
    pub(crate) color: String,
}

/// Frames of the animation: a value of each list per frame, in the world.
#[derive(Default, Serialize, Deserialize)]
pub(crate) struct Frames {
    pub(crate) t: Vec<f64>,
    pub(crate) phase: Vec<String>,
    pub(crate) position: Vec<Point>,
    pub(crate) orientation: Vec<Turn>,
    pub(crate) com: Vec<Point>,
    /// Of the links.
    pub(crate) origins: Vec<Vec<Point>>,
    pub(crate) turns: Vec<Vec<Turn>>,
    /// Where forces of the ground act, and those, N.
    pub(crate) feet: Vec<Vec<Point>>,
    pub(crate) forces: Vec<Vec<Point>>,
    /// By how much the floor has moved, m, where it moves.
    pub(crate) floor: Option<Vec<f64>>,
}

/// The plan as a ghost, up to its touchdown: the whole robot, or its centre of mass where no more is planned.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub(crate) enum Plan {
    Robot(Frames),
    Com { t: Vec<f64>, com: Vec<Point> },
}

/// One plot.
#[derive(Serialize, Deserialize)]
pub(crate) struct Plot {
    pub(crate) title: String,
    pub(crate) unit: String,
    pub(crate) series: Vec<Series>,
}

/// One curve; nothing where it has no value.
#[derive(Serialize, Deserialize)]
pub(crate) struct Series {
    pub(crate) label: String,
    pub(crate) color: String,
    pub(crate) dashed: bool,
    pub(crate) values: Vec<Option<f64>>,
}

impl Frames {
    /// Every list has a value per frame.
    fn is_whole(&self) -> bool {
        let n = self.t.len();
        let lists = [
            self.phase.len(),
            self.position.len(),
            self.orientation.len(),
            self.com.len(),
            self.origins.len(),
            self.turns.len(),
            self.feet.len(),
            self.forces.len(),
            self.floor.as_ref().map_or(n, Vec::len),
        ];
        n > 0 && lists.iter().all(|list| *list == n)
    }
}

impl Run {
    /// Lists that belong together are equally long, so that a page can show them.
    pub(crate) fn is_whole(&self) -> bool {
        let plan = match &self.plan {
            Plan::Robot(frames) => frames.is_whole(),
            Plan::Com { t, com } => !t.is_empty() && t.len() == com.len(),
        };
        let mut curves = self.plots.iter().chain(&self.measures);
        let whole = |plot: &Plot| {
            let n = self.plot_times.len();
            plot.series.iter().all(|curve| curve.values.len() == n)
        };
        plan && self.frames.is_whole() && curves.all(whole)
    }
}
