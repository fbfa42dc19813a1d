//! `cargo xtask report`: reports, comparisons and the gallery, looked at with a real browser.
//!
//! Chromium opens the files and presses their buttons. The animation waits where the address asks for, plays when `Play` is clicked and
//! stops when `Pause` is; every pane shows something and changes while time goes on, no robot is under its ground, one that is sunk on
//! purpose is noticed, and the pages say nothing on their consoles.

mod gallery;
mod ground;
mod picture;

use core::time::Duration;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use picture::{Picture, Place};

use crate::devtools::Browser;
use crate::{mujoco, run};

/// The window, pixels.
const WINDOW: [u32; 2] = [1200, 900];
/// Time at which a page is opened, on its own clock: a report's is zero at the push-off, a comparison's at the take-off, s.
const BEGIN: f64 = 0.0;
/// Time that playing must reach, from the take-off, s.
const FLYING: f64 = 0.1;
/// Longest time for that: software renders slowly.
const PLAYING: Duration = Duration::from_secs(60);
/// Fewest colours of a pane that shows something.
const COLORS: usize = 100;
/// Fewest pixels that an animation changes in a pane between the two.
const MOVED: usize = 300;
/// Tasks of the gallery that is made here: a floor, a box, a humanoid.
const TASKS: [&str; 3] = ["a1/lateral", "a1/barrel-roll-box", "icub/velocity"];

/// Arguments of `cargo xtask report`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// A report or a comparison to look at, and nothing else.
    html: Option<PathBuf>,
    /// The folder of a gallery with the tasks that are looked at, as `cargo xtask verdicts` leaves one; without it a small one is made.
    #[arg(long, conflicts_with = "html")]
    gallery: Option<PathBuf>,
    /// The browser.
    #[arg(long, env = "SALTUS_BROWSER", default_value = "chromium")]
    browser: PathBuf,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let folder = run::root().join("target/report-check");
    run::remove_folder(&folder)?;
    fs::create_dir_all(&folder)?;
    if !run::exists(&args.browser.to_string_lossy()) {
        run::install_debian(&["chromium"])?;
    }
    let start = || Browser::start(&args.browser, &folder.join("profile"), WINDOW);
    if let Some(html) = &args.html {
        let page = Page {
            html: whole(html)?,
            pictures: folder.join("page"),
            plays: true,
            sinks: true,
        };
        return page.check(&mut start()?);
    }
    let gallery = match &args.gallery {
        Some(gallery) => whole(gallery).context("`cargo xtask verdicts` makes a gallery")?,
        None => make(&folder)?,
    };
    let of = |name: &str| gallery.join(format!("{name}-native/report.html"));
    let compared = |name: &str| compare(&folder, &gallery, name);
    // What is common to pages is asked of some.
    let pages = [
        (of("a1-lateral"), true, true),
        (of("a1-barrel-roll-box"), false, false),
        (of("icub-velocity"), false, false),
        (compared("a1-lateral")?, true, false),
        (compared("icub-velocity")?, true, true),
    ];
    let mut browser = start()?;
    gallery::check(&mut browser, &gallery)?;
    for (i, (html, plays, sinks)) in pages.into_iter().enumerate() {
        let page = Page {
            html,
            pictures: folder.join(format!("page-{i}")),
            plays,
            sinks,
        };
        page.check(&mut browser)?;
    }
    Ok(())
}

fn whole(path: &Path) -> Result<PathBuf> {
    path.canonicalize()
        .with_context(|| path.display().to_string())
}

/// Runs some tasks in both simulators for their reports.
fn make(folder: &Path) -> Result<PathBuf> {
    let out = folder.join("gallery");
    let mut saltus = mujoco::saltus()?;
    saltus
        .arg("verdicts")
        .args(TASKS)
        .args(["--quiet", "--out"])
        .arg(&out);
    // Which of them are on target is not asked here.
    run::output(saltus.stderr(Stdio::inherit()))?;
    Ok(out)
}

/// Puts both simulators' runs of a task on one page.
fn compare(folder: &Path, gallery: &Path, name: &str) -> Result<PathBuf> {
    let out = folder.join(format!("{name}-compared"));
    let mut saltus = mujoco::saltus()?;
    saltus
        .args(["watch", "--no-open", "--quiet", "--out"])
        .arg(&out);
    for sim in ["native", "mujoco"] {
        saltus.arg(gallery.join(format!("{name}-{sim}")));
    }
    run::succeed(&mut saltus)?;
    Ok(out.join("comparison.html"))
}

/// Where the panes of a page are.
fn panes(browser: &mut Browser) -> Result<Vec<Place>> {
    Ok(serde_json::from_value(browser.ask("SALTUS.panes()")?)?)
}

/// Fails where the page has said something on its console.
fn silent(browser: &Browser) -> Result<()> {
    let said = browser.console();
    ensure!(said.is_empty(), "the page says on its console: {said:?}");
    Ok(())
}

/// What the page shows of time: the label of its button, and where it is, s.
fn clock(browser: &mut Browser) -> Result<(String, f64)> {
    let both = browser.ask(
        "[document.getElementById('play').textContent, +document.getElementById('scrub').value]",
    )?;
    let label = both[0].as_str().context("no button")?;
    Ok((label.to_owned(), both[1].as_f64().context("no time")?))
}

/// A page with one animation or several.
struct Page {
    html: PathBuf,
    /// How the names of its pictures begin.
    pictures: PathBuf,
    /// Whether its buttons are pressed.
    plays: bool,
    /// Whether its robots are sunk, to see that this is noticed.
    sinks: bool,
}

impl Page {
    /// Everything that is asked of it.
    fn check(&self, browser: &mut Browser) -> Result<()> {
        let start = Instant::now();
        let shown = self.html.display();
        let looked = self.look(browser);
        let told = looked
            .with_context(|| format!("{shown}, pictures at {}-*.png", self.pictures.display()))?;
        let seconds = start.elapsed().as_secs_f64();
        println!("{shown}: {told}, nothing under the ground, {seconds:.1} s");
        Ok(())
    }

    /// The same, and what there was to see.
    fn look(&self, browser: &mut Browser) -> Result<String> {
        browser.open(&format!("file://{}#t={BEGIN}", self.html.display()))?;
        let mut told = self.waits(browser)?;
        if self.plays {
            told = format!("{told}, {}", self.play(browser)?);
        }
        ground::check(browser)?;
        if self.sinks {
            ground::check_notices(browser)?;
        }
        silent(browser)?;
        Ok(told)
    }

    /// A picture of every pane, kept as one file.
    fn pictures(&self, browser: &mut Browser, what: &str) -> Result<Vec<Picture>> {
        let png = browser.picture()?;
        fs::write(format!("{}-{what}.png", self.pictures.display()), &png)?;
        let whole = Picture::read(&png)?;
        let panes = panes(browser)?;
        ensure!(!panes.is_empty(), "no panes");
        Ok(panes.into_iter().map(|place| whole.part(place)).collect())
    }

    /// The page waits where its address says, and every pane shows something.
    fn waits(&self, browser: &mut Browser) -> Result<String> {
        let (label, begin) = clock(browser)?;
        ensure!(
            label == "Play" && (begin - BEGIN).abs() < 1e-3,
            "at #t={BEGIN} the page shows `{label}` at {begin} s"
        );
        let panes = self.pictures(browser, "waits")?;
        let colors: Vec<usize> = panes.iter().map(Picture::colors).collect();
        for (pane, colors) in colors.iter().enumerate() {
            ensure!(
                *colors >= COLORS,
                "pane {pane} shows nothing: {colors} colours"
            );
        }
        let (_, still) = clock(browser)?;
        ensure!(
            still == begin,
            "the animation does not wait: {begin} to {still} s"
        );
        Ok(format!("{colors:?} colours"))
    }

    /// Lets the page play and stops it.
    fn play(&self, browser: &mut Browser) -> Result<String> {
        let before = self.pictures(browser, "waits")?;
        // Where its clock is at the take-off is the page's to tell.
        let takeoff = browser.ask("SALTUS.runs[0].takeoff - SALTUS.runs[0].zero")?;
        let takeoff = takeoff.as_f64().context("no take-off")?;
        // A quarter of the speed would take as many more pictures of a slow machine.
        browser.ask("document.getElementById('speed').value = '1'")?;
        browser.click("play")?;
        let limit = Instant::now() + PLAYING;
        let passed = loop {
            let (label, now) = clock(browser)?;
            ensure!(
                label == "Pause",
                "after a click on Play the button says `{label}`"
            );
            if now >= takeoff + FLYING {
                break now;
            }
            ensure!(
                Instant::now() < limit,
                "the animation stands still: {now} s after {} s of playing",
                PLAYING.as_secs()
            );
            thread::sleep(Duration::from_millis(20));
        };
        let after = self.pictures(browser, "plays")?;
        let moved: Vec<usize> = before
            .iter()
            .zip(&after)
            .map(|(a, b)| a.changed(b))
            .collect();
        for (pane, moved) in moved.iter().enumerate() {
            ensure!(
                *moved >= MOVED,
                "nothing moves in pane {pane}: {moved} pixels changed from {BEGIN} to {passed} s"
            );
        }

        browser.click("play")?;
        let (label, stopped) = clock(browser)?;
        thread::sleep(Duration::from_millis(300));
        let (_, later) = clock(browser)?;
        ensure!(
            label == "Play" && later == stopped,
            "after a click on Pause the button says `{label}` and time goes from {stopped} to {later} s"
        );
        Ok(format!(
            "{moved:?} pixels move while it plays from {BEGIN} to {passed:.3} s"
        ))
    }
}
