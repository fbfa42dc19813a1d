//! The file of expected verdicts: how each task ends in each simulator, and what each item of the papers comes out as. A jump that ends
//! otherwise, better or worse, is a change that somebody has to look at and write down.

use super::folder::describe;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The file's tables.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    /// Task, then simulator, then what fails first, or `target`.
    verdicts: BTreeMap<String, BTreeMap<String, String>>,
    /// Item of a paper, then simulator or `any`, then `yes`, `NO` or `unjudged`.
    papers: BTreeMap<String, BTreeMap<String, String>>,
}

/// The file.
pub(crate) struct Expected {
    path: PathBuf,
    tables: Tables,
}

/// Something that came out.
pub(crate) struct Found {
    /// Task or item.
    pub(crate) name: String,
    /// Simulator, or `any` for what needs none.
    pub(crate) sim: String,
    /// The word that is compared.
    pub(crate) outcome: String,
    /// What to tell people if it differs.
    pub(crate) words: String,
}

impl Expected {
    /// Reads the file.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let show = |error: &dyn core::fmt::Display| format!("{}: {error}", path.display());
        let text = jump_planner::file::read_text(path).map_err(|error| describe(path, &error))?;
        Ok(Self {
            path: path.to_owned(),
            tables: toml::from_str(&text).map_err(|error| {
                show(&format!(
                    "{error}: it must be like jump-planner/tasks/expected.toml"
                ))
            })?,
        })
    }

    /// The tasks as they are run: files are seen from the file of expected verdicts.
    pub(crate) fn tasks(&self) -> Vec<String> {
        self.tables
            .verdicts
            .keys()
            .map(|name| self.seen(name))
            .collect()
    }

    /// A task that is a file, from where the program runs.
    fn seen(&self, name: &str) -> String {
        if !name.ends_with(".toml") {
            return name.to_owned();
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        folder.join(name).display().to_string()
    }

    /// Names every verdict that is not as expected.
    pub(crate) fn compare_verdicts(&self, found: &[Found]) -> ExitCode {
        let expected = self.tables.verdicts.iter();
        tell(expected.map(|(name, sims)| (self.seen(name), sims)), found)
    }

    /// Names every item of the papers that does not come out as expected.
    pub(crate) fn compare_papers(&self, found: &[Found]) -> ExitCode {
        let expected = self.tables.papers.iter();
        tell(expected.map(|(name, sims)| (name.clone(), sims)), found)
    }
}

/// Prints what differs; exit code 2 if anything does.
fn tell<'a>(
    expected: impl Iterator<Item = (String, &'a BTreeMap<String, String>)>,
    found: &[Found],
) -> ExitCode {
    let wrong = differences(expected, found);
    for line in &wrong {
        tell!("saltus: {line}");
    }
    ExitCode::from(if wrong.is_empty() { 0 } else { 2 })
}

/// What differs, a line each: other outcomes, what nobody expected, and what did not come. A simulator that was not run at all is not
/// asked for.
fn differences<'a>(
    expected: impl Iterator<Item = (String, &'a BTreeMap<String, String>)>,
    found: &[Found],
) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut known = Vec::new();
    for (name, sims) in expected {
        for (sim, outcome) in sims {
            known.push((name.clone(), sim.clone()));
            match found.iter().find(|f| f.name == name && f.sim == *sim) {
                Some(f) if f.outcome == *outcome => {}
                Some(f) => {
                    wrong.push(format!(
                        "{name} in {sim}: {outcome} is expected, found {}",
                        f.words
                    ));
                }
                None if found.iter().any(|f| f.sim == *sim) => {
                    wrong.push(format!(
                        "{name} in {sim}: {outcome} is expected, and it was not run"
                    ));
                }
                None => {}
            }
        }
    }
    let new = found.iter().filter(|f| {
        !known
            .iter()
            .any(|(name, sim)| *name == f.name && *sim == f.sim)
    });
    wrong.extend(new.map(|f| {
        format!(
            "{} in {}: nothing is expected, found {}",
            f.name, f.sim, f.words
        )
    }));
    wrong
}

#[cfg(test)]
mod tests {
    use super::{Found, differences};
    use std::collections::BTreeMap;

    fn found(name: &str, sim: &str, outcome: &str) -> Found {
        Found {
            name: name.to_owned(),
            sim: sim.to_owned(),
            outcome: outcome.to_owned(),
            words: outcome.to_owned(),
        }
    }

    #[test]
    fn every_difference_is_named() {
        let sims = BTreeMap::from([("native", "target"), ("mujoco", "fault")]);
        let sims: BTreeMap<String, String> = sims
            .into_iter()
            .map(|(sim, word)| (sim.to_owned(), word.to_owned()))
            .collect();
        let expected = || core::iter::once(("a1/spin".to_owned(), &sims));
        let check = |found: &[Found]| differences(expected(), found);
        let good = [
            found("a1/spin", "native", "target"),
            found("a1/spin", "mujoco", "fault"),
        ];
        assert!(check(&good).is_empty());
        // A build without MuJoCo compares what it has.
        assert!(check(&good[..1]).is_empty());
        let worse = check(&[found("a1/spin", "native", "stand.feet_m")]);
        assert!(
            worse.len() == 1 && worse[0].contains("a1/spin in native"),
            "{worse:?}"
        );
        assert_eq!(check(&[found("a1/roll", "native", "target")]).len(), 2);
    }
}
