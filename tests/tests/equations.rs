//! The index of equations names what exists, in files that cite the equation, and tests that execute it, and leaves none out.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const PAPER_A: &[&str] = &[
    "1a", "1b", "1c", "2", "2a", "2b", "2c", "2d", "3", "4", "5", "6", "7",
];
const PAPER_B: &[&str] = &[
    "1", "2", "3a", "3b", "3c", "3d", "3e", "4", "5", "6a", "6b", "6c", "6d", "6e", "6f",
];

/// Item and path of every link in a cell, `[`item`](path)`.
fn links(cell: &str) -> Vec<(&str, &str)> {
    let mut found = Vec::new();
    for part in cell.split("[`").skip(1) {
        let (item, rest) = part.split_once("`](").unwrap();
        found.push((item, rest.split_once(')').unwrap().0));
    }
    found
}

#[test]
fn every_equation_has_its_code() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let index = fs::read_to_string(docs.join("EQUATIONS.md")).unwrap();
    let (_, papers) = index.split_once("## Paper A").unwrap();
    let (a, b) = papers.split_once("## Paper B").unwrap();
    for (paper, text, equations) in [("paper a", a, PAPER_A), ("paper b", b, PAPER_B)] {
        let mut seen = BTreeSet::new();
        for row in text.lines().filter(|line| line.starts_with("| (")) {
            let cells: Vec<&str> = row.split('|').map(str::trim).collect();
            let equation = cells[1].trim_matches(['(', ')']);
            assert!(seen.insert(equation), "{paper} ({equation}) twice");
            let code = links(cells[3]);
            assert!(!code.is_empty(), "{paper} ({equation}) has no code");
            let tests = links(cells[4]);
            assert!(
                !tests.is_empty(),
                "{paper} ({equation}) is executed by no test"
            );
            for (test, path) in tests {
                let source = fs::read_to_string(docs.join(path)).unwrap();
                let (before, _) = source.split_once(&format!("fn {test}(")).unwrap();
                let marked = before
                    .trim_end()
                    .lines()
                    .rev()
                    .take(3)
                    .any(|line| line.trim() == "#[test]");
                assert!(
                    marked || before.contains("proptest!"),
                    "{test} in {path} is no test"
                );
            }
            for (item, path) in code {
                let source = fs::read_to_string(docs.join(path)).unwrap();
                let is_defined = ["fn ", "struct ", "enum "]
                    .iter()
                    .any(|kind| source.contains(&format!("{kind}{item}")));
                assert!(is_defined, "{item} is not in {path}");
                let cited = source.to_lowercase().contains(paper);
                assert!(cited, "{path} does not cite {paper}");
                let number = format!("({equation})");
                assert!(
                    source.contains(&number),
                    "{path} does not cite ({equation})"
                );
            }
        }
        let all: BTreeSet<&str> = equations.iter().copied().collect();
        assert_eq!(seen, all, "{paper}");
    }
}

#[test]
fn links_outside_the_tables_lead_somewhere() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let index = fs::read_to_string(docs.join("EQUATIONS.md")).unwrap();
    for part in index.split("](").skip(1) {
        let path = part.split_once(')').unwrap().0;
        assert!(docs.join(path).exists(), "{path}");
    }
}
