//! The gallery: a page with a card per task, whose pictures show something and whose links lead to reports.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use super::picture::Picture;
use crate::devtools::Browser;

/// Fewest lines of a picture of a jump: a robot has a dozen parts, and is there several times.
const LINES: u64 = 60;
/// Smallest picture of a jump, pixels.
const SMALLEST: [f64; 2] = [250.0, 30.0];
/// Fewest colours of a page that shows something.
const COLORS: usize = 50;

/// Looks at the page in a folder.
pub(super) fn check(browser: &mut Browser, folder: &Path) -> Result<()> {
    browser.open(&format!("file://{}", folder.join("index.html").display()))?;
    let told: Value = serde_json::from_str(&fs::read_to_string(folder.join("gallery.json"))?)?;
    let verdicts = told["verdicts"].as_array().context("no verdicts")?;
    let runs = verdicts.iter().filter(|v| v["error"].is_null()).count();
    let links =
        browser.ask("[...document.querySelectorAll('td a')].map(a => a.getAttribute('href'))")?;
    let links = links.as_array().context("no links")?;
    ensure!(links.len() == runs, "{} links to {runs} runs", links.len());
    for link in links {
        let link = link.as_str().context("no link")?;
        ensure!(
            folder.join(link).exists(),
            "the gallery links {link}, which is not there"
        );
    }
    let pictures = browser.ask(
        "[...document.querySelectorAll('.card')].map(card => { const svg = card.querySelector('.strip svg'), r = svg && svg.getBoundingClientRect(); \
         return [card.querySelector('h2').textContent, svg ? svg.querySelectorAll('path').length : 0, r ? r.width : 0, r ? r.height : 0, \
         card.querySelectorAll('td a').length]; })",
    )?;
    let pictures = pictures.as_array().context("no cards")?;
    ensure!(!pictures.is_empty(), "an empty gallery");
    for card in pictures {
        let [lines, flown] = [1, 4].map(|i| card[i].as_u64().unwrap_or_default());
        let size = [2, 3].map(|i| card[i].as_f64().unwrap_or_default());
        let shows = lines >= LINES && size.iter().zip(SMALLEST).all(|(x, least)| *x >= least);
        ensure!(
            flown == 0 || shows,
            "the picture of {} shows little: {lines} lines, {size:?} pixels",
            card[0]
        );
    }
    let colors = Picture::read(&browser.picture()?)?.colors();
    ensure!(
        colors >= COLORS,
        "the gallery shows nothing: {colors} colours"
    );
    super::silent(browser)?;
    println!(
        "gallery: {} cards, {runs} reports, {colors} colours",
        pictures.len()
    );
    Ok(())
}
