//! The gallery of `saltus verdicts --out`: a folder with the report of every run, and a page of all tasks with their pictures.

use super::subject::Cell;
use crate::cmd::failure::Failure;
use crate::cmd::folder::{create, describe, write};
use crate::report::escape;
use core::fmt::Write;
use jump_lab::Sim;
use jump_lab::verdict::Verdict;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

const STYLE: &str = include_str!("../../../assets/page.css");

/// The folder while it fills.
pub(super) struct Gallery {
    folder: PathBuf,
    /// Names of the tasks' folders, without the simulator.
    names: BTreeMap<String, String>,
}

/// What is kept of a run beside its report.
pub(super) struct Kept {
    /// Its folder in the gallery.
    name: String,
    /// The jump in one picture, as SVG.
    strip: String,
}

/// A row of a card: what it is, and how it stands in a verdict.
type Number = (&'static str, fn(&Verdict) -> Option<String>);

const NUMBERS: [Number; 5] = [
    ("off the plan at touchdown", |v| {
        let flight = v.flight?;
        Some(format!("{:.3} m, {:.1}°", flight.position, flight.rotation))
    }),
    ("feet off the goal", |v| {
        Some(format!("{:.3} m", v.stand?.feet))
    }),
    ("turned in the end", |v| {
        Some(format!("{:.1}°", v.stand?.rotation))
    }),
    ("ground, 10 ms mean", |v| {
        Some(format!("{:.1} weights", v.hardware.ground_force))
    }),
    ("fastest joint", |v| {
        Some(format!("{:.1} rad/s", v.hardware.peak_speed))
    }),
];

impl Gallery {
    /// A new folder for the runs of these tasks.
    pub(super) fn create(folder: &Path, tasks: &[String]) -> Result<Self, Failure> {
        Ok(Self {
            folder: create(Some(folder), "gallery")?,
            names: names(tasks),
        })
    }

    /// Writes the report of a run and its picture.
    pub(super) fn keep(
        &self,
        task: &str,
        sim: Sim,
        report: &str,
        strip: String,
    ) -> Result<Kept, Failure> {
        let own = self.names.get(task).map_or(task, String::as_str);
        let name = format!("{own}-{}", sim.name());
        let folder = self.folder.join(&name);
        fs::create_dir(&folder).map_err(|error| Failure::Outside(describe(&folder, &error)))?;
        write(&folder, "report.html", report.as_bytes())?;
        write(&folder, "strip.svg", strip.as_bytes())?;
        Ok(Kept { name, strip })
    }

    /// Writes the page, and the verdicts as they are told in JSON; where it is.
    pub(super) fn finish(&self, cells: &[Cell], verdicts: &Value) -> Result<PathBuf, Failure> {
        write(
            &self.folder,
            "gallery.json",
            format!("{verdicts:#}\n").as_bytes(),
        )?;
        write(&self.folder, "index.html", page(cells).as_bytes())?;
        Ok(self.folder.join("index.html"))
    }
}

/// A folder's name for every task: a file is known by its own name, and two of one name are numbered.
fn names(tasks: &[String]) -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    for task in tasks {
        let file = Path::new(task)
            .file_stem()
            .filter(|_| task.ends_with(".toml"));
        let short = file.map_or_else(|| task.clone(), |name| name.to_string_lossy().into_owned());
        let short = short.replace(['/', '\\'], "-");
        let taken = |name: &String| out.values().any(|known| known == name);
        let numbered = (2..).map(|i| format!("{short}-{i}"));
        let name = core::iter::once(short.clone())
            .chain(numbered)
            .find(|name| !taken(name));
        out.insert(task.clone(), name.unwrap_or(short));
    }
    out
}

/// The page: a card per task, with what each simulator says.
fn page(cells: &[Cell]) -> String {
    let good = cells.iter().filter(|cell| cell.on_target()).count();
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Gallery of jumps</title><style>{STYLE}</style></head>\n<body class=\"gallery\"><h1>Gallery of jumps</h1>\n\
         <p>{good} of {} runs are on target: flown as planned, standing where they should, hardware within its budgets. A picture shows a jump from before \
         its take-off to after its landing; a verdict leads to the report, where it moves. <code>saltus watch FOLDER FOLDER</code> shows runs side by side.</p>\n",
        cells.len()
    );
    for runs in cells.chunk_by(|a, b| a.task == b.task) {
        card(&mut out, runs);
    }
    out + "</body></html>\n"
}

/// One task.
fn card(out: &mut String, runs: &[Cell]) {
    let Some(first) = runs.first() else { return };
    let _ = writeln!(
        out,
        "<section class=\"card\"><h2>{}</h2>",
        escape(&first.task)
    );
    let shown = runs.iter().find_map(|run| run.kept.as_ref());
    if let Some(kept) = shown {
        let _ = writeln!(
            out,
            "<a class=\"strip\" href=\"{}/report.html\">{}</a>",
            escape(&kept.name),
            kept.strip
        );
    }
    out.push_str("<div class=\"scroll\"><table><tr><th></th>");
    for run in runs {
        let _ = write!(out, "<th>{}</th>", run.sim.name());
    }
    out.push_str("</tr>\n<tr><td>verdict</td>");
    for run in runs {
        let mark = if run.on_target() { "good" } else { "bad" };
        let words = escape(&run.sentence());
        let _ = match &run.kept {
            Some(kept) => {
                let name = escape(&kept.name);
                write!(
                    out,
                    "<td class=\"{mark}\"><a href=\"{name}/report.html\">{words}</a></td>"
                )
            }
            None => write!(out, "<td class=\"{mark}\">{words}</td>"),
        };
    }
    out.push_str("</tr>\n");
    for (name, number) in NUMBERS {
        let numbers = runs
            .iter()
            .map(|run| run.verdict.as_ref().ok().and_then(number));
        let numbers: Vec<Option<String>> = numbers.collect();
        if numbers.iter().any(Option::is_some) {
            let cells = numbers
                .iter()
                .map(|number| number.as_deref().unwrap_or("–"));
            let cells: Vec<&str> = cells.collect();
            let _ = writeln!(
                out,
                "<tr><td>{name}</td><td>{}</td></tr>",
                cells.join("</td><td>")
            );
        }
    }
    out.push_str("</table></div></section>\n");
}

#[cfg(test)]
mod tests {
    use super::{names, page};
    use crate::cmd::verdicts::subject::Cell;
    use jump_lab::Sim;

    #[test]
    fn every_task_has_a_folder_of_its_own() {
        let tasks = ["a1/lateral", "a/b.toml", "c/b.toml"].map(str::to_owned);
        let names = names(&tasks);
        let of = |task: &str| names.get(task).map(String::as_str);
        assert_eq!(of("a1/lateral"), Some("a1-lateral"));
        assert_eq!([of("a/b.toml"), of("c/b.toml")], [Some("b"), Some("b-2")]);
    }

    /// A task without a plan has a card too, with the reason and no link.
    #[test]
    fn a_task_without_a_run_is_told() {
        let cell = |sim| Cell {
            task: "my <task>".to_owned(),
            sim,
            verdict: Err("no plan".to_owned()),
            kept: None,
        };
        let page = page(&[cell(Sim::Native), cell(Sim::MUJOCO)]);
        assert!(page.contains("<h2>my &lt;task></h2>") && page.contains("no plan"));
        assert!(page.contains("0 of 2 runs") && !page.contains("<a "));
        assert_eq!(page.matches("class=\"card\"").count(), 1);
    }
}
