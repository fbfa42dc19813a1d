//! Reads the golden files that `tests/peers/golden.py` writes, whose docstring defines the format.

#![allow(
    clippy::panic,
    reason = "a broken golden file must fail the test that reads it"
)]

use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// One quantity: `rows` × `cols` numbers, row-major.
#[derive(Clone, Debug, Default)]
pub struct Matrix {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub cols: usize,
    /// The numbers, row by row.
    pub values: Vec<f64>,
}

impl Matrix {
    /// Element in row `i`, column `j`.
    #[must_use]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.values[i * self.cols + j]
    }

    /// The full symmetric matrix whose lower triangle, row by row, this column holds.
    #[must_use]
    pub fn symmetric(&self, n: usize) -> Self {
        assert_eq!(
            self.values.len(),
            n * (n + 1) / 2,
            "not a lower triangle of size {n}"
        );
        let lower = |i: usize, j: usize| self.values[i * (i + 1) / 2 + j];
        let values = (0..n * n)
            .map(|k| lower((k / n).max(k % n), (k / n).min(k % n)))
            .collect();
        Self {
            rows: n,
            cols: n,
            values,
        }
    }
}

/// Quantities by key.
#[derive(Clone, Debug, Default)]
pub struct Record(HashMap<String, Matrix>);

impl Record {
    /// The quantity `key`, if this record has it.
    #[must_use]
    pub fn find(&self, key: &str) -> Option<&Matrix> {
        self.0.get(key)
    }

    /// The quantity `key`; a missing one is a broken test.
    ///
    /// # Panics
    /// If the record has no such quantity.
    #[must_use]
    pub fn get(&self, key: &str) -> &Matrix {
        self.find(key)
            .unwrap_or_else(|| panic!("golden file has no `{key}`"))
    }

    /// The numbers of `key`.
    #[must_use]
    pub fn values(&self, key: &str) -> &[f64] {
        &self.get(key).values
    }

    /// The single number `key`.
    #[must_use]
    pub fn scalar(&self, key: &str) -> f64 {
        self.values(key)[0]
    }
}

/// A golden file: what holds for the robot, and its states.
#[derive(Clone, Debug, Default)]
pub struct Golden {
    /// Sizes, mass and frames of the robot.
    pub robot: Record,
    /// Random states and what Pinocchio says about them.
    pub states: Vec<Record>,
    /// Names of the joints, in the order of the velocity coordinates.
    pub joints: Vec<String>,
}

impl Golden {
    /// The robot's golden file of this repository, `a1` or `icub23`.
    ///
    /// # Panics
    /// If the file is missing or malformed.
    #[must_use]
    pub fn load(robot: &str) -> Self {
        Self::read(&directory().join(format!("{robot}.txt")))
    }

    /// A golden file anywhere.
    ///
    /// # Panics
    /// If the file is missing or malformed.
    #[must_use]
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut golden = Self::default();
        for line in text.lines() {
            if let Some(names) = line.strip_prefix("# joints: ") {
                golden.joints = names.split_whitespace().map(str::to_owned).collect();
            }
            if line.starts_with('#') || line.is_empty() {
                continue;
            }
            let (key, matrix) = parse_line(line).unwrap_or_else(|| panic!("malformed: {line}"));
            if key == "state" {
                golden.states.push(Record::default());
            }
            golden
                .states
                .last_mut()
                .unwrap_or(&mut golden.robot)
                .0
                .insert(key, matrix);
        }
        golden
    }

    /// Names of the frames whose placements and motions the file has.
    pub fn frames(&self) -> impl Iterator<Item = String> {
        let name = |key: &String| {
            let name = key.strip_prefix("frame.")?.strip_suffix(".joint")?;
            Some(name.to_owned())
        };
        self.robot.0.keys().filter_map(name)
    }

    /// Number of velocity coordinates.
    #[must_use]
    pub fn nv(&self) -> usize {
        self.robot.scalar("nv") as usize
    }
}

/// Where the golden files are.
#[must_use]
pub fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/golden")
}

fn parse_line(line: &str) -> Option<(String, Matrix)> {
    let mut words = line.split(' ');
    let key = words.next()?.to_owned();
    let rows = words.next()?.parse().ok()?;
    let cols = words.next()?.parse().ok()?;
    let values: Vec<f64> = words.map(str::parse).collect::<Result<_, _>>().ok()?;
    (values.len() == rows * cols).then_some((key, Matrix { rows, cols, values }))
}
