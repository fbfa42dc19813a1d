//! Rates of success with their confidence, by cells of what was disturbed.

use super::execute::Trial;
use super::judge::Judged;
use super::measure::Measure;
use crate::lab::keys::{COUNT, ROWS, Row};
use crate::lab::{Interface, Key, Lab, PlantArgument};
use crate::verdict::TARGET;
use crate::{Sim, noise};
use core::fmt::Write;
use std::collections::BTreeMap;

/// Intervals per disturbance.
pub const BINS: usize = 4;

/// The two disturbances of the picture.
pub const PICTURE: [Key; 2] = [Key::Ground, Key::TorqueGain];

/// What differs between the samples of a study: whatever A1's lab draws.
fn axes() -> impl Iterator<Item = &'static Row> {
    ROWS.iter().filter(|row| row.lab[0][0] < row.lab[0][1])
}

/// One run of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Its number in the study.
    pub index: u64,
    /// Of its lab and its noise.
    pub seed: u64,
    /// By key.
    values: [f64; COUNT],
    /// Distance of the feet's middle from the goal's in the end, m; not a number where the run ended before.
    pub feet_error: f64,
    /// Angle of the base from the goal's in the end, degrees; likewise.
    pub rotation_error: f64,
    /// `target`, or what failed first.
    pub outcome: String,
}

impl Sample {
    /// Names of the columns.
    #[must_use]
    pub fn header() -> String {
        let names: Vec<&str> = ROWS.iter().map(|row| row.name).collect();
        format!(
            "index,seed,{},feet_error_m,rotation_error_deg,outcome",
            names.join(",")
        )
    }

    /// Its number in the study.
    #[must_use]
    pub fn new(index: u64, trial: &Trial<'_>, judged: &Judged) -> Self {
        let stand = judged.verdict.stand;
        Self {
            index,
            seed: trial.seed,
            values: core::array::from_fn(|i| trial.disturbance.get(ROWS[i].key)),
            feet_error: stand.map_or(f64::NAN, |stand| stand.feet),
            rotation_error: stand.map_or(f64::NAN, |stand| stand.rotation),
            outcome: judged.verdict.outcome().to_owned(),
        }
    }

    /// As a line of the file; a comma ends it, so that one that was cut is seen.
    #[must_use]
    pub fn line(&self) -> String {
        let mut out = format!("{},{},", self.index, self.seed);
        for value in self.values {
            let _ = write!(out, "{value:.6},");
        }
        let _ = write!(
            out,
            "{:.6},{:.4},{},",
            self.feet_error, self.rotation_error, self.outcome
        );
        out
    }

    /// The way back from [`Sample::line`]; `None` for headings and broken lines.
    #[must_use]
    pub fn parse(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.split(',').collect();
        let [index, seed, values @ .., feet, rotation, outcome, ""] = cells.as_slice() else {
            return None;
        };
        let number = |text: &str| text.parse::<f64>().ok();
        let values: Option<Vec<f64>> = values.iter().map(|text| number(text)).collect();
        Some(Self {
            index: index.parse().ok()?,
            seed: seed.parse().ok()?,
            values: values?.try_into().ok()?,
            feet_error: number(feet)?,
            rotation_error: number(rotation)?,
            outcome: (*outcome).to_owned(),
        })
    }

    /// The run was on target.
    #[must_use]
    pub fn good(&self) -> bool {
        self.outcome == TARGET
    }

    /// What a key was in this run.
    #[must_use]
    pub fn value(&self, key: Key) -> f64 {
        self.values[key as usize]
    }
}

/// The run of a sample of a study: the same on every machine. `plant` is what differs in every run, instead of the lab of its seed.
#[must_use]
pub fn trial<'a>(
    (seed, index): (u64, u64),
    plant: Option<&PlantArgument>,
    (sim, interface): (Sim, Interface),
    without: &'a [Measure],
) -> Trial<'a> {
    // Seed 0 would be the nominal run.
    let seed = noise::mix(seed, index).max(1);
    Trial {
        sim,
        disturbance: PlantArgument::plant(plant, Lab::A1, seed),
        seed,
        interface,
        without,
    }
}

/// Samples counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts {
    /// How many.
    pub samples: usize,
    /// How many of them were on target.
    pub on_target: usize,
    /// Those not on target, by what failed first.
    pub failed: BTreeMap<String, usize>,
}

impl Counts {
    /// Counts.
    #[must_use]
    pub fn of(samples: &[Sample]) -> Self {
        let mut failed = BTreeMap::new();
        for sample in samples.iter().filter(|sample| !sample.good()) {
            *failed.entry(sample.outcome.clone()).or_insert(0) += 1;
        }
        Self {
            samples: samples.len(),
            on_target: samples.iter().filter(|sample| sample.good()).count(),
            failed,
        }
    }

    /// What failed first, for people: `flight.rotation_deg 3, stand.upright 1`.
    #[must_use]
    pub fn failures(&self) -> String {
        let words: Vec<String> = self
            .failed
            .iter()
            .map(|(name, count)| format!("{name} {count}"))
            .collect();
        words.join(", ")
    }
}

/// Wilson's 95 % interval of a rate of `good` in `count`; [0, 1] where nothing was tried.
#[must_use]
pub fn wilson(good: usize, count: usize) -> [f64; 2] {
    if count == 0 {
        return [0.0, 1.0];
    }
    let (n, z) = (count as f64, 1.959_963_984_540_054);
    let rate = good as f64 / n;
    let middle = rate + z * z / (2.0 * n);
    let half = z * so3::math::sqrt(rate * (1.0 - rate) / n + z * z / (4.0 * n * n));
    let scale = 1.0 + z * z / n;
    [
        ((middle - half) / scale).max(0.0),
        ((middle + half) / scale).min(1.0),
    ]
}

/// A rate of `good` in `count` with its interval, as the cells `rate,low95,high95` of a file; empty where nothing was tried, of which nothing is
/// known.
#[must_use]
pub fn rate(good: usize, count: usize) -> String {
    if count == 0 {
        return ",,".to_owned();
    }
    let [low, high] = wilson(good, count);
    format!("{:.4},{low:.4},{high:.4}", good as f64 / count as f64)
}

/// Which of the equal parts of the range a value lies in; in none where it is outside, as a `--plant` may have it.
fn bin(value: f64, [low, high]: [f64; 2]) -> Option<usize> {
    let share = (value - low) / (high - low) * BINS as f64;
    // Both ends are inside, and what is not a number is not.
    let inside = low <= value && value <= high;
    inside.then(|| (share as usize).min(BINS - 1))
}

fn edges([low, high]: [f64; 2], bin: usize) -> [f64; 2] {
    let width = (high - low) / BINS as f64;
    [low + width * bin as f64, low + width * (bin + 1) as f64]
}

/// All samples, then the cells of each disturbance, then those of the picture's two together; then what failed first. The cells are parts of the lab's
/// range: a sample that differs by more is in none of that disturbance.
pub fn table(samples: &[Sample]) -> String {
    let mut out =
        String::from("cell,from,to,cell2,from2,to2,samples,on_target,rate,low95,high95\n");
    let mut row = |name: &str, cell: &[&Sample]| {
        let good = cell.iter().filter(|s| s.good()).count();
        let rate = rate(good, cell.len());
        let _ = writeln!(out, "{name},{},{good},{rate}", cell.len());
    };
    row("all,,,,,", &samples.iter().collect::<Vec<_>>());
    for axis in axes() {
        let range = axis.lab[0];
        for k in 0..BINS {
            let inside = |s: &&Sample| bin(s.value(axis.key), range) == Some(k);
            let cell: Vec<&Sample> = samples.iter().filter(inside).collect();
            let [from, to] = edges(range, k);
            row(&format!("{},{from:.4},{to:.4},,,", axis.name), &cell);
        }
    }
    let [a, b] = PICTURE.map(Key::row);
    for (i, j, cell) in grid(samples) {
        let ([a0, a1], [b0, b1]) = (edges(a.lab[0], i), edges(b.lab[0], j));
        let name = format!("{},{a0:.4},{a1:.4},{},{b0:.4},{b1:.4}", a.name, b.name);
        row(&name, &cell);
    }
    for (cause, count) in Counts::of(samples).failed {
        let _ = writeln!(out, "# failed: {cause} {count}");
    }
    out
}

/// Cells of the picture's two disturbances.
pub fn grid(samples: &[Sample]) -> impl Iterator<Item = (usize, usize, Vec<&Sample>)> {
    let [a, b] = PICTURE.map(Key::row);
    (0..BINS).flat_map(move |i| {
        (0..BINS).map(move |j| {
            let inside = |s: &&Sample| {
                let [of_a, of_b] = [a, b].map(|row| bin(s.value(row.key), row.lab[0]));
                of_a == Some(i) && of_b == Some(j)
            };
            (i, j, samples.iter().filter(inside).collect())
        })
    })
}

#[cfg(test)]
mod tests {
    use super::{BINS, Counts, Sample, bin, grid, table, wilson};
    use crate::lab::Key;
    use crate::lab::keys::ROWS;

    fn sample(index: u64, ground: f64, outcome: &str) -> Sample {
        let mut values = ROWS.each_ref().map(|row| row.nominal.unwrap_or(0.25));
        values[Key::Ground as usize] = ground;
        Sample {
            index,
            seed: 9,
            values,
            feet_error: 0.012,
            rotation_error: 1.5,
            outcome: outcome.to_owned(),
        }
    }

    /// Values of Brown, Cai and DasGupta's formula, computed by hand from the quadratic (p − k/n)² = z² p (1 − p)/n.
    #[test]
    fn wilsons_interval_solves_its_quadratic() {
        for (good, count) in [(0, 10), (3, 10), (10, 10), (95, 100), (1, 1)] {
            let (n, z) = (count as f64, 1.959_963_984_540_054_f64);
            let rate = good as f64 / n;
            for p in wilson(good, count) {
                let defect = (p - rate) * (p - rate) - z * z * p * (1.0 - p) / n;
                assert!(defect.abs() < 1e-12, "{good}/{count}: {p}");
            }
        }
        assert_eq!(wilson(0, 0), [0.0, 1.0]);
    }

    #[test]
    fn lines_come_back_and_broken_ones_do_not() {
        let one = sample(3, 9.0, "target");
        assert_eq!(Sample::parse(&one.line()), Some(one.clone()));
        let line = one.line();
        for cut in 1..line.len() {
            assert_eq!(Sample::parse(&line[..cut]), None, "{}", &line[..cut]);
        }
        assert_eq!(Sample::parse(&Sample::header()), None);
    }

    #[test]
    fn every_sample_is_in_one_cell_of_each_axis() {
        let range = [0.8, 1.2];
        assert_eq!(
            [0.8, 0.85, 0.95, 1.05, 1.15, 1.2].map(|x| bin(x, range)),
            [0, 0, 1, 2, 3, 3].map(Some)
        );
        let samples: Vec<Sample> = (0..8)
            .map(|i| {
                let outcome = if i < 6 { "target" } else { "stand.upright" };
                sample(i, 2.5 + 2.25 * i as f64, outcome)
            })
            .collect();
        let text = table(&samples);
        assert!(text.contains("all,,,,,,8,6,0.7500,"));
        assert!(text.contains("ground,2.0000,6.5000,,,,2,2,1.0000,"));
        assert!(text.contains("ground,15.5000,20.0000,,,,2,0,0.0000,"));
        assert!(text.contains("# failed: stand.upright 2"));
    }

    /// What is outside of the lab's range is no sample of its ends, and a cell without samples has no rate.
    #[test]
    fn a_sample_outside_of_the_cells_is_in_none() {
        for x in [0.79, 1.21, f64::NAN, f64::INFINITY] {
            assert_eq!(bin(x, [0.8, 1.2]), None, "{x}");
        }
        let samples = [1.0, 30.0].map(|ground| sample(0, ground, "target"));
        let text = table(&samples);
        assert!(text.contains("\nall,,,,,,2,2,1.0000,"), "{text}");
        let cells = text.lines().filter(|line| line.starts_with("ground,"));
        let cells: Vec<&str> = cells.collect();
        assert!(cells.len() > BINS && cells.iter().all(|line| line.ends_with(",0,0,,,")));
        assert!(grid(&samples).all(|(_, _, cell)| cell.is_empty()));
        assert!(table(&[]).contains("\nall,,,,,,0,0,,,\n"));
    }

    #[test]
    fn failures_are_counted_by_what_failed_first() {
        let samples: Vec<Sample> = ["target", "stand.feet_m", "stand.feet_m", "fault"]
            .map(|outcome| sample(0, 2.0, outcome))
            .into();
        let counts = Counts::of(&samples);
        assert_eq!((counts.samples, counts.on_target), (4, 1));
        assert_eq!(counts.failures(), "fault 1, stand.feet_m 2");
    }
}
