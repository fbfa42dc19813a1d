//! No robot is under its ground: neither by the numbers of the page, nor by what it draws.

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use super::panes;
use super::picture::Picture;
use crate::devtools::Browser;

/// How deep the lowest point of a robot may be drawn under the ground, m: the radius of A1's foot, less than which the simulators' contacts
/// give way by far.
const DEEPEST: f64 = 0.02;
/// Times of a run at which its picture is looked at, as shares of it.
const LOOKS: [f64; 5] = [0.1, 0.35, 0.5, 0.6, 0.95];
/// Fewest pixels of a robot that is seen along its floor.
const ROBOT: usize = 300;
/// Most pixels under the floor: none.
const UNDER: usize = 0;
/// By how much a robot is sunk to see whether that is noticed, m.
const SUNK: f64 = 0.1;

/// What is wrong in one pane.
#[derive(Default)]
struct Found {
    by_numbers: Option<String>,
    by_pixels: Option<String>,
}

/// Fails where a robot is under the ground.
pub(super) fn check(browser: &mut Browser) -> Result<()> {
    for (pane, found) in look(browser)?.into_iter().enumerate() {
        let wrong = found.by_numbers.or(found.by_pixels);
        ensure!(
            wrong.is_none(),
            "pane {pane}: {}",
            wrong.unwrap_or_default()
        );
    }
    Ok(())
}

/// Sinks every robot and fails where [`check`] would not notice, by its numbers and by its pixels.
pub(super) fn check_notices(browser: &mut Browser) -> Result<()> {
    let sink = |by: f64| {
        format!("SALTUS.runs.forEach(run => {{ run.stage.body.group.position.z -= {by}; }})")
    };
    browser.ask(&sink(SUNK))?;
    for (pane, found) in look(browser)?.into_iter().enumerate() {
        let noticed = [found.by_numbers.is_some(), found.by_pixels.is_some()];
        ensure!(
            noticed == [true, true],
            "pane {pane}: a robot {SUNK} m under its floor is noticed by numbers, pixels: {noticed:?}"
        );
    }
    browser.ask(&sink(-SUNK))?;
    Ok(())
}

/// Looks at every pane.
fn look(browser: &mut Browser) -> Result<Vec<Found>> {
    let depths = browser.ask("SALTUS.depths()")?;
    let depths = depths.as_array().context("no depths")?;
    let mut out: Vec<Found> = depths.iter().map(by_numbers).collect::<Result<_>>()?;
    let panes = panes(browser)?;
    ensure!(panes.len() == out.len(), "panes without a run");
    // A robot high over its floor is not in the picture; on it, it is.
    let mut most = vec![0; out.len()];
    for share in LOOKS {
        browser.ask(&format!("SALTUS.alongFloor({share}, {DEEPEST})"))?;
        let picture = Picture::read(&browser.picture()?)?;
        let robots = out.iter_mut().zip(&mut most).zip(&panes);
        for ((found, most), [left, top, right, bottom]) in robots {
            // The line of the floor is in the middle; frames and labels stay out.
            let middle = (top + bottom) / 2;
            let upper = picture.part([left + 4, top + 40, right - 4, middle - 1]);
            let lower = picture.part([left + 4, middle + 2, right - 4, bottom - 4]);
            *most = upper.drawn().max(*most);
            if lower.drawn() > UNDER {
                let at = 100.0 * share;
                let pixels = lower.drawn();
                found.by_pixels = Some(format!(
                    "{pixels} pixels under the floor at {at} % of the run"
                ));
            }
        }
    }
    for (pane, most) in most.iter().enumerate() {
        let seen = out.get(pane).is_some_and(|found| found.by_pixels.is_some());
        ensure!(
            *most >= ROBOT || seen,
            "pane {pane}: {most} pixels of a robot along its floor"
        );
    }
    Ok(out)
}

/// What the page's own geometry says.
fn by_numbers(worst: &Value) -> Result<Found> {
    let depth = worst["depth"].as_f64().context("no depth")?;
    // A page that looks at nothing would be content.
    ensure!(
        depth > -DEEPEST,
        "the robot never comes down to the ground: {depth} m"
    );
    let wrong = (depth > DEEPEST).then(|| {
        format!(
            "{depth:.4} m under the ground at {} s, {DEEPEST} are allowed",
            worst["time"]
        )
    });
    Ok(Found {
        by_numbers: wrong,
        by_pixels: None,
    })
}
