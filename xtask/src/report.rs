//! `cargo xtask report`: the report of a run, looked at with a real browser.
//!
//! Chromium opens the file at two times of the animation, which the address asks for. Both pictures must show something, they must
//! differ, and the page must not complain on its console.

use core::time::Duration;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::run;

/// The window, pixels.
const WINDOW: [u32; 2] = [1200, 900];
/// Where the animation is in it: left, top, right, bottom, pixels.
const VIEW: [u32; 4] = [60, 190, 1140, 540];
/// Times of the animation: before the take-off and in flight, s.
const TIMES: [f64; 2] = [0.1, 0.65];
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
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
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
    let [first, second] = TIMES;
    let before = look(&args.browser, &html, &folder, first)?;
    let after = look(&args.browser, &html, &folder, second)?;
    let colors = before.colors();
    ensure!(
        colors >= COLORS,
        "the report shows nothing: {colors} colours in the animation's place"
    );
    let moved = before.changed(&after);
    ensure!(
        moved >= MOVED,
        "the animation stands still: {moved} pixels changed from {first} to {second} s"
    );
    println!("{colors} colours, {moved} pixels move, nothing on the console");
    Ok(())
}

/// Runs a short jump for its report.
fn make(folder: &Path) -> Result<PathBuf> {
    let out = folder.join("run");
    let mut saltus = run::cargo();
    saltus.args(["run", "--release", "--quiet", "--package", "saltus", "--"]);
    saltus
        .args(["run", "a1/lateral", "--json", "--out"])
        .arg(&out);
    run::succeed(saltus.stdout(Stdio::null()))?;
    Ok(out.join("report.html"))
}

/// A picture of the page at a time of the animation; what it says on its console is an error.
fn look(browser: &Path, html: &Path, folder: &Path, time: f64) -> Result<Picture> {
    let png = folder.join(format!("at-{time}-s.png"));
    let log = folder.join(format!("at-{time}-s.log"));
    let [width, height] = WINDOW;
    let mut chromium = Command::new(browser);
    chromium
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--hide-scrollbars",
            "--virtual-time-budget=3000",
            "--enable-logging=stderr",
        ])
        .arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ))
        .arg(format!("--window-size={width},{height}"))
        .arg(format!("--screenshot={}", png.display()))
        .arg(format!("file://{}#t={time}", html.display()))
        .stderr(File::create(&log)?);
    run::stdout_within(&mut chromium, Duration::from_secs(180))?;
    let said = fs::read(&log)?;
    for line in String::from_utf8_lossy(&said).lines() {
        // Software rendering is slow, and the driver says so.
        if line.contains("CONSOLE") && !line.contains("GL Driver Message") {
            bail!("the page says on its console: {line}");
        }
    }
    Picture::read(&png)
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
