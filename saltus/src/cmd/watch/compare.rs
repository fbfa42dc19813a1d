//! What several runs have in common and what not.

use crate::report::data::{Kind, Run};
use core::fmt;
use jump_lab::lab::keys::ROWS;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::cmd::failure::Failure;

/// The page.
pub(super) const PAGE: &str = "comparison.html";
/// What stands above it and above its table.
pub(super) const INTRO: &str = "Runs side by side in step: zero is the planned take-off of each.";
pub(super) const TABLE: &str = "What differs";

/// What is compared of what went in: a name, and where it stands in the result.
const CAUSES: [(&str, &str); 10] = [
    ("task", "/task"),
    ("robot", "/robot"),
    ("planner", "/plan/reference"),
    ("plan, CRC-32", "/plan/crc32"),
    ("simulator", "/sim"),
    ("seed", "/seed"),
    ("interface", "/interface"),
    ("height asked for, m", "/height_m"),
    ("rows on the angular momentum", "/momentum_control"),
    ("landing", "/landing/controller"),
];

/// The same of what came out.
const MEASURES: [(&str, &str); 9] = [
    ("off the plan at touchdown, m", "/verdict/flight/position_m"),
    ("the same, degrees", "/verdict/flight/rotation_deg"),
    ("feet off the goal, m", "/verdict/stand/feet_m"),
    ("turned in the end, degrees", "/verdict/stand/rotation_deg"),
    (
        "saturated in the landing, ms",
        "/verdict/hardware/saturation_ms/landing",
    ),
    (
        "ground, weights (10 ms mean)",
        "/verdict/hardware/ground_force_10ms_weights",
    ),
    ("fastest joint, rad/s", "/verdict/hardware/peak_joint_speed"),
    ("largest torque, N m", "/peak_torque_nm"),
    ("largest power, W", "/verdict/hardware/supply_power_w"),
];

/// Why runs cannot stand on one page.
#[derive(Debug)]
pub(super) enum Mix {
    /// The same folder twice.
    Twice(PathBuf),
    /// A run of another kind of robot than the first.
    Kinds([(PathBuf, Kind); 2]),
}

impl fmt::Display for Mix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Twice(path) => write!(
                f,
                "{} is given twice: a run differs from itself in nothing, give another",
                path.display()
            ),
            Self::Kinds([(first, a), (second, b)]) => write!(
                f,
                "{} is a {} and {} a {}, whose curves mean different things: watch each alone or with its like",
                first.display(),
                name_of(*a),
                second.display(),
                name_of(*b)
            ),
        }
    }
}

impl From<Mix> for Failure {
    fn from(mix: Mix) -> Self {
        Self::Refused(mix.to_string())
    }
}

const fn name_of(kind: Kind) -> &'static str {
    match kind {
        Kind::Quadruped => "quadruped",
        Kind::Humanoid => "humanoid",
    }
}

/// Refuses runs that cannot stand side by side.
pub(super) fn check(paths: &[PathBuf], runs: &[Run]) -> Result<(), Mix> {
    let mut seen = BTreeSet::new();
    for path in paths {
        if !seen.insert(fs::canonicalize(path).unwrap_or_else(|_| path.clone())) {
            return Err(Mix::Twice(path.clone()));
        }
    }
    let mut all = paths.iter().cloned().zip(runs.iter().map(|run| run.kind));
    let Some(first) = all.next() else {
        return Ok(());
    };
    match all.find(|(_, kind)| *kind != first.1) {
        Some(other) => Err(Mix::Kinds([first, other])),
        None => Ok(()),
    }
}

/// Gives every run the shortest name that no other has: its folder's, or the whole path.
pub(super) fn name(paths: &[PathBuf], runs: &mut [Run]) {
    let short = |path: &PathBuf| {
        path.file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    let shorts: BTreeSet<_> = paths.iter().filter_map(short).collect();
    for (path, run) in paths.iter().zip(runs) {
        let whole = || Path::new(path).display().to_string();
        let own = short(path).filter(|_| shorts.len() == paths.len());
        run.label = own.unwrap_or_else(whole);
    }
}

/// What differs of what went in, and what came out: a name, and a word for each run.
pub(super) fn differences(runs: &[Run]) -> Vec<Vec<String>> {
    let row = |(name, place): (&str, &str)| {
        let words = runs.iter().map(|run| word(run.result.pointer(place)));
        let mut row = vec![name.to_owned()];
        row.extend(words);
        row
    };
    let plant = ROWS.iter().map(|key| {
        let place = format!("/plant/{}", key.name);
        row((&format!("plant: {}", key.name), &place))
    });
    let causes = CAUSES.iter().map(|cause| row(*cause)).chain(plant);
    let differ = |row: &Vec<String>| row.iter().skip(2).any(|word| row.get(1) != Some(word));
    let mut out: Vec<Vec<String>> = causes.filter(differ).collect();
    let is_known = |row: &Vec<String>| row.iter().skip(1).any(|word| word != NONE);
    out.extend(
        MEASURES
            .iter()
            .map(|measure| row(*measure))
            .filter(is_known),
    );
    out
}

/// What stands for no value.
const NONE: &str = "–";

/// A value for people.
fn word(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => NONE.to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Bool(yes)) => if *yes { "yes" } else { "no" }.to_owned(),
        Some(Value::Number(number)) if number.is_f64() => {
            let text = format!("{:.3}", number.as_f64().unwrap_or(f64::NAN));
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        Some(other) => other.to_string(),
    }
}
