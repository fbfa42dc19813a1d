//! Rates of success with their confidence, by cells of what was disturbed.

use super::execute::Run;
use super::judge::Verdict;
use super::plant::Disturbance;
use core::fmt::Write;

/// Intervals per disturbance.
const BINS: usize = 4;

/// One disturbance: name, value in a sample, range.
type Axis = (&'static str, fn(&Sample) -> f64, [f64; 2]);

/// The disturbances whose cells are counted, relative to nominal, with the ranges of [`Disturbance::draw`].
const AXES: [Axis; 4] = [
    ("friction", |s| s.values[0], [0.8, 1.2]),
    ("mass", |s| s.values[1], [0.95, 1.05]),
    ("rotors", |s| s.values[2], [0.7, 1.3]),
    ("joint_friction", |s| s.values[3], [0.7, 1.3]),
];

/// What an [`outcome`](Sample) is where the target is met.
const TARGET: &str = "target";
/// Why a run is not on target, gravest first.
pub(crate) const CAUSES: [&str; 6] = ["fault", "no_touchdown", "fell", "trunk", "place", "heading"];
/// Place that counts as near, m.
const NEAR: f64 = 0.20;

/// One run of a study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sample {
    pub(crate) index: u64,
    seed: u64,
    /// Ground friction, mass, rotor inertia and joint friction, relative to nominal.
    values: [f64; 4],
    position_error: f64,
    orientation_error: f64,
    /// `target`, or why not: the first of [`CAUSES`] that holds.
    outcome: String,
}

impl Sample {
    /// Names of the columns.
    pub(crate) const HEADER: &str = "index,seed,friction,mass,rotors,joint_friction,position_error_m,orientation_error_deg,outcome";

    pub(crate) fn new(
        index: u64,
        seed: u64,
        disturbance: &Disturbance,
        run: &Run,
        verdict: &Verdict,
    ) -> Self {
        let holds = [
            run.fault.is_some(),
            run.first_contact.is_none(),
            !(verdict.landed && verdict.upright),
            !verdict.trunk_is_right,
            verdict.position_error > 0.10,
            !verdict.on_target(),
        ];
        let mut causes = CAUSES.into_iter().zip(holds);
        let outcome = causes.find_map(|(cause, holds)| holds.then_some(cause));
        Self {
            index,
            seed,
            values: [
                disturbance.friction / Disturbance::NOMINAL.friction,
                disturbance.mass,
                disturbance.rotors,
                disturbance.joint_friction,
            ],
            position_error: verdict.position_error,
            orientation_error: verdict.orientation_error,
            outcome: outcome.unwrap_or(TARGET).to_owned(),
        }
    }

    /// As a line of the file.
    pub(crate) fn line(&self) -> String {
        let [a, b, c, d] = self.values;
        format!(
            "{},{},{a:.6},{b:.6},{c:.6},{d:.6},{:.6},{:.4},{}",
            self.index, self.seed, self.position_error, self.orientation_error, self.outcome
        )
    }

    /// The way back from [`Sample::line`]; `None` for headings and broken lines.
    pub(crate) fn parse(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.split(',').collect();
        let [index, seed, a, b, c, d, place, turn, outcome] = cells[..] else {
            return None;
        };
        let number = |text: &str| text.parse::<f64>().ok();
        (outcome == TARGET || CAUSES.contains(&outcome)).then_some(())?;
        Some(Self {
            index: index.parse().ok()?,
            seed: seed.parse().ok()?,
            values: [number(a)?, number(b)?, number(c)?, number(d)?],
            position_error: number(place)?,
            orientation_error: number(turn)?,
            outcome: outcome.to_owned(),
        })
    }

    pub(crate) fn good(&self) -> bool {
        self.outcome == TARGET
    }

    /// As [`Sample::good`], but within 0.20 m.
    fn near(&self) -> bool {
        let placed = self.outcome == "place" && self.position_error <= NEAR;
        self.good() || placed && self.orientation_error <= 10.0
    }
}

/// Samples counted.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Counts {
    pub(crate) samples: usize,
    pub(crate) on_target: usize,
    /// On target but for a place within 0.20 m.
    pub(crate) near: usize,
    /// Those not on target, by [`CAUSES`].
    pub(crate) failed: [usize; CAUSES.len()],
}

impl Counts {
    pub(crate) fn of(samples: &[Sample]) -> Self {
        let count = |is: &dyn Fn(&Sample) -> bool| samples.iter().filter(|s| is(s)).count();
        Self {
            samples: samples.len(),
            on_target: count(&Sample::good),
            near: count(&Sample::near),
            failed: CAUSES.map(|cause| count(&|s| s.outcome == cause)),
        }
    }

    /// Causes with the number of their samples, without those that have none.
    pub(crate) fn causes(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let causes = CAUSES.into_iter().zip(self.failed);
        causes.filter(|(_, count)| *count > 0)
    }

    /// Causes for people: `place 3, fell 1`.
    pub(crate) fn failures(&self) -> String {
        let words: Vec<String> = self
            .causes()
            .map(|(name, n)| format!("{name} {n}"))
            .collect();
        words.join(", ")
    }
}

/// Wilson's 95 % interval of a rate of `good` in `count`; [0, 1] where nothing was tried.
pub(crate) fn wilson(good: usize, count: usize) -> [f64; 2] {
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

/// Which of the equal parts of the range a value lies in.
fn bin(value: f64, [low, high]: [f64; 2]) -> usize {
    let share = (value - low) / (high - low) * BINS as f64;
    (share.max(0.0) as usize).min(BINS - 1)
}

fn edges([low, high]: [f64; 2], bin: usize) -> [f64; 2] {
    let width = (high - low) / BINS as f64;
    [low + width * bin as f64, low + width * (bin + 1) as f64]
}

/// All samples, then the cells of each disturbance, then those of friction and mass together; then failures by cause.
pub(crate) fn table(samples: &[Sample]) -> String {
    let mut out =
        String::from("cell,from,to,cell2,from2,to2,samples,on_target,rate,low95,high95\n");
    let mut row = |name: &str, cell: &[&Sample]| {
        let good = cell.iter().filter(|s| s.good()).count();
        let [low, high] = wilson(good, cell.len());
        let rate = good as f64 / cell.len().max(1) as f64;
        let _ = writeln!(
            out,
            "{name},{},{good},{rate:.4},{low:.4},{high:.4}",
            cell.len()
        );
    };
    row("all,,,,,", &samples.iter().collect::<Vec<_>>());
    for (name, value, range) in AXES {
        for k in 0..BINS {
            let cell: Vec<&Sample> = samples
                .iter()
                .filter(|s| bin(value(s), range) == k)
                .collect();
            let [from, to] = edges(range, k);
            row(&format!("{name},{from:.4},{to:.4},,,"), &cell);
        }
    }
    for (i, j, cell) in grid(samples) {
        let ([f0, f1], [m0, m1]) = (edges(AXES[0].2, i), edges(AXES[1].2, j));
        let name = format!("friction,{f0:.4},{f1:.4},mass,{m0:.4},{m1:.4}");
        row(&name, &cell);
    }
    for (cause, count) in Counts::of(samples).causes() {
        let _ = writeln!(out, "# failed: {cause} {count}");
    }
    out
}

/// Cells of friction and mass.
fn grid(samples: &[Sample]) -> impl Iterator<Item = (usize, usize, Vec<&Sample>)> {
    (0..BINS).flat_map(move |i| {
        (0..BINS).map(move |j| {
            let inside = |s: &&Sample| {
                bin((AXES[0].1)(s), AXES[0].2) == i && bin((AXES[1].1)(s), AXES[1].2) == j
            };
            (i, j, samples.iter().filter(inside).collect())
        })
    })
}

/// Cells of friction and mass as a picture: darker is better, with the rate and the number of samples.
pub(crate) fn picture(samples: &[Sample], title: &str) -> String {
    let side = 90;
    let (left, top) = (90, 50);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <text x=\"10\" y=\"20\">{}</text>\n",
        left + side * BINS + 20,
        top + side * BINS + 60,
        title.trim_start_matches("# ")
    );
    for (i, j, cell) in grid(samples) {
        let good = cell.iter().filter(|s| s.good()).count();
        let rate = good as f64 / cell.len().max(1) as f64;
        let (x, y) = (left + side * i, top + side * (BINS - 1 - j));
        let (fill, text) = if cell.is_empty() {
            ("#ffffff".to_owned(), "none".to_owned())
        } else {
            let light = (235.0 - 150.0 * rate) as u8;
            let fill = format!("#{light:02x}e0{light:02x}");
            (fill, format!("{:.0} % of {}", 100.0 * rate, cell.len()))
        };
        let _ = writeln!(
            out,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{side}\" height=\"{side}\" fill=\"{fill}\" stroke=\"#888\"/>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
            x + side / 2,
            y + side / 2 + 5
        );
    }
    for k in 0..=BINS {
        let at = |[low, high]: [f64; 2]| low + (high - low) * k as f64 / BINS as f64;
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{:.2}</text><text x=\"{}\" y=\"{}\" text-anchor=\"end\">{:.3}</text>",
            left + side * k,
            top + side * BINS + 20,
            at(AXES[0].2),
            left - 6,
            top + side * (BINS - k) + 5,
            at(AXES[1].2)
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\">friction, relative</text><text x=\"10\" y=\"{}\">mass</text>\n</svg>",
        left,
        top + side * BINS + 44,
        top - 10
    );
    out
}

#[cfg(test)]
mod tests {
    use super::{Counts, Sample, bin, table, wilson};

    fn sample(index: u64, friction: f64, outcome: &str) -> Sample {
        Sample {
            index,
            seed: 9,
            values: [friction, 1.0, 1.0, 1.0],
            position_error: 0.012,
            orientation_error: 1.5,
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
        let one = sample(3, 0.9, "target");
        assert_eq!(Sample::parse(&one.line()), Some(one.clone()));
        let line = one.line();
        for cut in 1..line.len() {
            assert_eq!(Sample::parse(&line[..cut]), None, "{}", &line[..cut]);
        }
        assert_eq!(Sample::parse(Sample::HEADER), None);
    }

    #[test]
    fn every_sample_is_in_one_cell_of_each_axis() {
        let range = [0.8, 1.2];
        assert_eq!(
            [0.8, 0.85, 0.95, 1.05, 1.15, 1.2].map(|x| bin(x, range)),
            [0, 0, 1, 2, 3, 3]
        );
        let samples: Vec<Sample> = (0..8)
            .map(|i| {
                let outcome = if i < 6 { "target" } else { "fell" };
                sample(i, 0.81 + 0.05 * i as f64, outcome)
            })
            .collect();
        let text = table(&samples);
        assert!(text.contains("all,,,,,,8,6,0.7500,"));
        assert!(text.contains("friction,0.8000,0.9000,,,,2,2,1.0000,"));
        assert!(text.contains("friction,1.1000,1.2000,,,,2,0,0.0000,"));
        assert!(text.contains("# failed: fell 2"));
    }

    #[test]
    fn failures_are_counted_by_cause_and_near_ones_apart() {
        let mut samples: Vec<Sample> = ["target", "place", "place", "place", "fell", "trunk"]
            .map(|outcome| sample(0, 1.0, outcome))
            .into();
        samples[1].position_error = 0.15;
        samples[2].position_error = 0.25;
        (samples[3].position_error, samples[3].orientation_error) = (0.15, 12.0);
        let counts = Counts::of(&samples);
        assert_eq!((counts.samples, counts.on_target, counts.near), (6, 1, 2));
        assert_eq!(counts.failures(), "fell 1, trunk 1, place 3");
    }
}
