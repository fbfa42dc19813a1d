//! The table of measures: a line per task and simulator.

use super::subject::Cell;
use core::fmt::Write;
use jump_lab::verdict::Verdict;

/// As Markdown.
pub(super) fn table(cells: &[Cell]) -> String {
    let mut out = String::from(
        "| task | simulator | flight: m, deg | stand: feet m, heading deg, height m, rotation deg | saturation ms: push-off, flight, landing \
         | stops ms | too fast ms | ground, weights (10 ms mean) | touched | verdict |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for cell in cells {
        let measures = cell
            .verdict
            .as_ref()
            .map_or_else(|_| " | | | | | |".to_owned(), measures);
        let _ = writeln!(
            out,
            "| `{}` | {} | {measures} | {} |",
            cell.task,
            cell.sim.name(),
            cell.words()
        );
    }
    let good = cells.iter().filter(|cell| cell.on_target()).count();
    let _ = writeln!(out, "\n{good} of {} on target", cells.len());
    out
}

/// The measures of one verdict, cell by cell.
fn measures(verdict: &Verdict) -> String {
    let none = || "none".to_owned();
    let flight = verdict
        .flight
        .map_or_else(none, |f| format!("{:.3}, {:.1}", f.position, f.rotation));
    let stand = verdict.stand.map_or_else(none, |s| {
        let fell = if s.upright { "" } else { "fell: " };
        format!(
            "{fell}{:.3}, {:.1}, {:.3}, {:.1}",
            s.feet, s.heading, s.height, s.rotation
        )
    });
    let h = &verdict.hardware;
    let [push_off, air, landing] = h.saturation.map(|x| 1e3 * x);
    let touched = if h.touched.is_empty() {
        "nothing".to_owned()
    } else {
        h.touched.join(", ")
    };
    format!(
        "{flight} | {stand} | {push_off:.1}, {air:.1}, {landing:.1} | {:.1} | {:.1} | {:.1} | {touched}",
        1e3 * h.stop_time,
        1e3 * h.overspeed,
        h.ground_force
    )
}
