//! `cargo xtask book`: glossary, guide, references and every crate's page as one book, made by mdBook.
//!
//! Pages stay where they are read in the repository. Here they are gathered in `target/book/src` under the same paths, so that links between
//! them hold, and with them what else they link to: pictures and source files. A link to what is not there is an error, a link to a heading
//! as well.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::run;

const VERSION: &str = "0.5.4";

/// Where the words are explained: the first chapter is cut from it.
const CONVENTIONS: &str = "CONVENTIONS.md";
const GLOSSARY: &str = "GLOSSARY.md";
/// The first page of the repository, and its name in the book: mdBook writes the first chapter where `README.md` would be.
const FRONT: [&str; 2] = ["README.md", "SALTUS.md"];

/// Parts of the book. Of what a folder's name stands for, its `README.md` is the page.
const PARTS: [(&str, &[&str]); 4] = [
    (
        "The guide",
        &[
            "docs/guide",
            "docs/guide/0-first-hour.md",
            "docs/guide/1-first-jump.md",
            "docs/guide/2-my-quadruped.md",
            "docs/guide/3-my-task.md",
            "docs/guide/4-firmware.md",
            "docs/guide/5-whole-body-control.md",
            "docs/guide/6-maths.md",
            "docs/guide/7-how-we-know.md",
        ],
    ),
    (
        "To look up",
        &[
            CONVENTIONS,
            "jump-planner/tasks",
            "docs/JUMPS.md",
            "docs/EQUATIONS.md",
            "docs/PEERS.md",
            "docs/CRATES.md",
        ],
    ),
    (
        "Programs and crates",
        &[
            "saltus",
            "python",
            "firmware",
            "firmware/c-abi",
            "so3",
            "rbd-core",
            "a1-model",
            "icub-model",
            "model-import",
            "ocp-solver",
            "dense-qp",
            "srb-opt",
            "wb-opt",
            "jump-planner",
            "reference-problems",
            "wbc-qp",
            "landing",
            "jump-control",
            "jump-machine",
            "state-est",
            "robot-link",
            "contact-sim",
            "jump-lab",
        ],
    ),
    (
        "How it is built",
        &["ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"],
    ),
];

const CONFIGURATION: &str = r#"[book]
title = "Saltus"
description = "Jumps of legged robots: planned, audited, flown"
language = "en"

[output.html]
no-section-label = true

[output.html.print]
enable = false

[output.html.playground]
runnable = false
"#;

/// Arguments of `cargo xtask book`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only gather the pages, and see that every link leads to a file.
    #[arg(long)]
    links: bool,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let home = run::root().join("target/book");
    run::remove_folder(&home)?;
    let mut book = Book {
        source: home.join("src"),
        chapters: PARTS
            .iter()
            .flat_map(|(_, pages)| pages.iter().map(|page| resolve(Path::new(page))))
            .collect::<Result<_>>()?,
        anchors: Vec::new(),
    };
    book.chapters.push(FRONT[0].into());
    let words = glossary()?;
    book.page(Path::new(GLOSSARY), &words)?;
    // Pages that are only linked to are chapters too: the list grows while it is read.
    let mut next = 0;
    while let Some(page) = book.chapters.get(next).cloned() {
        let text = fs::read_to_string(run::root().join(&page));
        book.page(&page, &text.with_context(|| page.display().to_string())?)?;
        next += 1;
    }
    fs::write(book.source.join("SUMMARY.md"), book.summary()?)?;
    fs::write(home.join("book.toml"), CONFIGURATION)?;
    if args.links {
        let pages = book.chapters.len() + 1;
        println!("book: every link of {pages} pages leads to a file");
        return Ok(());
    }
    run::succeed(Command::new(program()?).arg("build").arg(&home))?;
    book.check(&home.join("book"))?;
    println!(
        "book: {} chapters in {}",
        book.chapters.len() + 1,
        home.join("book/index.html").display()
    );
    Ok(())
}

/// mdBook, built once.
fn program() -> Result<PathBuf> {
    let home = run::root().join("target/mdbook");
    let program = home.join("bin/mdbook");
    if !program.exists() {
        let mut install = run::cargo();
        // It runs for a second: to optimise it would take longer.
        install.args(["install", "mdbook", "--version", VERSION, "--locked"]);
        install.args(["--debug", "--no-default-features", "--features", "search"]);
        install.arg("--root").arg(&home);
        run::succeed(install.env("CARGO_TARGET_DIR", home.join("build")))?;
    }
    Ok(program)
}

/// The glossary as a page.
fn glossary() -> Result<String> {
    let text = fs::read_to_string(run::root().join(CONVENTIONS))?;
    let (_, rest) = text
        .split_once("\n## Glossary\n")
        .context("CONVENTIONS.md has no glossary")?;
    let end = rest.find("\n## ").unwrap_or(rest.len());
    Ok(format!("# Glossary\n{}", &rest[..end]))
}

/// The page or file that a path of the repository stands for: of a folder what is read first in it.
fn resolve(path: &Path) -> Result<PathBuf> {
    let whole = run::root().join(path);
    if whole.is_file() {
        return Ok(path.to_owned());
    }
    let first = ["README.md", "lib.rs", "mod.rs", "src/lib.rs"];
    let found = first.iter().find(|name| whole.join(name).is_file());
    let found = found.with_context(|| format!("there is nothing to read at {}", path.display()))?;
    Ok(path.join(found))
}

/// `from/../to` without the detour.
fn simplified(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                out.pop();
            }
            Component::CurDir => {}
            other => out.push(other),
        }
    }
    out
}

/// A path of the repository, in the book.
fn placed(path: &Path) -> &Path {
    if path == Path::new(FRONT[0]) {
        Path::new(FRONT[1])
    } else {
        path
    }
}

/// A page's first heading.
fn title(text: &str) -> Option<&str> {
    text.lines().find_map(|line| line.strip_prefix("# "))
}

struct Book {
    source: PathBuf,
    /// Pages of the repository.
    chapters: Vec<PathBuf>,
    /// Page that links, page linked to, and heading.
    anchors: Vec<(PathBuf, PathBuf, String)>,
}

impl Book {
    /// Writes a page, its links led to where they are in the book, and what else it links to.
    fn page(&mut self, page: &Path, text: &str) -> Result<()> {
        let folder = page.parent().unwrap_or(Path::new(""));
        let mut out = String::new();
        let mut code = false;
        for line in text.lines() {
            code ^= line.trim_start().starts_with("```");
            let mut rest = line;
            while let Some(at) = rest.find("](").filter(|_| !code) {
                let (before, after) = rest.split_at(at + 2);
                let (target, end) = after.split_once(')').context("a link without an end")?;
                out += before;
                out += &self
                    .link(page, folder, target)
                    .with_context(|| page.display().to_string())?;
                out.push(')');
                rest = end;
            }
            out += rest;
            out.push('\n');
        }
        let to = self.source.join(placed(page));
        fs::create_dir_all(to.parent().context("a page without a folder")?)?;
        Ok(fs::write(to, out)?)
    }

    /// A link as it is in the book; its target becomes a chapter or is copied.
    fn link(&mut self, page: &Path, folder: &Path, target: &str) -> Result<String> {
        // Elsewhere, or an item of a crate's documentation.
        if target.contains("://") || target.contains("::") {
            return Ok(target.to_owned());
        }
        let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
        let to = match path {
            "" => page.to_owned(),
            path => resolve(&simplified(&folder.join(path)))?,
        };
        if !anchor.is_empty() {
            let link = (page.to_owned(), to.clone(), anchor.to_owned());
            self.anchors.push(link);
        }
        if to.extension().is_none_or(|end| end != "md") {
            let copy = self.source.join(&to);
            fs::create_dir_all(copy.parent().context("a file without a folder")?)?;
            fs::copy(run::root().join(&to), copy)?;
        } else if to != Path::new(GLOSSARY) && !self.chapters.contains(&to) {
            self.chapters.push(to.clone());
        }
        if path.is_empty() {
            return Ok(target.to_owned());
        }
        let up = "../".repeat(folder.components().count());
        let end = if anchor.is_empty() { "" } else { "#" };
        Ok(format!("{up}{}{end}{anchor}", placed(&to).display()))
    }

    /// The table of contents.
    fn summary(&self) -> Result<String> {
        let entry = |page: &Path| -> Result<String> {
            let text = fs::read_to_string(self.source.join(placed(page)))?;
            let title = title(&text).with_context(|| format!("{} has no title", page.display()))?;
            Ok(format!("- [{title}]({})\n", placed(page).display()))
        };
        let mut out = format!("# Summary\n\n[Glossary]({GLOSSARY})\n\n");
        out += &entry(Path::new(FRONT[0]))?;
        let mut told = BTreeSet::from([PathBuf::from(FRONT[0])]);
        for (part, pages) in PARTS {
            out += &format!("\n# {part}\n\n");
            for page in pages {
                let page = resolve(Path::new(page))?;
                out += &entry(&page)?;
                told.insert(page);
            }
        }
        for page in self.chapters.iter().filter(|page| !told.contains(*page)) {
            out += &entry(page)?;
        }
        Ok(out)
    }

    /// That every page was written, and has the headings that others link to.
    fn check(&self, made: &Path) -> Result<()> {
        let html = |page: &Path| -> Result<String> {
            let path = made.join(placed(page)).with_extension("html");
            let index = path.with_file_name("index.html");
            let readme = path.file_stem().is_some_and(|stem| stem == "README");
            let path = if readme { index } else { path };
            fs::read_to_string(&path).with_context(|| path.display().to_string())
        };
        for page in &self.chapters {
            html(page)?;
        }
        for (from, to, anchor) in &self.anchors {
            if !html(to)?.contains(&format!("id=\"{anchor}\"")) {
                bail!("{}: {} has no #{anchor}", from.display(), to.display());
            }
        }
        ensure!(
            made.join("index.html").is_file(),
            "the book has no first page"
        );
        Ok(())
    }
}
