//! `cargo xtask report`: the report of a run, looked at with a real browser.
//!
//! Chromium opens the file and presses its buttons. The animation waits where the address asks for, plays when `Play` is clicked and
//! stops when `Pause` is; the picture shows something, it changes while time goes on, and the page says nothing on its console.

use core::time::Duration;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::devtools::Browser;
use crate::{mujoco, run};

/// The window, pixels.
const WINDOW: [u32; 2] = [1200, 900];
/// Where the animation is in it: left, top, right, bottom, pixels.
const VIEW: [u32; 4] = [60, 190, 1140, 540];
/// Time of the animation at which the page is opened, before the take-off, s.
const BEGIN: f64 = 0.1;
/// Time of the animation that playing must reach, in flight, s.
const FLYING: f64 = 0.65;
/// Longest time for that: a quarter of the speed, and a slow machine.
const PLAYING: Duration = Duration::from_secs(60);
/// Fewest colours of a picture that shows something.
const COLORS: usize = 100;
/// Fewest pixels that an animation changes between the two.
const MOVED: usize = 300;

/// Arguments of `cargo xtask report`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// A report to look at; without it one of a1/lateral is made.
    html: Option<PathBuf>,
    /// The browser.
    #[arg(long, env = "SALTUS_BROWSER", default_value = "chromium")]
    browser: PathBuf,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let folder = run::root().join("target/report-check");
    run::remove_folder(&folder)?;
    fs::create_dir_all(&folder)?;
    let html = match &args.html {
        Some(html) => html
            .canonicalize()
            .with_context(|| html.display().to_string())?,
        None => make(&folder)?,
    };
    if !run::exists(&args.browser.to_string_lossy()) {
        run::install_debian(&["chromium"])?;
    }
    let mut browser = Browser::start(&args.browser, &folder.join("profile"), WINDOW)?;
    play(&mut browser, &html, &folder)
}

/// Runs a short jump for its report.
fn make(folder: &Path) -> Result<PathBuf> {
    let out = folder.join("run");
    let mut saltus = mujoco::saltus()?;
    saltus
        .args(["run", "a1/lateral", "--json", "--out"])
        .arg(&out);
    run::succeed(saltus.stdout(Stdio::null()))?;
    Ok(out.join("report.html"))
}

/// What the page shows of time: the label of its button, and where it is, s.
fn clock(browser: &mut Browser) -> Result<(String, f64)> {
    let both = browser.ask(
        "[document.getElementById('play').textContent, +document.getElementById('scrub').value]",
    )?;
    let label = both[0].as_str().context("no button")?;
    Ok((label.to_owned(), both[1].as_f64().context("no time")?))
}

/// A picture of the page, kept as a file.
fn picture(browser: &mut Browser, path: &Path) -> Result<Picture> {
    fs::write(path, browser.picture()?)?;
    Picture::read(path)
}

/// Opens the page, lets it play and stops it.
fn play(browser: &mut Browser, html: &Path, folder: &Path) -> Result<()> {
    browser.open(&format!("file://{}#t={BEGIN}", html.display()))?;
    let (label, begin) = clock(browser)?;
    ensure!(
        label == "Play" && (begin - BEGIN).abs() < 1e-3,
        "at #t={BEGIN} the page shows `{label}` at {begin} s"
    );
    let before = picture(browser, &folder.join("waits.png"))?;
    let colors = before.colors();
    ensure!(
        colors >= COLORS,
        "the report shows nothing: {colors} colours in the animation's place"
    );
    let (_, still) = clock(browser)?;
    ensure!(
        still == begin,
        "the animation does not wait: {begin} to {still} s"
    );

    browser.click("play")?;
    let limit = Instant::now() + PLAYING;
    let passed = loop {
        let (label, now) = clock(browser)?;
        ensure!(
            label == "Pause",
            "after a click on Play the button says `{label}`"
        );
        if now >= FLYING {
            break now;
        }
        ensure!(
            Instant::now() < limit,
            "the animation stands still: {now} s after {} s of playing",
            PLAYING.as_secs()
        );
        thread::sleep(Duration::from_millis(20));
    };
    let after = picture(browser, &folder.join("plays.png"))?;
    let moved = before.changed(&after);
    ensure!(
        moved >= MOVED,
        "nothing moves: {moved} pixels changed from {begin} to {passed} s"
    );

    browser.click("play")?;
    let (label, stopped) = clock(browser)?;
    thread::sleep(Duration::from_millis(300));
    let (_, later) = clock(browser)?;
    ensure!(
        label == "Play" && later == stopped,
        "after a click on Pause the button says `{label}` and time goes from {stopped} to {later} s"
    );
    let said = browser.console();
    ensure!(said.is_empty(), "the page says on its console: {said:?}");
    println!(
        "{colors} colours, {moved} pixels move while it plays from {begin} to {passed:.3} s, nothing on the console"
    );
    Ok(())
}

/// Pixels of the animation's place, red, green, blue.
struct Picture(Vec<[u8; 3]>);

impl Picture {
    fn read(path: &Path) -> Result<Self> {
        let file = File::open(path).with_context(|| format!("no picture at {}", path.display()))?;
        let mut reader = png::Decoder::new(BufReader::new(file)).read_info()?;
        let mut bytes = vec![0; reader.output_buffer_size().context("picture too large")?];
        let info = reader.next_frame(&mut bytes)?;
        let depth = info.color_type.samples();
        ensure!(
            depth >= 3 && [info.width, info.height] == WINDOW,
            "a picture of {} x {} with {depth} channels",
            info.width,
            info.height
        );
        let [left, top, right, bottom] = VIEW;
        let pixel = |x: u32, y: u32| {
            let at = (y * info.width + x) as usize * depth;
            [bytes[at], bytes[at + 1], bytes[at + 2]]
        };
        let rows = (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y)));
        Ok(Self(rows.map(|(x, y)| pixel(x, y)).collect()))
    }

    fn colors(&self) -> usize {
        let mut colors = self.0.clone();
        colors.sort_unstable();
        colors.dedup();
        colors.len()
    }

    fn changed(&self, other: &Self) -> usize {
        self.0.iter().zip(&other.0).filter(|(a, b)| a != b).count()
    }
}

#[cfg(test)]
mod tests {
    use super::Picture;

    #[test]
    fn blank_and_still_are_seen() {
        let blank = Picture(vec![[255; 3]; 1000]);
        let mut drawn = Picture(vec![[255; 3]; 1000]);
        for (i, pixel) in drawn.0.iter_mut().enumerate().take(300) {
            *pixel = [(i % 250) as u8, 0, 0];
        }
        assert_eq!((blank.colors(), drawn.colors()), (1, 251));
        assert_eq!((blank.changed(&blank), blank.changed(&drawn)), (0, 300));
    }
}
